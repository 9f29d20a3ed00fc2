"""What is shown follows edits: labels, axes and loupes, the badge with an accurate run behind, the size of the window."""

from __future__ import annotations

from dataclasses import replace

import pygame
import pytest
from softcradle.sandbox.session.inputs import SetContact, SetVelocity
from softcradle.sandbox.window.scene.editor import Pick

from tests.helpers.windows import Driver

pytestmark = pytest.mark.usefixtures("own_folder")


def test_axes_and_loupes_follow_another_exponent(driver: Driver) -> None:
    before = driver.page.view.scales.scales
    law = driver.session.lanes[0].chain.contact[0]
    driver.session.apply(SetContact(0, None, replace(law, exponent=0.02)))
    driver.until(lambda: driver.page.view.scales.scales.decades != before.decades)
    after = driver.page.view.scales.scales
    assert after.decades[0] < before.decades[0] - 10
    assert after.deepest[0][3] < 1e-6 * before.deepest[0][3]
    assert driver.page.view.lanes[0].drawing.label == "alpha = 1/50"


def test_the_badge_tells_the_error_of_velocities(driver: Driver) -> None:
    assert driver.page.cards.health[0].velocity_error is None
    driver.key(pygame.K_SPACE)
    driver.frames(330)
    driver.key(pygame.K_SPACE)
    driver.until(lambda: driver.page.cards.health[0].velocity_error is not None)
    assert driver.page.cards.health[0].velocity_error < 1e-3


def test_the_badge_goes_to_the_fault_of_the_run() -> None:
    driver = Driver("draft-gear-one-on-three")
    for _ in range(2):
        driver.key(pygame.K_m, pygame.KMOD_SHIFT)
    driver.key(pygame.K_SPACE)
    driver.frames(900)
    button = driver.page.cards.verdicts[0]
    assert "chattered" in button.text
    driver.click(button.rect.center)
    driver.frames(2)
    assert driver.session.scrubbed
    assert driver.session.frame == driver.session.findings(0)[0].first
    driver.close()


def test_fullscreen_gives_the_size_back(driver: Driver) -> None:
    driver.key(pygame.K_F11)
    driver.frames(2)
    driver.key(pygame.K_F11)
    driver.frames(2)
    assert driver.app.size == (1280, 720)


def settled(driver: Driver) -> object:
    """The scales once they follow the last edit."""
    driver.frames(30)
    driver.until(lambda: not driver.page.view.follower.pending)
    driver.frames(2)
    return driver.page.view.scales.scales


def test_scales_of_an_edit_that_is_undone_go_with_it(driver: Driver) -> None:
    before = driver.page.view.scales.scales
    driver.key(pygame.K_SPACE)
    driver.frames(300)
    driver.key(pygame.K_SPACE)
    driver.key(pygame.K_r)
    driver.page.editor.apply(SetVelocity(0, 0, -8.0))
    assert settled(driver).velocity[0] < -7.0
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.until(lambda: driver.page.view.scales.scales == before)


def test_scales_of_a_throw_that_is_undone_go_with_it(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(240)
    before = settled(driver)
    centre = driver.bead(4)
    driver.drag(centre, (centre[0] - 400, centre[1]), steps=4)
    driver.frames(20)
    driver.release(centre)
    driver.frames(60)
    assert driver.page.view.scales.scales.energy > 2.0 * before.energy
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.key(pygame.K_r)
    driver.until(lambda: driver.page.view.scales.scales == before)


def test_the_smallest_overlap_stays_on_its_axis_after_beads_were_removed_and_brought_back(driver: Driver) -> None:
    before = driver.page.view.scales.scales.decades
    driver.page.editor.selection = Pick(0, "bead", 4)
    driver.drag(driver.bead(4), (driver.bead(4)[0] - 120, driver.bead(4)[1]))
    driver.key(pygame.K_DELETE)
    driver.release(driver.bead(3))
    driver.page.editor.selection = Pick(0, "bead", 3)
    driver.key(pygame.K_DELETE)
    driver.frames(40)
    while driver.session.undo_stack.done:
        driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.until(lambda: driver.page.view.scales.scales.decades == before)
