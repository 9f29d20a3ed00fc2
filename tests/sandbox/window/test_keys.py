"""The table of keys."""

from __future__ import annotations

import pygame
from softcradle.sandbox.window.keys import CTRL, SHIFT, action_of, bindings

from tests.helpers.windows import Driver


def test_every_key_has_one_action_and_every_action_is_offered():
    keys = [key for binding in bindings() for key in binding.keys]
    assert len(keys) == len(set(keys))
    driver = Driver("one-on-four")
    offered = set(driver.app.actions) | set(driver.page.actions)
    driver.key(pygame.K_ESCAPE)
    offered |= set(driver.app.page.actions)
    assert {binding.action for binding in bindings()} == offered
    driver.close()


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
    driver.close()
