"""SUNDIALS' CVODE through scikit-sundae, with a compiled right-hand side and its banded solver."""

from __future__ import annotations

from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import (
    FIRST_STEP,
    MOST_STEPS,
    TIME_LIMIT,
    TimeLimitError,
    absolute_tolerances,
    output_times,
    parameter_array,
    solution_of,
    start_state,
    timed_derivatives,
)  # fmt: skip
from softcradle.sandbox.studies.precision.solvers import Solution, Solver, tolerances

Array = NDArray[np.float64]

METHODS = ("Adams", "BDF")
RATIOS = (1e-2, 1e-6)  # absolute tolerance of overlaps over that of rates


def solvers(case: Case) -> list[Solver]:
    """A curve a method."""
    return [
        Solver(f"CVODE {method}", f"overlaps {ratio:g}", tolerances(), partial(_solve, case, method, ratio))
        for method in METHODS
        for ratio in RATIOS
    ]


def _solve(case: Case, method: str, ratio: float, tolerance: float, _start: Start, sample_times: Array) -> Solution:
    from sksundae.cvode import CVODE

    counter, start, times = np.zeros(1), start_state(case), np.append(0.0, output_times(case, sample_times))
    parameters = parameter_array(case, counter)

    def right_hand_side(_time: float, y: Array, out: Array) -> None:
        timed_derivatives(parameters, out, y, began + TIME_LIMIT)

    options: dict[str, Any] = {"rtol": tolerance, "atol": absolute_tolerances(case, ratio, tolerance)}
    began = perf_counter()
    solver = CVODE(right_hand_side, method=method, first_step=FIRST_STEP, max_num_steps=MOST_STEPS, **options)
    try:
        found = solver.solve(times if times.size > 2 else np.append(times, times[-1] * (1.0 + 1e-12)), start)
    except TimeLimitError:
        return Solution(None, perf_counter() - began, counter[0])
    seconds = perf_counter() - began
    if seconds > TIME_LIMIT:  # a compiled caller drops a TimeLimitError and returns what it has
        return Solution(None, seconds, counter[0])
    states = found.y[1 : times.size] if found.success else None
    return solution_of(case, states, sample_times, seconds, counter[0])
