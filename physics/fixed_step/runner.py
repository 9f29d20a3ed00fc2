"""Runner of the fixed-step methods: euler, verlet, yoshida4 and conserving."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.contact import power_law
from softcradle.physics.fixed_step.discrete_gradient import WORK_ROWS
from softcradle.physics.fixed_step.explicit_steps import EULER, VERLET, YOSHIDA4
from softcradle.physics.fixed_step.step_loop import (
    AT,
    BEGUN,
    NEVER,
    NEXT,
    SPACING,
    Pause,
    march,
    no_pause,
    sample_between,
)
from softcradle.physics.kernel_records import (
    FIRST_LOG,
    FRAME_LOG,
    chain_records,
    empty_log,
    kept_switches,
    larger_log,
    log_warnings,
    motion_record,
    require_finite_motion,
)
from softcradle.physics.kernel_tiers import KernelTiers
from softcradle.physics.numerics.contact_solve import BEAD_ROWS
from softcradle.physics.numerics.records import (
    EVALUATION,
    PAUSED,
    SAMPLE,
    STEP,
    SWITCH,
    UNCONVERGED,
    Samples,
    SwitchLog,
)
from softcradle.physics.problem import NO_TIMES, Problem, Record, empty_samples, first_samples, run_to_end
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]

# Drifts and kicks of each method. The arrays are empty for the method with a discrete gradient.
DRIFTS_AND_KICKS = {"euler": EULER, "verlet": VERLET, "yoshida4": YOSHIDA4, "conserving": (NO_TIMES, NO_TIMES)}
# Largest number of steps of a run. If a run needs more, its step is too small for its motion.
MOST_FIXED_STEPS = 100_000_000

# Number of steps times contacts after which a kernel returns to Python, so that Python can handle signals. This work
# takes about 0.1 s.
PAUSE = 2_000_000
# Largest number of checkpoints of a run, and largest number of floats in them (32 MB).
MOST_ROWS, MOST_NUMBERS = 1024, 2**22
# Number of steps between two checkpoints at the start of a run. Leaving the step loop after every step would take half
# of the computing time of a short chain.
FIRST_SPACING = 4
# Number of steps times contacts that plain Python tries in a run without a duration. This work takes about one second.
PLAIN_STEPS = 20_000


@dataclass
class Scratch:
    """Scratch memory of the kernels, created once for a run, or once for all frames of live use."""

    beads: Array
    work: Array
    samples: Samples
    log: SwitchLog
    checkpoints: Samples
    plan: NDArray[np.int64]
    pause: Pause

    @classmethod
    def of(
        cls, method: str, contacts: int, times: Array = NO_TIMES, log_size: int = 0, checkpoints: bool = False
    ) -> Scratch:
        """Return scratch memory for a chain with this number of `contacts`.

        The memory contains one row for each sample time in `times`. If `checkpoints` is True, it also contains rows for
        checkpoints, because the sample times are only known after the run.
        """
        solver_rows = WORK_ROWS if method == "conserving" else 0
        # Each checkpoint stores overlaps, rates and forces.
        rows = min(MOST_ROWS, max(2, MOST_NUMBERS // (3 * contacts))) if checkpoints else 0
        plan = np.array([0, 0 if checkpoints else NEVER, FIRST_SPACING])
        beads, work = np.zeros((BEAD_ROWS, contacts + 1)), np.empty((solver_rows, contacts))
        samples, kept = empty_samples(times, contacts), empty_samples(np.empty(rows), contacts)
        return cls(beads, work, samples, empty_log(contacts, log_size), kept, plan, no_pause())


def run(problem: Problem) -> Record:
    """Compute the whole motion. ``problem.state`` is not changed."""
    KERNELS.load_made()  # Load the kernels first. The measured time should only contain the motion.
    return run_to_end(problem, _pass)


def advance(problem: Problem) -> Status:
    """Advance ``problem.state`` in place by the duration. The scratch memory is stored in the state for the next call."""
    state = problem.state
    scratch = state.work.get(problem.method)
    if scratch is None:
        scratch = state.work[problem.method] = Scratch.of(problem.method, problem.chain.contacts, NO_TIMES, FRAME_LOG)
    # Each frame starts with an empty log. The log keeps the information which contacts are closed.
    log = scratch.log
    log.counter[:] = 0
    log.closed[:] = state.closed
    kernel = KERNELS.of_frame(march)
    status, state.time = _march_chain(kernel, MOST_FIXED_STEPS, problem, state, scratch)
    state.note_switches(*kept_switches(log), int(log.counter[SWITCH]))
    return Status(status)


def _pass(problem: Problem, times: Array, log_size: int = FIRST_LOG, plain: bool = True) -> Record:
    """Run the kernel once. If the log of contact switches was too small, run again with a larger log.

    If `plain` is True, a run without a duration is first tried in plain Python. If the number of tried steps is not
    sufficient, compiled code starts the run again.
    """
    state = problem.state.copy()
    kernel, most = _kernel_and_steps(problem, plain)
    scratch = Scratch.of(problem.method, problem.chain.contacts, times, log_size, problem.keeps)
    began = perf_counter()
    status, state.time = _march_chain(kernel, most, problem, state, scratch)
    seconds = perf_counter() - began
    if kernel is not march:
        KERNELS.spent += float(scratch.log.counter[STEP] * problem.chain.contacts)
    # Plain Python did not reach the end within its budget. Start again with machine code.
    if most < (problem.most_steps or MOST_FIXED_STEPS) and Status(status).gave_up:
        return _pass(problem, times, log_size, plain=False)
    # The log of contact switches was too small. Run again with a larger log.
    larger = larger_log(scratch.log)
    if larger:
        return _pass(problem, times, larger, plain)
    counter = scratch.log.counter
    # If the run gave up, there are fewer samples than wanted.
    samples = first_samples(scratch.samples, int(counter[SAMPLE]))
    return Record(
        problem.chain, samples, *kept_switches(scratch.log), state, int(counter[STEP]), int(counter[EVALUATION]),
        Status(status), _warnings(problem, Status(status), state.time, scratch.log), seconds,
        kept=_KeptRun(problem, scratch) if problem.keeps else None,
    )  # fmt: skip


@dataclass
class _KeptRun:
    """Finished run with checkpoints. Samples can be computed from the checkpoints."""

    problem: Problem
    scratch: Scratch

    def record(self, found: Record, times: Array) -> Record:
        """Add samples at `times` to the record `found` of the run. The times may lie after the end of the run."""
        problem, scratch, chain = self.problem, self.scratch, self.problem.chain
        scratch.samples = empty_samples(times, chain.contacts)
        scratch.log = empty_log(chain.contacts, 0)
        state, late = problem.state.copy(), max(float(times[-1]) - found.end.time, 0.0) if times.size else 0.0
        # Number of steps to repeat. This number decides between compiled code and plain Python.
        again = min(found.steps, times.size * int(scratch.plan[SPACING])) + late / problem.step
        work = again * chain.contacts
        kernel = KERNELS.of(sample_between, work)
        if kernel is not sample_between:
            KERNELS.spent += work
        most, counts = problem.most_steps or MOST_FIXED_STEPS, scratch.pause.counts
        counts[AT], counts[BEGUN], counts[NEXT] = _steps_at_once(problem), 0, 0
        began = perf_counter()
        # The kernel returns False when it has used its step budget.
        while not _call(kernel, most, problem, state, scratch):
            pass  # Python handles signals between two calls of the kernel.
        found.seconds += perf_counter() - began
        return found.with_samples(first_samples(scratch.samples, int(scratch.log.counter[SAMPLE])))


def _kernel_and_steps(problem: Problem, plain: bool) -> tuple[Any, int]:
    """Return the compiled or plain kernel for a run, and the largest number of steps it may take."""
    chain, duration, most = problem.chain, problem.duration, problem.most_steps or MOST_FIXED_STEPS
    # Without a duration, the number of steps is unknown. Plain Python tries a limited number.
    steps = PLAIN_STEPS / chain.contacts if duration is None else duration / problem.step + 1.0
    kernel = KERNELS.of(march, steps * chain.contacts if plain else np.inf)
    return kernel, most if kernel is march or duration is not None else min(most, int(steps))


def _march_chain(kernel: Any, most: int, problem: Problem, state: State, scratch: Scratch) -> tuple[int, float]:
    """Run `march` on `state` for at most `most` steps. Return its status and the time that it reached.

    `kernel` is the compiled or the plain version of `march`.
    """
    span, counts = (state.time, problem.end, problem.duration is None, most), scratch.pause.counts
    code, time, counts[BEGUN] = PAUSED, state.time, 0
    while code == PAUSED:
        counts[AT] = scratch.log.counter[STEP] + _steps_at_once(problem)
        code, time = _call(kernel, span, problem, state, scratch)
    return code, time


def _steps_at_once(problem: Problem) -> int:
    """Return the number of steps after which a kernel returns to Python."""
    return max(1, PAUSE // problem.chain.contacts)


def _call(kernel: Any, span: Any, problem: Problem, state: State, scratch: Scratch) -> Any:
    """Call `kernel` on `state`. `span` is the time span of the call, or its largest number of steps."""
    chain, kept = problem.chain, (tuple(scratch.checkpoints), scratch.plan)
    records = motion_record(state), tuple(scratch.samples), tuple(scratch.log), kept, tuple(scratch.pause)
    task = (*DRIFTS_AND_KICKS[problem.method], problem.step), span, chain_records(chain, state)
    found = kernel(*task, *records, (scratch.beads, scratch.work))
    require_finite_motion(chain, state)
    return found


def _warnings(problem: Problem, status: Status, time: float, log: SwitchLog) -> Warnings:
    """Return the warnings for a run that gave up, or whose steps did not converge."""
    found = []
    if status.gave_up:
        steps = problem.most_steps or MOST_FIXED_STEPS
        sentence = f"{problem.method} gave up after {steps} steps at t = {time:.6g} s: take a larger step"
        found.append(CodedWarning(WarningCode.GAVE_UP, sentence, {"steps": steps, "time": time}))
    failed = int(log.counter[UNCONVERGED])
    if failed:
        sentence = f"{failed} steps of {problem.method} did not converge: take a smaller step"
        found.append(CodedWarning(WarningCode.UNCONVERGED, sentence, {"steps": failed}))
    return (*found, *log_warnings(log))


def _call_kernels() -> None:
    """Compile all kernels by calling each of them once."""
    chain = Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1))
    state = State.at_start(chain, [1.0, 0.0, 0.0])
    run(Problem(chain, state, "verlet", 1e-3, 1e-3))
    run(Problem(chain, state, "conserving", 1e-3, 1e-3))
    run(Problem(chain, state, "conserving", None, 1e-3, samples=3))


KERNELS = KernelTiers("fixed-step", __name__, _call_kernels)
TIERS = {KERNELS.name: KERNELS}
