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
