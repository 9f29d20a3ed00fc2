"""Tests of the table of keys. The tests check that every control can be used without a mouse."""

import pygame
import pytest
from pygame_gui.elements import UIButton, UIDropDownMenu, UITextEntryLine
from softcradle.sandbox.draw.text import width
from softcradle.sandbox.languages import LANGUAGES, gettext, use_language
from softcradle.sandbox.window.keys import COLUMN, CTRL, KEYS_ROOM, MOUSE, ORDER, SHIFT, action_of, bindings, groups
from softcradle.sandbox.window.widgets import KEYS, REPEAT

from tests.helpers.windows import FRAME, Driver, pressed


def test_every_key_has_one_action(driver: Driver) -> None:
    keys = [key for binding in bindings() for key in binding.keys]
    assert len(keys) == len(set(keys))
    offered = set(driver.app.actions) | set(driver.page.actions)
    driver.key(pygame.K_ESCAPE)
    offered |= set(driver.app.page.actions)
    assert {binding.action for binding in bindings()} == offered


def test_a_key_that_is_held_repeats_only_what_is_gradual(driver: Driver) -> None:
    """Check that a key that is held down repeats its action only if the action is gradual.

    While a key is held down, the operating system sends repeated key-down events.
    """

    def hold(code, times=5):
        driver.app.frame(FRAME, pressed(code, times=times))
        driver.frames(2)

    hold(pygame.K_PERIOD)
    assert driver.session.frame == 5
    hold(pygame.K_COMMA)
    assert driver.session.frame == 0
    beads = len(driver.session.lanes[0].chain.mass)
    driver.key(pygame.K_RIGHT)
    hold(pygame.K_a)
    assert len(driver.session.lanes[0].chain.mass) == beads + 1
    driver.click(driver.page.inspector.controls["mass"].entry.rect.center)
    driver.key(pygame.K_RETURN)
    assert pygame.key.get_repeat() == REPEAT  # After typing in a text box, the normal repeat rate of keys is restored.
    hold(pygame.K_SPACE, 4)
    assert driver.session.playing


@pytest.mark.parametrize(
    ("action", "keys"),
    [
        ("larger", [(pygame.K_EQUALS, CTRL | SHIFT, "+"), (pygame.K_EQUALS, CTRL, "=")]),  # English keyboard.
        ("larger", [(pygame.K_PLUS, CTRL, "+"), (pygame.K_KP_PLUS, CTRL, "+")]),  # German keyboard.
        ("smaller", [(pygame.K_KP_MINUS, CTRL, "-"), (pygame.K_MINUS, CTRL, "")]),
        ("faster", [(pygame.K_KP_PLUS, 0, "+")]),
        ("slower", [(pygame.K_MINUS, SHIFT, "")]),  # On some keyboards, the minus sign needs the Shift key.
        ("forward", [(pygame.K_SEMICOLON, SHIFT, ".")]),  # French keyboard.
        ("back", [(pygame.K_COMMA, 0, ",")]),
        ("next_event", [(pygame.K_PERIOD, SHIFT, ">"), (pygame.K_PERIOD, SHIFT, ":")]),  # English and German keyboard.
        ("save_scene", [(pygame.K_s, pygame.KMOD_LCTRL, "")]),
        ("save_session", [(pygame.K_s, pygame.KMOD_RMETA | pygame.KMOD_SHIFT, "")]),
        (None, [(pygame.K_QUOTE, SHIFT, "*"), (pygame.K_s, 0, ""), (pygame.K_r, pygame.KMOD_ALT, "")]),
    ],
)
def test_keys_work_on_every_keyboard_layout(action, keys):
    assert [action_of(*key) for key in keys] == [action] * len(keys)


def test_the_letter_of_a_key_does_not_land_in_the_line_that_it_opens(driver: Driver) -> None:
    driver.key(pygame.K_x, text="x")
    driver.type("meas.csv")
    assert driver.app.dialog.entry.get_text() == "meas.csv"
    driver.key(pygame.K_ESCAPE)
    driver.key(pygame.K_8, SHIFT, "*")
    assert driver.app.dialog.entry.get_text() == "f0 against d0"
    driver.key(pygame.K_ESCAPE)
    driver.app.act("plots_menu")
    driver.app.dialog.focus = driver.app.dialog.names.index("data")
    driver.key(pygame.K_SPACE, text=" ")
    assert driver.app.dialog.entry.get_text() == ""


def test_escape_closes_an_open_list_and_nothing_else(driver: Driver) -> None:
    driver.click(driver.bead(1))
    driver.click(driver.page.cards.menus[0].rect.center)
    menu = driver.page.cards.menus[0]
    assert menu.current_state is menu.menu_states["expanded"]
    driver.key(pygame.K_ESCAPE)
    assert menu.current_state is menu.menu_states["closed"]
    assert driver.page.editor.selection is not None


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_help_text_fits_its_column(code):
    assert sorted(ORDER) == sorted([*groups(), "Mouse"])
    use_language(code)
    bindings = [binding for group in groups().values() for binding in group]
    texts = [gettext(text) for text in [binding.text for binding in bindings] + [text for _, text in MOUSE]]
    keys = [str(binding.keys[0]) for binding in bindings] + [gettext(what) for what, _ in MOUSE]
    assert not [text for text in texts if KEYS_ROOM + 2 + width(text, 13.0) > COLUMN + 15]
    assert not [text for text in keys if width(text, 13.0, bold=True) + 10 > KEYS_ROOM]


def focus(driver: Driver, wanted) -> None:
    for _ in range(len(driver.app.focus.controls()) + 1):
        driver.key(pygame.K_TAB)
        control = driver.app.focus.control
        if control is not None and wanted(control):
            return
    raise AssertionError("Tab does not reach it")


def test_every_kind_of_control_is_used_by_keys(driver: Driver) -> None:
    focus(driver, lambda one: one is driver.page.time_controls.buttons["play_pause"])
    driver.key(pygame.K_RETURN)
    assert driver.session.playing
    driver.key(pygame.K_RETURN)
    assert not driver.session.playing
    driver.key(pygame.K_RIGHT, times=3)  # The three key presses select bead 0, contact 0-1 and bead 1.
    focus(driver, lambda one: isinstance(one, UITextEntryLine))
    driver.page.inspector.controls["mass"].entry.set_text("2.5")
    driver.key(pygame.K_RETURN)
    assert driver.session.lanes[0].chain.mass[1] == 2.5
    slider = driver.page.inspector.controls["velocity"].slider
    focus(driver, lambda one: one is slider)
    driver.key(pygame.K_UP)  # Move the slider away from its middle, because the velocity is 0 in the middle.
    for key, by in KEYS.items():
        before, speed = slider.get_current_value(), driver.session.lanes[0].velocity[1]
        driver.key(key)
        assert slider.get_current_value() == pytest.approx(min(max(before + by, 0.0), 1.0), abs=2e-3), key
        assert (driver.session.lanes[0].velocity[1] > speed) == (by > 0.0), key
    focus(driver, lambda one: isinstance(one, UIDropDownMenu))
    driver.key(pygame.K_DOWN)
    assert driver.session.lanes[0].setup.method == "euler"
    focus(driver, lambda one: isinstance(one, UIButton) and one.text == "Undo")
    driver.key(pygame.K_SPACE)
    assert driver.session.lanes[0].setup.method == "conserving"


@pytest.mark.parametrize("name", ["one-on-four", "beads-against-gear", "cradle"])
def test_tab_reaches_every_control(name: str) -> None:
    driver = Driver(name)
    driver.key(pygame.K_RIGHT)  # A selected bead adds its controls to the page.
    controls, reached = driver.app.focus.controls(), []
    assert len(controls) > 4
    for _ in controls:
        driver.key(pygame.K_TAB)
        reached.append(driver.app.focus.control)
    assert set(reached) == set(controls)
    driver.key(pygame.K_TAB, SHIFT)
    assert driver.app.focus.control is reached[-2]
    driver.click((400, 300))
    assert driver.app.focus.control is None
