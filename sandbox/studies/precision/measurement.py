"""Measurement: error and time of each solver from coarse to fine, until it is exact enough or its time is used up."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.cases import ChartCase, Start
from softcradle.sandbox.studies.precision.solvers import NO_SAMPLES, Solution, Solver

Array = NDArray[np.float64]

SMALLEST_ERROR = 3e-11  # a series ends after two settings with smaller errors
REPEATS = 7  # runs of a setting, whose median time counts
SHORT_RUN = 0.01  # [s] longer runs are repeated fewer times

# The next finer setting is expected to take as much longer as the last one did, within these factors.
LEAST_GROWTH = 1.3
MOST_GROWTH = 2.5

SLOWEST_FIRST_RUN = 4.0  # over the time limit of a run: a solver that is slower at its coarsest setting runs just once


@dataclass(frozen=True)
class TimeLimits:
    """How long a measurement may take.

    Attributes:
        run: no run is begun that is expected to take longer [s].
        series: all runs of a series together [s].
        case: all series of a case together [s], without loading and compiling; each series has its share of what is left.
    """

    run: float = 0.25
    series: float = 0.8
    case: float = 18.0


@dataclass
class ChartPoint:
    """One setting of one solver.

    Attributes:
        solver, fineness: the setting.
        error: root mean square over the start phases.
        seconds: median wall time of a run.
        evaluations: mean number of evaluations of all contact forces; nan where they are not counted.
    """

    solver: Solver
    fineness: float
    error: float
    seconds: float
    evaluations: float = math.nan


@dataclass(frozen=True)
class Series:
    """The points of one solver, coarse to fine, and whether a time limit ended them."""

    solver: Solver
    points: list[ChartPoint]
    out_of_time: bool = False


def error_of(case: ChartCase, quantity: str, solution: Solution) -> float:
    """Error of a solution: of final velocities the largest; of forces and overlaps the root mean square over the samples.

    Forces are relative to the largest force, overlaps to the overlap itself (App. B), at most 1, where it is not 0.
    """
    if solution.velocity is None:
        return math.inf
    if quantity == "velocities":
        return case.error(solution.velocity)
    found = solution.force if quantity == "forces" else solution.overlap
    if found is None:
        return math.inf
    true = case.sampled_truth.force if quantity == "forces" else case.sampled_truth.overlap
    if quantity == "forces":
        error = (found - true) / true.max()
    else:
        loaded = true > 0.0
        error = np.clip((found[loaded] - true[loaded]) / true[loaded], -1.0, 1.0)
    value = float(np.sqrt(np.mean(error**2))) if error.size else math.inf
    return value if math.isfinite(value) else math.inf


def measure_case(
    case: ChartCase,
    solvers: Sequence[Solver],
    quantity: str = "velocities",
    limits: TimeLimits = TimeLimits(),
    announce: Callable[[str], None] = lambda _: None,
) -> list[Series]:
    """Every series; `announce` is called with the name of each solver before it is measured."""
    found, spent = [], 0.0
    for k, solver in enumerate(solvers):
        announce(solver.name)
        share = (limits.case - spent) / (len(solvers) - k)
        with _silenced():
            first = _first_point(case, solver, quantity)  # compiles, where there is something to compile
            began = perf_counter()
            if first.seconds > SLOWEST_FIRST_RUN * limits.run:
                found.append(Series(solver, [first], out_of_time=True))
            else:
                own = replace(limits, series=min(limits.series, share))
                found.append(measure_series(case, solver, quantity, own))
            spent += perf_counter() - began
    return found


def measure_series(
    case: ChartCase, solver: Solver, quantity: str = "velocities", limits: TimeLimits = TimeLimits()
) -> Series:
    """Points of a series from coarse to fine; its first run should not be the solver's first, which may compile."""
    points: list[ChartPoint] = []
    began = perf_counter()
    for fineness in solver.finenesses:
        points.append(_point(case, solver, fineness, quantity))
        if all(point.error < SMALLEST_ERROR for point in points[-2:]) and len(points) > 1:
            return Series(solver, points)
        expected = _growth(points) * points[-1].seconds
        if expected > limits.run or perf_counter() - began > limits.series:
            return Series(solver, points, out_of_time=True)
    return Series(solver, points)


def _growth(points: Sequence[ChartPoint]) -> float:
    """Expected time of the next finer setting over that of the last one."""
    last = points[-1].seconds / points[-2].seconds if len(points) > 1 else LEAST_GROWTH
    return min(max(last, LEAST_GROWTH), MOST_GROWTH)


def _point(case: ChartCase, solver: Solver, fineness: float, quantity: str) -> ChartPoint:
    starts, times = solver.starts(case, fineness), _sample_times(case, quantity)
    solutions = [_run(solver, fineness, start, times) for start in starts]
    errors = [error_of(case, quantity, solution) for solution in solutions]
    seconds = [solution.seconds for solution in solutions]
    while len(seconds) < REPEATS and max(seconds) < SHORT_RUN:
        seconds.append(_run(solver, fineness, starts[len(seconds) % len(starts)], times).seconds)
    evaluations = float(np.mean([solution.evaluations for solution in solutions]))
    with np.errstate(over="ignore"):
        error = float(np.sqrt(np.mean(np.square(errors))))
    return ChartPoint(solver, fineness, error, float(np.median(seconds)), evaluations)


def _first_point(case: ChartCase, solver: Solver, quantity: str) -> ChartPoint:
    """One run at the coarsest setting."""
    fineness = solver.finenesses[0]
    solution = _run(solver, fineness, solver.starts(case, fineness)[0], _sample_times(case, quantity))
    return ChartPoint(solver, fineness, error_of(case, quantity, solution), solution.seconds, solution.evaluations)


def _run(solver: Solver, fineness: float, start: Start, sample_times: Array) -> Solution:
    """A run. A peer that raises has given up; a method of ours that raises has a bug."""
    began = perf_counter()
    try:
        return solver.run(fineness, start, sample_times)
    except (ValueError, ArithmeticError, RuntimeError):
        if solver.ours:
            raise
        return Solution(None, perf_counter() - began)


def _sample_times(case: ChartCase, quantity: str) -> Array:
    return NO_SAMPLES if quantity == "velocities" else case.sample_times


@contextmanager
def _silenced() -> Iterator[None]:
    """Output of compiled code is not shown: some peers print a line for every step that they reject."""
    copies = [os.dup(1), os.dup(2)]
    with open(os.devnull, "w", encoding="utf-8") as null:
        os.dup2(null.fileno(), 1)
        os.dup2(null.fileno(), 2)
    try:
        yield
    finally:
        for copy, descriptor in zip(copies, (1, 2), strict=True):
            os.dup2(copy, descriptor)
            os.close(copy)
