"""Half a minute of random input for each seed; an hour of it is `python -m tests.helpers.window_fuzz`."""

from __future__ import annotations

from pathlib import Path

import pygame
import pytest
from softcradle.sandbox.session.inputs import AddBead, RemoveBead

from tests.helpers.window_fuzz import Fuzz, run
from tests.helpers.windows import Driver

pytestmark = pytest.mark.usefixtures("own_folder")  # keys change settings


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_random_input_causes_no_exception_and_every_number_is_finite(seed: int, tmp_path: Path) -> None:
    fuzz = Fuzz(seed, tmp_path)
    run(fuzz, 1800)
    assert fuzz.driver.app.running


def test_the_cursor_reads_frames_from_before_beads_were_removed() -> None:
    """There are then more values than names, and more than are listed: found by the fuzz."""
    driver = Driver("one-on-ten")
    for _ in range(3):
        driver.session.apply(AddBead(0, 1))
    driver.session.step_frames(60)
    for _ in range(3):
        driver.session.apply(RemoveBead(0, 1))
    driver.session.step_frames(5)
    driver.frames(2)
    for plot in driver.page.board.plots:
        for x in range(plot.area.left, plot.area.right, 7):
            driver.page.board.paint_reading(driver.app.surface, (x, plot.area.centery))
    driver.close()


def test_an_edit_that_is_undone_in_the_frame_in_which_the_page_was_built_anew() -> None:
    """The page was then built of beads that there are no more: found by the fuzz."""
    driver = Driver("one-on-four")
    driver.click(driver.bead(2))
    driver.session.step_frames(200)
    driver.frames(2)
    for code, modifiers in ((pygame.K_DELETE, 0), (pygame.K_i, 0), (pygame.K_z, pygame.KMOD_CTRL)):
        pygame.event.post(pygame.Event(pygame.KEYDOWN, key=code, mod=modifiers, unicode="", scancode=0))
    driver.frames(2)
    assert driver.session.lanes[0].chain.contacts == 4
    assert [len(depths) for depths in driver.page.view.scales.scales.deepest] == [4]
    assert driver.page.view.lanes[0].drawing.chain == driver.session.lanes[0].chain
    driver.close()
