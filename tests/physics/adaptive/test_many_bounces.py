"""Tests of thousands of bounces at full speed: pi from collisions, a bead between two walls, and step budgets that end."""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, hooke, power_law, simulate
from softcradle.physics.status import Status, WarningCode

from tests.helpers.relations import PROMISE, simulate_quietly

# Final velocity [m/s] of the light bead for heavy beads of 1e6 and 1e8 kg. Each hit is a rotation of (sqrt(m) v,
# sqrt(M) V).
PI_SPEED = {1e6: 0.4062990663234393, 1e8: 0.07335938195382136}


def pi_from_collisions(mass: float, **settings):
    """Return the run of a wall, a bead of 1 kg at rest, and a heavy bead that hits it."""
    return simulate_quietly(
        Chain([math.inf, 1.0, mass], hooke(1e13 * mass), gap=1.0), [0.0, 0.0, -1.0], samples=2, **settings
    )


def hits(found) -> int:
    return sum(map(len, found.contact_intervals))


@pytest.mark.parametrize(
    ("method", "tolerance"), [("accurate", 1e-8), ("accurate", 1e-6), ("accurate", 1e-4), ("dop853", 1e-8)]
)
def test_pi_from_3141_collisions_is_clean(method: str, tolerance: float) -> None:
    """Check a run that was right to 4e-8 m/s but reported an error of 3 m/s, because each bounce counted as an
    oscillation whose phase matters.
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
    """Check the error of round-off. On the way the light bead is a thousand times as fast, and its rates determine the
    velocity of the heavy bead.
    """
    found = pi_from_collisions(1e6, tolerance=1e-12)
    assert hits(found) == 3141
    assert abs(found.final_velocity[1] - PI_SPEED[1e6]) < found.velocity_error[1] < 1e-6


def bounced(bounces: int, tolerance: float):
    """Return the run of a bead between two walls 1 m apart. It flies at 1 m/s before and after each bounce."""
    chain = Chain([math.inf, 1.0, math.inf], hooke(1e10), gap=0.5)
    return simulate_quietly(chain, [0.0, 1.0, 0.0], duration=bounces + 0.25, samples=2, tolerance=tolerance)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10])
def test_errors_of_like_bounces_add_up(tolerance: float) -> None:
    """Check that errors of equal bounces are added linearly: each loses the same energy, so the root of the sum of
    squares is too small.
    """
    found = bounced(3000, tolerance)
    error = abs(abs(found.final_velocity[1]) - 1.0)
    assert hits(found) == 3000
    assert found.status == Status.DONE
    assert error <= max(found.velocity_error[1], PROMISE * tolerance)
    assert error < 100.0 * PROMISE * tolerance


@pytest.mark.slow
def test_a_finer_run_of_a_hundred_thousand_bounces_is_better() -> None:
    """Check that a finer tolerance gives a smaller error. At 1e-10 the budget ended, and the result was off by 0.38
    m/s.
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
    """One contact closes at the time at which the other opens. The step ends at the event that round-off makes the first."""
    stiffness, ends = 12.874637388274245, [math.inf, 1.0, math.inf]
    chain = Chain(ends, [hooke(stiffness), power_law(0.9229452383487167, 1.5)])
    spring, other = simulate(chain, [0.0, 1.0, 0.0], 8.4601661, tolerance=tolerance, samples=2).contact_intervals
    half = math.pi / math.sqrt(stiffness)
    assert [end - start for start, end in spring] == pytest.approx([half, half], abs=10.0 * tolerance)
    met = [start for start, _ in other]
    assert met == pytest.approx([0.0, *(end for _, end in spring)], abs=1e-9)
