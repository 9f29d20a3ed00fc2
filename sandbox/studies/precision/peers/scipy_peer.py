"""SciPy's `solve_ivp` with a compiled right-hand side, called from its Python loop."""

from __future__ import annotations

from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import (
    FIRST_STEP,
    TIME_LIMIT,
    TimeLimitError,
    absolute_tolerances,
    output_times,
    parameter_array,
    solution_of,
    start_state,
    timed_derivatives,
)
from softcradle.sandbox.studies.precision.solvers import Solution, Solver, tolerances

Array = NDArray[np.float64]

METHODS = ("DOP853", "LSODA", "Radau")
RATIO = 1e-6  # absolute tolerance of overlaps over that of rates


def solvers(case: Case) -> list[Solver]:
    """A curve a method."""
    return [Solver(f"SciPy {method}", "", tolerances(), partial(_solve, case, method)) for method in METHODS]


def _solve(case: Case, method: str, tolerance: float, _start: Start, sample_times: Array) -> Solution:
    from scipy.integrate import solve_ivp

    counter, start, times = np.zeros(1), start_state(case), output_times(case, sample_times)
    parameters, out = parameter_array(case, counter), np.empty(start.size)
    options: dict[str, Any] = {"rtol": tolerance, "atol": absolute_tolerances(case, RATIO, tolerance)}

    def right_hand_side(_time: float, y: Array) -> Array:
        return timed_derivatives(parameters, out, y, began + TIME_LIMIT).copy()

    began = perf_counter()
    try:
        found = solve_ivp(
            right_hand_side, (0.0, case.run_duration), start, method, times, first_step=FIRST_STEP, **options
        )
    except TimeLimitError:
        return Solution(None, perf_counter() - began, counter[0])
    seconds = perf_counter() - began
    if seconds > TIME_LIMIT:  # a compiled caller drops a TimeLimitError and returns what it has
        return Solution(None, seconds, counter[0])
    return solution_of(case, found.y.T if found.success else None, sample_times, seconds, counter[0])
