"""SUNDIALS' CVODE through scikit-sundae, with a compiled right-hand side and its banded solver."""

from __future__ import annotations

from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.chart_cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import (
    COMPILED,
    FIRST_STEP,
    LONGEST,
    MOST_STEPS,
    LateError,
    answer_of,
    parameters_of,
    slopes_in_time,
    start_of,
    times_of,
    tolerances_of,
)  # fmt: skip
from softcradle.sandbox.studies.precision.solvers import Answer, Solver, tolerances

Array = NDArray[np.float64]

METHODS = ("Adams", "BDF")
FINER = (1e-2, 1e-6)  # absolute tolerance of overlaps, as part of that of rates


def solvers(case: Case) -> list[Solver]:
    """A curve a method."""
    if not COMPILED:
        return []
    return [
        Solver(f"CVODE {method}", f"overlaps {finer:g}", tolerances(), partial(_solve, case, method, finer))
        for method in METHODS
        for finer in FINER
    ]


def _solve(case: Case, method: str, finer: float, tolerance: float, _start: Start, moments: Array) -> Answer:
    from sksundae.cvode import CVODE

    counter, start, times = np.zeros(1), start_of(case), np.append(0.0, times_of(case, moments))
    parameters = parameters_of(case, counter)

    def right_hand_side(_time: float, y: Array, out: Array) -> None:
        slopes_in_time(parameters, out, y, began + LONGEST)

    options: dict[str, Any] = {"rtol": tolerance, "atol": tolerances_of(case, finer, tolerance)}
    began = perf_counter()
    solver = CVODE(right_hand_side, method=method, first_step=FIRST_STEP, max_num_steps=MOST_STEPS, **options)
    try:
        found = solver.solve(times if times.size > 2 else np.append(times, times[-1] * (1.0 + 1e-12)), start)
    except LateError:
        return Answer(None, perf_counter() - began, counter[0])
    seconds = perf_counter() - began
    if seconds > LONGEST:  # compiled callers swallow a LateError, and hand back what they have
        return Answer(None, seconds, counter[0])
    states = found.y[1 : times.size] if found.success else None
    return answer_of(case, states, moments, seconds, counter[0])
