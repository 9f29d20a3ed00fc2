"""Places of labels beside curves: each near its curve, moved apart until none overlap. Needs no pygame: charts use it."""

from __future__ import annotations

from collections.abc import Sequence


def spread(places: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """`places` moved apart to at least `gap`, in the same order and inside [low, high], by the smallest sum of squared moves."""
    order = sorted(range(len(places)), key=lambda k: places[k])
    gap = min(gap, (high - low) / max(1, len(places) - 1))
    groups: list[tuple[float, int]] = []  # of places that are `gap` apart: the mean of place - rank * gap, and how many
    for rank, k in enumerate(order):
        mean, count = places[k] - rank * gap, 1
        while groups and groups[-1][0] >= mean:
            before, more = groups.pop()
            mean, count = (mean * count + before * more) / (count + more), count + more
        groups.append((mean, count))
    starts = [mean for mean, count in groups for _ in range(count)]
    moved = [0.0] * len(places)
    for rank, k in enumerate(order):
        moved[k] = min(max(starts[rank], low), high - (len(order) - 1) * gap) + rank * gap
    return moved
