"""bounded_least_squares: the optimum on clusters at rest, whose columns depend on each other, and where SciPy misses it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from softcradle.physics import Chain, State, draft_gear, hertz, power_law
from softcradle.physics.friction import stick_slip
from softcradle.physics.friction.bounded_least_squares import bounded_least_squares

SCIPY_DEFAULT = 1e-10  # tolerance of lsq_linear


def cluster_at_rest(seed):
    """Up to 13 beads of masses over 4 decades, of which most rest: contacts touch, are held or open, on a bed or free."""
    draw = np.random.default_rng(seed)
    n = int(draw.integers(1, 13))
    mass = 10.0 ** draw.uniform(-2, 2, n + 1) if draw.random() < 0.5 else np.full(n + 1, draw.uniform(0.1, 10.0))
    if draw.random() < 0.25:
        mass[-1] = math.inf
    laws = [power_law(draw.uniform(0.1, 10), 0.1), draft_gear(10 ** draw.uniform(0, 3), 0.1), hertz(100.0)]
    contacts = [replace(laws[draw.integers(3)], loss=float(draw.choice([0.0, 0.3, 0.8]))) for _ in range(n)]
    drive = np.where(np.isfinite(mass), draw.normal(size=n + 1), 0.0) if draw.random() < 0.5 else None
    chain = Chain(mass, contacts, 0.0, drive, float(draw.choice([0.0, 0.01, 0.1, 0.5, 2.0])))
    speeds = np.append(0.0, draw.normal(size=n + 1))
    cluster = np.cumsum(draw.random(n + 1) < 0.3)
    state = State.at_start(chain, np.where(np.isfinite(mass), speeds[cluster], 0.0))
    state.overlap[:] = np.where(draw.random(n) < 0.4, 0.0, 10.0 ** draw.uniform(-6, 0, n))
    return chain, state


def assert_optimal(matrix, wanted, low, high, x):
    """Within the bounds, and no allowed direction lowers the sum of squares: the gradient is 0 or points out of a bound."""
    terms = np.abs(matrix).max(initial=0.0) * (np.abs(wanted).max() + (np.abs(matrix) @ np.abs(x)).max(initial=0.0))
    assert (x >= low - 1e-15 * np.abs(low).max(initial=0.0)).all()
    assert (x <= high + 1e-15 * np.abs(high).max(initial=0.0)).all()
    pull = matrix.T @ (wanted - matrix @ x)
    uphill = np.where(x <= low, np.maximum(pull, 0.0), np.where(x >= high, np.maximum(-pull, 0.0), np.abs(pull)))
    assert uphill.max(initial=0.0) <= 1e-13 * terms


def test_the_optimum_for_clusters_at_rest(monkeypatch):
    problems = []

    def solve(matrix, wanted, low, high):
        x = bounded_least_squares(matrix, wanted, low, high)
        problems.append((matrix, wanted, low, high, x))
        return x

    monkeypatch.setattr(stick_slip, "bounded_least_squares", solve)
    for seed in range(1000):
        chain, state = cluster_at_rest(seed)
        stick_slip.resolve_modes(chain, state, state.velocity(chain))
    dependent = 0
    for matrix, wanted, low, high, x in problems:
        assert_optimal(matrix, wanted, low, high, x)
        dependent += bool(x.size) and np.linalg.matrix_rank(matrix) < x.size
    assert dependent > 100


def test_small_accelerations_beside_large_ones():
    """SciPy leaves the last force at its bound: freeing it lowers the sum of squares, of 3e5, by less than it tells apart."""
    matrix = np.array(
        [
            [-0.71, 0.0, 0.0, 0.0],
            [1.82, 0.0, 0.0, 0.0],
            [0.0, -0.485, 0.0, 0.0],
            [0.0, 19.6, -19.6, 0.0],
            [0.0, 0.0, 14.6, -14.6],
            [0.0, 0.0, 0.0, 5.55],
            [0.0, 0.0, 0.0, 0.0],
        ]
    )
    wanted = np.array([27.5, 11.8, -40.7, -5.15, -1.66, -3.22, -580.0])
    low, high = np.array([0.361, 5.22e-8, 0.369, 0.215]), np.array([0.515, 2.61e-7, 7.38, 4.3])
    found = bounded_least_squares(matrix, wanted, low, high)
    assert_optimal(matrix, wanted, low, high, found)
    missed = lsq_linear(matrix, wanted, (low, high), method="bvls", tol=SCIPY_DEFAULT).x
    assert missed[3] == low[3] < 0.7 * found[3]
    assert np.abs(matrix @ (found - missed)).max() > 1.0


def test_forces_that_are_not_unique():
    """Two pairs of gears at rest on a bed: with a tolerance of 0 SciPy divides by 0 here, with rounding as on x86-64."""
    root, bed, preload = 2.9367817054892, 2.274088379943077, 0.4653613351304642
    matrix = np.zeros((4, 6))
    matrix[[0, 1, 0, 1], [0, 0, 2, 3]] = -root, root, root, root
    matrix[[2, 3, 2, 3], [1, 1, 4, 5]] = -root, root, root, root
    low = np.array([23.79140156153853, 0.0, -bed, -bed, -bed, -bed])
    high = np.array([118.95700780769268, preload, bed, bed, bed, bed])
    found = bounded_least_squares(matrix, np.zeros(4), low, high)
    assert_optimal(matrix, np.zeros(4), low, high, found)
    assert matrix @ found == pytest.approx([root * (bed - low[0]), root * (low[0] - bed), 0.0, 0.0])


def test_nothing_to_solve():
    assert bounded_least_squares(np.zeros((3, 0)), np.ones(3), np.zeros(0), np.zeros(0)).size == 0
