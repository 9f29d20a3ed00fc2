"""Method `pymunk`: the digits, steps and switches of `euler`, from bodies in a Space."""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, OwnLaw, State, advance, hertz, hooke, one_on, power_law, simulate
from softcradle.physics.simulation import solve
from softcradle.physics.status import Status

MIXED = [hertz(10.0), hooke(30.0), power_law(2.0, 1.2)]
CASES = {
    "hertz": (one_on(4, hertz(1.0)), [1, 0, 0, 0, 0]),
    "hooke": (one_on(9, hooke(1e4)), [1] + [0] * 9),
    "square root": (one_on(4, power_law(1.0, 0.5)), [1, 0, 0, 0, 0]),
    "alpha 1/5": (one_on(4, power_law(1.0, 0.2)), [1, 0, 0, 0, 0]),
    "alpha 1/7": (one_on(3, power_law(1.0, 1 / 7)), [1, 0, 0, 0]),
    "mixed, with gaps": (Chain([1, 2, 0.5, 3], MIXED, [0, 0.1, 0.03]), [1, 0, 0, -0.5]),
    "wall at rest": (Chain([1, 2, 0.5, math.inf], MIXED, [0, 0.1, 0.03]), [1, 0, 0, 0]),
    "a law of one's own": (Chain([1.0] * 3, OwnLaw(lambda overlap: 3.0 * math.expm1(overlap))), [1, 0, 0]),
    "moving wall": (Chain([math.inf, 2, 0.5, 1], MIXED), [0.5, 0, 0, 0]),
}


def both(chain, velocity, **options):
    return [simulate(chain, velocity, method=method, **options) for method in ("euler", "pymunk")]


@pytest.mark.parametrize("case", CASES)
def test_digits_steps_and_switches_are_those_of_euler(case):
    chain, velocity = CASES[case]
    euler, pymunk = both(chain, velocity, step=2e-3, samples=57)
    assert pymunk.time == pytest.approx(euler.time)
    for name in ("overlap", "rate", "anchor", "position", "velocity"):
        np.testing.assert_allclose(getattr(pymunk, name), getattr(euler, name), rtol=0, atol=1e-12, err_msg=name)
    np.testing.assert_allclose(pymunk.force, euler.force, rtol=0, atol=1e-10 * euler.force.max())
    assert np.abs(euler.velocity[-1] - velocity).max() > 0.1
    assert (pymunk.steps, pymunk.evaluations) == (euler.steps, euler.evaluations)
    assert [len(each) for each in pymunk.contact_intervals] == [len(each) for each in euler.contact_intervals]
    for ours, theirs in zip(pymunk.contact_intervals, euler.contact_intervals, strict=True):
        np.testing.assert_allclose(ours, theirs, atol=0.05)  # a contact that closes at speed 0 has no sharp time
        np.testing.assert_allclose([end for _, end in ours], [end for _, end in theirs], atol=1e-6)


@pytest.mark.parametrize("speed", [1e-3, 1.0, 1e3])
def test_touching_distance_fits_the_speed(speed):
    """Overlaps of 1e3 m or 1e-3 m: the anchors are always further apart, never so far that digits are lost."""
    euler, pymunk = both(one_on(2, hertz(1.0)), [speed, 0, 0])
    np.testing.assert_allclose(pymunk.velocity, euler.velocity, rtol=0, atol=1e-12 * speed)


def test_anchors_move_apart_under_deep_overlaps():
    """Two walls approach: overlaps grow to a hundred times those of the start."""
    euler, pymunk = both(Chain([math.inf, 1.0, math.inf], hertz(100.0)), [1.0, 0.0, -1.0], duration=30.0, step=1e-3)
    assert euler.overlap[-1].max() > 25.0
    np.testing.assert_allclose(pymunk.overlap, euler.overlap, rtol=0, atol=1e-8)
    np.testing.assert_allclose(pymunk.overlap[:60], euler.overlap[:60], rtol=0, atol=1e-12)


def test_advance_agrees_with_euler_under_a_push():
    chain, velocity = CASES["mixed, with gaps"]
    states = [State.at_start(chain, velocity) for _ in range(2)]
    for frame in range(60):
        for state, method in zip(states, ("euler", "pymunk"), strict=True):
            state.push = np.array([math.sin(0.1 * frame), 0.0, 0.3, -1.0])
            advance(chain, state, 1.0 / 60.0 + 1e-4 * frame, method, step=1e-3)
    euler, pymunk = states
    assert pymunk.time == euler.time
    for name in ("overlap", "rate", "anchor"):
        np.testing.assert_allclose(getattr(pymunk, name), getattr(euler, name), rtol=0, atol=1e-12, err_msg=name)
    assert abs(euler.rate).max() > 0.1


def test_it_gives_up_after_the_steps_that_it_may_take():
    found = solve(one_on(3, hertz(1.0)), [1.0, 0.0, 0.0, 0.0], None, "pymunk", step=1e-3, most_steps=50)
    assert (found.status, found.steps) == (Status.OUT_OF_STEPS, 50)
    assert "pymunk gave up after 50 steps" in str(found.warnings[0])


def test_a_time_that_has_no_digits_below_a_step_ends():
    """Where a billionth of a step is less than the last digit of the time."""
    found = simulate(one_on(1, hooke(1.0)), [1.0, 0.0], 1e6, "pymunk", step=0.02, samples=3)
    assert found.time.tolist() == [0.0, 5e5, 1e6]
    assert found.final_velocity == pytest.approx([0.0, 1.0], abs=1e-3)


@pytest.mark.parametrize("contact", [hooke(1e9), power_law(1e6, 2.0)], ids=["hooke", "power law"])
def test_live_frames_go_on(contact):
    chain = Chain([1.0, 1.0, 1.0], contact, drive=[1.0, 0.0, -1.0])
    state = State.at_start(chain, [1.0, 0.0, 0.0])
    deepest = 0.0
    with np.errstate(all="ignore"):
        for _ in range(400):
            advance(chain, state, 1.0, "pymunk", step=0.1)
            deepest = max(deepest, float(np.nanmax(np.abs(state.overlap), initial=0.0)))
    assert deepest > 1e30 or not np.isfinite(state.overlap).all()
