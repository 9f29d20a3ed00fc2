"""Tables of the work-precision measurements.

The table for people contains the shortest time to each error level. The file contains every measured point.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from softcradle.physics.checked_input import finite_or_none
from softcradle.physics.methods import AUTO
from softcradle.sandbox.studies.data_table import write_rows
from softcradle.sandbox.studies.precision.cases import ERROR_LEVELS, ChartCase
from softcradle.sandbox.studies.precision.measurement import ChartPoint, Series

LARGEST_ERROR = 1.0  # Points with larger errors, which exceed the closing speed itself, are not shown.
LARGEST_ORDER_ERROR = 0.1  # Points with larger errors are not used to fit the order.
# Points with errors below this multiple of the uncertainty of the true result are not used to fit the order.
ORDER_MARGIN = 10.0


def series_by_name(series: Sequence[Series]) -> dict[str, list[Series]]:
    """Return the series of each name in order of appearance. The series of one name form one curve."""
    found: dict[str, list[Series]] = {}
    for one in series:
        found.setdefault(one.solver.name, []).append(one)
    return found


def frontier(series: Sequence[Series], cost: str = "seconds") -> list[ChartPoint]:
    """Return the points that no other point beats in both cost and error.

    The last point is the most expensive and the most accurate one.
    """
    points = [point for one in series for point in one.points if math.isfinite(getattr(point, cost))]
    best: list[ChartPoint] = []
    for point in sorted(points, key=lambda point: (getattr(point, cost), point.error)):
        if point.error < (best[-1].error if best else LARGEST_ERROR):
            best.append(point)
    return best


def fastest(series: Sequence[Series], error: float) -> ChartPoint | None:
    """Return the fastest point that reaches `error`.

    The next finer point must also reach the error, because a single error may be small by chance.
    """
    reaching = [
        point
        for one in series
        for point, finer in zip(one.points, [*one.points[1:], one.points[-1]], strict=True)
        if point.error <= error and finer.error <= error
    ]
    return min(reaching, key=lambda point: point.seconds, default=None)


def most_exact(series: Sequence[Series]) -> Series:
    """Return the series that contains the point with the smallest error."""
    return min(series, key=lambda one: min((point.error for point in one.points), default=math.inf))


def fitted_order(series: Series, uncertainty: float) -> float | None:
    """Return the order p of error ~ fineness**p, where the fineness is the step or tolerance.

    The order is None if there are fewer than 3 valid points.
    """
    points = [point for point in series.points if ORDER_MARGIN * uncertainty < point.error < LARGEST_ORDER_ERROR]
    if len(points) < 3:
        return None
    fineness = np.log([1.0 / p.fineness if series.solver.steps else p.fineness for p in points])
    return float(np.polyfit(fineness, np.log([p.error for p in points]), 1)[0])


@dataclass(frozen=True)
class MeasuredCase:
    """A case with all its series, and the name of the quantity whose error was measured."""

    case: ChartCase
    series: list[Series]
    quantity: str = "velocities"


@dataclass(frozen=True)
class CurveRow:
    """Row of the table for one curve.

    Attributes:
        name, ours: as in Solver.
        fastest: the fastest point for each error level, or None.
        out_of_time: True if a time limit ended the most accurate series of the curve.
    """

    name: str
    ours: bool
    fastest: list[ChartPoint | None]
    out_of_time: bool

    def seconds(self, level: int) -> float:
        """Return the time to reach the error level with the index `level`. The time is infinite if the curve does not
        reach it.
        """
        point = self.fastest[level]
        return math.inf if point is None else point.seconds


def curve_rows(measured: MeasuredCase) -> list[CurveRow]:
    """Return one row for each curve name."""
    return [
        CurveRow(
            name,
            series[0].solver.ours,
            [fastest(series, error) for error in ERROR_LEVELS],
            most_exact(series).out_of_time,
        )
        for name, series in series_by_name(measured.series).items()
    ]


def fastest_row(rows: Sequence[CurveRow], ours: bool, level: int) -> CurveRow | None:
    """Return the row that reaches an error level fastest.

    The search is limited to the methods of `simulate` if `ours` is True, and to other integrators if it is False.
    """
    reaching = [row for row in rows if row.ours == ours and row.fastest[level] is not None]
    return min(reaching, key=lambda row: row.seconds(level), default=None)


def ratio(rows: Sequence[CurveRow], level: int) -> float | None:
    """Return the time of the fastest other integrator, divided by the time of our fastest method.

    The ratio is infinite if only our methods reach the error level, and None if our methods do not reach it.
    """
    mine, peer = fastest_row(rows, True, level), fastest_row(rows, False, level)
    if mine is None:
        return None
    return math.inf if peer is None else peer.seconds(level) / mine.seconds(level)


def ratio_sentence(rows: Sequence[CurveRow]) -> str:
    """Return a sentence with the fastest solver for each error level, and the time ratios.

    Without other integrators, the sentence contains only our methods.
    """
    parts, alone = [], all(row.ours for row in rows)
    for level, error in enumerate(ERROR_LEVELS):
        mine, peer = fastest_row(rows, True, level), fastest_row(rows, False, level)
        if mine is None:
            parts.append(f"{error:g}: none of ours")
        elif peer is None:
            parts.append(f"{error:g}: {mine.name}" + ("" if alone else ", no peer"))
        else:
            parts.append(f"{error:g}: {peer.name} / {mine.name} = {ratio(rows, level):.2g}")
    return ("fastest, at " if alone else "fastest peer over our fastest, at ") + "; ".join(parts)


def auto_sentence(rows: Sequence[CurveRow]) -> str:
    """Return a sentence with the time of `auto`, divided by the time of our fastest method, for each error level.

    The sentence is empty if `auto` was not measured.
    """
    auto = next((row for row in rows if row.name == AUTO), None)
    if auto is None:
        return ""
    others = [row for row in rows if row.name != AUTO]
    parts = []
    for level, error in enumerate(ERROR_LEVELS):
        best = fastest_row(others, True, level)
        if best is None or auto.fastest[level] is None:
            parts.append(f"{error:g}: -")
        else:
            parts.append(f"{error:g}: {auto.seconds(level) / best.seconds(level):.2g}")
    return f"auto over the fastest of our methods, at {'; '.join(parts)}"


def setting_text(point: ChartPoint | None) -> str:
    """Return the setting of a point as text."""
    if point is None:
        return "-"
    fineness = f"{point.fineness:.0f} steps" if point.solver.steps else f"{point.fineness:.0e}"
    return f"{point.solver.setting} {fineness}".strip()


def write_csv(measured: Sequence[MeasuredCase], path: Path) -> None:
    """Write every point of every series to a .csv file.

    A field is empty if the simulation gave up or if evaluations are not counted.
    """
    error = f"error of {measured[0].quantity}"
    header = ("case", "method", "ours", "setting", "tolerance or steps", error, "seconds", "evaluations")
    rows = [
        (found.case.name, one.solver.name, int(one.solver.ours), one.solver.setting, point.fineness,
         finite_or_none(point.error), point.seconds, finite_or_none(point.evaluations))
        for found in measured for one in found.series for point in one.points
    ]  # fmt: skip
    write_rows(path, header, rows)
