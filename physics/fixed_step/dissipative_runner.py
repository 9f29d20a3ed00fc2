"""Runner of the fixed-step kernels for chains that rub: bed friction, contacts with loss."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.fixed_step import dissipative_loop as kernel
from softcradle.physics.fixed_step import splitting as explicit
from softcradle.physics.fixed_step.dissipative_gradient import WORK_ROWS
from softcradle.physics.fixed_step.step_loop import COUNTERS, EVALUATION, SAMPLE, STEP, SWITCH
from softcradle.physics.numerics.dissipative_solve import BEAD_ROWS
from softcradle.physics.problem import NO_TIMES, Problem, Record, empty_samples, run_to_end
from softcradle.physics.state import State

Array = NDArray[np.float64]

PARTS = {"euler": explicit.EULER, "verlet": explicit.VERLET, "conserving": (NO_TIMES, NO_TIMES)}
MOST_STEPS = 20_000_000  # a run that needs more has a step that does not fit its motion
FIRST_SWITCHES, MOST_SWITCHES = 1024, 4_000_000  # rows in the book of contact switches: at first, and at the most

_march: Any = kernel.dry_march  # its arguments are unpacked from tuples, which type checkers cannot count
_LOADED: set[str] = set()  # methods whose kernels are in memory


def run(problem: Problem) -> Record:
    """Run a fixed-step method on a chain that rubs."""
    if not _LOADED:  # so that the cost measured is that of the motion
        _pass(problem, problem.state.time, NO_TIMES, False)
        _LOADED.add(problem.method)
    return run_to_end(problem, _pass)


def _pass(problem: Problem, end: float, times: Array, stop: bool, book: int = FIRST_SWITCHES) -> Record:
    """One run of the kernel; again with a larger book of switches where the first was too small."""
    from softcradle.physics.fixed_step.runner import run_warnings

    chain, state = problem.chain, problem.state.copy()
    counter = np.zeros(COUNTERS, dtype=np.int64)
    switches = np.zeros(book, dtype=np.int64), np.zeros(book)
    rows = *empty_samples(times.size, chain.contacts), np.zeros((times.size, 2))
    began = perf_counter()
    status, time = _march(
        *PARTS[problem.method], problem.step, state.time, end, stop, MOST_STEPS, *_given(chain, state), *_moving(state),
        *_scratch(chain.contacts), *switches, times, *rows, counter,
    )  # fmt: skip
    seconds = perf_counter() - began
    used = int(counter[SWITCH])
    if used > book and book < MOST_SWITCHES:
        return _pass(problem, end, times, stop, min(4 * used, MOST_SWITCHES))
    state.time = time
    kept = min(used, book)
    filled = int(counter[SAMPLE])  # fewer than wished where the run gave up
    overlap, rate, anchor, force, absorbed = (row[:filled] for row in rows)
    warnings = run_warnings(problem, status, time, counter, kept)
    return Record(
        times[:filled], overlap, rate, anchor, force, switches[0][:kept], switches[1][:kept], state,
        int(counter[STEP]), int(counter[EVALUATION]), warnings, seconds, absorbed,
    )  # fmt: skip


def _given(chain: Chain, state: State) -> tuple[Any, ...]:
    push = state.external(chain)
    law, inverse_mass = chain.parameters
    return law, chain.loss, inverse_mass, NO_TIMES if push is None else push, chain.bed, chain.anchor


def _moving(state: State) -> tuple[Array, ...]:
    return state.overlap, state.rate, state.anchor, state.force, state.absorbed


def _scratch(contacts: int) -> tuple[Any, ...]:
    """A spare state, flags of closed contacts, and the work rows."""
    spare = np.empty(contacts), np.empty(contacts), np.empty(2), np.empty(contacts), np.empty(2)
    return (
        *spare,
        np.zeros(contacts, dtype=np.uint8),
        np.zeros((WORK_ROWS, contacts)),
        np.zeros((BEAD_ROWS, contacts + 1)),
    )


def advance(chain: Chain, state: State, duration: float, method: str, step: float) -> None:
    """Move `state` on by `duration` in place; the scratch memory stays with the state."""
    if "dry" not in state.work:
        book = np.zeros(0, dtype=np.int64), np.zeros(0)
        rows = *empty_samples(0, chain.contacts), np.zeros((0, 2))
        state.work["dry"] = _scratch(chain.contacts), book, rows, np.zeros(COUNTERS, dtype=np.int64)
    scratch, book, rows, counter = state.work["dry"]
    counter[:] = 0
    scratch[5][:] = (state.overlap > 0.0) | ((state.overlap == 0.0) & (state.force > 0.0))
    end = state.time + duration
    _march(
        *PARTS[method], step, state.time, end, False, MOST_STEPS, *_given(chain, state), *_moving(state), *scratch, *book,
        NO_TIMES, *rows, counter,
    )  # fmt: skip
    state.time = end
    state.switches += int(counter[SWITCH])
