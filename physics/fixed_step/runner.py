"""Runner of the methods of fixed steps: euler, verlet, yoshida4, conserving."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.fixed_step.discrete_gradient import WORK_ROWS
from softcradle.physics.fixed_step.splitting import EULER, VERLET, YOSHIDA4
from softcradle.physics.fixed_step.splitting_simd import LONG
from softcradle.physics.fixed_step.step_loop import (
    DISCRETE_GRADIENT,
    SPLITTING,
    SPLITTING_SIMD,
    march,
)
from softcradle.physics.kernel_records import (
    FIRST_LOG,
    chain_records,
    empty_log,
    kept_switches,
    larger_log,
    log_warnings,
    motion_record,
    require_finite_motion,
)
from softcradle.physics.numerics.contact_solve import BEAD_ROWS
from softcradle.physics.numerics.kernel_arithmetic import kernel_arithmetic
from softcradle.physics.numerics.records import (
    EVALUATION,
    SAMPLE,
    STEP,
    SWITCH,
    UNCONVERGED,
    Motion,
    Samples,
    SwitchLog,
)
from softcradle.physics.problem import NO_TIMES, Problem, Record, empty_samples, run_to_end
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]

DRIFTS_AND_KICKS = {"euler": EULER, "verlet": VERLET, "yoshida4": YOSHIDA4, "conserving": (NO_TIMES, NO_TIMES)}
MOST_STEPS = 100_000_000  # of a run; one that needs more has a step that does not fit its motion

_march: Any = march  # its arguments are unpacked from tuples, which type checkers cannot count
_loaded: set[tuple[str, bool, bool]] = set()  # (method, dissipative, with own laws) whose kernels are in memory


@dataclass
class Scratch:
    """Memory of the kernels beside the state: made once for a run, or once for all frames of live use."""

    method: str
    spare: Motion
    beads: Array
    work: Array
    samples: Samples
    log: SwitchLog

    @classmethod
    def of(cls, method: str, contacts: int, times: Array = NO_TIMES, log_size: int = 0) -> Scratch:
        """Memory for a chain with `contacts`; sample rows at `times`."""
        none = np.empty(0, dtype=np.int8)
        spare = Motion(np.empty(contacts), np.empty(contacts), np.empty(2), np.empty(contacts), np.empty(2), none, none)
        rows = WORK_ROWS if method == "conserving" else 0
        samples = Samples(times, *empty_samples(times.size, contacts))
        beads, work = np.zeros((BEAD_ROWS, contacts + 1)), np.empty((rows, contacts))
        return cls(method, spare, beads, work, samples, empty_log(contacts, log_size))


def run(problem: Problem) -> Record:
    """Compute the whole motion; ``problem.state`` stays as it is."""
    chain_records(problem.chain, problem.state)  # compiles laws of one's own
    key = problem.method, problem.chain.dissipative, bool(problem.chain.own_laws)
    if key not in _loaded:  # so that the cost measured is that of the motion
        _pass(problem, problem.state.time, NO_TIMES, False)
        _loaded.add(key)
    return run_to_end(problem, _pass)


def advance(problem: Problem) -> Status:
    """Move ``problem.state`` on by the duration in place; the scratch memory stays with the state."""
    state, end = problem.state, problem.end
    scratch = state.work.get("fixed_step")
    if scratch is None or scratch.method != problem.method:
        scratch = state.work["fixed_step"] = Scratch.of(problem.method, problem.chain.contacts)
    log = scratch.log
    log.counter[:] = 0
    log.closed[:] = state.closed
    status, state.time = _march_chain(problem, state, end, False, scratch)
    state.switches += int(log.counter[SWITCH])
    return Status(status)


def _pass(problem: Problem, end: float, times: Array, stop: bool, log_size: int | None = None) -> Record:
    """One run of the kernel; again with a larger log of switches where the first was too small."""
    state = problem.state.copy()
    scratch = Scratch.of(problem.method, problem.chain.contacts, times, log_size or FIRST_LOG)
    began = perf_counter()
    status, state.time = _march_chain(problem, state, end, stop, scratch)
    seconds = perf_counter() - began
    larger = larger_log(scratch.log)
    if larger:
        return _pass(problem, end, times, stop, larger)
    counter = scratch.log.counter
    rows = int(counter[SAMPLE])  # fewer than wanted where the run gave up
    overlap, rate, anchor, force, absorbed = (row[:rows] for row in scratch.samples[1:])
    return Record(
        times[:rows], overlap, rate, anchor, force, *kept_switches(scratch.log), state, int(counter[STEP]),
        int(counter[EVALUATION]), Status(status), _warnings(problem, Status(status), state.time, scratch.log), seconds, absorbed,
    )  # fmt: skip


def _march_chain(problem: Problem, state: State, end: float, stop: bool, scratch: Scratch) -> tuple[int, float]:
    """Run the kernel on `state`. Returns its status and the time reached."""
    chain = problem.chain
    data, dissipation = chain_records(chain, state)
    method = _kind(problem.method, chain), *DRIFTS_AND_KICKS[problem.method]
    records = motion_record(state), tuple(scratch.spare), tuple(scratch.samples), tuple(scratch.log)
    span = problem.step, state.time, end, stop, MOST_STEPS
    with kernel_arithmetic():
        status, time = _march(*method, *span, data, dissipation, *records, scratch.beads, scratch.work)
    require_finite_motion(chain, state)
    return status, time


def _kind(method: str, chain: Chain) -> int:
    """The kind of step that the loop takes."""
    if method == "conserving":
        return DISCRETE_GRADIENT
    scalar = chain.dissipative or chain.own_laws  # vector code has the power law alone
    return SPLITTING if scalar or chain.contacts < LONG else SPLITTING_SIMD


def _warnings(problem: Problem, status: Status, time: float, log: SwitchLog) -> Warnings:
    """What a run could not do."""
    found = []
    if status.gave_up:
        sentence = f"{problem.method} gave up after {MOST_STEPS} steps at t = {time:.6g} s: take a larger step"
        found.append(CodedWarning(WarningCode.GAVE_UP, sentence, {"steps": MOST_STEPS, "time": time}))
    failed = int(log.counter[UNCONVERGED])
    if failed:
        sentence = f"{failed} steps of {problem.method} did not converge: take a smaller step"
        found.append(CodedWarning(WarningCode.UNCONVERGED, sentence, {"steps": failed}))
    return (*found, *log_warnings(log))
