"""What the chart compares: a solver takes a start and a fineness, and gives velocities, a time and a count."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import METHODS
from softcradle.physics.methods import AUTO, Method
from softcradle.physics.simulation import solve
from softcradle.sandbox.studies.precision.cases import ChartCase, Start

Array = NDArray[np.float64]

NO_SAMPLES = np.zeros(0)  # sample times of a run whose final velocities alone are compared
FEWEST_STEPS = 30  # of the coarsest run of a fixed-step method
MOST_STEPS = 8e6  # of the finest
START_PHASES = 4  # lead times, evenly over one step, over which the error of a fixed step is averaged


@dataclass(frozen=True)
class Solution:
    """What a run gives.

    Attributes:
        velocity: (n+1,) final velocities [m/s], or None where the run gave up.
        seconds: wall time of the solver alone.
        evaluations: of all contact forces; nan where they are not counted.
        overlap, force: (T, n) at the sample times [m], [N]; None where there are none.
    """

    velocity: Array | None
    seconds: float
    evaluations: float = np.nan
    overlap: Array | None = None
    force: Array | None = None


RunFunction = Callable[[float, Start, Array], Solution]  # fineness, start, sample times (T,) [s]


@dataclass(frozen=True)
class Solver:
    """One way to solve a case, over one series of finenesses.

    Attributes:
        name: of its curve, which has all settings of that name.
        setting: what distinguishes this series from others of the same name.
        finenesses: tolerances or numbers of steps, coarse to fine.
        run: solves the case.
        ours: True for the methods of `simulate`.
        steps: True where a fineness is a number of steps.
    """

    name: str
    setting: str
    finenesses: Sequence[float]
    run: RunFunction
    ours: bool = False
    steps: bool = False

    def starts(self, case: ChartCase, fineness: float) -> list[Start]:
        """The starts over which the error is averaged.

        The error of a fixed step depends on where in a step the first touch lies; an adaptive run locates the touch.
        """
        if not self.steps:
            return [Start(case.chain, case.velocity)]
        step = case.run_duration / fineness
        return case.starts([(k + 0.5) / START_PHASES * step for k in range(START_PHASES)])


def tolerances(finest: float = 1e-12) -> list[float]:
    """Half decades from 1e-2 down to `finest`."""
    return [float(10.0 ** (-0.5 * k)) for k in range(4, round(-2.0 * np.log10(finest)) + 1)]


def step_counts() -> list[float]:
    """Numbers of steps by factors of 2."""
    return [FEWEST_STEPS * 2.0**k for k in range(1 + int(np.log2(MOST_STEPS / FEWEST_STEPS)))]


def our_solvers(case: ChartCase) -> list[Solver]:
    """Every method that can take the case, adaptive ones over tolerances, others over numbers of steps; and `auto`."""
    auto = Solver(AUTO, "", tolerances(1e-11)[2:], partial(_run_adaptive, case, AUTO), ours=True)
    return [*(_solver(case, method) for method in METHODS if method.dissipative or not case.chain.dissipative), auto]


def _solver(case: ChartCase, method: Method) -> Solver:
    if method.adaptive:
        return Solver(method.name, "", tolerances(), partial(_run_adaptive, case, method.name), ours=True)
    return Solver(method.name, "", step_counts(), partial(_run_fixed, case, method.name), ours=True, steps=True)


def _run_adaptive(case: ChartCase, method: str, tolerance: float, start: Start, sample_times: Array) -> Solution:
    duration = case.run_duration if sample_times.size else case.duration
    return _run(start, duration, method, sample_times, tolerance=tolerance)


def _run_fixed(case: ChartCase, method: str, steps: float, start: Start, sample_times: Array) -> Solution:
    # to the known end, as the peers: a run that chatters may never end by itself
    duration = case.run_duration + start.early
    return _run(start, duration, method, sample_times, step=case.run_duration / steps)


def _run(start: Start, duration: float | None, method: str, sample_times: Array, **fineness: Any) -> Solution:
    samples = sample_times + start.early if sample_times.size else 2
    found = solve(start.chain, start.velocity, duration, method, samples=samples, **fineness)
    overlap, force = (found.overlap, found.force) if sample_times.size else (None, None)
    velocity = None if found.status.gave_up else found.final_velocity
    return Solution(velocity, found.seconds, found.evaluations, overlap, force)
