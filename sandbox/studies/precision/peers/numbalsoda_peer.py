"""numbalsoda's LSODA; it has one absolute tolerance for all, so overlaps are held as absolute parts of the relative one."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from time import perf_counter
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.chart_cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import (
    COMPILED,
    FINER,
    MOST_STEPS,
    answer_of,
    parameters_of,
    slopes,
    start_of,
    times_of,
)
from softcradle.sandbox.studies.precision.solvers import Answer, Solver, tolerances

Array = NDArray[np.float64]


def solvers(case: Case) -> list[Solver]:
    """One curve."""
    if not COMPILED:
        return []
    return [
        Solver("numbalsoda", f"LSODA, absolute {finer:g}", tolerances(), partial(_solve, case, finer))
        for finer in (1.0, *FINER)
    ]


@cache
def _parts() -> tuple[Any, Callable[..., Any]]:
    from numbalsoda import lsoda, lsoda_sig

    @numba.cfunc(lsoda_sig)
    def right_hand_side(t, y, out, p):
        slopes(y, out, p)

    return right_hand_side, lsoda


def _solve(case: Case, finer: float, tolerance: float, _start: Start, moments: Array) -> Answer:
    right_hand_side, lsoda = _parts()
    counter, start, times = np.zeros(1), start_of(case), np.append(0.0, times_of(case, moments))
    parameters, address = parameters_of(case, counter), right_hand_side.address
    began = perf_counter()
    found, ok = lsoda(address, start, times, data=parameters, rtol=tolerance, atol=finer * tolerance, mxstep=MOST_STEPS)
    seconds = perf_counter() - began
    return answer_of(case, found[1:] if ok else None, moments, seconds, counter[0])
