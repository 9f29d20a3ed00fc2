"""Runner of the adaptive kernels: radau."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from physics.chain import Chain
from physics.kernels import adaptive as kernel
from physics.run import Problem, Record, empty_samples
from physics.state import State
from physics.time_scale import speed_scale

Array = NDArray[np.float64]

MOST_STEPS = 200_000
FIRST_SWITCHES, MOST_SWITCHES = 1024, 4_000_000


def run(problem: Problem) -> Record:
    """Run an adaptive method; without a duration in two passes, the first of which finds the end."""
    end = np.inf if problem.duration is None else problem.state.time + problem.duration
    if problem.duration is None:
        found = _pass(problem, end, np.zeros(0), True)
        times = problem.sample_times(found.end.time)
        end = max(found.end.time, float(times[-1]))
        if found.warnings:
            return dataclasses.replace(_pass(problem, end, times, False), warnings=found.warnings)
    return _pass(problem, end, problem.sample_times(end), False)


def _pass(problem: Problem, end: float, times: Array, stop: bool, book: int = FIRST_SWITCHES) -> Record:
    chain, state = problem.chain, problem.state.copy()
    counter = np.zeros(kernel.COUNTERS, dtype=np.int64)
    switches = np.zeros(book, dtype=np.int64), np.zeros(book)
    rows = empty_samples(times.size, chain.contacts)
    status, time = kernel.integrate(
        state.time, end, stop, MOST_STEPS, speed_scale(chain, state.velocity(chain)), problem.tolerance, *chain.parameters,
        np.zeros(0) if state.push is None else state.push, _external(chain, state), chain.anchor, state.overlap, state.rate, state.anchor, state.force,
        *_marks(chain.contacts), *switches, times, *rows, *_scratch(chain.contacts), counter,
    )  # fmt: skip
    state.time = time
    used = int(counter[kernel.SWITCH])
    kept = min(used, book)
    return Record(
        times, *rows, switches[0][:kept], switches[1][:kept], state, int(counter[kernel.STEP]),
        int(counter[kernel.EVALUATION]), () if status <= 1 else (f"status {status} {time}",),
    )  # fmt: skip


def _external(chain: Chain, state: State) -> Array:
    """(n+1,) accelerations of the overlaps and of the anchor by what pushes from outside, or none."""
    push = state.external(chain)
    if push is None:
        return np.zeros(0)
    acceleration = push * chain.parameters.inverse_mass
    return np.append(acceleration[:-1] - acceleration[1:], acceleration[chain.anchor])


def _marks(contacts: int) -> tuple[NDArray[np.int8], NDArray[np.int8]]:
    return np.zeros(contacts, dtype=np.int8), np.zeros(contacts, dtype=np.int8)


def _scratch(contacts: int) -> tuple[Array, ...]:
    stages = tuple(np.zeros((3, contacts)) for _ in range(6))
    return (*stages, np.zeros((contacts, 9)), np.zeros((16, contacts)), np.zeros((16, contacts + 1)))
