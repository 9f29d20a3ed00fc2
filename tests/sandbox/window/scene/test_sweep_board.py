"""The sweep of a slider: nine values side by side, each the motion that it really makes."""

from __future__ import annotations

import pygame
import pytest
from softcradle.physics import one_on, power_law, simulate
from softcradle.sandbox.window.scene.editor import Pick
from softcradle.sandbox.window.scene.inspector import COUNT, SweepBoard

from tests.helpers.windows import Driver


def swept(driver: Driver) -> SweepBoard:
    """The board, when all is computed."""
    board = driver.app.dialog
    assert isinstance(board, SweepBoard)
    driver.until(lambda: board.found is not None)
    return board


def test_each_of_nine_masses_has_the_motion_that_it_makes(driver: Driver) -> None:
    driver.page.editor.selection = Pick(0, "bead", 0)
    driver.frames(2)
    driver.click(driver.page.inspector.controls["mass"].sweep.rect.center)
    board = swept(driver)
    masses = [variant.value for variant in board.found]
    assert len(masses) == COUNT
    assert masses == sorted(masses)
    law = power_law(1.0, 0.1)
    for variant in (board.found[4], board.found[7]):
        chain = one_on(4, law, mass=[variant.value, 1.0, 1.0, 1.0, 1.0])
        exact = simulate(chain, [1.0, 0.0, 0.0, 0.0, 0.0])
        assert variant.motion.velocity[-1] == pytest.approx(exact.final_velocity, abs=5e-3)
    assert board.focus == 4  # the present mass
    driver.key(pygame.K_DOWN)
    driver.key(pygame.K_RETURN)
    assert driver.session.lanes[0].chain.mass[0] == masses[7]
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert driver.session.lanes[0].chain.mass[0] == 1.0


def test_a_click_takes_a_value_and_a_key_sweeps_the_slider_used_last(driver: Driver) -> None:
    driver.key(pygame.K_y)
    assert "select a bead or a contact" in driver.messages[-1]
    driver.page.editor.selection = Pick(0, "contact", 1)
    driver.frames(2)
    control = driver.page.inspector.controls["preload"]
    driver.click((control.slider.rect.centerx, control.slider.rect.centery))
    driver.frames(2)
    driver.key(pygame.K_y)
    board = swept(driver)
    assert board.parameter.key == "preload"
    driver.frames(2)
    wanted = board.found[8].value
    driver.click(board.places[8].center)
    assert driver.session.lanes[0].chain.contact[1].preload == pytest.approx(wanted)
    driver.key(pygame.K_y)
    swept(driver)
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.dialog.open
