"""Placement of labels beside a panel: each near the height of its curve, moved apart until none overlap."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def spread_apart(wanted: ArrayLike, distance: float, low: float = 0.0, high: float = 1.0) -> Array:
    """Heights as near as possible to `wanted`, in its order, at least `distance` apart and within [low, high].

    The least-squares solution under ordered distances: isotonic regression of the heights less their places in the
    column. Where the room is too small for all, they share it evenly.
    """
    heights = np.asarray(wanted, dtype=np.float64)
    if heights.size == 0:
        return heights
    distance = min(distance, (high - low) / max(heights.size - 1, 1))
    order = np.argsort(heights, kind="stable")
    place = distance * np.arange(heights.size)
    blocks: list[tuple[float, int]] = []  # mean height and number of labels
    for value in (heights[order] - place).tolist():
        blocks.append((value, 1))
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            (left, many), (right, more) = blocks[-2:]
            blocks[-2:] = [((left * many + right * more) / (many + more), many + more)]
    level = np.concatenate([np.full(count, value) for value, count in blocks])
    found = np.empty_like(heights)
    found[order] = np.clip(level, low, high - place[-1]) + place
    return found
