"""The end of a motion that rattles: several runs of `conserving` from where following each bounce stops paying.

Bounces by the thousand at a millionth of the closing speed determine no digit of the end that a finer run would confirm.
Energy and momentum are kept by every step of the discrete gradient, so it carries such a motion to its end in bounded time,
and how far runs of unlike steps differ says how well that end is determined.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.fixed_step import runner as fixed_step
from softcradle.physics.problem import NO_TIMES, Pass, Problem, Record, continued_switches
from softcradle.physics.scales import default_step
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, Status, WarningCode

Array = NDArray[np.float64]

STEP_PART = 0.25  # of the default step: the longest step of these runs, or
ELAPSED_PART = 1.0 / 1500.0  # of the time that the motion took so far, where that is longer
PARTS = (1.0, 0.83, 0.61, 0.5)  # of the longest step, one for each run; the last one is the result
SPREAD = 2.0  # times the largest difference between the runs: the error that is stated
MOST_GROWN = 8.0  # factor by which errors may grow before another run has to confirm the motion
ROWS = ("time", "overlap", "rate", "anchor", "force", "absorbed")  # fields of a Record with one row a sample
MOST_STEPS_OF_END = 400_000  # steps of one run


def finish(problem: Problem, given_up: Record, run_pass: Pass) -> Record:
    """The whole record of a motion that the adaptive method gave up at ``given_up.end``; its error is the spread of the runs."""
    start = given_up.end
    elapsed = start.time - problem.state.time
    step = STEP_PART * default_step(problem.chain, problem.state.velocity(problem.chain))
    step = max(step, ELAPSED_PART * elapsed)
    if problem.duration is not None:
        step = max(step, (problem.end - start.time) / MOST_STEPS_OF_END)
    ends = [_run_on(problem, start, part * step, None, NO_TIMES) for part in PARTS]
    velocities = np.array([end.end.velocity(problem.chain) for end in ends])
    error = confirmed_error(given_up) + SPREAD * np.ptp(velocities, axis=0)
    times = problem.sample_times(ends[-1].end.time)
    early = times[times <= start.time]
    parts = [run_pass(problem, start.time, early, False)]
    missed = early[parts[0].time.size :]  # cut at another end, that pass may not get so far
    if missed.size:
        parts.append(_run_on(problem, parts[0].end, PARTS[-1] * step, start.time, missed))
    last = _run_on(problem, start, PARTS[-1] * step, ends[-1].end.time, times[times > start.time])
    return _joined(problem, [*parts, replace(last, end=ends[-1].end)], start.time, error)


def _run_on(problem: Problem, start: State, step: float, end: float | None, times: Array) -> Record:
    """`conserving` from `start` to `end`, or to the end of the problem."""
    stop = problem.end if end is None else end
    duration = None if np.isinf(stop) else stop - start.time
    samples = times if times.size else np.array([start.time if duration is None else stop])
    found = fixed_step.run(Problem(problem.chain, start.copy(), "conserving", duration, step, samples=samples))
    return replace(found, **{name: getattr(found, name)[: times.size] for name in ROWS})


def _joined(problem: Problem, parts: list[Record], handed_over: float, error: Array) -> Record:
    """Records of runs that go on from each other as one; switches are those of the first, then of the last from `handed_over`."""
    first, last = parts[0], parts[-1]
    rows: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in ROWS}
    closed = np.zeros(problem.chain.contacts, dtype=bool)
    switches = continued_switches(closed, problem.state.time, first)
    switches += continued_switches(closed, handed_over, last)
    return replace(
        first,
        **rows,
        switch_contact=np.array([contact for contact, _ in switches], dtype=np.int64),
        switch_time=np.array([time for _, time in switches]),
        end=last.end,
        steps=sum(part.steps for part in parts),
        evaluations=sum(part.evaluations for part in parts),
        seconds=sum(part.seconds for part in parts),
        status=Status.UNDETERMINED,
        warnings=(undetermined(error),),
        velocity_error=error,
    )


def confirmed_error(record: Record) -> Array:
    """The stated error of a record whose growth of errors another run has shown, or bounded."""
    error: Array = record.velocity_error * (min(record.growth, MOST_GROWN) / record.growth)
    return error


def undetermined(error: Array) -> CodedWarning:
    """How far a motion is determined."""
    worst = float(error.max())
    sentence = f"final velocities are determined to {worst:.1g} m/s only: the contacts rattle, and finer runs differ by as much"
    return CodedWarning(WarningCode.SENSITIVE, sentence, {"error": worst})
