"""Work against precision: the least time in which each method, and each peer, reaches an error of final velocities.

The cases, the solvers and the measuring are those of `softcradle chart`; here each case is given more time, and its table
carries the aims.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from softcradle.sandbox.studies.precision.chart_cases import REACHES, RECIPES, Case, Recipe
from softcradle.sandbox.studies.precision.peers import PEERS, missing, peers
from softcradle.sandbox.studies.precision.precision_table import (
    Measured,
    Row,
    auto_sentence,
    how,
    ratio,
    ratio_sentence,
    rows,
)
from softcradle.sandbox.studies.precision.solvers import Solver, ours
from softcradle.sandbox.studies.precision.work_precision import Patience, Point, measure

from benchmarks.report import Report, against

PATIENCE = Patience(point=1.0, series=3.0, case=60.0)


def table(case: Case, found: Measured) -> Report:
    """One row a solver; the aims beside `accurate`, which is what `simulate` takes by itself."""
    told = rows(found)
    cells = [[row.name, *_times(case, row), "; ".join(how(best) for best in row.best)] for row in told]
    return Report(
        f"{case.label}: milliseconds to an error of final velocities",
        ["", *(f"{reach:g}" for reach in REACHES), "at"],
        cells,
        [
            ratio_sentence(told),
            auto_sentence(told),
            f"median; -: not within {PATIENCE.point:g} s a run; truth: {case.origin}",
        ],
        {
            "case": case.label,
            "doubt": case.doubt,
            "aims": {f"{reach:g}": aim for reach, aim in case.aims.items()},
            "ratios": [_finite(ratio(told, k)) for k in range(len(REACHES))],
            "solvers": [_row(row, found) for row in told],
        },
    )


def _times(case: Case, row: Row) -> list[str]:
    times = [1e3 * best.seconds if best else None for best in row.best]
    aims = [case.aims.get(reach) if row.name == "accurate" else None for reach in REACHES]
    return [against(time, aim) for time, aim in zip(times, aims, strict=True)]


def _row(row: Row, found: Measured) -> dict[str, Any]:
    tried = [point for one in found.series if one.solver.name == row.name for point in one.points]
    return {
        "name": row.name,
        "ours": row.ours,
        "best": [_point(point) for point in row.best],
        "tried": [_point(point) for point in tried],
    }


def _point(point: Point | None) -> dict[str, Any] | None:
    if point is None:
        return None
    return {
        "setting": point.solver.setting,
        "fineness": point.fineness,
        "error": _finite(point.error),
        "milliseconds": 1e3 * point.seconds,
        "evaluations": _finite(point.evaluations),
    }


def _finite(value: float | None) -> float | None:
    """A number as JSON takes it."""
    return value if value is not None and math.isfinite(value) else None


def measured(case: Case, solvers: Sequence[Solver], patience: Patience = PATIENCE) -> Report:
    """Measure and report one case."""
    return table(case, Measured(case, measure(case, solvers, patience=patience)))


def reports(recipes: Sequence[Recipe] = RECIPES) -> Iterator[Report]:
    """A report a case, with one on what is not installed."""
    packages = {peer.name: peer.package for peer in PEERS}
    for name in missing():
        yield Report(f"{name} is not installed: left out (pip install {packages[name]})", [], [])
    for recipe in recipes:
        case = recipe.cook()
        yield measured(case, [*ours(case), *peers(case)])
