"""Work against precision: the least time in which each method, and each peer, reaches an error of final velocities.

A setting (tolerance, number of steps) counts as reaching an error where it and the next finer one both have it: errors
are irregular, and one lucky hit is no accuracy. Of those that count the fastest is timed again, all solvers of a case in
turn, and the minimum is shown.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from benchmarks.cases import REACHES, RECIPES, Case, Recipe
from benchmarks.report import Report, against
from benchmarks.solvers import Solver, ours

SLOWEST = 1.0  # [s] a series of settings ends where one solve takes longer
PATIENCE = 4.0  # or where all of them together take so many times as long
ENOUGH = 0.1  # of the least error wanted: a series ends after two settings below it
LOOKS = 3  # times each setting is run while looking for the fastest
ROUNDS = 15
SHORT = 0.02  # [s] what takes longer is run once while looking, and in a few rounds only
FEW = 3


@dataclass
class Point:
    """One setting of one solver: its error, and its least time so far [s]."""

    solver: Solver
    fineness: float
    error: float
    seconds: float

    def again(self) -> None:
        """Time it once more."""
        self.seconds = min(self.seconds, self.solver.run(self.fineness)[1])


def scan(case: Case, solver: Solver) -> list[Point]:
    """Points of a series from coarse to fine."""
    found: list[Point] = []
    solver.run(solver.finenesses[0])  # compiles
    spent = 0.0
    for fineness in solver.finenesses:
        velocity, seconds = solver.run(fineness)
        error = math.inf if velocity is None else case.error(velocity)
        found.append(Point(solver, fineness, error, seconds))
        spent += seconds
        if max(seconds, spent / PATIENCE) > SLOWEST or all(point.error < ENOUGH * min(REACHES) for point in found[-2:]):
            break
        if seconds < SHORT:
            for _ in range(LOOKS - 1):
                found[-1].again()
    return found


def fastest(series: Sequence[Sequence[Point]], reach: float) -> Point | None:
    """Fastest point that reaches the error together with the next finer one of its series."""
    counting = [
        point
        for points in series
        for point, finer in zip(points, [*points[1:], points[-1]], strict=True)
        if point.error <= reach and finer.error <= reach
    ]
    return min(counting, key=lambda point: point.seconds, default=None)


@contextmanager
def unheard() -> Iterator[None]:
    """Nothing that compiled code prints is shown: peers complain of every step they do not like."""
    kept = [os.dup(1), os.dup(2)]
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        for copy, descriptor in zip(kept, (1, 2), strict=True):
            os.dup2(copy, descriptor)
            os.close(copy)


def measure(case: Case, solvers: Sequence[Solver], rounds: int = ROUNDS) -> list[dict[str, Any]]:
    """By solver name: what it takes to reach each error, and every setting tried."""
    with unheard():
        series = [scan(case, solver) for solver in solvers]
        names = list(dict.fromkeys(solver.name for solver in solvers))
        of_name = {name: [points for points in series if points[0].solver.name == name] for name in names}
        best = {name: [fastest(of_name[name], reach) for reach in REACHES] for name in names}
        chosen = list({id(point): point for row in best.values() for point in row if point}.values())
        for k in range(rounds):
            for point in chosen:
                if point.seconds < SHORT or k < FEW:
                    point.again()
    return [
        {
            "name": name,
            "ours": of_name[name][0][0].solver.ours,
            "best": [_plain(point) for point in best[name]],
            "tried": [_plain(point) for points in of_name[name] for point in points],
        }
        for name in names
    ]


def _plain(point: Point | None) -> dict[str, Any] | None:
    if point is None:
        return None
    error = point.error if math.isfinite(point.error) else None
    return {
        "setting": point.solver.setting,
        "fineness": point.fineness,
        "error": error,
        "milliseconds": 1e3 * point.seconds,
    }


def least(found: Sequence[dict[str, Any]], ours: bool, k: int) -> float | None:
    """Least milliseconds to the k-th error of REACHES among the methods of `simulate`, or among the peers."""
    times = [row["best"][k]["milliseconds"] for row in found if row["ours"] == ours and row["best"][k]]
    return min(times, default=None)


def table(case: Case, found: Sequence[dict[str, Any]], rounds: int = ROUNDS) -> Report:
    """One row a solver; the aims beside `accurate`, which is what `simulate` takes by itself."""
    rows = []
    for row in found:
        times = [best["milliseconds"] if best else None for best in row["best"]]
        aims = [case.aims.get(reach) if row["name"] == "accurate" else None for reach in REACHES]
        cells = [against(time, aim) for time, aim in zip(times, aims, strict=True)]
        rows.append([row["name"], *cells, "; ".join(_how(row["best"]))])
    return Report(
        f"{case.name}: milliseconds to an error of final velocities",
        ["", *(f"{reach:g}" for reach in REACHES), "at"],
        rows,
        [_ratio(found), f"minimum of {rounds} rounds, {FEW} where one solve takes over {1e3 * SHORT:g} ms; "
         f"-: not within {SLOWEST:g} s; {_doubt(case)}"],
        {"case": case.name, "doubt": case.doubt, "aims": {f"{k:g}": v for k, v in case.aims.items()}, "solvers": found},
    )  # fmt: skip


def _how(best: Sequence[dict[str, Any] | None]) -> list[str]:
    return ["-" if point is None else f"{point['setting']} {point['fineness']:.0e}".strip() for point in best]


def _ratio(found: Sequence[dict[str, Any]]) -> str:
    pairs = [(least(found, False, k), least([r for r in found if r["name"] == "accurate"], True, k)) for k in range(3)]
    shown = ["-" if not mine else "no peer" if not peer else f"{peer / mine:.2g}" for peer, mine in pairs]
    return f"best peer over accurate: {' / '.join(shown)}"


def _doubt(case: Case) -> str:
    if case.doubt == 0.0:
        return "truth in quadruple precision"
    return f"truth by radau at 1e-12, accurate agrees within {case.doubt:.0e}"


def reports(recipes: Sequence[Recipe] = RECIPES, rounds: int = ROUNDS) -> Iterator[Report]:
    """A report a case, with one on what is not installed."""
    from benchmarks.peers import missing, peers

    for name in missing():
        yield Report(f"{name} is not installed: left out (pip install {name})", [], [])
    for recipe in recipes:
        case = recipe.cook()
        yield table(case, measure(case, [*ours(case), *peers(case)], rounds), rounds)
