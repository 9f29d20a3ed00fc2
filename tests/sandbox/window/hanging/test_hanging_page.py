"""The hanging cradle: its energy, its motion, and its page."""

from __future__ import annotations

import pygame
import pytest
from softcradle.sandbox.window.hanging.hanging_cradle import LAWS, HangingModel
from softcradle.sandbox.window.hanging.hanging_page import HangingPage
from softcradle.sandbox.window.hanging.hanging_picture import to_screen
from softcradle.sandbox.window.scene.scene_page import ScenePage

from tests.helpers.windows import Driver


@pytest.mark.parametrize("law", LAWS)
def test_soft_balls_on_strings_gain_no_energy(law):
    model = HangingModel(law)
    before = model.cradles[0].energy()
    model.advance(10.0)
    assert 0.9 * before < model.cradles[0].energy() < 1.02 * before


def test_a_small_exponent_makes_the_balls_swing_off_nearly_as_one_body():
    """Shortly after the first impact the four balls that were hit move alike; of steel balls only the last moves."""
    spreads = []
    for law in ("power law, alpha 1/14", "steel balls (Hertz)"):
        model = HangingModel(law)
        model.advance(0.95)
        speeds = [ball.velocity.x for ball in model.cradles[0].balls]
        spreads.append(max(speeds[1:]) - min(speeds[1:]))
    assert spreads[0] < 0.5 * spreads[1]


def test_the_hanging_page_is_driven_by_mouse_and_keys():
    driver = Driver("hanging-cradle")
    page = driver.app.page
    assert isinstance(page, HangingPage)
    driver.key(pygame.K_SPACE)
    driver.frames(30)
    assert page.model.time > 0.4
    ball = to_screen(page.pictures[1], page.model.cradles[1].places()[4])
    driver.drag(ball, (ball[0] + 60, ball[1] - 40), steps=10)
    driver.frames(20)
    assert page.model.cradles[1].places()[4][0] > 0.9
    driver.release(ball)
    driver.key(pygame.K_MINUS)
    assert page.slow == 2.0
    driver.key(pygame.K_r)
    assert page.model.time < 0.1
    driver.key(pygame.K_ESCAPE)
    assert not isinstance(driver.app.page, (HangingPage, ScenePage))
    driver.close()
