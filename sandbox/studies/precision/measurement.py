"""Measurement of the error and the computing time of each solver.

The settings run from coarse to fine. The series of settings ends when a solver is accurate enough or has used up its
time.
"""

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

NO_SAMPLES = np.zeros(0)  # Sample times if only final velocities are compared.
FEWEST_STEPS = 30  # Number of steps in the coarsest simulation of a fixed-step method.
MOST_STEPS = 8e6  # Number of steps in the finest simulation of a fixed-step method.
# Number of lead times over which the error of a fixed-step method is averaged. The lead times are uniform over one
# step.
START_PHASES = 4
PACKAGES = ("softcradle", "numba", "numpy", "scipy", "pymunk")


@dataclass(frozen=True)
class Solution:
    """Result of one simulation.

    Attributes:
        velocity: (n+1,) final velocities [m/s], or None if the simulation gave up.
        seconds: wall time of the solver only.
        evaluations: number of evaluations of all contact forces; NaN if they are not counted.
        overlap, force: (T, n) at the sample times [m], [N]; None without samples.
    """

    velocity: Array | None
    seconds: float
    evaluations: float = np.nan
    overlap: Array | None = None
    force: Array | None = None


RunFunction = Callable[[float, Start, Array], Solution]  # The arguments are fineness, start and sample times (T,) [s].


@dataclass(frozen=True)
class Solver:
    """A solver with one series of settings.

    Attributes:
        name: name of the curve in the chart. A curve contains all settings of this name.
        setting: text that distinguishes this series from other series of the same name.
        finenesses: tolerances or numbers of steps, from coarse to fine.
        run: function that solves the case.
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
        """Return the initial states over which the error is averaged.

        With fixed steps, the error depends on the time within a step at which beads first touch. Adaptive methods
        locate this time.
        """
        if not self.steps:
            return [Start(case.chain, case.velocity)]
        step = case.run_duration / fineness
        return case.starts([(k + 0.5) / START_PHASES * step for k in range(START_PHASES)])


def tolerances(finest: float = 1e-12) -> list[float]:
    """Return the tolerances from 1e-2 down to `finest`, two in each decade."""
    return [float(10.0 ** (-0.5 * k)) for k in range(4, round(-2.0 * np.log10(finest)) + 1)]


def step_counts() -> list[float]:
    """Return the numbers of steps. Each number is twice the previous number."""
    return [FEWEST_STEPS * 2.0**k for k in range(1 + int(np.log2(MOST_STEPS / FEWEST_STEPS)))]


def our_solvers(case: ChartCase) -> list[Solver]:
    """Return every method of ours that can solve the case.

    The settings are tolerances for adaptive methods and numbers of steps for other methods. The method `auto` is
    included.
    """
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
    # The duration ends at the known end of the collision, as for other integrators. A chattering motion may never end
    # by itself.
    duration = case.run_duration + start.early
    return _solution(start, duration, method, sample_times, step=case.run_duration / steps)


def _solution(start: Start, duration: float | None, method: str, sample_times: Array, **fineness: Any) -> Solution:
    samples = sample_times + start.early if sample_times.size else 2
    found = solve(start.chain, start.velocity, duration, method, samples=samples, **fineness)
    overlap, force = (found.overlap, found.force) if sample_times.size else (None, None)
    velocity = None if found.status.gave_up else found.final_velocity
    return Solution(velocity, found.seconds, found.evaluations, overlap, force)


SMALLEST_ERROR = 3e-11  # A series ends after two settings with smaller errors.
REPEATS = 7  # Number of simulations with one setting. Their median time counts.
SHORT_RUN = 0.01  # Simulations that take longer [s] are repeated fewer times.

# Smallest and largest factor between the expected time of the next finer setting and the last time. Within these
# limits, the factor is assumed to stay the same.
LEAST_GROWTH = 1.3
MOST_GROWTH = 2.5

# Multiple of the time limit of a simulation. A solver whose coarsest setting takes longer runs only once.
SLOWEST_FIRST_RUN = 4.0


@dataclass(frozen=True)
class TimeLimits:
    """Time limits of a measurement.

    Attributes:
        run: a simulation that is expected to take longer is not started [s].
        series: limit for all simulations of a series together [s].
        case: limit for all series of a case together [s], without loading and compiling. Each series has its share of
            the remaining time.
    """

    run: float = 0.25
    series: float = 0.8
    case: float = 18.0


@dataclass
class ChartPoint:
    """One setting of one solver, with its measured error and time.

    Attributes:
        solver, fineness: the setting.
        error: root mean square of the errors for different start phases.
        seconds: median wall time of a simulation.
        evaluations: mean number of evaluations of all contact forces; NaN if they are not counted.
    """

    solver: Solver
    fineness: float
    error: float
    seconds: float
    evaluations: float = math.nan


@dataclass(frozen=True)
class Series:
    """Measured points of one solver from coarse to fine. The object records if a time limit ended the series."""

    solver: Solver
    points: list[ChartPoint]
    out_of_time: bool = False


def error_of(case: ChartCase, quantity: str, solution: Solution) -> float:
    """Return the error of a solution.

    The error of final velocities is the largest one. The error of forces or overlaps is a root mean square. Forces are
    relative to the largest force. Overlaps are relative to the overlap itself (App. B), with a limit of 1. Only
    contacts that are compressed or extended count for overlaps.
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
    """Measure every series of a case. Call `announce` with the name of each solver before its measurement."""
    found, spent = [], 0.0
    for k, solver in enumerate(solvers):
        announce(solver.name)
        share = (limits.case - spent) / (len(solvers) - k)
        with _silenced():
            first = _first_point(case, solver, quantity)  # The first simulation may compile the solver.
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
    """Return the points of a series from coarse to fine.

    The solver should have run before, because its first simulation may include the time to compile it.
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
    """Return the expected time of the next finer setting, divided by the time of the last setting."""
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
    """Measure the coarsest setting with a single simulation."""
    fineness = solver.finenesses[0]
    solution = _run(solver, fineness, solver.starts(case, fineness)[0], _sample_times(case, quantity))
    return ChartPoint(solver, fineness, error_of(case, quantity, solution), solution.seconds, solution.evaluations)


def _run(solver: Solver, fineness: float, start: Start, sample_times: Array) -> Solution:
    """Solve the case with one setting.

    If another integrator raises an error, it counts as given up. An error of one of our methods is a bug and is raised.
    """
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
    """Suppress the output of compiled code. Some integrators print a line for every rejected step."""
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
    """Return a text with the processor, the cores, the system, and the versions of Python and of packages.

    The packages are PACKAGES and the given `packages`.
    """
    found = [f"{name} {installed}" for name in (*PACKAGES, *packages) if (installed := _version(name))]
    cores = os.cpu_count() or 1
    hardware = f"{processor()}, {cores} core{'s' * (cores > 1)}"
    return "; ".join([hardware, f"{platform.system()}, Python {platform.python_version()}", ", ".join(found)])


def processor() -> str:
    """Return the name of the processor. On Linux it is read from /proc/cpuinfo, because Python reports only the
    architecture.
    """
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
