"""Tests of the sine, cosine and arc tangent for beads on strings, and of the time at which two such beads next meet."""

import math

import numpy as np
import pytest
from softcradle.physics.numerics import elementary, swing
from softcradle.physics.numerics.plain_kernels import plain

sine_cosine, arc_tangent, turning_angle, swing_time = map(
    plain, (elementary.sine_cosine, elementary.arc_tangent, elementary.turning_angle, swing.swing_time)
)
DRAW = np.random.default_rng(7)


def units(found: float, true: float) -> float:
    """Return an error in units of the last place. The functions of the C library are accurate to about half a unit."""
    return abs(found - true) / math.ulp(true)


@pytest.mark.parametrize("size", [1e-9, 0.5, 3.0, 100.0, 1e5])
def test_sine_and_cosine_are_accurate(size):
    for x in (size * DRAW.random(500)).tolist():
        sine, cosine = sine_cosine(x)
        assert units(sine, math.sin(x)) <= 2.0
        assert units(cosine, math.cos(x)) <= 2.0


def test_angles_are_accurate():
    for x in DRAW.random(500).tolist():
        assert units(arc_tangent(x), math.atan(x)) <= 2.0
    for angle in (2.0 * math.pi * DRAW.random(500)).tolist():
        assert turning_angle(math.sin(angle), math.cos(angle)) == pytest.approx(angle, rel=1e-14)
    assert turning_angle(0.0, -1.0) == math.pi
    assert turning_angle(0.0, 1.0) == 0.0


def test_the_next_contact_is_the_first_zero_of_the_overlap():
    met = 0
    for _ in range(400):
        root, rate = 10.0 ** DRAW.uniform(-1.0, 1.0), DRAW.uniform(-3.0, 3.0)
        rest, overlap = (
            DRAW.choice([0.0, -DRAW.random(), DRAW.random()]),
            -DRAW.random() * DRAW.choice([0.0, 1.0, 1e-9]),
        )
        time = swing_time(overlap, rate, rest, root, 0.0)
        reach = math.hypot(overlap - rest, rate / root)
        if math.isinf(time):
            assert reach <= -rest * (1.0 + 1e-12)
            continue
        met += 1
        phase = root * np.append(np.linspace(0.0, time, 200)[1:-1], time)
        found = rest + (overlap - rest) * np.cos(phase) + rate / root * np.sin(phase)
        assert abs(found[-1]) < 1e-12 * (1.0 + reach)
        assert found.max() < 1e-12 * (1.0 + reach)
    assert met > 100


def test_slow_contacts_do_not_count():
    assert swing_time(-0.1, 1e-3, 0.0, 1.0, 1.0) == math.inf
    assert swing_time(0.0, 0.0, 0.0, 1.0, 0.0) == math.inf
    assert swing_time(0.0, -1.0, 0.0, 2.0, 0.0) == pytest.approx(0.5 * math.pi)
