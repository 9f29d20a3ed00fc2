"""Verlet as one writes it for one cradle: the loop that people write themselves, compiled."""

from __future__ import annotations

from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import solution_of
from softcradle.sandbox.studies.precision.solvers import Solution, Solver, step_counts

Array = NDArray[np.float64]


@njit(error_model="numpy")
def leapfrog(overlap: Any, rate: Any, stiffness: float, exponent: float, h: float, steps: int) -> None:
    """Equal unit masses, one power law, nothing else; in place."""
    n = overlap.size
    for _ in range(steps):
        left, before = 0.0, 0.0
        for i in range(n):
            overlap[i] += 0.5 * h * rate[i]
            force = stiffness * overlap[i] ** exponent if overlap[i] > 0.0 else 0.0
            if i > 0:
                rate[i - 1] += h * (left - before + force)
            left, before = before - force, force
        rate[n - 1] += h * (left - before)
        for i in range(n):
            overlap[i] += 0.5 * h * rate[i]


def solvers(case: Case) -> list[Solver]:
    """None for a chain that is not of unit masses and one power law: a preload is added to no force."""
    chain = case.chain
    simple = set(chain.mass) == {1.0} and len(set(chain.power_laws)) == 1 and chain.power_laws[0].preload == 0.0
    if not simple or chain.drive:
        return []
    return [Solver("Verlet by hand", "", step_counts(), partial(_solve, case), steps=True)]


def _solve(case: Case, steps: float, start: Start, sample_times: Array) -> Solution:
    law = case.chain.power_laws[0]
    overlap, rate = 0.0 - np.array(start.chain.gap), -np.diff(start.velocity)
    step, count, times = case.run_duration / steps, 0, np.append(sample_times, case.run_duration) + start.early
    states, seconds = [], 0.0
    for time in times:
        more = max(round(time / step) - count, 0)
        began = perf_counter()
        leapfrog(overlap, rate, law.stiffness, law.exponent, step, more)
        seconds += perf_counter() - began
        count += more
        late = time - count * step  # less than half a step, on a straight line
        states.append(np.concatenate((overlap + late * rate, rate)))
    return solution_of(case, np.array(states), sample_times, seconds, count)
