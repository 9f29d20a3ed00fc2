"""Work-precision benchmark: the shortest time in which each method and each other integrator reaches an error.

The benchmark uses the cases, solvers and measurements of `softcradle chart`, but gives each case more time. The table
of the benchmark also shows the goals.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from softcradle.sandbox.studies.precision.cases import CASE_DEFINITIONS, ERROR_LEVELS, ChartCase
from softcradle.sandbox.studies.precision.measurement import ChartPoint, Solver, TimeLimits, measure_case, our_solvers
from softcradle.sandbox.studies.precision.peers import missing_peers, peer_solvers
from softcradle.sandbox.studies.precision.table import (
    CurveRow,
    MeasuredCase,
    auto_sentence,
    curve_rows,
    ratio,
    ratio_sentence,
    setting_text,
)

from benchmarks.reports import Report, at_most

LIMITS = TimeLimits(run=1.0, series=3.0, case=60.0)


def reports() -> Iterator[Report]:
    """Yield a report for each integrator that is not installed, and then a report for each case."""
    for peer in missing_peers():
        yield Report(f"{peer.name} is not installed: left out (pip install {peer.package})")
    for definition in CASE_DEFINITIONS:
        case = definition.solve()
        yield case_report(case, [*our_solvers(case), *peer_solvers(case)])


def case_report(case: ChartCase, solvers: Sequence[Solver], limits: TimeLimits = LIMITS) -> Report:
    """Measure one case, and return a table with a row for each solver.

    The table shows the goals for `accurate`, the default method of `simulate`.
    """
    measured = MeasuredCase(case, measure_case(case, solvers, limits=limits))
    rows = curve_rows(measured)
    note = f"median; -: not within {limits.run:g} s a run; truth: {case.source}"
    return Report(
        f"{case.label}: milliseconds to an error of final velocities",
        ["", *(f"{error:g}" for error in ERROR_LEVELS), "at"],
        [[row.name, *_times(case, row), "; ".join(setting_text(point) for point in row.fastest)] for row in rows],
        [ratio_sentence(rows), auto_sentence(rows), note],
        {
            "case": case.label,
            "uncertainty": case.uncertainty,
            "aims": {f"{error:g}": aim for error, aim in case.aims.items()},
            "ratios": [_finite(ratio(rows, level)) for level in range(len(ERROR_LEVELS))],
            "solvers": [_solver_data(row, measured) for row in rows],
        },
    )


def _times(case: ChartCase, row: CurveRow) -> list[str]:
    times = [1e3 * point.seconds if point else None for point in row.fastest]
    aims = [case.aims.get(error) if row.name == "accurate" else None for error in ERROR_LEVELS]
    return [at_most(time, aim) for time, aim in zip(times, aims, strict=True)]


def _solver_data(row: CurveRow, measured: MeasuredCase) -> dict[str, Any]:
    points = [point for one in measured.series if one.solver.name == row.name for point in one.points]
    return {
        "name": row.name,
        "ours": row.ours,
        "fastest": [_point_data(point) if point else None for point in row.fastest],
        "points": [_point_data(point) for point in points],
    }


def _point_data(point: ChartPoint) -> dict[str, Any]:
    return {
        "setting": point.solver.setting,
        "fineness": point.fineness,
        "error": _finite(point.error),
        "milliseconds": 1e3 * point.seconds,
        "evaluations": _finite(point.evaluations),
    }


def _finite(value: float | None) -> float | None:
    """Return a number, or None if JSON cannot represent it."""
    return value if value is not None and math.isfinite(value) else None
