"""The table of keys."""

from __future__ import annotations

import pygame
import pytest
from softcradle.sandbox.draw.text import width
from softcradle.sandbox.languages import LANGUAGES, gettext, use_language
from softcradle.sandbox.window.keys import COLUMN, CTRL, KEYS_ROOM, MOUSE, ORDER, SHIFT, action_of, bindings, groups

from tests.helpers.windows import Driver


def test_every_key_has_one_action_and_every_action_is_offered():
    keys = [key for binding in bindings() for key in binding.keys]
    assert len(keys) == len(set(keys))
    driver = Driver("one-on-four")
    offered = set(driver.app.actions) | set(driver.page.actions)
    driver.key(pygame.K_ESCAPE)
    offered |= set(driver.app.page.actions)
    assert {binding.action for binding in bindings()} == offered


def test_modifiers_distinguish_keys():
    assert action_of(pygame.K_s, pygame.KMOD_LCTRL) == "save_scene"
    assert action_of(pygame.K_s, pygame.KMOD_RMETA | pygame.KMOD_SHIFT) == "save_session"
    assert action_of(pygame.K_s, 0) is None
    assert action_of(pygame.K_r, pygame.KMOD_ALT) is None
    assert action_of(pygame.K_MINUS, SHIFT) == "slower"  # on keyboards where the sign needs Shift
    assert action_of(pygame.K_MINUS, CTRL) == "smaller"


def test_a_key_that_is_held_repeats_only_what_is_gradual():
    """The system sends it again and again, as one that was pressed."""
    driver = Driver("one-on-four")

    def hold(code, times=5):
        for _ in range(times):
            pygame.event.post(pygame.Event(pygame.KEYDOWN, key=code, mod=0, unicode="", scancode=0))
        driver.frames()
        pygame.event.post(pygame.Event(pygame.KEYUP, key=code, mod=0, unicode="", scancode=0))
        driver.frames()

    hold(pygame.K_PERIOD)
    assert driver.session.frame == 5
    hold(pygame.K_COMMA)
    assert driver.session.frame == 0
    beads = len(driver.session.lanes[0].chain.mass)
    driver.key(pygame.K_RIGHT)
    hold(pygame.K_a)
    assert len(driver.session.lanes[0].chain.mass) == beads + 1
    hold(pygame.K_SPACE, 4)
    assert driver.session.playing


@pytest.mark.parametrize(
    ("code", "modifiers", "text", "action"),
    [
        (pygame.K_EQUALS, CTRL | SHIFT, "+", "larger"),  # English
        (pygame.K_EQUALS, CTRL, "=", "larger"),
        (pygame.K_PLUS, CTRL, "+", "larger"),  # German
        (pygame.K_KP_PLUS, CTRL, "+", "larger"),
        (pygame.K_KP_MINUS, CTRL, "-", "smaller"),
        (pygame.K_KP_PLUS, 0, "+", "faster"),
        (pygame.K_SEMICOLON, SHIFT, ".", "forward"),  # French
        (pygame.K_COMMA, 0, ",", "back"),
        (pygame.K_PERIOD, SHIFT, ">", "next_event"),
        (pygame.K_PERIOD, SHIFT, ":", "next_event"),  # German
        (pygame.K_QUOTE, SHIFT, "*", None),
    ],
)
def test_a_sign_is_the_same_on_every_keyboard(code, modifiers, text, action):
    assert action_of(code, modifiers, text) == action


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
    driver.frames(2)
    menu = driver.page.cards.menus[0]
    assert menu.current_state is menu.menu_states["expanded"]
    driver.key(pygame.K_ESCAPE)
    driver.frames(2)
    assert menu.current_state is menu.menu_states["closed"]
    assert driver.page.editor.selection is not None
    driver.app.open("hanging-cradle")
    driver.frames(2)
    page = driver.app.page
    driver.click(page.menus["law"].rect.center)
    driver.frames(2)
    driver.key(pygame.K_ESCAPE)
    assert driver.app.page is page


def test_bare_letters_edit_what_is_selected_alone(driver: Driver) -> None:
    before = driver.session.setup
    for key in (pygame.K_a, pygame.K_m, pygame.K_g, pygame.K_l):
        driver.key(key)
    assert driver.session.setup is before
    assert any("select a bead" in text for text in driver.messages)


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_text_fits_into_its_column(code):
    use_language(code)
    bindings = [binding for group in groups().values() for binding in group]
    texts = [gettext(text) for text in [binding.text for binding in bindings] + [text for _, text in MOUSE]]
    keys = [str(binding.keys[0]) for binding in bindings] + [gettext(what) for what, _ in MOUSE]
    use_language("en")
    assert not [text for text in texts if KEYS_ROOM + 2 + width(text, 13.0) > COLUMN + 15]
    assert not [text for text in keys if width(text, 13.0, bold=True) + 10 > KEYS_ROOM]


def test_every_group_is_shown():
    assert sorted(ORDER) == sorted([*groups(), "Mouse"])
