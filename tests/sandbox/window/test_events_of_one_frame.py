"""Events of one frame: an edit, and a click on what was drawn before it."""

from __future__ import annotations

import random

import pygame
import pytest
from softcradle.sandbox.session.inputs import AddBead, RemoveBead
from softcradle.sandbox.window.scene.editor import Pick

from tests.helpers.windows import FRAME, Driver

CLICKS = 40  # a view and edit
EDITS = {"remove": (pygame.K_DELETE, 0), "undo": (pygame.K_z, pygame.KMOD_CTRL), "redo": (pygame.K_y, pygame.KMOD_CTRL)}
pytestmark = pytest.mark.usefixtures("own_folder")


def pressed(key: int, modifiers: int = 0) -> list[pygame.Event]:
    return [
        pygame.Event(kind, key=key, mod=modifiers, unicode="", scancode=0) for kind in (pygame.KEYDOWN, pygame.KEYUP)
    ]


def clicked(point: tuple[int, int]) -> list[pygame.Event]:
    return [pygame.Event(kind, pos=point, button=1) for kind in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP)]


def last_bead(driver: Driver) -> int:
    return driver.session.lanes[-1].chain.contacts


@pytest.mark.parametrize("table", [False, True], ids=["plots", "table"])
@pytest.mark.parametrize("edit", EDITS)
def test_a_click_meets_the_chain_that_an_edit_of_the_same_frame_has_left(
    driver: Driver, table: bool, edit: str
) -> None:
    rng, page = random.Random(f"{table} {edit}"), driver.page
    if table:
        driver.key(pygame.K_t)
    beads = last_bead(driver)
    for _ in range(CLICKS):
        assert page.editor.apply(RemoveBead(0, beads) if edit == "redo" else AddBead(0, beads + 1, 1.0))
        if edit == "redo":
            driver.session.undo()
        page.editor.selection = Pick(0, "bead", last_bead(driver))
        driver.frames()
        area = page.view.plots_area() if rng.random() < 0.6 else page.view.places.lanes[0]
        point = rng.randrange(area.left, area.right), rng.randrange(area.top, area.bottom)
        before = last_bead(driver)
        driver.app.frame(FRAME, [*pressed(*EDITS[edit]), *clicked(point)])
        assert last_bead(driver) == before - 1
        assert len(page.view.lanes[0].edges) == before
        page.cancel_typing()
        if edit == "redo":
            driver.session.undo()
        driver.frames()
