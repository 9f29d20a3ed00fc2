"""Bounded least squares, for the forces of contacts and beds at rest: which of them hold, which give way.

SciPy's `lsq_linear` (method bvls) is the same algorithm with other criteria to stop, and fails on clusters at rest, whose
columns depend on each other: it stops where the sum of squares hardly falls, which does not show small accelerations beside
large ones, and with a tolerance of 0 it may divide by 0. tests/physics/friction/test_bounded_least_squares.py has both cases.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUND_OFF = 1e-14  # of the largest term of a gradient: a component below it counts as 0
INFINITE_ROOM = 9.0  # steps to a bound that a variable at rest never meets; more than the 1 of a full step


def bounded_least_squares(matrix: Array, wanted: Array, low: Array, high: Array) -> Array:
    """x (k,) with low <= x <= high that minimises ``|matrix x - wanted|``; not unique where columns depend on each other.

    Active sets (Stark and Parker 1995): the bound with the largest gradient away from it is freed, the free variables are
    solved for, and those that meet a bound on the way are fixed there.
    """
    x = np.clip(np.zeros(low.size), low, high)
    free = np.zeros(low.size, dtype=bool)
    size = np.abs(matrix).max(initial=0.0) * (np.abs(wanted).max(initial=0.0) + np.abs(matrix @ x).max(initial=0.0))
    for _ in range(10 * low.size + 10):
        pull = matrix.T @ (wanted - matrix @ x)
        may = ~free & (((x <= low) & (pull > 0.0)) | ((x >= high) & (pull < 0.0)) | ((x > low) & (x < high)))
        if not may.any() or np.abs(pull[may]).max() <= ROUND_OFF * size:
            break
        free[np.argmax(np.where(may, np.abs(pull), -1.0))] = True
        _solve_free(matrix, wanted, low, high, x, free)
    return x


def _solve_free(matrix: Array, wanted: Array, low: Array, high: Array, x: Array, free: NDArray[np.bool_]) -> None:
    """Least squares over the `free` entries of `x`, in place; entries that meet a bound on the way are fixed there."""
    while free.any():
        rest = wanted - matrix[:, ~free] @ x[~free]
        goal = np.linalg.lstsq(matrix[:, free], rest, rcond=None)[0]
        now, change = x[free], goal - x[free]
        with np.errstate(divide="ignore", invalid="ignore"):
            to_bound = np.where(change > 0.0, (high[free] - now) / change, (low[free] - now) / change)
        room = np.where(change == 0.0, INFINITE_ROOM, to_bound)
        first = float(room.min())
        if first >= 1.0:
            x[free] = goal
            return
        moved = np.clip(now + first * change, low[free], high[free])
        met = room <= first
        moved[met] = np.where(change[met] > 0.0, high[free][met], low[free][met])
        index = np.flatnonzero(free)
        x[index] = moved
        free[index[met]] = False
