"""What the chart compares: a solver takes a start and a fineness, and gives velocities, a time and a count."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import METHODS, simulate
from softcradle.physics.methods import AUTO, Method
from softcradle.sandbox.studies.precision.chart_cases import Case, Start

Array = NDArray[np.float64]

NO_MOMENTS = np.zeros(0)
PHASES = 4  # gaps before the first touch, evenly over one step, whose errors are averaged
SLOW = ("pymunk", "scipy")  # methods for which a contact and step takes a microsecond or more


@dataclass(frozen=True)
class Answer:
    """What a run gave.

    Attributes:
        velocity: (n+1,) final velocities [m/s], or None where the run gave up.
        seconds: wall time of the solver alone.
        evaluations: of all contact forces; nan where nobody counts.
        overlap, force: (T, n) at the moments asked for [m], [N]; None where there are none.
    """

    velocity: Array | None
    seconds: float
    evaluations: float = np.nan
    overlap: Array | None = None
    force: Array | None = None


Run = Callable[[float, Start, Array], Answer]  # fineness, start, moments (T,) [s]


@dataclass(frozen=True)
class Solver:
    """One way to solve a case, at one series of settings.

    Attributes:
        name: whose it is: settings of the same name are one curve.
        setting: what sets this series apart from others of the same name.
        finenesses: tolerances or numbers of steps, coarse to fine.
        run: the solver itself.
        ours: True for the methods of `simulate`.
        steps: True where a fineness is a number of steps; its error is averaged over PHASES gaps before the touch.
    """

    name: str
    setting: str
    finenesses: Sequence[float]
    run: Run
    ours: bool = False
    steps: bool = False

    def starts(self, case: Case, fineness: float) -> list[Start]:
        """Those whose errors are averaged: an adaptive run finds the touch wherever it is, a fixed step does not."""
        if not self.steps:
            return [Start(case.chain, case.velocity)]
        step = case.span / fineness
        return case.starts([(k + 0.5) / PHASES * step for k in range(PHASES)])


def tolerances(least: float = 1e-12) -> list[float]:
    """Half decades from 1e-2 down to `least`."""
    return [float(10.0 ** (-0.5 * k)) for k in range(4, round(-2.0 * np.log10(least)) + 1)]


def step_counts(most: float = 8e6) -> list[float]:
    """Numbers of steps from 30 up to `most`, by factors of 2."""
    return [30.0 * 2**k for k in range(1 + int(np.log2(most / 30)))]


def ours(case: Case) -> list[Solver]:
    """Every method of METHODS, the adaptive ones over tolerances, the others over numbers of steps; and what auto takes."""
    auto = Solver(AUTO, "", tolerances(1e-11)[2:], partial(_adaptive, case, AUTO), True)
    return [*(_ours(case, method) for method in METHODS if method.dissipative or not case.chain.dissipative), auto]


def _ours(case: Case, method: Method) -> Solver:
    if method.adaptive:
        return Solver(method.name, "", tolerances(), partial(_adaptive, case, method.name), True)
    return Solver(method.name, "", step_counts(), partial(_fixed, case, method.name), True, True)


def _adaptive(case: Case, method: str, tolerance: float, start: Start, moments: Array) -> Answer:
    return _solved(start, case.span if moments.size else case.duration, method, moments, tolerance=tolerance)


def _fixed(case: Case, method: str, steps: float, start: Start, moments: Array) -> Answer:
    # to the known end, as the peers: chatter may never end
    return _solved(start, case.span + start.early, method, moments, step=case.span / steps)


def _solved(start: Start, duration: float | None, method: str, moments: Array, **fineness: float) -> Answer:
    samples = moments + start.early if moments.size else 2
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the error shows what the warning says
        found = simulate(start.chain, start.velocity, duration, method=method, samples=samples, **fineness)
    overlap, force = (found.overlap, found.force) if moments.size else (None, None)
    complete = None if found.status.gave_up else found.final_velocity
    return Answer(complete, found.seconds, found.evaluations, overlap, force)
