"""numbalsoda's LSODA. It has one absolute tolerance for all variables: parts of the relative one are scanned."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from time import perf_counter
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import (
    MOST_STEPS,
    RATIOS,
    derivatives,
    output_times,
    parameter_array,
    solution_of,
    start_state,
)
from softcradle.sandbox.studies.precision.solvers import Solution, Solver, tolerances

Array = NDArray[np.float64]


def solvers(case: Case) -> list[Solver]:
    """One curve."""
    return [
        Solver("numbalsoda", f"LSODA, absolute {ratio:g}", tolerances(), partial(_solve, case, ratio))
        for ratio in (1.0, *RATIOS)
    ]


@cache
def _parts() -> tuple[Any, Callable[..., Any]]:
    from numbalsoda import lsoda, lsoda_sig

    @numba.cfunc(lsoda_sig)
    def right_hand_side(t, y, out, p):
        derivatives(y, out, p)

    return right_hand_side, lsoda


def _solve(case: Case, ratio: float, tolerance: float, _start: Start, sample_times: Array) -> Solution:
    right_hand_side, lsoda = _parts()
    counter, start, times = np.zeros(1), start_state(case), np.append(0.0, output_times(case, sample_times))
    parameters, address = parameter_array(case, counter), right_hand_side.address
    began = perf_counter()
    found, ok = lsoda(address, start, times, data=parameters, rtol=tolerance, atol=ratio * tolerance, mxstep=MOST_STEPS)
    seconds = perf_counter() - began
    return solution_of(case, found[1:] if ok else None, sample_times, seconds, counter[0])
