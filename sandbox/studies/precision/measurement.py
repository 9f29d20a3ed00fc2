"""Measurement of error and time of each solver from coarse to fine, until it is accurate enough or its time is used up."""

import math
import os
import platform
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import METHODS
from softcradle.physics.methods import AUTO, Method, refusal_of
from softcradle.physics.simulation import solve
from softcradle.sandbox.studies.precision.cases import ChartCase, Start

Array = NDArray[np.float64]

NO_SAMPLES = np.zeros(0)  # sample times of a run whose final velocities only are compared
FEWEST_STEPS = 30  # steps of the coarsest run of a fixed-step method
MOST_STEPS = 8e6  # steps of the finest run
START_PHASES = 4  # lead times, uniform over one step, over which the error of a fixed-step run is averaged
PACKAGES = ("softcradle", "numba", "numpy", "scipy", "pymunk")


@dataclass(frozen=True)
class Solution:
    """Result of a run.

    Attributes:
        velocity: (n+1,) final velocities [m/s], or None if the run gave up.
        seconds: wall time of the solver only.
        evaluations: of all contact forces; NaN if they are not counted.
        overlap, force: (T, n) at the sample times [m], [N]; None without samples.
    """

    velocity: Array | None
    seconds: float
    evaluations: float = np.nan
    overlap: Array | None = None
    force: Array | None = None


RunFunction = Callable[[float, Start, Array], Solution]  # fineness, start, sample times (T,) [s]


@dataclass(frozen=True)
class Solver:
    """A solver with one series of settings.

    Attributes:
        name: name of its curve, which contains all settings of that name.
        setting: distinguishes this series from others of the same name.
        finenesses: tolerances or numbers of steps, coarse to fine.
        run: solves the case.
        ours: True for the methods of `simulate`.
        steps: True if the settings are numbers of steps.
    """

    name: str
    setting: str
    finenesses: Sequence[float]
    run: RunFunction
    ours: bool = False
    steps: bool = False

    def starts(self, case: ChartCase, fineness: float) -> list[Start]:
        """Return the starts over which the error is averaged.

        The error of a fixed-step run depends on the place of the first touch within a step; an adaptive run locates the
        touch.
        """
        if not self.steps:
            return [Start(case.chain, case.velocity)]
        step = case.run_duration / fineness
        return case.starts([(k + 0.5) / START_PHASES * step for k in range(START_PHASES)])


def tolerances(finest: float = 1e-12) -> list[float]:
    """Return half decades from 1e-2 down to `finest`."""
    return [float(10.0 ** (-0.5 * k)) for k in range(4, round(-2.0 * np.log10(finest)) + 1)]


def step_counts() -> list[float]:
    """Return numbers of steps by factors of 2."""
    return [FEWEST_STEPS * 2.0**k for k in range(1 + int(np.log2(MOST_STEPS / FEWEST_STEPS)))]


def our_solvers(case: ChartCase) -> list[Solver]:
    """Return every method that can solve the case: adaptive ones by tolerance, others by number of steps, and `auto`."""
    auto = Solver(AUTO, "", tolerances(1e-11)[2:], partial(_run_adaptive, case, AUTO), ours=True)
    return [*(_solver(case, method) for method in METHODS if not refusal_of(method.name, case.chain)), auto]


def _solver(case: ChartCase, method: Method) -> Solver:
    if method.adaptive:
        return Solver(method.name, "", tolerances(), partial(_run_adaptive, case, method.name), ours=True)
    return Solver(method.name, "", step_counts(), partial(_run_fixed, case, method.name), ours=True, steps=True)


def _run_adaptive(case: ChartCase, method: str, tolerance: float, start: Start, sample_times: Array) -> Solution:
    duration = case.run_duration if sample_times.size else case.duration
    return _solution(start, duration, method, sample_times, tolerance=tolerance)


def _run_fixed(case: ChartCase, method: str, steps: float, start: Start, sample_times: Array) -> Solution:
    # to the known end, like other integrators, because a chattering run may never end by itself
    duration = case.run_duration + start.early
    return _solution(start, duration, method, sample_times, step=case.run_duration / steps)


def _solution(start: Start, duration: float | None, method: str, sample_times: Array, **fineness: Any) -> Solution:
    samples = sample_times + start.early if sample_times.size else 2
    found = solve(start.chain, start.velocity, duration, method, samples=samples, **fineness)
    overlap, force = (found.overlap, found.force) if sample_times.size else (None, None)
    velocity = None if found.status.gave_up else found.final_velocity
    return Solution(velocity, found.seconds, found.evaluations, overlap, force)


SMALLEST_ERROR = 3e-11  # a series ends after two settings with smaller errors
REPEATS = 7  # runs of a setting; their median time counts
SHORT_RUN = 0.01  # [s] longer runs are repeated fewer times

# The expected time of the next finer setting grows like the last one did, within these factors.
LEAST_GROWTH = 1.3
MOST_GROWTH = 2.5

# Multiple of the time limit of a run. A solver that is slower at its coarsest setting runs just once.
SLOWEST_FIRST_RUN = 4.0


@dataclass(frozen=True)
class TimeLimits:
    """Time limits of a measurement.

    Attributes:
        run: a run that is expected to take longer is not started [s].
        series: all runs of a series together [s].
        case: all series of a case together [s], without loading and compiling; each series has its share of the
            remaining time.
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
        evaluations: mean number of evaluations of all contact forces; NaN if they are not counted.
    """

    solver: Solver
    fineness: float
    error: float
    seconds: float
    evaluations: float = math.nan


@dataclass(frozen=True)
class Series:
    """Points of one solver, coarse to fine, and whether a time limit ended them."""

    solver: Solver
    points: list[ChartPoint]
    out_of_time: bool = False


def error_of(case: ChartCase, quantity: str, solution: Solution) -> float:
    """Return the error of a solution: the largest of the final velocities, or the root mean square of forces or
    overlaps.

    Forces are relative to the largest force, overlaps to the overlap itself (App. B) and at most 1, while contacts
    yield.
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
        error = (found - true) / np.abs(true).max()
    else:
        yielding = case.yielding
        error = np.clip((found[yielding] - true[yielding]) / true[yielding], -1.0, 1.0)
    value = float(np.sqrt(np.mean(error**2))) if error.size else math.inf
    return value if math.isfinite(value) else math.inf


def measure_case(
    case: ChartCase,
    solvers: Sequence[Solver],
    quantity: str = "velocities",
    limits: TimeLimits = TimeLimits(),
    announce: Callable[[str], None] = lambda _: None,
) -> list[Series]:
    """Measure every series; call `announce` with the name of each solver before."""
    found, spent = [], 0.0
    for k, solver in enumerate(solvers):
        announce(solver.name)
        share = (limits.case - spent) / (len(solvers) - k)
        with _silenced():
            first = _first_point(case, solver, quantity)  # compiles if necessary
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
    """Return the points of a series from coarse to fine. Its first run should not be the solver's first one, which may
    compile.
    """
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
    """Return the expected time of the next finer setting relative to the last one."""
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
    """Run once at the coarsest setting."""
    fineness = solver.finenesses[0]
    solution = _run(solver, fineness, solver.starts(case, fineness)[0], _sample_times(case, quantity))
    return ChartPoint(solver, fineness, error_of(case, quantity, solution), solution.seconds, solution.evaluations)


def _run(solver: Solver, fineness: float, start: Start, sample_times: Array) -> Solution:
    """Run. Another integrator that raises has given up; a method of ours that raises has a bug."""
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
    """Suppress the output of compiled code, because some integrators print a line for every rejected step."""
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


def machine_stamp(packages: Sequence[str] = ()) -> str:
    """Return processor and cores, system, Python and the installed versions of PACKAGES and `packages`."""
    found = [f"{name} {installed}" for name in (*PACKAGES, *packages) if (installed := _version(name))]
    cores = os.cpu_count() or 1
    hardware = f"{processor()}, {cores} core{'s' * (cores > 1)}"
    return "; ".join([hardware, f"{platform.system()}, Python {platform.python_version()}", ", ".join(found)])


def processor() -> str:
    """Return the name of the processor; on Linux from /proc/cpuinfo, because Python knows only the architecture there."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return next(iter(names), "") or platform.processor() or platform.machine()


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
