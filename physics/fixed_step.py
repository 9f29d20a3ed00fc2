"""Runner of the fixed-step kernels: euler, verlet, yoshida4, conserving."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from physics.chain import Chain
from physics.kernels import explicit
from physics.kernels import march as kernel
from physics.run import Problem, Record, empty_samples
from physics.state import State

Array = NDArray[np.float64]

PARTS = {"euler": explicit.EULER, "verlet": explicit.VERLET, "yoshida4": explicit.YOSHIDA4}
MOST_STEPS = 100_000_000  # a run that needs more has a step that does not fit its motion
FIRST_SWITCHES, MOST_SWITCHES = 1024, 4_000_000  # rows in the book of contact switches: at first, and at the most
NO_TIMES = np.zeros(0)


def run(problem: Problem) -> Record:
    """Run a fixed-step method; without a duration in two passes, the first of which finds the end."""
    end = np.inf if problem.duration is None else problem.state.time + problem.duration
    if problem.duration is None:
        book = FIRST_SWITCHES
        found = _pass(problem, end, NO_TIMES, True, book)
        times = problem.sample_times(found.end.time)
        end = max(found.end.time, float(times[-1]) if times.size else 0.0)
    times = problem.sample_times(end)
    return _pass(problem, end, times, False, FIRST_SWITCHES)


def _pass(problem: Problem, end: float, times: Array, stop: bool, book: int) -> Record:
    """One run of the kernel; again with a larger book of switches where the first was too small."""
    chain, state = problem.chain, problem.state.copy()
    counter = np.zeros(kernel.COUNTERS, dtype=np.int64)
    switches = np.zeros(book, dtype=np.int64), np.zeros(book)
    rows = empty_samples(times.size, chain.contacts)
    status, time = kernel.march(
        *PARTS[problem.method], problem.step, state.time, end, stop, MOST_STEPS, *chain.parameters, _push(chain, state),
        chain.anchor, *_moving(state), *_spare(chain.contacts), np.zeros(chain.contacts, dtype=np.uint8),
        *switches, times, *rows, counter,
    )  # fmt: skip
    used = int(counter[kernel.SWITCH])
    if used > book and book < MOST_SWITCHES:
        return _pass(problem, end, times, stop, min(4 * used, MOST_SWITCHES))
    state.time = time
    kept = min(used, book)
    return Record(
        times, *rows, switches[0][:kept], switches[1][:kept], state, int(counter[kernel.STEP]),
        _evaluations(problem.method, counter), _warnings(problem, status, time, used, kept),
    )  # fmt: skip


def _warnings(problem: Problem, status: int, time: float, used: int, kept: int) -> tuple[str, ...]:
    found = []
    if status == kernel.OUT_OF_STEPS:
        found.append(f"{problem.method} gave up after {MOST_STEPS} steps at t = {time:.6g} s: take a larger step")
    if used > kept:
        found.append(f"contacts switched {used} times, only the first {kept} are listed")
    return tuple(found)


def _evaluations(method: str, counter: NDArray[np.int64]) -> int:
    return int(counter[kernel.STEP] + counter[kernel.EXTRA]) * PARTS[method][1].size


def _push(chain: Chain, state: State) -> Array:
    return NO_TIMES if state.push is None else state.push


def _moving(state: State) -> tuple[Array, Array, Array, Array]:
    return state.overlap, state.rate, state.anchor, state.force


def _spare(contacts: int) -> tuple[Array, Array, Array, Array]:
    return np.empty(contacts), np.empty(contacts), np.empty(2), np.empty(contacts)


def advance(chain: Chain, state: State, duration: float, method: str, step: float) -> None:
    """Move `state` on by `duration` in place; the scratch memory stays with the state."""
    work: tuple[Any, ...] = state.work.get("fixed_step") or state.work.setdefault(
        "fixed_step", _scratch(chain.contacts)
    )
    *spare, closed, switch_contact, switch_time, rows, counter = work
    counter[:] = 0
    kernel.march(
        *PARTS[method], step, state.time, state.time + duration, False, MOST_STEPS, *chain.parameters, _push(chain, state),
        chain.anchor, *_moving(state), *spare, closed, switch_contact, switch_time, NO_TIMES, *rows, counter,
    )  # fmt: skip
    state.time += duration


def _scratch(contacts: int) -> tuple[Any, ...]:
    closed = np.zeros(contacts, dtype=np.uint8)
    book = np.zeros(0, dtype=np.int64), np.zeros(0)
    return (*_spare(contacts), closed, *book, empty_samples(0, contacts), np.zeros(kernel.COUNTERS, dtype=np.int64))
