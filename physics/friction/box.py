"""Least squares in a box, for the forces of contacts and beds that stand still: which of them hold, which give way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SLACK = 1e-14  # of the largest gradient: what is below is 0


def box_least_squares(matrix: Array, wanted: Array, low: Array, high: Array) -> Array:
    """x (k,) with low <= x <= high that minimises ``|matrix x - wanted|``; not unique where columns depend on each other.

    Active sets (Stark and Parker): the bound that pulls most is let go, the rest solved, and a bound that is met is kept.
    """
    x = np.clip(np.zeros(low.size), low, high)
    free = np.zeros(low.size, dtype=bool)
    size = np.abs(matrix).max(initial=0.0) * (np.abs(wanted).max(initial=0.0) + np.abs(matrix @ x).max(initial=0.0))
    for _ in range(10 * low.size + 10):
        pull = matrix.T @ (wanted - matrix @ x)
        may = ~free & (((x <= low) & (pull > 0.0)) | ((x >= high) & (pull < 0.0)) | ((x > low) & (x < high)))
        if not may.any() or np.abs(pull[may]).max() <= SLACK * size:
            break
        free[np.argmax(np.where(may, np.abs(pull), -1.0))] = True
        _solve_free(matrix, wanted, low, high, x, free)
    return x


def _solve_free(matrix: Array, wanted: Array, low: Array, high: Array, x: Array, free: NDArray[np.bool_]) -> None:
    """Least squares over the `free` entries of `x`, in place; those that meet a bound on the way stay there."""
    while free.any():
        rest = wanted - matrix[:, ~free] @ x[~free]
        goal = np.linalg.lstsq(matrix[:, free], rest, rcond=None)[0]
        now, change = x[free], goal - x[free]
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(
                change > 0.0, (high[free] - now) / change, np.where(change < 0.0, (low[free] - now) / change, 9.0)
            )
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
