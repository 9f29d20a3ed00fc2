"""What is shown follows edits: labels, axes and loupes, the badge with an accurate run behind, the size of the window."""

from __future__ import annotations

from dataclasses import replace

import pygame
import pytest
from softcradle.sandbox.session.inputs import SetContact

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
    for key in (pygame.K_m, pygame.K_m):
        driver.key(key)
    driver.key(pygame.K_SPACE)
    driver.frames(900)
    button = driver.page.cards.verdicts[0]
    assert "chattered" in button.text
    driver.click(button.rect.center)
    driver.frames(2)
    assert driver.session.scrubbed
    assert driver.session.frame == driver.session.findings(0)[0].first
    driver.close()


def test_marks_of_rigid_clusters_stay_those_of_the_collision(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(240)
    driver.key(pygame.K_SPACE)
    shares = driver.page.view.lanes[0].drawing.rigid
    assert any(shares)
    driver.key(pygame.K_4)
    driver.key(pygame.K_4)
    assert driver.page.view.lanes[0].drawing.rigid == shares


def test_fullscreen_gives_the_size_back(driver: Driver) -> None:
    driver.key(pygame.K_F11)
    driver.frames(2)
    driver.key(pygame.K_F11)
    driver.frames(2)
    assert driver.app.size == (1280, 720)
