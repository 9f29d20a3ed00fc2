"""What the points of a curve say: its frontier, its fastest point for an error, its order."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from softcradle.sandbox.studies.precision.measurement import Point, Series

LARGEST_ERROR = 1.0  # an error of the closing speed itself is not shown
LARGEST_ORDER_ERROR = 0.1  # points with larger errors do not count for the order
ORDER_MARGIN = 10.0  # nor do points whose error is less than this times the uncertainty of the truth


def series_by_name(series: Sequence[Series]) -> dict[str, list[Series]]:
    """The series of each name, which make one curve; names in order of appearance."""
    found: dict[str, list[Series]] = {}
    for one in series:
        found.setdefault(one.solver.name, []).append(one)
    return found


def frontier(series: Sequence[Series], cost: str = "seconds") -> list[Point]:
    """The points such that no other is both cheaper (by `cost`) and more exact; the most expensive and exact last."""
    points = [point for one in series for point in one.points if math.isfinite(getattr(point, cost))]
    best: list[Point] = []
    for point in sorted(points, key=lambda point: (getattr(point, cost), point.error)):
        if point.error < (best[-1].error if best else LARGEST_ERROR):
            best.append(point)
    return best


def fastest(series: Sequence[Series], error: float) -> Point | None:
    """The fastest point that reaches `error` as its next finer one does: errors that are small by chance do not count."""
    reaching = [
        point
        for one in series
        for point, finer in zip(one.points, [*one.points[1:], one.points[-1]], strict=True)
        if point.error <= error and finer.error <= error
    ]
    return min(reaching, key=lambda point: point.seconds, default=None)


def most_exact(series: Sequence[Series]) -> Series:
    """The series that has the point with the smallest error."""
    return min(series, key=lambda one: min((point.error for point in one.points), default=math.inf))


def fitted_order(series: Series, uncertainty: float) -> float | None:
    """Order p of error ~ fineness**p, in the step or in the tolerance; None for fewer than 3 points that count."""
    points = [point for point in series.points if ORDER_MARGIN * uncertainty < point.error < LARGEST_ORDER_ERROR]
    if len(points) < 3:
        return None
    fineness = np.log([1.0 / p.fineness if series.solver.steps else p.fineness for p in points])
    return float(np.polyfit(fineness, np.log([p.error for p in points]), 1)[0])
