"""Runner of the fixed-step kernels: euler, verlet, yoshida4, conserving."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.fixed_step import splitting as explicit
from softcradle.physics.fixed_step import step_loop as kernel
from softcradle.physics.fixed_step.discrete_gradient import WORK_ROWS
from softcradle.physics.problem import NO_TIMES, Problem, Record, empty_samples, run_to_end
from softcradle.physics.state import State

Array = NDArray[np.float64]

PARTS = {
    "euler": explicit.EULER,
    "verlet": explicit.VERLET,
    "yoshida4": explicit.YOSHIDA4,
    "conserving": (NO_TIMES, NO_TIMES),
}
MOST_STEPS = 100_000_000  # a run that needs more has a step that does not fit its motion
FIRST_SWITCHES, MOST_SWITCHES = 1024, 4_000_000  # rows in the book of contact switches: at first, and at the most

_march: Any = kernel.march  # its arguments are unpacked from tuples, which type checkers cannot count
_LOADED: set[str] = set()  # methods whose kernels are in memory


def run(problem: Problem) -> Record:
    """Run a fixed-step method; where something rubs, by the kernels of softcradle.physics.fixed_step.dissipative_runner."""
    if problem.chain.dry:
        from softcradle.physics.fixed_step import dissipative_runner as dry

        return dry.run(problem)
    if problem.method not in _LOADED:  # so that the cost measured is that of the motion
        _pass(problem, problem.state.time, NO_TIMES, False)
        _LOADED.add(problem.method)
    return run_to_end(problem, _pass)


def _pass(problem: Problem, end: float, times: Array, stop: bool, book: int = FIRST_SWITCHES) -> Record:
    """One run of the kernel; again with a larger book of switches where the first was too small."""
    chain, state = problem.chain, problem.state.copy()
    counter = np.zeros(kernel.COUNTERS, dtype=np.int64)
    switches = np.zeros(book, dtype=np.int64), np.zeros(book)
    rows = empty_samples(times.size, chain.contacts)
    began = perf_counter()
    status, time = _march(
        *PARTS[problem.method], problem.step, state.time, end, stop, MOST_STEPS, *chain.parameters, _push(chain, state),
        chain.anchor, *_moving(state), *_spare(chain.contacts), *_marks(problem.method, chain.contacts),
        *switches, times, *rows, counter,
    )  # fmt: skip
    seconds = perf_counter() - began
    used = int(counter[kernel.SWITCH])
    if used > book and book < MOST_SWITCHES:
        return _pass(problem, end, times, stop, min(4 * used, MOST_SWITCHES))
    state.time = time
    kept = min(used, book)
    filled = int(counter[kernel.SAMPLE])  # fewer than wished where the run gave up
    overlap, rate, anchor, force = (row[:filled] for row in rows)
    warnings = run_warnings(problem, status, time, counter, kept)
    return Record(
        times[:filled], overlap, rate, anchor, force, switches[0][:kept], switches[1][:kept], state,
        int(counter[kernel.STEP]), int(counter[kernel.EVALUATION]), warnings, seconds,
    )  # fmt: skip


def run_warnings(problem: Problem, status: int, time: float, counter: NDArray[np.int64], kept: int) -> tuple[str, ...]:
    """Sentences on what a run of a fixed-step kernel could not do."""
    found = []
    if status == kernel.OUT_OF_STEPS:
        found.append(f"{problem.method} gave up after {MOST_STEPS} steps at t = {time:.6g} s: take a larger step")
    if counter[kernel.FAILURE]:
        found.append(f"{counter[kernel.FAILURE]} steps of {problem.method} did not converge: take a smaller step")
    if counter[kernel.SWITCH] > kept:
        found.append(f"contacts switched {counter[kernel.SWITCH]} times, only the first {kept} are listed")
    return tuple(found)


def _push(chain: Chain, state: State) -> Array:
    push = state.external(chain)
    return NO_TIMES if push is None else push


def _moving(state: State) -> tuple[Array, Array, Array, Array]:
    return state.overlap, state.rate, state.anchor, state.force


def _spare(contacts: int) -> Any:
    return np.empty(contacts), np.empty(contacts), np.empty(2), np.empty(contacts)


def _marks(method: str, contacts: int) -> tuple[NDArray[np.uint8], Array]:
    """Flags of the closed contacts, and the work rows of `conserving` (none for the explicit methods)."""
    rows = WORK_ROWS if PARTS[method][1].size == 0 else 0
    return np.zeros(contacts, dtype=np.uint8), np.empty((rows, contacts))


def advance(chain: Chain, state: State, duration: float, method: str, step: float) -> None:
    """Move `state` on by `duration` in place; the scratch memory stays with the state."""
    if chain.dry:
        from softcradle.physics.fixed_step import dissipative_runner as dry

        dry.advance(chain, state, duration, method, step)
        return
    if state.work.get("fixed_step", ("",))[0] != method:
        state.work["fixed_step"] = (method, *_scratch(method, chain.contacts))
    spare: Any
    _, spare, marks, switches, rows, counter = state.work["fixed_step"]
    counter[:] = 0
    marks[0][:] = (state.overlap > 0.0) | ((state.overlap == 0.0) & (state.force > 0.0))
    end = state.time + duration
    _march(
        *PARTS[method], step, state.time, end, False, MOST_STEPS, *chain.parameters, _push(chain, state), chain.anchor,
        *_moving(state), *spare, *marks, *switches, NO_TIMES, *rows, counter,
    )  # fmt: skip
    state.time = end
    state.switches += int(counter[kernel.SWITCH])


def _scratch(method: str, contacts: int) -> tuple[Any, ...]:
    book = np.zeros(0, dtype=np.int64), np.zeros(0)
    counter = np.zeros(kernel.COUNTERS, dtype=np.int64)
    return _spare(contacts), _marks(method, contacts), book, empty_samples(0, contacts), counter
