"""Labels beside a panel: each at the height of what it names, moved apart until none overlaps, tied to it by a line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def apart(wanted: ArrayLike, least: float, low: float = 0.0, high: float = 1.0) -> Array:
    """Heights as near as can be to `wanted`, in its order, at least `least` apart and within [low, high].

    Least squares under ordered distances (isotonic regression of the heights less their places in the row). Where the
    room is too small for all, they share it evenly.
    """
    heights = np.asarray(wanted, dtype=np.float64)
    if heights.size == 0:
        return heights
    least = min(least, (high - low) / max(heights.size - 1, 1))
    order = np.argsort(heights, kind="stable")
    place = least * np.arange(heights.size)
    blocks: list[tuple[float, int]] = []
    for value in (heights[order] - place).tolist():
        blocks.append((value, 1))
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            (first, many), (second, more) = blocks[-2:]
            blocks[-2:] = [((first * many + second * more) / (many + more), many + more)]
    level = np.concatenate([np.full(count, value) for value, count in blocks])
    found = np.empty_like(heights)
    found[order] = np.clip(level, low, high - place[-1]) + place
    return found


def overlapping(boxes: Sequence[tuple[float, float, float, float]]) -> list[tuple[int, int]]:
    """Pairs of boxes (left, bottom, right, top) that overlap."""
    return [
        (i, j)
        for i, a in enumerate(boxes)
        for j, b in enumerate(boxes[:i])
        if a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
    ]
