"""CyRK's compiled loop called from compiled code, over its methods and ratios of the absolute tolerances."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from time import perf_counter
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import (
    FIRST_STEP,
    MOST_STEPS,
    RATIOS,
    absolute_tolerances,
    derivatives,
    output_times,
    parameter_array,
    solution_of,
    start_state,
)  # fmt: skip
from softcradle.sandbox.studies.precision.solvers import Solution, Solver, tolerances

Array = NDArray[np.float64]

METHODS = ("RK45", "DOP853", "LSODA", "RADAU")


def solvers(case: Case) -> list[Solver]:
    """A curve a method."""
    return [
        Solver(f"CyRK {method}", f"overlaps {ratio:g}", tolerances(), partial(_solve, case, method, ratio))
        for method in METHODS
        for ratio in RATIOS
    ]


@cache
def _parts() -> tuple[int, Callable[..., Any]]:
    from CyRK import nb_diffeq_addr, nbsolve2_ivp

    def right_hand_side(out, t, y, p):
        derivatives(y, out, p)

    @njit
    def solve(address, times, start, method, parameters, rtol, absolute, first, most):
        found = nbsolve2_ivp(
            address, (0.0, times[-1]), start, method=method, t_eval=times, args=parameters, rtol=rtol, atols=absolute,
            first_step=first, max_num_steps=most,
        )  # fmt: skip
        ok = found.success and found.size > 0
        last = found.y.copy() if ok else start.reshape(-1, 1)
        found.free()
        return ok, last

    return nb_diffeq_addr(right_hand_side), solve


def _solve(case: Case, method: str, ratio: float, tolerance: float, _start: Start, sample_times: Array) -> Solution:
    address, solve = _parts()
    counter, start, times = np.zeros(1), start_state(case), output_times(case, sample_times)
    absolute, parameters = absolute_tolerances(case, ratio, tolerance), parameter_array(case, counter)
    began = perf_counter()
    ok, states = solve(address, times, start, method, parameters, tolerance, absolute, FIRST_STEP, MOST_STEPS)
    seconds = perf_counter() - began
    return solution_of(case, states.T if ok else None, sample_times, seconds, counter[0])
