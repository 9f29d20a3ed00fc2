"""Motions that make much of small errors: deep soft contacts that swing, gears that rattle between two strikers."""

from __future__ import annotations

import warnings
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from softcradle.physics import Chain, Trajectory, draft_gear, one_on, power_law, simulate

PROMISE = 10.0  # times the tolerance
SWINGING = ((2, 16), (3, 14), (3, 24))  # one on n, alpha = 1 / this: a velocity of 1e-6 in the deepest contact


@cache
def by_scipy(n: int, softness: int) -> tuple[float, ...]:
    """Final velocities by a method that shares no kernel, which follows every swing."""
    chain, velocity = one_on(n, power_law(1.0, 1.0 / softness)), np.eye(1, n + 1)[0]
    end = simulate(chain, velocity, samples=2, method="radau", tolerance=1e-6).time[-1]
    found = simulate(chain, velocity, float(end) + 0.01, method="scipy", tolerance=1e-9, samples=2)
    return tuple(found.final_velocity)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["accurate", "radau"])
@pytest.mark.parametrize(("n", "softness"), SWINGING)
def test_swings_of_deep_contacts_are_kept(n: int, softness: int, method: str) -> None:
    """A step as long as a swing damps it, a little each time: errors were up to 160 times the tolerance."""
    truth = np.array(by_scipy(n, softness))
    chain, velocity = one_on(n, power_law(1.0, 1.0 / softness)), np.eye(1, n + 1)[0]
    for tolerance in 10.0 ** -np.arange(4.0, 11.0):
        found = simulate(chain, velocity, samples=2, method=method, tolerance=tolerance)
        assert np.abs(found.final_velocity - truth).max() < PROMISE * tolerance, tolerance


def hit_from_both_sides(
    n: int, stiffness: float, precompression: float, last: float, tolerance: float, method: str = "accurate"
) -> Trajectory:
    """Gears between two strikers; a warning is a value here."""
    velocity: NDArray[np.float64] = np.zeros(n + 1)
    velocity[0], velocity[-1] = 1.0, last
    chain = Chain(np.ones(n + 1), draft_gear(stiffness, precompression))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return simulate(chain, velocity, method=method, samples=2, tolerance=tolerance)


@pytest.mark.parametrize("method", ["accurate", "radau"])
def test_runs_of_like_steps_are_no_confirmation(method: str) -> None:
    """Steps between sharp events are the same at 1e-6 and 1e-7, errors of 6e-3 and all: the finer run is of a shaken chain."""
    truth = hit_from_both_sides(4, 5.0, 10.0, -0.5, 1e-10).final_velocity
    for tolerance in 10.0 ** -np.arange(3.0, 9.0):
        found = hit_from_both_sides(4, 5.0, 10.0, -0.5, tolerance, method)
        assert found.warnings or np.abs(found.final_velocity - truth).max() < PROMISE * 1.5 * tolerance


@pytest.mark.parametrize("method", ["accurate", "radau"])
def test_a_motion_that_only_round_off_determines_says_so(method: str) -> None:
    """Far below their preload gears are rigid spheres, and many that touch are a lottery; energy and momentum are not."""
    found = hit_from_both_sides(4, 1.0, 10.0, -0.2, 1e-6, method)
    assert any(warning.code == "sensitive" for warning in found.warnings)
    assert np.sum(found.final_velocity) == pytest.approx(0.8, abs=1e-12)
    assert np.sum(found.final_velocity**2) == pytest.approx(1.04, abs=1e-4)


@pytest.mark.parametrize("method", ["accurate", "radau"])
@pytest.mark.parametrize("n", [4, 5, 8, 13])
def test_two_strikers_on_a_row_of_gears_are_a_mirror(n: int, method: str) -> None:
    """All contacts are at their preload at once, and yield together: round-off chose among them, and it ended in NaN."""
    found = hit_from_both_sides(n, 1.0, 1.0, -1.0, 1e-6, method)
    assert not found.warnings
    np.testing.assert_allclose(found.final_velocity, -found.final_velocity[::-1], atol=1e-5)
    assert np.sum(found.final_velocity**2) == pytest.approx(2.0, abs=1e-5)


def test_unequal_beads_squeezed_at_their_preload_have_no_nan() -> None:
    """Strikers at both ends of 13 gears: whatever the steps it takes or the warnings it gives, its numbers are numbers."""
    mass = np.random.default_rng(1).uniform(0.1, 6.0, 14)
    velocity = np.zeros(14)
    velocity[0], velocity[-1] = 1.0, -0.41
    chain = Chain(mass, draft_gear(1.88, 106.0))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        found = simulate(chain, velocity, 1e-3, samples=2, tolerance=1e-6)
    assert np.isfinite(found.final_velocity).all()
    assert np.sum(mass * found.final_velocity) == pytest.approx(float(mass @ velocity), abs=1e-9)
