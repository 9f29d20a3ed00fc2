"""Runner of the adaptive methods: radau, dop853, accurate."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive.adaptive_loop import integrate
from softcradle.physics.adaptive.constants import TOLERANCE_PART
from softcradle.physics.adaptive.effective_chain import chain_and_regime
from softcradle.physics.adaptive.kept_steps import KeptSteps
from softcradle.physics.adaptive.self_check import checked
from softcradle.physics.adaptive.step_records import (
    ALLOWED,
    GROWTH,
    LOCAL_SQUARE,
    Scratch,
    Steps,
    Trial,
    empty_scratch,
    empty_steps,
    empty_trial,
)
from softcradle.physics.adaptive.undetermined import DOUBT, finish, undetermined
from softcradle.physics.adaptive.usual_budget import step_budget
from softcradle.physics.chain import Chain, per_chain
from softcradle.physics.contact import Contact, power_law
from softcradle.physics.kernel_records import (
    FIRST_LOG,
    FRAME_LOG,
    ROWS_A_STEP,
    empty_log,
    kept_switches,
    larger_log,
    law_rows,
    log_warnings,
    motion_record,
    require_finite_motion,
    with_free_rows,
)
from softcradle.physics.kernel_tiers import KernelTiers
from softcradle.physics.numerics.kernel_arithmetic import kernel_arithmetic
from softcradle.physics.numerics.records import (
    EVALUATION,
    OUT_OF_STEPS,
    PAUSED,
    REJECTED,
    STEP,
    SWITCH,
    SwitchLog,
)
from softcradle.physics.own_law import OwnLaw
from softcradle.physics.problem import (
    NO_TIMES,
    Problem,
    Record,
    empty_samples,
    with_ends_as_samples,
    with_samples_of,
)
from softcradle.physics.scales import closing_scale, is_possible, largest_error
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]

TURN_GROWTH = 1.0 / 16.0  # by each turn of an oscillation, whose phase all errors before it have moved
PAUSE = 20_000  # steps, rejected ones included, after which a kernel hands back, so that a signal is heard
LONGER = 1.1  # a budget of steps that has grown by this since it was asked for is worth another call
PLAIN_PAUSE = 50  # steps likewise as plain Python, so that machine code is taken when it comes
PLAIN_COST = 3.0  # fixed steps that cost plain Python as much as one of these
SOFTEST = 0.02  # exponent of contacts below which the ledger bounds the error too
MOST_ENERGY = 100.0  # tolerances: a larger relative error of the energy gives a warning


@dataclass
class Memory:
    """Memory of the kernels beside the state: made once for a run, or once for all frames of live use."""

    mode: NDArray[np.int8]
    held: NDArray[np.int8]
    trial: Trial
    look: Trial
    scratch: Scratch
    steps: Steps
    log: SwitchLog

    @classmethod
    def of(cls, chain: Chain, log_size: int = 0, steps: Steps | None = None) -> Memory:
        """Memory for a chain; with rows for `steps` where samples are wanted."""
        n = chain.contacts
        mode, held, rows = np.zeros(n, dtype=np.int8), np.zeros(n, dtype=np.int8), steps
        if rows is None:
            rows = empty_steps(0, n, chain.dissipative or bool(chain.couplers))
        return cls(mode, held, empty_trial(n), empty_trial(n), empty_scratch(n), rows, empty_log(n, log_size))


def kernels_of(chain: Chain) -> KernelTiers:
    """The kernels for such a chain: they are compiled for what they need not ask for."""
    return TIERS["adaptive-own-laws" if chain.own_laws else "adaptive"]


def run(problem: Problem) -> Record:
    """Compute the whole motion; ``problem.state`` stays as it is."""
    kernels_of(problem.chain).load_made()  # so that the cost measured is that of the motion
    record = completed(problem)
    if problem.most_steps is None and record.status != Status.UNDETERMINED:
        record = checked(problem, record, _scale(problem), completed)
    if record.kept is not None and not problem.later:
        began = perf_counter()
        record = _sampled(record, problem.sample_times(record.end.time))
        record.seconds += perf_counter() - began
    before, change = _ledger(problem, record)
    record.velocity_error = record.velocity_error + _unresolved(problem.chain, change)
    if not is_possible(problem.chain, problem.state, float(record.velocity_error.max())):
        most = largest_error(problem.chain, problem.state, record.end)
        record.velocity_error = np.minimum(record.velocity_error, most)
        if record.status == Status.UNDETERMINED and most.max() <= problem.tolerance * _scale(problem):
            record.status = Status.DONE  # energy and momentum determine it
    if record.status == Status.UNDETERMINED:
        record.warnings += (undetermined(record.velocity_error),)
    if change > MOST_ENERGY * problem.tolerance * before:
        record.warnings += (_energy_warning(problem, change / before),)
    return record


def completed(problem: Problem) -> Record:
    """One run to the end of the problem, by `conserving` from where contacts only rattle; samples may be still to be taken."""
    record = _pass(problem)
    if record.status.gave_up and problem.most_steps is None:
        record = finish(problem, record, _sampled)
    return record


def _sampled(record: Record, times: Array) -> Record:
    """The record with its samples; from another run where it ended before the last, or did not keep its steps."""
    kept = record.kept
    if not isinstance(kept, KeptSteps):
        return record
    if kept.ends:
        return with_ends_as_samples(record, kept.problem.state, times)
    late = not isinstance(kept.problem.samples, int) and times.size > 0 and times[-1] > record.end.time
    if kept.known or not (kept.overflows or late):
        return kept.record(record, times)
    end = max(record.end.time, float(times[-1])) if times.size else record.end.time
    again = _pass(replace(kept.problem, duration=end - kept.problem.state.time, samples=times))
    return with_samples_of(record, _sampled(again, times))


def error_growth(before: Any, grown: Array, turns: Array) -> Any:
    """The factor by which errors have grown: by bounces `before`, by the last ones and by the turns of contacts (..., n)."""
    return 1.0 + before + grown.sum(axis=-1) + TURN_GROWTH * turns.max(axis=-1)


def advance(problem: Problem) -> Status:
    """Move ``problem.state`` on by the duration in place; the memory of the kernels stays with the state."""
    state = problem.state
    memory = state.work.get("adaptive") or state.work.setdefault("adaptive", Memory.of(problem.chain, FRAME_LOG))
    memory.log.counter[:] = 0
    memory.log.closed[:] = state.closed
    status, state.time = _integrate(problem, state, _scale(problem), memory)
    state.note_switches(*kept_switches(memory.log), int(memory.log.counter[SWITCH]))
    return Status(status)


def _pass(problem: Problem, log_size: int = FIRST_LOG) -> Record:
    """One run of the kernel; again with a larger log of switches where the first was too small."""
    state = problem.state.copy()
    scale = _scale(problem)
    kept = KeptSteps(problem, TOLERANCE_PART * problem.tolerance * scale, kernels_of(problem.chain))
    memory = Memory.of(problem.chain, log_size, kept.steps)
    began = perf_counter()
    code, state.time = _integrate(problem, state, scale, memory, kept)
    seconds = perf_counter() - began
    larger = larger_log(memory.log)
    if larger:
        return _pass(problem, larger)
    counter, status, scratch = memory.log.counter, Status(code), memory.scratch
    growth = float(error_growth(scratch.control[GROWTH], scratch.grown, scratch.turns))
    error = DOUBT * growth * float(np.sqrt(scratch.control[LOCAL_SQUARE]))
    overlap, rate, anchor, force, taken = empty_samples(0, problem.chain.contacts)
    return Record(
        NO_TIMES, overlap, rate, anchor, force, *kept_switches(memory.log), state, int(counter[STEP]),
        int(counter[EVALUATION]), status, _warnings(problem, status, state.time, memory.log), seconds, taken,
        np.full(problem.chain.contacts + 1, error), growth,
        kept=None if problem.later and kept.overflows else kept,
    )  # fmt: skip


def _integrate(problem: Problem, state: State, scale: float, memory: Memory, kept: KeptSteps | None = None) -> Any:
    """Run the kernel on `state`; by the tier at hand where it is live and nothing is `kept`. Returns its status and the time."""
    data, regime = chain_and_regime(problem.chain, state)
    most, counter, stop = step_budget(problem, state.time, scale), memory.log.counter, problem.duration is None
    code, time, resumed, end = PAUSED, state.time, False, problem.end
    motion = tuple(motion_record(state, memory.mode, memory.held))
    records: Any = data, regime, motion, tuple(memory.trial), tuple(memory.look), tuple(memory.scratch)
    tiers = kernels_of(problem.chain)
    while code == PAUSED:
        memory.log = with_free_rows(memory.log) if kept else memory.log  # that of a frame stays as long as it is
        most_now = min(PAUSE, memory.log.contact.size // ROWS_A_STEP or PAUSE) if kept else PAUSE
        work = PLAIN_COST * PLAIN_PAUSE * problem.chain.contacts
        kernel: Any = tiers.of(integrate, work) if kept else tiers.of_frame(integrate)
        compiled = kernel is integrate
        pause = int(counter[STEP] + counter[REJECTED]) + (most_now if compiled else min(most_now, PLAIN_PAUSE))
        if kept and not compiled:
            tiers.spent += work
        steps = kept.steps if kept else memory.steps
        with kernel_arithmetic():
            code, time = kernel(
                ALLOWED[problem.method], resumed, time, end, stop, most, pause, scale, problem.tolerance, *records,
                tuple(steps), tuple(memory.log),
            )  # fmt: skip
        resumed = True
        if code == OUT_OF_STEPS:
            allowed = step_budget(problem, time, scale)
            if allowed > LONGER * most:
                code, most = PAUSED, allowed
        require_finite_motion(problem.chain, state)
        if kept:
            kept.take(memory.log)
    return code, time


def _scale(problem: Problem) -> float:
    """The velocity [m/s] that a tolerance is relative to: that of the fastest closing there can be, see `closing_scale`."""
    chain, state = problem.chain, problem.state
    return closing_scale(chain, state.velocity(chain), state.overlap, state.external(chain), problem.duration)


def _warnings(problem: Problem, status: Status, time: float, log: SwitchLog) -> Warnings:
    """What a run could not do."""
    found = []
    if status.gave_up:
        steps = int(log.counter[STEP] + log.counter[REJECTED])
        sentence = (
            f"{problem.method} gave up after {steps} steps at t = {time:.6g} s: the contacts rattle on; take method "
            "'conserving', or a looser tolerance"
        )
        found.append(CodedWarning(WarningCode.GAVE_UP, sentence, {"steps": steps, "time": time}))
    return (*found, *log_warnings(log))


def _ledger(problem: Problem, record: Record) -> tuple[float, float]:
    """The energy [J] of a chain at the start, and by how much it is off in the end, 0 where work is done on it."""
    chain, start, end = problem.chain, problem.state, record.end
    before = start.energy(chain)
    wall_moves = chain.walls > 0 and bool((np.isinf(chain.mass) & (start.velocity(chain) != 0.0)).any())
    if wall_moves or chain.forces or start.external(chain) is not None:
        return before, 0.0
    return before, abs(end.energy(chain) + float((end.absorbed - start.absorbed).sum()) - before)


def _unresolved(chain: Chain, change: float) -> float:
    """What velocities [m/s] the energy `change` of a run could be, where contacts are so soft that they rattle.

    A cluster of such contacts is all but rigid: rattling far below the closing speed can be damped in every run alike, so that
    none tells of it, and of its energy alone is known that it is no more than what the ledger lacks.
    """
    return float(np.sqrt(2.0 * change * chain.inverse_reduced_mass.max())) if _rattles(chain) else 0.0


@per_chain
def _rattles(chain: Chain) -> bool:
    """Whether contacts are so soft that a cluster of them rattles."""
    law = law_rows(chain)
    return bool(((law[:, 0] == 0.0) & (law[:, 2] < SOFTEST)).any())


def _energy_warning(problem: Problem, error: float) -> CodedWarning:
    """The energy ledger does not close to within many times the tolerance."""
    sentence = (
        f"energy is off by {error:.1g} of itself, more than {problem.method} promises at tolerance {problem.tolerance:g}: "
        "compare with method 'conserving', or with another tolerance"
    )
    return CodedWarning(WarningCode.ENERGY, sentence, {"error": error})


def _call_kernels(contact: Contact | OwnLaw) -> None:
    """Call every kernel once for such contacts."""
    chain = Chain([1.0, 1.0, 1.0], contact)
    run(Problem(chain, State.at_start(chain, [1.0, 0.0, 0.0]), "accurate", 1e-3, tolerance=1e-8, samples=3))


TIERS = {
    name: KernelTiers(name, __name__, partial(_call_kernels, contact))
    for name, contact in (("adaptive", power_law(1.0, 0.1)), ("adaptive-own-laws", OwnLaw(lambda overlap: overlap)))
}
