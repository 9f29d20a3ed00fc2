"""Measuring: each solver's series of settings, coarse to fine, until it is exact enough or has had its share of time."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.chart_cases import Case, Start
from softcradle.sandbox.studies.precision.solvers import NO_MOMENTS, Answer, Solver

Array = NDArray[np.float64]

ENOUGH = 3e-11  # a series ends after two settings below this error
REPEATS = 7  # runs of a setting, of whose times the median counts
SHORT = 0.01  # [s] what takes longer is run fewer times
LEAST_GROWTH, MOST_GROWTH = 1.3, 2.5  # a finer setting is expected to take so many times as long, as the last two say
HOPELESS = 4.0  # times the longest run wanted: what takes so long at its coarsest setting is run but once
SHOWN = 1.0  # an error of the closing speed itself is none that a chart shows


@dataclass(frozen=True)
class Patience:
    """How long a series may go on.

    Attributes:
        point: one run must not be expected to take longer [s].
        series: all runs of a series together [s], at most.
        case: all series of a case together [s]; a series has its share of what is left, loading and compiling apart.
    """

    point: float = 0.25
    series: float = 0.8
    case: float = 18.0


@dataclass
class Point:
    """One setting of one solver.

    Attributes:
        solver, fineness: the setting.
        error: root mean square over the start phases.
        seconds: median wall time of a run.
        evaluations: mean number of evaluations of all contact forces; nan where nobody counts.
    """

    solver: Solver
    fineness: float
    error: float
    seconds: float
    evaluations: float = math.nan


@dataclass(frozen=True)
class Series:
    """The points of one solver, coarse to fine, and why there are no more ("" where it is exact enough)."""

    solver: Solver
    points: list[Point]
    ended: str = ""


def error_of(case: Case, quantity: str, answer: Answer) -> float:
    """Error of an answer: of final velocities the largest; of forces and overlaps the root mean square over MOMENTS.

    Forces are relative to the largest force, overlaps to the overlap itself (App. B), at most 1, where it is not 0.
    """
    if answer.velocity is None:
        return math.inf
    if quantity == "velocities":
        return case.error(answer.velocity)
    found = answer.force if quantity == "forces" else answer.overlap
    if found is None:
        return math.inf
    true = case.fine.force if quantity == "forces" else case.fine.overlap
    if quantity == "forces":
        off = (found - true) / true.max()
    else:
        loaded = true > 0.0
        off = np.clip((found[loaded] - true[loaded]) / true[loaded], -1.0, 1.0)
    value = float(np.sqrt(np.mean(off**2))) if off.size else math.inf
    return value if math.isfinite(value) else math.inf


def scan(case: Case, solver: Solver, quantity: str = "velocities", patience: Patience = Patience()) -> Series:
    """Points of a series from coarse to fine; its first run should not be the solver's first, which may compile."""
    moments = _moments(case, quantity)
    points: list[Point] = []
    began = perf_counter()
    for fineness in solver.finenesses:
        points.append(_point(case, solver, fineness, quantity, moments))
        if all(point.error < ENOUGH for point in points[-2:]) and len(points) > 1:
            return Series(solver, points)
        expected = _growth(points) * points[-1].seconds
        if expected > patience.point or perf_counter() - began > patience.series:
            return Series(solver, points, f"a finer run would take about {expected:.2g} s")
    return Series(solver, points, "no finer setting")


def _growth(points: Sequence[Point]) -> float:
    """How many times as long as the last the next finer setting will take."""
    last = points[-1].seconds / points[-2].seconds if len(points) > 1 else LEAST_GROWTH
    return min(max(last, LEAST_GROWTH), MOST_GROWTH)


def _point(case: Case, solver: Solver, fineness: float, quantity: str, moments: Array) -> Point:
    starts = solver.starts(case, fineness)
    answers = [_answer(solver, fineness, start, moments) for start in starts]
    errors = [error_of(case, quantity, answer) for answer in answers]
    times = [answer.seconds for answer in answers]
    while len(times) < REPEATS and max(times) < SHORT:
        times.append(_answer(solver, fineness, starts[len(times) % len(starts)], moments).seconds)
    counts = [answer.evaluations for answer in answers]
    with np.errstate(over="ignore"):
        return Point(
            solver,
            fineness,
            float(np.sqrt(np.mean(np.square(errors)))),
            float(np.median(times)),
            float(np.mean(counts)),
        )


def measure(
    case: Case,
    solvers: Sequence[Solver],
    quantity: str = "velocities",
    patience: Patience = Patience(),
    told: Callable[[str], None] = lambda _: None,
) -> list[Series]:
    """Every series; `told` hears the name of each before it is measured."""
    found, spent = [], 0.0
    for k, solver in enumerate(solvers):
        told(solver.name)
        share = (patience.case - spent) / (len(solvers) - k)
        with unheard():
            first = _first(case, solver, quantity)  # compiles, where there is something to compile
            began = perf_counter()
            if first.seconds > HOPELESS * patience.point:
                found.append(Series(solver, [first], f"a run takes {first.seconds:.2g} s"))
            else:
                found.append(scan(case, solver, quantity, replace(patience, series=min(patience.series, share))))
            spent += perf_counter() - began
    return found


def _answer(solver: Solver, fineness: float, start: Start, moments: Array) -> Answer:
    """A run; a peer that raises has given up, a method of ours that does has a bug."""
    began = perf_counter()
    try:
        return solver.run(fineness, start, moments)
    except (ValueError, ArithmeticError, RuntimeError):
        if solver.ours:
            raise
        return Answer(None, perf_counter() - began)


def _first(case: Case, solver: Solver, quantity: str) -> Point:
    """One run at the coarsest setting."""
    fineness = solver.finenesses[0]
    answer = _answer(solver, fineness, solver.starts(case, fineness)[0], _moments(case, quantity))
    return Point(solver, fineness, error_of(case, quantity, answer), answer.seconds, answer.evaluations)


def _moments(case: Case, quantity: str) -> Array:
    return NO_MOMENTS if quantity == "velocities" else case.moments


def frontier(series: Sequence[Series], cost: str = "seconds") -> list[Point]:
    """The points of several series than which none is both cheaper (by `cost`) and more exact; dear and exact last."""
    points = [point for one in series for point in one.points if math.isfinite(getattr(point, cost))]
    best: list[Point] = []
    for point in sorted(points, key=lambda point: (getattr(point, cost), point.error)):
        if point.error < (best[-1].error if best else SHOWN):
            best.append(point)
    return best


def fastest(series: Sequence[Series], reach: float) -> Point | None:
    """Fastest point that reaches the error together with the next finer one of its series: no lucky hit counts."""
    counting = [
        point
        for one in series
        for point, finer in zip(one.points, [*one.points[1:], one.points[-1]], strict=True)
        if point.error <= reach and finer.error <= reach
    ]
    return min(counting, key=lambda point: point.seconds, default=None)


def by_name(series: Sequence[Series]) -> dict[str, list[Series]]:
    """The series of each name, names in order of appearance."""
    found: dict[str, list[Series]] = {}
    for one in series:
        found.setdefault(one.solver.name, []).append(one)
    return found


def fitted_order(series: Series, floor: float) -> float | None:
    """Order p of error ~ fineness**p: in the step for a fixed step, in the tolerance else; None for fewer than 3 points.

    Points above a tenth of the closing speed, or within ten times the floor that the truth or round-off sets, are no part.
    """
    points = [point for point in series.points if 10.0 * floor < point.error < 0.1]
    if len(points) < 3:
        return None
    fineness = np.log([1.0 / p.fineness if series.solver.steps else p.fineness for p in points])
    return float(np.polyfit(fineness, np.log([p.error for p in points]), 1)[0])


@contextmanager
def unheard() -> Iterator[None]:
    """Nothing that compiled code prints is shown: peers complain of every step they do not like."""
    kept = [os.dup(1), os.dup(2)]
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        for copy, descriptor in zip(kept, (1, 2), strict=True):
            os.dup2(copy, descriptor)
            os.close(copy)
