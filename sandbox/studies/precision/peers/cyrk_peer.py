"""CyRK's compiled loop called from compiled code, over its methods and ratios of the absolute tolerances."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from time import perf_counter
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.chart_cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import (
    COMPILED,
    FINER,
    FIRST_STEP,
    MOST_STEPS,
    answer_of,
    parameters_of,
    slopes,
    start_of,
    times_of,
    tolerances_of,
)  # fmt: skip
from softcradle.sandbox.studies.precision.solvers import Answer, Solver, tolerances

Array = NDArray[np.float64]

METHODS = ("RK45", "DOP853", "LSODA", "RADAU")


def solvers(case: Case) -> list[Solver]:
    """A curve a method."""
    if not COMPILED:
        return []
    return [
        Solver(f"CyRK {method}", f"overlaps {finer:g}", tolerances(), partial(_solve, case, method, finer))
        for method in METHODS
        for finer in FINER
    ]


@cache
def _parts() -> tuple[int, Callable[..., Any]]:
    from CyRK import nb_diffeq_addr, nbsolve2_ivp

    def right_hand_side(out, t, y, p):
        slopes(y, out, p)

    @njit
    def solve(address, times, start, method, parameters, rtol, atols, first, most):
        found = nbsolve2_ivp(
            address, (0.0, times[-1]), start, method=method, t_eval=times, args=parameters, rtol=rtol, atols=atols,
            first_step=first, max_num_steps=most,
        )  # fmt: skip
        ok = found.success and found.size > 0
        last = found.y.copy() if ok else start.reshape(-1, 1)
        found.free()
        return ok, last

    return nb_diffeq_addr(right_hand_side), solve


def _solve(case: Case, method: str, finer: float, tolerance: float, _start: Start, moments: Array) -> Answer:
    address, solve = _parts()
    counter, start, times = np.zeros(1), start_of(case), times_of(case, moments)
    atols, parameters = tolerances_of(case, finer, tolerance), parameters_of(case, counter)
    began = perf_counter()
    ok, states = solve(address, times, start, method, parameters, tolerance, atols, FIRST_STEP, MOST_STEPS)
    seconds = perf_counter() - began
    return answer_of(case, states.T if ok else None, moments, seconds, counter[0])
