"""Runner of the adaptive methods: radau, dop853, accurate."""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive.adaptive_loop import integrate
from softcradle.physics.adaptive.constants import TOLERANCE_PART
from softcradle.physics.adaptive.kept_steps import NO_STEPS, KeptSteps
from softcradle.physics.adaptive.sampling import count_from_touch
from softcradle.physics.adaptive.step_records import (
    ALLOWED,
    CARRIED_SQUARE,
    CONTINUES,
    ENDING,
    GROWTH,
    IMPACTS,
    LOCAL_SQUARE,
    UNSEEN_SQUARE,
    Regime,
    Scratch,
    Steps,
    Trial,
    empty_scratch,
    empty_trial,
)
from softcradle.physics.adaptive.usual_budget import followed_steps, step_budget
from softcradle.physics.chain import Chain
from softcradle.physics.contact import power_law
from softcradle.physics.kernel_records import (
    FIRST_LOG,
    FRAME_LOG,
    ROWS_A_STEP,
    chain_and_regime,
    empty_log,
    kept_switches,
    larger_log,
    log_warnings,
    motion_record,
    require_finite_motion,
    with_free_rows,
)
from softcradle.physics.kernel_tiers import KernelTiers
from softcradle.physics.numerics.plain_kernels import plain
from softcradle.physics.numerics.records import EVALUATION, OUT_OF_STEPS, PAUSED, REJECTED, STEP, SWITCH, SwitchLog
from softcradle.physics.problem import NO_SAMPLES, Problem, Record, with_ends_as_samples
from softcradle.physics.scales import SPEED_ROUND_OFF, is_possible, largest_error
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]

# Growth of errors by each oscillation of a loaded contact: all errors made before it have moved its phase.
TURN_GROWTH = 1.0 / 8.0
PAUSE = 20_000  # steps, rejected ones included, after which a kernel hands back, so that a signal is heard
LONGER = 1.1  # a budget of steps that has grown by this since it was asked for is worth another call
PLAIN_PAUSE = 50  # steps likewise as plain Python, so that machine code is taken when it comes
PLAIN_COST = 3.0  # fixed steps that cost plain Python as much as one of these
LONGEST_REUSED = 1000  # contacts of a chain whose memory the thread keeps for its next run
# Tolerances: velocity errors up to this are guaranteed.
GUARANTEED = 10.0
# Relative round-off of one operation
HALF_DIGIT = 0.5 * float(np.finfo(np.float64).eps)
# Smallest tolerance that the guarantee refers to. Below it round-off decides; the estimated error says how far it goes.
LEAST_GUARANTEED = 1e-11
# Largest growth of errors at which a run needs no confirmation: `mixed` is off by 40 tolerances at 10. The growth that another
# run may show again is no larger, because it is the same in both.
MOST_GROWN = 8.0
DOUBT = 3.0  # times the sum of all local errors of a run, or the difference between runs: the error that is stated


@dataclass
class Memory:
    """Memory of the kernels beside the state: made once for a run, or once for all frames of live use."""

    mode: NDArray[np.int8]
    held: NDArray[np.int8]
    trial: Trial
    look: Trial
    scratch: Scratch
    log: SwitchLog
    spare: list[Steps]  # see `KeptSteps`
    waited: float = 0.0  # seconds for kernels, in the last run
    # of live use: time [s] and error [m/s] of the state after the last frame, and the largest scale of all frames [m/s]
    reached: tuple[float, float] = (math.nan, math.nan)
    scale: float = 0.0

    @classmethod
    def of(cls, contacts: int, log_size: int) -> Memory:
        """Memory for a chain with `contacts`."""
        mode, held = np.zeros((2, contacts), dtype=np.int8)
        trial, look = empty_trial(contacts), empty_trial(contacts)
        return cls(mode, held, trial, look, empty_scratch(contacts), empty_log(contacts, log_size), [])


class _LastRun(threading.local):
    """Memory of the last run of a thread, for its next one with as many contacts: fresh memory costs as much as some steps."""

    memory: Memory | None = None  # None while it is in use


_last_run = _LastRun()


def sampled(record: Record, times: Array) -> Record:
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
    again = one_run(replace(kept.problem, duration=end - kept.problem.state.time, samples=times))
    return record.with_samples(sampled(again, times).samples)


def error_growth(before: Any, grown: Array, turns: Array) -> Any:
    """The factor by which errors have grown: by bounces `before`, by the last ones and by the turns of contacts (..., n)."""
    return 1.0 + before + grown.sum(axis=-1) + TURN_GROWTH * turns.max(axis=-1)


def stated_error(growth: Any, local_square: Any, roundings: Any, rounding: Any) -> Any:
    """Return the estimated error [m/s]: local errors and `roundings` times the `rounding` of one step, and their growth."""
    return DOUBT * growth * np.sqrt(local_square + roundings * (rounding * rounding))


def rounding_of(mass: Array, velocity: Array) -> Any:
    """Return the round-off (...) [m/s] of a step of beads of `mass` (..., n+1) at `velocity` (..., n+1).

    A light bead can get all the kinetic energy, and velocities of heavy beads are rebuilt from rates that are as fast then. Their
    round-off returns to the light bead amplified by the square root of the mass ratio. Walls count neither way.
    """
    finite = np.isfinite(mass)
    inertia = np.where(finite, mass, 0.0)
    lightest, heaviest = np.where(finite, mass, np.inf).min(axis=-1), inertia.max(axis=-1)
    own = SPEED_ROUND_OFF * np.abs(velocity).max(axis=-1)
    return np.maximum(own, HALF_DIGIT * np.sqrt(heaviest * (inertia * velocity**2).sum(axis=-1)) / lightest)


def guaranteed_error(tolerance: float, scale: float) -> float:
    """Return the largest velocity error [m/s] that the tolerance allows at the speed `scale` [m/s]."""
    return GUARANTEED * max(tolerance, LEAST_GUARANTEED) * scale


def advance(problem: Problem) -> Status:
    """Move ``problem.state`` on by the duration in place; the memory of the kernels stays with the state."""
    state = problem.state
    memory = state.work.get("adaptive")
    if memory is None:
        memory = state.work["adaptive"] = Memory.of(problem.chain.contacts, FRAME_LOG)
    _carry_estimate(state, memory)
    before = rounding_of(np.asarray(problem.chain.mass), problem.velocity)
    status, state.time = _integrate(problem, state, memory)
    _note_switches(state, memory.log)
    _update_estimate(problem, memory, before)
    return Status(status)


def _carry_estimate(state: State, memory: Memory) -> None:
    """Let the estimate of the frame before go on; a state that was copied or edited begins a new one with its own error."""
    control = memory.scratch.control
    control[CONTINUES] = float(memory.reached == (state.time, state.velocity_error))
    if not control[CONTINUES]:
        control[CARRIED_SQUARE] = (state.velocity_error / DOUBT) ** 2 if math.isfinite(state.velocity_error) else 0.0
        memory.scale = 0.0


def _update_estimate(problem: Problem, memory: Memory, before: float) -> None:
    """Put the error after the frame into the state; `before` is the `rounding_of` [m/s] its start.

    Local errors of all frames add up as those of one run do, and grow by all bounces since the estimate began. Energy and
    momentum bound the error. An error that is not known (NaN) stays so.
    """
    state, control, counter = problem.state, memory.scratch.control, memory.log.counter
    velocity = state.velocity(problem.chain)
    rounding = max(before, rounding_of(np.asarray(problem.chain.mass), velocity))
    control[LOCAL_SQUARE] += int(counter[STEP]) * rounding * rounding
    growth = error_growth(control[GROWTH] + control[ENDING], memory.scratch.grown, memory.scratch.turns)
    error = float(stated_error(growth, control[LOCAL_SQUARE], problem.chain.contacts, rounding))
    memory.scale = max(memory.scale, problem.scale, float(np.ptp(velocity)))
    if not is_possible(problem.chain, state, error):
        error = min(error, float(largest_error(problem.chain, state, state).max()))
    state.velocity_error = error if math.isfinite(state.velocity_error) else math.nan
    memory.reached = state.time, state.velocity_error
    if state.velocity_error > guaranteed_error(problem.tolerance, memory.scale):
        state.warnings = (_estimate_warning(problem, error),)


def _estimate_warning(problem: Problem, error: float) -> CodedWarning:
    sentence = (
        f"velocities may be off by {error:.0e} m/s, more than {problem.method} guarantees at tolerance {problem.tolerance:g}: "
        "use a smaller tolerance, or simulate() for the whole motion"
    )
    return CodedWarning(WarningCode.ESTIMATE, sentence, {"error": error})


def _note_switches(state: State, log: SwitchLog) -> None:
    """Hand out the switches of a frame: the next begins with what the state tells, where a contact at d = 0 does not push yet."""
    contact, time = kept_switches(log)
    more = int(log.counter[SWITCH]) - contact.size
    for i in np.flatnonzero(log.closed != state.closed):
        last = np.flatnonzero(contact == i)[-1:]
        if last.size and time[last[0]] == state.time:  # it closes at the start of the next
            contact, time = np.delete(contact, last), np.delete(time, last)
        else:
            contact, time = np.append(contact, i), np.append(time, state.time)
    state.note_switches(contact, time, contact.size + more)


def one_run(problem: Problem, log_size: int = FIRST_LOG) -> Record:
    """One run of the kernel, samples still to be taken; again with a larger log of switches where the first was too small."""
    state = problem.state.copy()
    contacts, memory, _last_run.memory = problem.chain.contacts, _last_run.memory, None
    if memory is None or (memory.mode.size, memory.log.contact.size) != (contacts, log_size):
        memory = Memory.of(contacts, log_size)
    memory.scratch.control[[CONTINUES, CARRIED_SQUARE]] = 0.0
    wanted = TOLERANCE_PART * problem.tolerance * problem.scale
    kept = KeptSteps(problem, wanted, KERNELS, memory.spare)
    began = perf_counter()
    code, state.time = _integrate(problem, state, memory, kept)
    seconds = perf_counter() - began - memory.waited
    larger = larger_log(memory.log)
    if larger:
        return one_run(problem, larger)
    counter, control, status = memory.log.counter.tolist(), memory.scratch.control.tolist(), Status(code)
    growth = float(error_growth(control[GROWTH] + control[ENDING], memory.scratch.grown, memory.scratch.turns))
    contact, at = kept_switches(memory.log)
    record = Record(
        problem.chain, NO_SAMPLES, contact.copy(), at.copy(), state, counter[STEP],
        counter[EVALUATION], status, _warnings(problem, status, state.time, memory.log), seconds, growth=growth,
        kept=kept,
    )  # fmt: skip
    rounding = rounding_of(np.asarray(problem.chain.mass), np.array((problem.velocity, record.velocity))).max()
    error = stated_error(growth, control[LOCAL_SQUARE], counter[STEP] + contacts, rounding)
    record.velocity_error = np.full(contacts + 1, error)
    record.unseen = DOUBT * growth * math.sqrt(control[UNSEEN_SQUARE])
    _last_run.memory = memory if contacts <= LONGEST_REUSED else None
    return record


def _integrate(problem: Problem, state: State, memory: Memory, kept: KeptSteps | None = None) -> Any:
    """Run the kernel on `state`; by the tier at hand where it is live and nothing is `kept`. Returns its status and the time."""
    data, regime = chain_and_regime(problem.chain, state)
    memory.log.counter[:] = 0
    memory.log.closed[:] = 0 if kept else state.closed
    memory.waited = 0.0
    most, counter, stop = step_budget(problem, state.time), memory.log.counter, problem.duration is None
    code, time, resumed, end = PAUSED, state.time, False, problem.end
    motion = tuple(motion_record(state, memory.mode, memory.held))
    records: Any = data, regime, motion, tuple(memory.trial), tuple(memory.look), tuple(memory.scratch)
    scratch, tiers, accuracy = memory.scratch, KERNELS, (ALLOWED[problem.method], problem.tolerance, problem.scale)
    while code == PAUSED:
        memory.log = with_free_rows(memory.log) if kept else memory.log  # that of a frame stays as long as it is
        most_now = min(PAUSE, memory.log.contact.size // ROWS_A_STEP or PAUSE) if kept else PAUSE
        work = PLAIN_COST * PLAIN_PAUSE * problem.chain.contacts
        asked = perf_counter()
        kernel: Any = tiers.of(integrate, work) if kept else tiers.of_frame(integrate)
        memory.waited += perf_counter() - asked
        compiled = kernel is integrate
        pause = int(counter[STEP] + counter[REJECTED]) + (most_now if compiled else min(most_now, PLAIN_PAUSE))
        if kept and not compiled:
            tiers.spent += work
        steps = kept.steps if kept else NO_STEPS
        code, time = kernel(
            (time, end, stop, most), (resumed, pause), accuracy, *records, tuple(steps), tuple(memory.log)
        )
        resumed = True
        if code == OUT_OF_STEPS:
            growth = error_growth(scratch.control[GROWTH], scratch.grown, scratch.turns)
            followed = followed_steps(problem, int(scratch.control[IMPACTS])) if growth <= MOST_GROWN else 0
            allowed = step_budget(problem, time) + followed
            if allowed > LONGER * most:
                code, most = PAUSED, allowed
        require_finite_motion(problem.chain, state)
        if kept:
            kept.take(memory.log)
    plain(count_from_touch)(state.overlap, Regime(*regime))
    return code, time


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


def _call_kernels() -> None:
    """Call every kernel once."""
    chain = Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1))
    problem = Problem(chain, State.at_start(chain, [1.0, 0.0, 0.0]), "accurate", 1e-3, tolerance=1e-8, samples=3)
    sampled(one_run(problem), problem.sample_times(problem.end))


KERNELS = KernelTiers("adaptive", __name__, _call_kernels)
TIERS = {KERNELS.name: KERNELS}
