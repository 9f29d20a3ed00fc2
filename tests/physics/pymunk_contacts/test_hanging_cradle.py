"""Tests of the example that simulates Newton's cradle in a pymunk Space."""

import math

import pytest

from examples import hanging_cradle
from examples.hanging_cradle import ANGLE, GRAVITY, LAWS, MASS, STRING, Cradle


def swung(law: str) -> tuple[list[float], float, Cradle]:
    """Return the largest displacements of the balls after the first collision, the energy at the start, and the cradle."""
    cradle = Cradle(LAWS[law])
    first = cradle.energy()
    cradle.run(62)
    return cradle.swings(), first, cradle


def test_steel_passes_the_blow_on_and_soft_balls_swing_together():
    steel, first, cradle = swung("steel, Hertz")
    assert first == pytest.approx(MASS * GRAVITY * STRING * (1.0 - math.cos(ANGLE)), rel=1e-9)
    assert steel[4] == pytest.approx(0.47, abs=0.01)
    assert max(map(abs, steel[:4])) < 0.08
    assert cradle.energy() == pytest.approx(first, rel=0.01)
    soft, first, cradle = swung("soft, alpha 1/10")
    assert soft[0] < -0.2
    assert min(soft[2:]) > 0.2
    assert cradle.energy() == pytest.approx(first, rel=0.01)


def test_rigid_contacts_share_the_blow_in_another_way():
    rigid, _, _ = swung("pymunk's rigid contacts")
    assert rigid[3] == pytest.approx(rigid[4], abs=0.01)


def test_the_strings_keep_their_length():
    _, _, cradle = swung("steel, Hertz")
    for k, ball in enumerate(cradle.balls):
        length = math.hypot(ball.position.x - 2.0 * hanging_cradle.RADIUS * k, ball.position.y)
        assert length == pytest.approx(STRING, rel=1e-3)
