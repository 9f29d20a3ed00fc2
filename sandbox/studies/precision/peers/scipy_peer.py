"""SciPy's `solve_ivp` with a compiled right-hand side, called from its Python loop."""

from __future__ import annotations

from functools import partial
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.chart_cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import (
    COMPILED,
    FIRST_STEP,
    LONGEST,
    LateError,
    answer_of,
    parameters_of,
    slopes_in_time,
    start_of,
    times_of,
    tolerances_of,
)
from softcradle.sandbox.studies.precision.solvers import Answer, Solver, tolerances

Array = NDArray[np.float64]

METHODS = ("DOP853", "LSODA", "Radau")
FINER = 1e-6  # absolute tolerance of overlaps, as part of that of rates


def solvers(case: Case) -> list[Solver]:
    """A curve a method."""
    if not COMPILED:
        return []
    return [Solver(f"SciPy {method}", "", tolerances(), partial(_solve, case, method)) for method in METHODS]


def _solve(case: Case, method: str, tolerance: float, _start: Start, moments: Array) -> Answer:
    from scipy.integrate import solve_ivp

    counter, start, times = np.zeros(1), start_of(case), times_of(case, moments)
    parameters, atols, out = parameters_of(case, counter), tolerances_of(case, FINER, tolerance), np.empty(start.size)

    def right_hand_side(_time: float, y: Array) -> Array:
        return slopes_in_time(parameters, out, y, began + LONGEST).copy()

    began = perf_counter()
    try:
        found = solve_ivp(
            right_hand_side, (0.0, case.span), start, method, times, rtol=tolerance, atol=atols, first_step=FIRST_STEP
        )
    except LateError:
        return Answer(None, perf_counter() - began, counter[0])
    seconds = perf_counter() - began
    if seconds > LONGEST:  # compiled callers swallow a LateError, and hand back what they have
        return Answer(None, seconds, counter[0])
    return answer_of(case, found.y.T if found.success else None, moments, seconds, counter[0])
