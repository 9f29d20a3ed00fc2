"""Tests of the method `pymunk`, which simulates bodies in a pymunk Space. Results, steps and contact changes must be
bitwise equal to the ones of the method `euler`.
"""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, State, advance, hertz, hooke, one_on, power_law, simulate
from softcradle.physics.simulation import solve
from softcradle.physics.status import Status

from tests.helpers.motions import CASES, runs, solved

# Motions for which the two methods may differ. Either round-off decides which contacts touch, or the motion needs no
# evaluation.
UNLIKE_EULER = ("gears on straws", "step forces", "a ball that bounces to rest", "held by friction")


@pytest.mark.parametrize("name", [name for name, _ in runs(CASES, ("pymunk",)) if name not in UNLIKE_EULER])
def test_pymunk_agrees_with_euler(name):
    same_as_euler(*(solved(CASES[name], method) for method in ("euler", "pymunk")))


def test_absorbed_energy_agrees_with_euler():
    laws = [hertz(10.0, loss=0.6), hooke(30.0, loss=0.6), power_law(2.0, 1.2, loss=0.6)]
    same_as_euler(*both(Chain([1, 2, 0.5, 3], laws), [1, 0, 0, 0], step=2e-3, samples=57))


def same_as_euler(euler, pymunk):
    assert pymunk.time == pytest.approx(euler.time)
    absorbed = "absorbed_by_contacts", "absorbed_by_bed", "given"
    for row in ("overlap", "rate", "anchor", "position", "velocity", *absorbed):
        np.testing.assert_allclose(getattr(pymunk, row), getattr(euler, row), rtol=0, atol=1e-12, err_msg=row)
    np.testing.assert_allclose(pymunk.force, euler.force, rtol=0, atol=1e-10 * euler.force.max())
    assert (pymunk.steps, pymunk.evaluations) == (euler.steps, euler.evaluations)
    for ours, theirs in zip(pymunk.contact_intervals, euler.contact_intervals, strict=True):
        # If a contact closes at speed 0, its closing time is not sharply defined.
        np.testing.assert_allclose(ours, theirs, atol=0.05)
        np.testing.assert_allclose([end for _, end in ours], [end for _, end in theirs], atol=1e-6)


def both(chain, velocity, **options):
    return [simulate(chain, velocity, method=method, **options) for method in ("euler", "pymunk")]


def test_touching_distance_fits_the_speed():
    """Check overlaps of 1e3 m. The distance of the anchors at first contact must always be larger than the overlap."""
    euler, pymunk = both(one_on(2, hertz(1.0)), [1e3, 0, 0])
    np.testing.assert_allclose(pymunk.velocity, euler.velocity, rtol=0, atol=1e-9)


def test_anchors_move_apart_under_deep_overlaps():
    """Check two walls that approach each other until the overlaps are a hundred times their initial values."""
    euler, pymunk = both(Chain([math.inf, 1.0, math.inf], hertz(100.0)), [1.0, 0.0, -1.0], duration=30.0, step=1e-3)
    assert euler.overlap[-1].max() > 25.0
    np.testing.assert_allclose(pymunk.overlap, euler.overlap, rtol=0, atol=1e-8)
    np.testing.assert_allclose(pymunk.overlap[:60], euler.overlap[:60], rtol=0, atol=1e-12)


def test_it_gives_up_after_the_steps_that_it_may_take():
    found = solve(one_on(3, hertz(1.0)), [1.0, 0.0, 0.0, 0.0], None, "pymunk", step=1e-3, most_steps=50)
    assert (found.status, found.steps) == (Status.OUT_OF_STEPS, 50)
    assert "pymunk gave up after 50 steps" in str(found.warnings[0])


def test_a_time_that_has_no_digits_below_a_step_ends():
    """Check that a run ends if a billionth of a step is smaller than the last digit of the time."""
    found = simulate(one_on(1, hooke(1.0)), [1.0, 0.0], 1e6, "pymunk", step=0.02, samples=3)
    assert found.time.tolist() == [0.0, 5e5, 1e6]
    assert found.final_velocity == pytest.approx([0.0, 1.0], abs=1e-3)


@pytest.mark.parametrize(
    "contact", [hooke(1e9), power_law(1e6, 2.0), power_law(1e6, 2.0, loss=0.1)], ids=["hooke", "power law", "loss"]
)
def test_live_frames_go_on(contact):
    chain = Chain([1.0, 1.0, 1.0], contact, drive=[1.0, 0.0, -1.0])
    state = State.at_start(chain, [1.0, 0.0, 0.0])
    deepest = 0.0
    with np.errstate(all="ignore"):
        for _ in range(400):
            advance(chain, state, 1.0, "pymunk", step=0.1)
            deepest = max(deepest, float(np.nanmax(np.abs(state.overlap), initial=0.0)))
    assert deepest > 1e30 or not np.isfinite(state.overlap).all()
