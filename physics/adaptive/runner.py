"""Runner of the adaptive methods: radau, dop853, accurate."""

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
    ERROR_EXPONENT,
    GROWTH,
    LOCAL_SQUARE,
    RADAU,
    Scratch,
    Trial,
    empty_scratch,
    empty_trial,
)
from softcradle.physics.adaptive.undetermined import finish
from softcradle.physics.chain import Chain
from softcradle.physics.contact import power_law
from softcradle.physics.kernel_records import (
    FIRST_LOG,
    NO_FLAGS,
    NOTHING,
    chain_records,
    empty_log,
    kept_switches,
    larger_log,
    log_warnings,
    motion_record,
)
from softcradle.physics.kernel_tiers import KernelTiers
from softcradle.physics.numerics.kernel_arithmetic import kernel_arithmetic
from softcradle.physics.numerics.records import (
    EVALUATION,
    FALLBACK,
    PAUSED,
    REJECTED,
    SAMPLE,
    STEP,
    Samples,
    SwitchLog,
)
from softcradle.physics.problem import MOST_STEPS, NO_TIMES, Problem, Record, empty_samples, run_to_end
from softcradle.physics.scales import closing_scale, contact_scales
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]

CONTACT_STEPS = 120_000  # steps times contacts, rejected steps included: the budget of a short chain, about 0.1 s
STEPS_A_CONTACT = 60  # more steps for each contact, for waves pass through long chains one contact after another
STEPS_A_CONTACT_TIME = 400  # more steps for each of the longest contact times in the duration
USUAL_TOLERANCE = 1e-8  # below it the budget grows as the number of steps does
ERROR_GROWTH = 3.0  # times the sum of all local errors: the error that is stated where nothing makes it grow
PAUSE = 20_000  # steps, rejected ones included, after which a kernel hands back, so that a signal is heard
PLAIN_PAUSE = 50  # steps likewise as plain Python, so that machine code is taken when it comes
PLAIN_COST = 3.0  # fixed steps that cost plain Python as much as one of these
SOFTEST = 0.02  # exponent of contacts below which the ledger bounds the error too
MOST_ENERGY = 100.0  # tolerances: a larger relative error of the energy gives a warning
ALLOWED = {"radau": RADAU, "dop853": DOP853, "accurate": EITHER}  # kinds of step that a method takes


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
    KERNELS.load_made()  # so that the cost measured is that of the motion
    record = completed(problem)
    if problem.most_steps is None and record.status != Status.UNDETERMINED and is_sensitive(problem, record):
        record = checked(problem, record, _scale(problem), completed)
    record.velocity_error = record.velocity_error + _unresolved(problem, record)
    record.warnings += _energy_warnings(problem, record)
    return record


def completed(problem: Problem) -> Record:
    """One run to the end of the problem, by `conserving` from where the contacts only rattle."""
    record = run_to_end(problem, _pass)
    if record.status.gave_up and problem.most_steps is None:
        record = finish(problem, record, _pass)
    return record


def step_budget(problem: Problem) -> int:
    """Steps, rejected ones included, after which a motion rattles more than it determines; or what the problem allows."""
    if problem.most_steps is not None:
        return problem.most_steps
    if ALLOWED[problem.method] == DOP853:  # alone it follows the oscillations of soft contacts, however many
        return MOST_STEPS
    n = problem.chain.contacts
    budget = CONTACT_STEPS / n + STEPS_A_CONTACT * (n + 16)
    if problem.duration is not None:
        longest = contact_scales(problem.chain, problem.state.velocity(problem.chain))[1].max()
        budget += STEPS_A_CONTACT_TIME * problem.duration / longest
    finer = max(USUAL_TOLERANCE / problem.tolerance, 1.0) ** ERROR_EXPONENT[RADAU]
    return int(min(budget * finer, MOST_STEPS))


def advance(problem: Problem) -> Status:
    """Move ``problem.state`` on by the duration in place; the memory of the kernels stays with the state."""
    state, end = problem.state, problem.end
    memory = state.work.get("adaptive") or state.work.setdefault("adaptive", Memory.of(problem.chain.contacts))
    memory.log.counter[:] = 0
    memory.log.closed[:] = state.closed
    status, state.time = _integrate(problem, state, end, False, memory, live=True)
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
    counter, status, control = memory.log.counter, Status(code), memory.scratch.control
    growth = 1.0 + control[GROWTH] + memory.scratch.grown.sum()
    error = ERROR_GROWTH * growth * float(np.sqrt(control[LOCAL_SQUARE]))
    rows = int(counter[SAMPLE])  # fewer than wanted where the run gave up
    overlap, rate, anchor, force, absorbed = (row[:rows] for row in memory.samples[1:])
    return Record(
        times[:rows], overlap, rate, anchor, force, *kept_switches(memory.log), state, int(counter[STEP]),
        int(counter[EVALUATION]), status, _warnings(problem, status, state.time, memory.log), seconds, absorbed,
        np.full(overlap.shape[1] + 1, error), growth,
    )  # fmt: skip


def _integrate(problem: Problem, state: State, end: float, stop: bool, memory: Memory, live: bool = False) -> Any:
    """Run the kernel on `state`, in a frame of `live` use by what is at hand. Returns its status and the time reached."""
    data, regime = _chain_and_regime(problem.chain, state)
    most, scale, counter = step_budget(problem), _scale(problem), memory.log.counter
    motion, code, time = motion_record(state, memory.mode, memory.held), PAUSED, state.time
    rest = tuple(map(tuple, (memory.trial, memory.look, memory.scratch, memory.samples, memory.log)))
    work = PLAIN_COST * PLAIN_PAUSE * problem.chain.contacts
    with kernel_arithmetic():
        while code == PAUSED:
            spent = int(counter[STEP] + counter[REJECTED])
            kernel: Any = KERNELS.of_frame(integrate) if live else KERNELS.of(integrate, work)
            pause = PAUSE
            if kernel is not integrate:
                pause = PLAIN_PAUSE
                KERNELS.spent += 0.0 if live else work
            code, time = kernel(
                ALLOWED[problem.method], spent > 0, time, end, stop, most, spent + pause, scale, problem.tolerance, data,
                regime, motion, *rest,
            )  # fmt: skip
    return code, time


def _chain_and_regime(chain: Chain, state: State) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The fields of the effective chain and of its Regime; without dissipation they share their arrays."""
    (law, inverse_mass, push, external, anchor, own), dissipation = chain_records(chain, state)
    if dissipation is None:
        regime = (law, inverse_mass, push, NOTHING, NOTHING, NO_FLAGS, NO_FLAGS)
        return (law, inverse_mass, push, external, anchor, own), regime
    loss = dissipation.loss if dissipation.loss.any() else NOTHING
    bed = dissipation.bed if dissipation.bed.any() else NOTHING
    slide, easing = np.zeros(bed.size, dtype=np.int8), np.zeros(loss.size, dtype=np.int8)
    regime = (law, inverse_mass, push, loss, bed, slide, easing)
    if bed.size and not external.size:
        external = np.zeros(bed.size)
    return (law.copy(), inverse_mass.copy(), push, external, anchor, own), regime


def _scale(problem: Problem) -> float:
    """The velocity [m/s] that a tolerance is relative to: that of the fastest closing there can be, see `closing_scale`."""
    chain, state = problem.chain, problem.state
    return closing_scale(chain, state.velocity(chain), state.overlap, state.external(chain), problem.duration)


def _warnings(problem: Problem, status: Status, time: float, log: SwitchLog) -> Warnings:
    """What a run could not do."""
    found = []
    if status.gave_up:
        steps = step_budget(problem)
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


def _unresolved(problem: Problem, record: Record) -> float:
    """What velocities [m/s] the energy that the run has lost or gained could be, where contacts are so soft that they rattle.

    A cluster of such contacts is all but rigid: rattling far below the closing speed can be damped in every run alike, so that
    none tells of it, and of its energy alone is known that it is no more than what the ledger lacks.
    """
    chain = problem.chain
    if not any(contact.preload == 0.0 and contact.exponent < SOFTEST for contact in chain.power_laws):
        return 0.0
    return float(np.sqrt(2.0 * abs(_ledger_error(problem, record)) * chain.inverse_reduced_mass.max()))


def _ledger_error(problem: Problem, record: Record) -> float:
    """Change of the energy ledger [J] of an undriven chain; 0 where work is done on it."""
    chain, start = problem.chain, problem.state
    moved = np.isinf(chain.mass) & (start.velocity(chain) != 0.0)
    if start.external(chain) is not None or moved.any():
        return 0.0
    absorbed = float((record.end.absorbed - start.absorbed).sum())
    return float(record.end.energy(chain) + absorbed - start.energy(chain))


def _energy_warnings(problem: Problem, record: Record) -> Warnings:
    """A warning where the energy ledger of an undriven chain does not close to within many times the tolerance."""
    before, change = problem.state.energy(problem.chain), abs(_ledger_error(problem, record))
    if change <= MOST_ENERGY * problem.tolerance * before:
        return ()
    error = change / before
    sentence = (
        f"energy is off by {error:.1g} of itself, more than {problem.method} promises at tolerance {problem.tolerance:g}: "
        "compare with method 'conserving', or with another tolerance"
    )
    return (CodedWarning(WarningCode.ENERGY, sentence, {"error": error}),)


def _call_kernels() -> None:
    """Call every kernel once."""
    chain = Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1))
    run(Problem(chain, State.at_start(chain, [1.0, 0.0, 0.0]), "accurate", 1e-3, tolerance=1e-8))


KERNELS = KernelTiers("adaptive", __name__, _call_kernels)
TIERS = {KERNELS.name: KERNELS}
