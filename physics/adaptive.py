"""Runner of the adaptive kernels: radau, dop853, accurate."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physics.chain import Chain
from physics.kernels import adaptive as kernel
from physics.run import NO_TIMES, Problem, Record, empty_samples, run_to_end
from physics.state import State
from physics.time_scale import closing_speed

Array = NDArray[np.float64]

MOST_STEPS = 200_000  # steps and rejected steps; a chain that rattles on beyond is reported
FIRST_SWITCHES, MOST_SWITCHES = 1024, 4_000_000  # rows in the book of contact switches: at first, and at the most
_LOADED: set[str] = set()  # methods whose kernels are in memory


def run(problem: Problem) -> Record:
    """Run an adaptive method."""
    if not _LOADED:  # so that the cost measured is that of the motion
        _pass(problem, problem.state.time, NO_TIMES, False)
        _LOADED.add(problem.method)
    return run_to_end(problem, _pass)


def _pass(problem: Problem, end: float, times: Array, stop: bool, book: int = FIRST_SWITCHES) -> Record:
    """One run of the kernel; again with a larger book of switches where the first was too small."""
    chain, state = problem.chain, problem.state.copy()
    counter = np.zeros(kernel.COUNTERS, dtype=np.int64)
    switches = np.zeros(book, dtype=np.int64), np.zeros(book)
    rows = empty_samples(times.size, chain.contacts)
    scratch = _scratch(chain.contacts)
    began = perf_counter()
    status, time = kernel.integrate(
        state.time, end, stop, MOST_STEPS, closing_speed(state.velocity(chain)), problem.tolerance, *chain.parameters,
        *_forces(chain, state), chain.anchor, *_moving(state), *scratch[0], *switches, times, *rows, *scratch[1], counter,
    )  # fmt: skip
    seconds = perf_counter() - began
    used = int(counter[kernel.SWITCH])
    if used > book and book < MOST_SWITCHES:
        return _pass(problem, end, times, stop, min(4 * used, MOST_SWITCHES))
    state.time = time
    kept = min(used, book)
    return Record(
        times, *rows, switches[0][:kept], switches[1][:kept], state, int(counter[kernel.STEP]),
        int(counter[kernel.EVALUATION]), seconds, _warnings(problem, status, time, counter, kept),
    )  # fmt: skip


def _warnings(problem: Problem, status: int, time: float, counter: NDArray[np.int64], kept: int) -> tuple[str, ...]:
    found = []
    if status == kernel.OUT_OF_STEPS:
        found.append(
            f"{problem.method} gave up after {MOST_STEPS} steps at t = {time:.6g} s: the contacts rattle on; take method "
            "'conserving', or a looser tolerance"
        )
    if counter[kernel.RESCUE]:
        found.append(
            f"Newton did not settle in {counter[kernel.RESCUE]} places, where {problem.method} took a small conserving "
            "step: compare with another tolerance"
        )
    if counter[kernel.SWITCH] > kept:
        found.append(f"contacts switched {counter[kernel.SWITCH]} times, only the first {kept} are listed")
    return tuple(found)


def advance(chain: Chain, state: State, duration: float, method: str, tolerance: float) -> None:
    """Move `state` on by `duration` in place; the scratch memory stays with the state."""
    marks, scratch, counter = state.work.get("adaptive") or state.work.setdefault(
        "adaptive", (*_scratch(chain.contacts), np.zeros(kernel.COUNTERS, dtype=np.int64))
    )
    counter[:] = 0
    end = state.time + duration
    kernel.integrate(
        state.time, end, False, MOST_STEPS, closing_speed(state.velocity(chain)), tolerance, *chain.parameters,
        *_forces(chain, state), chain.anchor, *_moving(state), *marks, *_NO_BOOK, NO_TIMES,
        *empty_samples(0, chain.contacts), *scratch, counter,
    )  # fmt: skip
    state.time = end


_NO_BOOK = np.zeros(0, dtype=np.int64), np.zeros(0)


def _forces(chain: Chain, state: State) -> tuple[Array, Array]:
    """External forces (n+1,), and the accelerations (n+1,) of the overlaps and of the anchor by them; or none."""
    if state.push is None:
        return NO_TIMES, NO_TIMES
    acceleration = state.push * chain.parameters.inverse_mass
    return state.push, np.append(acceleration[:-1] - acceleration[1:], acceleration[chain.anchor])


def _moving(state: State) -> tuple[Array, Array, Array, Array]:
    return state.overlap, state.rate, state.anchor, state.force


def _scratch(contacts: int) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """Mode and held flags of the contacts; stage, block and work arrays."""
    marks = np.zeros(contacts, dtype=np.int8), np.zeros(contacts, dtype=np.int8)
    stages = tuple(np.zeros((3, contacts)) for _ in range(6))
    return marks, (*stages, np.zeros((contacts, 9)), np.zeros((16, contacts)), np.zeros((16, contacts + 1)))
