"""Tests of motions with thousands of bounces at full speed.

One motion counts collisions to obtain digits of pi. In another motion a bead bounces between two walls. The tests also
check that the step budget ends a run.
"""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, hooke, power_law, simulate
from softcradle.physics.status import Status, WarningCode

from tests.helpers.relations import PROMISE, simulate_quietly

# Final velocity [m/s] of the light bead for heavy beads of 1e6 and 1e8 kg. Each collision is a rotation of the vector
# (sqrt(m) v, sqrt(M) V).
PI_SPEED = {1e6: 0.4062990663234393, 1e8: 0.07335938195382136}


def pi_from_collisions(mass: float, **settings):
    """Simulate a wall, a bead of 1 kg at rest, and a heavy bead that hits the light bead."""
    return simulate_quietly(
        Chain([math.inf, 1.0, mass], hooke(1e13 * mass), gap=1.0), [0.0, 0.0, -1.0], samples=2, **settings
    )


def hits(found) -> int:
    return sum(map(len, found.contact_intervals))


@pytest.mark.parametrize(
    ("method", "tolerance"), [("accurate", 1e-8), ("accurate", 1e-6), ("accurate", 1e-4), ("dop853", 1e-8)]
)
def test_pi_from_3141_collisions_is_clean(method: str, tolerance: float) -> None:
    """Check the estimated error of a run with 3141 collisions. The result was correct to 4e-8 m/s, but the estimated
    error was 3 m/s. Each bounce was treated as an oscillation whose phase matters.
    """
    found = pi_from_collisions(1e6, method=method, tolerance=tolerance)
    assert hits(found) == 3141
    assert (found.status, found.warnings) == (Status.SEPARATED, ())
    error = abs(found.final_velocity[1] - PI_SPEED[1e6])
    assert error < found.velocity_error[1] < 100.0 * PROMISE * tolerance


@pytest.mark.slow
@pytest.mark.parametrize(("method", "tolerance"), [("accurate", 1e-6), ("accurate", 1e-10), ("dop853", 1e-6)])
def test_pi_from_31415_collisions_is_followed_to_its_end(method: str, tolerance: float) -> None:
    found = pi_from_collisions(1e8, method=method, tolerance=tolerance)
    assert hits(found) == 31415
    assert (found.status, found.warnings) == (Status.SEPARATED, ())
    assert abs(found.final_velocity[1] - PI_SPEED[1e8]) < found.velocity_error[1] < 1e-3


def test_round_off_of_a_heavy_bead_comes_back_to_a_light_one() -> None:
    """Check the estimated error due to round-off. During the motion the light bead is a thousand times as fast as at
    the start. The collisions of the light bead determine the velocity of the heavy bead.
    """
    found = pi_from_collisions(1e6, tolerance=1e-12)
    assert hits(found) == 3141
    assert abs(found.final_velocity[1] - PI_SPEED[1e6]) < found.velocity_error[1] < 1e-6


def bounced(bounces: int, tolerance: float):
    """Simulate a bead between two walls that are 1 m apart. The bead flies at 1 m/s before and after each bounce."""
    chain = Chain([math.inf, 1.0, math.inf], hooke(1e10), gap=0.5)
    return simulate_quietly(chain, [0.0, 1.0, 0.0], duration=bounces + 0.25, samples=2, tolerance=tolerance)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10])
def test_errors_of_like_bounces_add_up(tolerance: float) -> None:
    """Check that the errors of equal bounces are added linearly. Each bounce loses the same energy, so the root of the
    sum of squares would be too small.
    """
    found = bounced(3000, tolerance)
    error = abs(abs(found.final_velocity[1]) - 1.0)
    assert hits(found) == 3000
    assert found.status == Status.DONE
    assert error <= max(found.velocity_error[1], PROMISE * tolerance)
    assert error < 100.0 * PROMISE * tolerance


@pytest.mark.slow
def test_a_finer_run_of_a_hundred_thousand_bounces_is_better() -> None:
    """Check that a finer tolerance gives a smaller error. In an earlier version the run with tolerance 1e-10 exhausted
    its step budget, and its result was wrong by 0.38 m/s.
    """
    errors = []
    for tolerance in (1e-6, 1e-10):
        found = bounced(100_000, tolerance)
        errors.append(abs(abs(found.final_velocity[1]) - 1.0))
        assert found.status == Status.DONE
        assert errors[-1] <= found.velocity_error[1]
    assert errors[1] < 1e-6 < errors[0] < 1e-2


def test_a_budget_that_ends_is_reported_as_a_budget(monkeypatch) -> None:
    monkeypatch.setattr("softcradle.physics.adaptive.usual_budget.MOST_FOLLOWED", 0)
    monkeypatch.setattr("softcradle.physics.adaptive.usual_budget.CONTACT_STEPS", 1000)
    found = pi_from_collisions(1e4)
    (warning,) = found.warnings
    assert (found.status, warning.code) == (Status.BUDGET_SPENT, WarningCode.BUDGET)
    assert not found.status.gave_up
    assert "the step budget ended at t = " in warning.sentence
    assert "rattle" not in warning.sentence
    assert 0.0 < warning.numbers["time"] < found.time[-1]
    assert warning.numbers["error"] == pytest.approx(found.velocity_error.max())
    assert np.isfinite(found.velocity_error).all()


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10, 3e-12])
def test_a_bead_between_two_walls_leaves_one_when_it_meets_the_other(tolerance):
    """Check a bead that touches one wall at the moment at which it leaves the other wall. The two events coincide, and
    round-off decides which event ends the step.
    """
    stiffness, ends = 12.874637388274245, [math.inf, 1.0, math.inf]
    chain = Chain(ends, [hooke(stiffness), power_law(0.9229452383487167, 1.5)])
    spring, other = simulate(chain, [0.0, 1.0, 0.0], 8.4601661, tolerance=tolerance, samples=2).contact_intervals
    half = math.pi / math.sqrt(stiffness)
    assert [end - start for start, end in spring] == pytest.approx([half, half], abs=10.0 * tolerance)
    met = [start for start, _ in other]
    assert met == pytest.approx([0.0, *(end for _, end in spring)], abs=1e-9)
