"""The inspector: typed numbers, sliders, and which of them there are."""

from __future__ import annotations

from pathlib import Path

import pygame
import pytest
from softcradle.physics import power_law
from softcradle.sandbox.session.inputs import SetContact
from softcradle.sandbox.window.scene.editor import Pick
from softcradle.sandbox.window.widgets import number

from tests.helpers.windows import Driver

SCENE = """
title = "Friction, loss and drive"
duration = 5.0
[[lanes]]
beads = [1, 2]
contact = {law = "draft_gear", stiffness = 100.0, precompression = 0.1, loss = 0.5}
velocity = 1.0
friction = 0.1
drive = [0.5, 0.0, 0.0]
"""


def test_a_typed_mass_and_a_slider_act_in_the_next_frame(driver: Driver) -> None:
    driver.click(driver.bead(2))
    control = driver.page.inspector.controls["mass"]
    driver.click(control.entry.rect.center)
    control.entry.set_text("")
    driver.type("2.5")
    driver.key(pygame.K_RETURN)
    assert driver.session.lanes[0].chain.mass[2] == 2.5
    slider = driver.page.inspector.controls["mass"].slider
    driver.press(slider.sliding_button.rect.center)
    driver.move((slider.rect.left + 30, slider.rect.centery), (1, 0, 0))
    driver.frames(2)
    assert driver.session.lanes[0].chain.mass[2] < 0.1
    driver.release((slider.rect.left + 30, slider.rect.centery))


def test_keys_do_nothing_while_a_number_is_typed(driver: Driver) -> None:
    driver.click(driver.bead(2))
    driver.click(driver.page.inspector.controls["mass"].entry.rect.center)
    driver.type("r a")
    assert driver.session.lanes[0].chain.contacts == 4
    assert not driver.session.playing
    driver.key(pygame.K_ESCAPE)
    assert not driver.page.typing
    driver.key(pygame.K_a)
    assert driver.session.lanes[0].chain.contacts == 5


def test_friction_drive_and_loss_have_sliders_where_the_scene_has_them(tmp_path: Path) -> None:
    (tmp_path / "dissipative.toml").write_text(SCENE)
    driver = Driver(str(tmp_path / "dissipative.toml"))
    driver.click(driver.bead(0))
    for key, value in (("friction", 0.25), ("drive", 0.75)):
        controls = driver.page.inspector.controls
        driver.click(controls[key].entry.rect.center)
        controls[key].entry.set_text(f"{value}")
        driver.key(pygame.K_RETURN)
    chain = driver.session.lanes[0].chain
    assert (chain.friction, chain.drive) == (0.25, (0.75, 0.0, 0.0))
    driver.key(pygame.K_RIGHT)
    assert driver.page.editor.selection == Pick(0, "contact", 0)
    slider = driver.page.inspector.controls["loss"].slider.sliding_button.rect
    driver.drag(slider.center, (slider.centerx + 400, slider.centery))
    driver.release((slider.centerx + 400, slider.centery))
    driver.frames(2)
    assert driver.session.lanes[0].chain.contact[0].loss == 0.95
    driver.key(pygame.K_SPACE)
    driver.frames(120)
    assert driver.session.health(0).energy_error < 1e-9


def test_friction_and_drive_can_be_given_to_any_scene(driver: Driver) -> None:
    driver.click(driver.bead(0))
    for key, value in (("friction", 0.25), ("drive", 0.75)):
        control = driver.page.inspector.controls[key]
        driver.click(control.entry.rect.center)
        control.entry.set_text(f"{value}")
        driver.key(pygame.K_RETURN)
    chain = driver.session.lanes[0].chain
    assert (chain.friction, chain.drive) == (0.25, (0.75, 0.0, 0.0, 0.0, 0.0))
    driver.key(pygame.K_SPACE)
    driver.frames(30)
    assert driver.session.health(0).level == "good"


@pytest.mark.parametrize(
    ("text", "value"), [("0,5", 0.5), ("1/14", 1 / 14), ("\N{MINUS SIGN}2e-3", -2e-3), (" 7 ", 7.0)]
)
def test_numbers_are_read_as_people_type_them(text, value):
    assert number(text) == value


@pytest.mark.parametrize("text", ["", "x", "1/0", "1/", "--1"])
def test_a_text_that_is_no_number_is_refused(text):
    with pytest.raises(ValueError):  # noqa: PT011 - the inspector names the field and the text itself
        number(text)


def test_the_slider_goes_where_its_number_is(driver: Driver) -> None:
    """After a typed number, and while the model changes it."""
    driver.click(driver.bead(0))
    driver.click(driver.page.inspector.controls["velocity"].entry.rect.center)
    driver.page.inspector.controls["velocity"].entry.set_text("-8")
    driver.key(pygame.K_RETURN)
    driver.frames(20)
    control = driver.page.inspector.controls["velocity"]
    assert control.parameter.value == -8.0
    assert control.slider.current_value == pytest.approx(control.parameter.share(), abs=0.01)
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.play(300)
    driver.frames(20)
    control = driver.page.inspector.controls["velocity"]
    assert control.parameter.value < 0.5
    assert control.slider.current_value == pytest.approx(control.parameter.share(), abs=0.01)


def test_the_kind_of_a_contact_says_what_its_law_is(driver: Driver) -> None:
    """A spring of 1 N/m is not hard."""
    driver.page.editor.selection = Pick(0, "contact", 1)
    driver.session.apply(SetContact(0, 1, power_law(1.0, 1.0)))
    driver.frames(2)
    lit = [button.text for button in driver.page.inspector.buttons if button.is_selected]
    assert lit == ["alpha ≥ 1"]


def test_a_coupler_is_of_none_of_the_kinds() -> None:
    """Wagons are coupled: none of the three kinds is lit, and the buttons are there."""
    driver = Driver("train-starting")
    driver.page.editor.selection = Pick(0, "contact", 1)
    driver.frames(2)
    assert driver.page.inspector.buttons
    assert not [button.text for button in driver.page.inspector.buttons if button.is_selected]
