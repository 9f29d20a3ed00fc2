"""The end of a motion that rattles: several runs of `conserving` from where following each bounce stops paying.

Bounces by the thousand at a millionth of the closing speed determine no digit of the end that a finer run would confirm.
Energy and momentum are kept by every step of the discrete gradient, so it carries such a motion to its end in bounded time,
and how far runs of unlike steps differ says how well that end is determined.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.fixed_step import runner as fixed_step
from softcradle.physics.problem import NO_TIMES, SAMPLED, Problem, Record, continued_switches, with_ends_as_samples
from softcradle.physics.scales import default_step
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, Status, WarningCode

Array = NDArray[np.float64]

STEP_PART = 0.25  # of the default step: the longest step of these runs, or
ELAPSED_PART = 1.0 / 1500.0  # of the time that the motion took so far, where that is longer
PARTS = (1.0, 0.83, 0.61, 0.5)  # of the longest step, one for each run; the last one is the result
DOUBT = 3.0  # times the difference between runs, or the sum of all local errors of one: the error that is stated
MOST_GROWN = 8.0  # factor by which errors may grow before another run has to confirm the motion
STEPS_ALIKE = 12_000  # of one of these runs, after which they are twice as long: a long end takes few more


def finish(problem: Problem, given_up: Record, sampled: Callable[[Record, Array], Record]) -> Record:
    """The whole record of a motion that the adaptive method gave up at ``given_up.end``; its error is the spread of the runs.

    `sampled` takes samples of a record at some times.
    """
    start = given_up.end
    elapsed = start.time - problem.state.time
    step = STEP_PART * default_step(problem.chain, problem.state.velocity(problem.chain))
    step = max(step, ELAPSED_PART * elapsed)
    with ThreadPoolExecutor(min(len(PARTS), os.cpu_count() or 1)) as threads:
        ends = list(threads.map(lambda part: _run_on(problem, start, part * step, None, NO_TIMES), PARTS))
    velocities = np.array([end.end.velocity(problem.chain) for end in ends])
    spread = np.ptp(velocities, axis=0)  # that of one bead may be small by chance, where those of others are not
    error = confirmed_error(given_up) + np.maximum(DOUBT * spread, spread.max())
    times, last = problem.sample_times(ends[-1].end.time), ends[-1]
    early, late = times[times <= start.time], times[times > start.time]
    if (late < last.end.time).any():
        last = replace(_run_on(problem, start, PARTS[-1] * step, last.end.time, late), end=last.end)
    else:
        last = with_ends_as_samples(last, start, late)
    return _joined(problem, sampled(given_up, early), last, error)


def _run_on(problem: Problem, start: State, step: float, end: float | None, times: Array) -> Record:
    """`conserving` from `start` to `end`, or to the end of the problem, in steps that double again and again."""
    stop = problem.end if end is None else end
    state, left = start, times
    records: list[Record] = []
    while not records or records[-1].status.gave_up:
        duration = None if np.isinf(stop) else stop - state.time
        samples = left if left.size else 2
        part = Problem(
            problem.chain, state.copy(), "conserving", duration, step, samples=samples, most_steps=STEPS_ALIKE
        )
        found = fixed_step.run(part)
        records.append(replace(found, **{name: getattr(found, name)[: left.size] for name in SAMPLED}))
        left = left[records[-1].time.size :]  # samples within the step after the last one are taken too
        state, step = found.end, 2.0 * step
    starts = [start.time, *(record.end.time for record in records[:-1])]
    return records[0] if len(records) == 1 else _in_a_row(problem.chain, starts, records)


def _in_a_row(chain: Chain, starts: list[float], records: list[Record]) -> Record:
    """Records of runs that go on from each other, each from its start [s], as one."""
    closed, switches = np.zeros(chain.contacts, dtype=bool), []
    for start, record in zip(starts, records, strict=True):
        switches += continued_switches(closed, start, record)
    rows: dict[str, Any] = {name: np.concatenate([getattr(record, name) for record in records]) for name in SAMPLED}
    return replace(
        records[-1],
        **rows,
        switch_contact=np.array([contact for contact, _ in switches], dtype=np.int64),
        switch_time=np.array([time for _, time in switches]),
        steps=sum(record.steps for record in records),
        evaluations=sum(record.evaluations for record in records),
        seconds=sum(record.seconds for record in records),
    )


def _joined(problem: Problem, first: Record, last: Record, error: Array) -> Record:
    """Two records, the second of which goes on from the first, as that of a motion not determined."""
    return replace(
        _in_a_row(problem.chain, [problem.state.time, first.end.time], [first, last]),
        status=Status.UNDETERMINED,
        warnings=(),
        velocity_error=error,
        growth=first.growth,
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
