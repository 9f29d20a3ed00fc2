"""The whole of a lesson without a mouse: choose, play, look back, edit by sliders and boxes, undo, save, leave."""

from __future__ import annotations

from pathlib import Path

import pygame
import pytest
from pygame_gui.elements import UIButton, UIDropDownMenu, UITextEntryLine
from softcradle.sandbox.window.gallery.page import GalleryPage
from softcradle.sandbox.window.widgets import KEYS, REPEAT, Slider

from tests.helpers.windows import Driver

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


def focus(driver: Driver, wanted) -> None:
    """Press Tab until the control is reached."""
    for _ in range(len(driver.app.focus.controls()) + 1):
        driver.key(pygame.K_TAB)
        control = driver.app.focus.control
        if control is not None and wanted(control):
            return
    raise AssertionError("Tab does not reach it")


def test_a_lesson_without_a_mouse(tmp_path: Path) -> None:
    driver = Driver()
    driver.key(pygame.K_f, CTRL)
    driver.type("four")
    driver.key(pygame.K_RETURN)  # the first that is found
    assert driver.session.scene.title == "One bead on four"
    driver.key(pygame.K_SPACE)
    driver.frames(60)
    focus(driver, lambda one: one is driver.page.time_controls.buttons["play_pause"])
    driver.key(pygame.K_RETURN)
    assert not driver.session.playing
    driver.key(pygame.K_HOME)
    assert driver.session.scrubbed
    driver.key(pygame.K_ESCAPE)
    for _ in range(3):
        driver.key(pygame.K_RIGHT)  # bead 0, contact 01, bead 1
    focus(driver, lambda one: isinstance(one, UITextEntryLine))
    driver.page.inspector.controls["mass"].entry.set_text("2.5")
    driver.key(pygame.K_RETURN)
    assert driver.session.lanes[0].chain.mass[1] == 2.5
    driver.key(pygame.K_ESCAPE)
    focus(driver, lambda one: isinstance(one, Slider) and one is driver.page.inspector.controls["mass"].slider)
    driver.key(pygame.K_PAGEUP)
    driver.frames(2)
    assert driver.session.lanes[0].chain.mass[1] > 2.5
    focus(driver, lambda one: isinstance(one, UIDropDownMenu))
    driver.key(pygame.K_DOWN)
    driver.frames(2)
    assert driver.session.lanes[0].setup.method == "euler"
    focus(driver, lambda one: isinstance(one, UIButton) and one.text == "Undo")
    for _ in range(3):
        driver.key(pygame.K_SPACE)
        driver.frames(2)
    assert driver.session.lanes[0].chain.mass[1] == 1.0
    driver.key(pygame.K_y, CTRL)
    driver.key(pygame.K_s, CTRL)
    driver.app.dialog.entry.set_text("mine.toml")
    driver.key(pygame.K_RETURN)
    assert (tmp_path / "mine.toml").exists()
    for _ in range(4):
        driver.key(pygame.K_ESCAPE)
    assert isinstance(driver.app.page, GalleryPage)


@pytest.mark.parametrize("name", ["one-on-four", "beads-against-gear", "hanging-cradle"])
def test_tab_reaches_every_control_and_comes_back(name: str) -> None:
    driver = Driver(name)
    controls = driver.app.focus.controls()
    assert len(controls) > 4
    reached = []
    for _ in controls:
        driver.key(pygame.K_TAB)
        reached.append(driver.app.focus.control)
    assert set(reached) == set(controls)
    driver.key(pygame.K_TAB, SHIFT)
    assert driver.app.focus.control is reached[-2]
    driver.click((400, 300))
    assert driver.app.focus.control is None


@pytest.mark.parametrize(("key", "by"), KEYS.items(), ids=[pygame.key.name(key) for key in KEYS])
def test_keys_move_a_slider(driver: Driver, key: int, by: float) -> None:
    driver.click(driver.bead(2))
    slider = driver.page.inspector.controls["velocity"].slider
    focus(driver, lambda one: one is slider)
    driver.key(pygame.K_UP)  # away from its middle, at which a value is 0
    before, speed = slider.get_current_value(), driver.session.lanes[0].velocity[2]
    driver.key(key)
    driver.frames(2)
    assert slider.get_current_value() == pytest.approx(min(max(before + by, 0.0), 1.0), abs=2e-3)
    assert (driver.session.lanes[0].velocity[2] > speed) == (by > 0.0)


def test_keys_that_are_held_repeat_after_something_was_typed(driver: Driver) -> None:
    driver.click(driver.bead(1))
    driver.click(driver.page.inspector.controls["mass"].entry.rect.center)
    driver.key(pygame.K_RETURN)
    assert pygame.key.get_repeat() == REPEAT
