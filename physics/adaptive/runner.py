"""Runner of a single run of the adaptive methods radau, dop853 and accurate, and its error estimate."""

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
from softcradle.physics.adaptive.error_estimate import (
    DOUBT,
    MOST_GROWN,
    error_growth,
    estimated_error,
    guaranteed_error,
    rounding_in,
)
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
    Regime,
    Scratch,
    Steps,
    Trial,
    empty_scratch,
    empty_trial,
)
from softcradle.physics.adaptive.usual_budget import GrowingBudget
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
from softcradle.physics.numerics.records import (
    EVALUATION,
    OUT_OF_STEPS,
    PAUSED,
    REJECTED,
    STEP,
    SWITCH,
    ChainData,
    SwitchLog,
)
from softcradle.physics.problem import NO_SAMPLES, Problem, Record, with_ends_as_samples
from softcradle.physics.scales import is_possible, largest_error
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]

# Number of steps after which a kernel returns to Python, so that Python can handle signals. Rejected steps count as
# well.
PAUSE = 20_000
# The same number as PAUSE for kernels in plain Python. With this small number, a run can soon switch to compiled
# kernels.
PLAIN_PAUSE = 50
PLAIN_COST = 3.0  # Cost of an adaptive step in plain Python, in units of the cost of a fixed step
LONGEST_REUSED = 1000  # Largest chain, in contacts, whose working memory a thread keeps for its next run


@dataclass
class Memory:
    """Working memory of the kernels, in addition to the state of the chain.

    The memory is created once for a whole run, or once for all frames of live use.
    """

    mode: NDArray[np.int8]
    held: NDArray[np.int8]
    trial: Trial
    look: Trial
    scratch: Scratch
    log: SwitchLog
    spare: list[Steps]  # Blocks of stored steps that can be reused, see `KeptSteps`
    waited: float = 0.0  # Time [s] that the last run spent waiting for compiled kernels
    # For live use: time [s] of the last frame, estimated error [m/s] after it, and largest speed scale [m/s] of all
    # frames.
    reached: tuple[float, float] = (math.nan, math.nan)
    scale: float = 0.0

    @classmethod
    def of(cls, contacts: int, log_size: int) -> Memory:
        """Return the memory for a chain with this number of `contacts`."""
        mode, held = np.zeros((2, contacts), dtype=np.int8)
        trial, look = empty_trial(contacts), empty_trial(contacts)
        return cls(mode, held, trial, look, empty_scratch(contacts), empty_log(contacts, log_size), [])


class _LastRun(threading.local):
    """Working memory of the last run in a thread. The next run with the same number of contacts reuses this memory.

    Allocating new memory costs as much as several steps.
    """

    memory: Memory | None = None  # None while a run uses the memory


_last_run = _LastRun()


def sampled(record: Record, times: Array) -> Record:
    """Return the record with its samples.

    The run is repeated if it ended before the last sample, or if it did not store its steps.
    """
    kept = record.kept
    if not isinstance(kept, KeptSteps):
        return record
    if kept.ends:
        return with_ends_as_samples(record, kept.problem.state, times)
    late = not isinstance(kept.problem.samples, int) and times.size > 0 and times[-1] > record.end.time
    if kept.known or not (kept.overflows or late):
        return kept.record(record, times)
    # Repeat the run. The sample times are known now, and the run extends to the last one.
    end = max(record.end.time, float(times[-1])) if times.size else record.end.time
    again = one_run(replace(kept.problem, duration=end - kept.problem.state.time, samples=times))
    return record.with_samples(sampled(again, times).samples)


def advance(problem: Problem) -> Status:
    """Move ``problem.state`` forward by the duration, in place. The working memory is stored in the state."""
    state = problem.state
    memory = state.work.get("adaptive")
    if memory is None:
        memory = state.work["adaptive"] = Memory.of(problem.chain.contacts, FRAME_LOG)
    # Continue the error estimate of the last frame unless the state was changed since then.
    _carry_estimate(state, memory)
    before = rounding_in(problem.chain, problem.velocity)
    status, state.time = _integrate(problem, state, memory)
    _note_switches(state, memory.log)
    _update_estimate(problem, memory, before)
    return Status(status)


def _carry_estimate(state: State, memory: Memory) -> None:
    """Continue the error estimate of the previous frame.

    If the state was copied or edited since then, start a new estimate from the error stored in the state.
    """
    control = memory.scratch.control
    control[CONTINUES] = float(memory.reached == (state.time, state.velocity_error))
    # A new estimate starts with the error stored in the state, converted to a sum of squared local errors.
    if not control[CONTINUES]:
        control[CARRIED_SQUARE] = (state.velocity_error / DOUBT) ** 2 if math.isfinite(state.velocity_error) else 0.0
        memory.scale = 0.0


def _update_estimate(problem: Problem, memory: Memory, before: float) -> None:
    """Store the estimated error after the frame in the state. `before` is the round-off [m/s] at the start of the
    frame.

    The local errors of all frames add up, as in a single run. All bounces since the start of the estimate amplify them.
    Conservation of energy and momentum limits the error. If the error is unknown (NaN), it stays unknown.
    """
    state, control, counter = problem.state, memory.scratch.control, memory.log.counter
    velocity = state.velocity(problem.chain)
    rounding = max(before, rounding_in(problem.chain, velocity))
    # Every step of the frame adds a rounding error.
    control[LOCAL_SQUARE] += int(counter[STEP]) * rounding * rounding
    growth = error_growth(control[GROWTH] + control[ENDING], memory.scratch.grown, memory.scratch.turns)
    error = float(estimated_error(growth, control[LOCAL_SQUARE], problem.chain.contacts, rounding))
    memory.scale = max(memory.scale, problem.scale, float(np.ptp(velocity)))
    # Energy and momentum limit the error.
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
    """Add the contacts that opened or closed in this frame to the state.

    The log and the state must agree about which contacts are closed. The next frame starts with the contacts that are
    closed in the state. A contact at overlap 0 without force is open.
    """
    contact, time = kept_switches(log)
    more = int(log.counter[SWITCH]) - contact.size
    # Correct each contact whose log differs from the state at the end of the frame.
    for i in np.flatnonzero(log.closed != state.closed):
        last = np.flatnonzero(contact == i)[-1:]
        if last.size and time[last[0]] == state.time:  # The contact closes at the start of the next frame.
            contact, time = np.delete(contact, last), np.delete(time, last)
        else:
            contact, time = np.append(contact, i), np.append(time, state.time)
    state.note_switches(contact, time, contact.size + more)


def one_run(problem: Problem, log_size: int = FIRST_LOG) -> Record:
    """Run the kernel once, without computing samples. If the log of contact switches was too small, run again with a
    larger log.
    """
    state = problem.state.copy()
    contacts, memory, _last_run.memory = problem.chain.contacts, _last_run.memory, None
    # Reuse the memory of the last run if its shape fits.
    if memory is None or (memory.mode.size, memory.log.contact.size) != (contacts, log_size):
        memory = Memory.of(contacts, log_size)
    # A whole run begins a new error estimate.
    memory.scratch.control[[CONTINUES, CARRIED_SQUARE]] = 0.0
    wanted = TOLERANCE_PART * problem.tolerance * problem.scale
    kept = KeptSteps(problem, wanted, KERNELS, memory.spare)
    began = perf_counter()
    code, state.time = _integrate(problem, state, memory, kept)
    seconds = perf_counter() - began - memory.waited
    larger = larger_log(memory.log)
    if larger:
        return one_run(problem, larger)
    # Error estimate of the run: local errors and round-off, times the error amplification.
    counter, control, status = memory.log.counter.tolist(), memory.scratch.control.tolist(), Status(code)
    growth = float(error_growth(control[GROWTH] + control[ENDING], memory.scratch.grown, memory.scratch.turns))
    contact, at = kept_switches(memory.log)
    record = Record(
        problem.chain, NO_SAMPLES, contact.copy(), at.copy(), state, counter[STEP],
        counter[EVALUATION], status, _warnings(problem, status, state.time, memory.log), seconds, growth=growth,
        kept=kept,
    )  # fmt: skip
    rounding = max(rounding_in(problem.chain, record.velocity), rounding_in(problem.chain, problem.velocity))
    error = estimated_error(growth, control[LOCAL_SQUARE], counter[STEP] + contacts, rounding)
    record.velocity_error = np.full(contacts + 1, error)
    # Keep the working memory for the next run of this thread, unless it is large.
    _last_run.memory = memory if contacts <= LONGEST_REUSED else None
    return record


def _integrate(problem: Problem, state: State, memory: Memory, kept: KeptSteps | None = None) -> Any:
    """Run the kernel on `state`. Return its status and the time that it reached.

    If `kept` is None, the call belongs to live use. Live use never waits for compilation: it uses plain Python until
    the compiled kernels are available.
    """
    data, regime = chain_and_regime(problem.chain, state)
    memory.log.counter[:] = 0
    memory.log.closed[:] = 0 if kept else state.closed
    memory.waited = 0.0
    budget, counter, stop = GrowingBudget(problem, state.time), memory.log.counter, problem.duration is None
    code, time, resumed, end = PAUSED, state.time, False, problem.end
    # The kernels change the arrays of the state in place.
    motion = tuple(motion_record(state, memory.mode, memory.held))
    records: Any = data, regime, motion, tuple(memory.trial), tuple(memory.look), tuple(memory.scratch)
    scratch, tiers, accuracy = memory.scratch, KERNELS, (ALLOWED[problem.method], problem.tolerance, problem.scale)
    # The kernel pauses regularly. During a pause, Python handles signals, enlarges the log, and switches to compiled
    # kernels.
    while code == PAUSED:
        memory.log = with_free_rows(memory.log) if kept else memory.log  # The log of a live frame keeps its length.
        most_now = min(PAUSE, memory.log.contact.size // ROWS_A_STEP or PAUSE) if kept else PAUSE
        work = PLAIN_COST * PLAIN_PAUSE * problem.chain.contacts
        asked = perf_counter()
        kernel: Any = tiers.of(integrate, work) if kept else tiers.of_frame(integrate)
        memory.waited += perf_counter() - asked
        compiled = kernel is integrate
        # In plain Python the pause comes early, so the run can soon switch to machine code.
        pause = int(counter[STEP] + counter[REJECTED]) + (most_now if compiled else min(most_now, PLAIN_PAUSE))
        if kept and not compiled:
            tiers.spent += work
        steps = kept.steps if kept else NO_STEPS
        code, time = kernel(
            (time, end, stop, budget.steps), (resumed, pause), accuracy, *records, tuple(steps), tuple(memory.log)
        )
        resumed = True
        # Continue if the step budget has grown. Stop if the motion amplifies errors and has become too expensive.
        if code in (OUT_OF_STEPS, PAUSED):
            amplified = error_growth(scratch.control[GROWTH], scratch.grown, scratch.turns) > MOST_GROWN
            spent, impacts = int(counter[STEP] + counter[REJECTED]), int(scratch.control[IMPACTS])
            if code == OUT_OF_STEPS and budget.extend(spent, time, impacts, amplified):
                code = PAUSED
            if code == PAUSED and budget.exceeds_cost(int(counter[EVALUATION]) * problem.chain.contacts, amplified):
                code = OUT_OF_STEPS
        require_finite_motion(problem.chain, state)
        if kept:
            kept.take(memory.log)
    # The kernel measures overlaps from the origins of segments. The state measures them from the touching position.
    if problem.chain.has_segments:
        complete = Regime(*regime, ChainData(*data).graph)  # type: ignore[call-arg]
        plain(count_from_touch)(state.overlap, complete)
    return code, time


def _warnings(problem: Problem, status: Status, time: float, log: SwitchLog) -> Warnings:
    """Return the warnings for a run that gave up, or whose log of contact switches was too small."""
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
