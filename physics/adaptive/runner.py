"""Runner of the adaptive methods: radau, dop853, accurate. They move chains that nothing dissipates."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive.integrate import integrate
from softcradle.physics.adaptive.self_check import checked, is_sensitive
from softcradle.physics.adaptive.step_records import (
    DOP853,
    EITHER,
    RADAU,
    Scratch,
    Trial,
    empty_scratch,
    empty_trial,
)
from softcradle.physics.chain import Chain
from softcradle.physics.kernel_records import (
    FIRST_LOG,
    chain_records,
    empty_log,
    kept_switches,
    larger_log,
    log_warnings,
    motion_record,
)
from softcradle.physics.numerics.records import EVALUATION, FALLBACK, SAMPLE, STEP, Samples, SwitchLog
from softcradle.physics.problem import MOST_STEPS, NO_TIMES, Problem, Record, empty_samples, run_to_end
from softcradle.physics.scales import speed_scale
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]

MOST_ENERGY = 100.0  # tolerances: a larger relative error of the energy gives a warning
ROUND_OFF = 1e-13  # of the fastest bead: beads that close slower do not close
ALLOWED = {"radau": RADAU, "dop853": DOP853, "accurate": EITHER}  # kinds of step that a method takes
_loaded: set[str] = set()  # methods whose kernels are in memory


@dataclass
class Memory:
    """Memory of the kernels beside the state: made once for a run, or once for all frames of live use."""

    mode: NDArray[np.int8]
    held: NDArray[np.int8]
    trial: Trial
    look: Trial
    scratch: Scratch
    samples: Samples
    log: SwitchLog

    @classmethod
    def of(cls, contacts: int, times: Array = NO_TIMES, log_size: int = 0) -> Memory:
        """Memory for a chain with `contacts`; sample rows at `times`."""
        mode, held = np.zeros(contacts, dtype=np.int8), np.zeros(contacts, dtype=np.int8)
        samples = Samples(times, *empty_samples(times.size, contacts))
        trials = empty_trial(contacts), empty_trial(contacts)
        return cls(mode, held, *trials, empty_scratch(contacts), samples, empty_log(contacts, log_size))


def run(problem: Problem) -> Record:
    """Compute the whole motion; ``problem.state`` stays as it is."""
    if not _loaded:  # so that the cost measured is that of the motion
        _pass(problem, problem.state.time, NO_TIMES, False)
        _loaded.add(problem.method)
    record = run_to_end(problem, _pass)
    if problem.most_steps is None and is_sensitive(problem, record):
        record = checked(problem, record, _scale(problem.chain, problem.state), _pass)
    record.warnings += _energy_warnings(problem, record)
    return record


def advance(problem: Problem) -> Status:
    """Move ``problem.state`` on by the duration in place; the memory of the kernels stays with the state."""
    state, end = problem.state, problem.end
    memory = state.work.get("adaptive") or state.work.setdefault("adaptive", Memory.of(problem.chain.contacts))
    memory.log.counter[:] = 0
    memory.log.closed[:] = state.closed
    status, state.time = _integrate(problem, state, end, False, memory)
    return Status(status)


def _pass(problem: Problem, end: float, times: Array, stop: bool, log_size: int = FIRST_LOG) -> Record:
    """One run of the kernel; again with a larger log of switches where the first was too small."""
    state = problem.state.copy()
    memory = Memory.of(problem.chain.contacts, times, log_size)
    began = perf_counter()
    code, state.time = _integrate(problem, state, end, stop, memory)
    seconds = perf_counter() - began
    larger = larger_log(memory.log)
    if larger:
        return _pass(problem, end, times, stop, larger)
    counter, status = memory.log.counter, Status(code)
    rows = int(counter[SAMPLE])  # fewer than wanted where the run gave up
    overlap, rate, anchor, force, absorbed = (row[:rows] for row in memory.samples[1:])
    return Record(
        times[:rows], overlap, rate, anchor, force, *kept_switches(memory.log), state, int(counter[STEP]),
        int(counter[EVALUATION]), status, _warnings(problem, status, state.time, memory.log), seconds, absorbed,
    )  # fmt: skip


def _integrate(problem: Problem, state: State, end: float, stop: bool, memory: Memory) -> Any:
    """Run the kernel on `state`. Returns its status and the time reached."""
    data, _ = chain_records(problem.chain, state)
    return integrate(
        ALLOWED[problem.method], state.time, end, stop, problem.most_steps or MOST_STEPS, _scale(problem.chain, state),
        problem.tolerance, data, motion_record(state, memory.mode, memory.held), tuple(memory.trial), tuple(memory.look),
        tuple(memory.scratch), tuple(memory.samples), tuple(memory.log),
    )  # fmt: skip


def _scale(chain: Chain, state: State) -> float:
    """The velocity [m/s] that a tolerance is relative to: the closing speed, or what the contacts have stored of it."""
    released = float(np.sqrt(2.0 * chain.stored_energy(state.overlap) * chain.inverse_reduced_mass).max())
    velocity = state.velocity(chain)
    if np.ptp(velocity) > ROUND_OFF * np.abs(velocity).max() or not released:
        return max(speed_scale(chain, velocity), released)
    return released


def _warnings(problem: Problem, status: Status, time: float, log: SwitchLog) -> Warnings:
    """What a run could not do."""
    found = []
    if status.gave_up:
        steps = problem.most_steps or MOST_STEPS
        sentence = (
            f"{problem.method} gave up after {steps} steps at t = {time:.6g} s: the contacts rattle on; take method "
            "'conserving', or a looser tolerance"
        )
        found.append(CodedWarning(WarningCode.GAVE_UP, sentence, {"steps": steps, "time": time}))
    places = int(log.counter[FALLBACK])
    if places:
        sentence = (
            f"Newton's iteration did not converge in {places} places, where {problem.method} took a small step of "
            "'conserving': compare with another tolerance"
        )
        found.append(CodedWarning(WarningCode.FALLBACK, sentence, {"places": places}))
    return (*found, *log_warnings(log))


def _energy_warnings(problem: Problem, record: Record) -> Warnings:
    """A warning where the energy of an undriven chain has not come back to within many times the tolerance."""
    chain, start = problem.chain, problem.state
    moved = np.isinf(chain.mass) & (start.velocity(chain) != 0.0)
    if start.external(chain) is not None or moved.any():
        return ()
    before, after = start.energy(chain), record.end.energy(chain)
    if abs(after - before) <= MOST_ENERGY * problem.tolerance * before:
        return ()
    error = abs(after / before - 1.0)
    sentence = (
        f"energy is off by {error:.1g} of itself, more than {problem.method} promises at tolerance {problem.tolerance:g}: "
        "compare with method 'conserving', or with another tolerance"
    )
    return (CodedWarning(WarningCode.ENERGY, sentence, {"error": error}),)
