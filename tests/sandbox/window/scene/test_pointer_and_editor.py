"""The pointer tool and the scene editor: beads are dragged, thrown, added and removed; contacts are locked and converted."""

from __future__ import annotations

import numpy as np
import pygame
import pytest
from softcradle.sandbox.window.scene.editor import Pick

from tests.helpers.windows import Driver

SHIFT = pygame.KMOD_SHIFT


def test_a_bead_is_placed_while_paused(driver: Driver) -> None:
    x, y = driver.bead(0)
    before = driver.session.lanes[0].position.copy()
    driver.drag((x, y), (x - 60, y))
    driver.release((x - 60, y))
    after = driver.session.lanes[0].position
    assert after[0] < before[0]
    assert after[0] - before[0] == pytest.approx(driver.page.view.lanes[0].metres(-60), rel=0.05)
    assert np.array_equal(after[1:], before[1:])


def test_a_bead_is_pulled_and_thrown_while_running(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(5)
    x, y = driver.bead(4)
    driver.drag((x, y), (x + 120, y), steps=25)
    pulled = driver.session.lanes[0].velocity[4]
    assert pulled > 0.2
    driver.release((x + 120, y))
    thrown = driver.session.lanes[0].velocity[4]
    driver.frames(10)
    assert driver.session.lanes[0].velocity[4] == pytest.approx(thrown, rel=1e-6)
    assert driver.session.health(0).level == "good"  # the work of the spring is booked


def test_beads_are_added_and_removed(driver: Driver) -> None:
    driver.click(driver.bead(4))
    driver.key(pygame.K_a)
    assert driver.session.lanes[0].chain.contacts == 5
    assert driver.page.editor.selection == Pick(0, "bead", 5)
    driver.key(pygame.K_DELETE)
    driver.frames()
    assert driver.session.lanes[0].chain.contacts == 4
    assert driver.page.editor.selection == Pick(0, "bead", 4)


def test_locked_pistons_make_a_usual_cradle(driver: Driver) -> None:
    driver.key(pygame.K_l)
    assert any("select a contact" in text for text in driver.messages)
    driver.key(pygame.K_l, SHIFT)
    driver.key(pygame.K_SPACE)
    driver.frames(330)
    velocity = driver.session.lanes[0].velocity
    assert velocity[4] > 0.9  # the last bead leaves
    assert abs(velocity[0]) < 0.15


def test_keys_convert_one_contact_and_all(driver: Driver) -> None:
    driver.key(pygame.K_RIGHT)
    driver.key(pygame.K_RIGHT)
    assert driver.page.editor.selection == Pick(0, "contact", 0)
    driver.key(pygame.K_g)
    assert [law.preload > 0.0 for law in driver.session.lanes[0].chain.contact] == [True, False, False, False]
    driver.key(pygame.K_g, SHIFT)
    assert all(law.preload > 0.0 for law in driver.session.lanes[0].chain.contact)
