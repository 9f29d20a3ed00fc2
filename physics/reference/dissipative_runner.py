"""Method `scipy` on chains with bed friction, loss or couplers: the collocation of this room, which finds its switches itself."""

from __future__ import annotations

import math
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.contact import is_closed
from softcradle.physics.problem import SAMPLED, CheckpointList, Problem, Record, empty_samples, run_to_end
from softcradle.physics.reference.extended_precision import MOST_STEPS, ExtendedRun, ReferenceGaveUpError
from softcradle.physics.reference.one_thread import on_one_thread
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]

LOCAL = 0.1  # of the wanted error: the local error of a step


@dataclass
class _Recorder:
    """A run that notes when contacts close and open."""

    run: ExtendedRun
    closed: NDArray[np.bool_]
    switches: list[tuple[float, int]] = field(default_factory=list)
    status: Status = Status.DONE
    warnings: Warnings = ()
    kept: CheckpointList[ExtendedRun] | None = None

    def until(self, end: float) -> None:
        """Move on to `end`, or, where that is inf, until the motion is over; a run that gives up stays where it is."""
        try:
            while self.run.time < end and not self.status.gave_up:
                if self.kept:
                    self.kept.offer(self.run.steps, partial(deepcopy, self.run))
                if math.isinf(end) and self.run.is_over():
                    self.status = Status.SEPARATED
                    return
                self.run.step(end)
                self._note()
        except ReferenceGaveUpError as error:
            sentence = f"scipy gave up {error}; what follows repeats the state at that time: take 'conserving'"
            self.status = Status.OUT_OF_STEPS
            self.warnings = (CodedWarning(WarningCode.GAVE_UP, sentence, {"time": float(self.run.time)}),)

    def _note(self) -> None:
        reached = self.run.reached()
        now = is_closed(reached.overlap, reached.force)
        self.switches.extend((float(self.run.time), int(i)) for i in np.flatnonzero(now != self.closed))
        self.closed = now


def _recorder(problem: Problem) -> _Recorder:
    state = problem.state.copy()
    most = problem.most_steps or MOST_STEPS
    return _Recorder(
        ExtendedRun(problem.chain, state, LOCAL * problem.tolerance, most_steps=most),
        np.zeros(problem.chain.contacts, dtype=bool),
    )


@on_one_thread
def run(problem: Problem) -> Record:
    """Compute the whole motion; ``problem.state`` stays as it is."""
    return run_to_end(problem, _pass)


@on_one_thread
def advance(problem: Problem) -> Status:
    """Move ``problem.state`` on by the duration in place."""
    state, recorder = problem.state, _recorder(problem)
    recorder.closed = state.closed
    recorder.until(problem.end)
    end = recorder.run.reached()
    state.time = end.time
    state.note_switches([contact for _, contact in recorder.switches], [time for time, _ in recorder.switches])
    for name in ("overlap", "rate", "anchor", "force", "taken"):
        getattr(state, name)[:] = getattr(end, name)
    return recorder.status


def _pass(problem: Problem, end: float, times: Array, _stop: bool) -> Record:
    recorder = _recorder(problem)
    recorder.kept = CheckpointList(1) if problem.keeps else None
    rows = empty_samples(times.size, problem.chain.contacts)
    for k, time in enumerate(times):
        recorder.until(float(time))
        _fill(rows, k, recorder.run.reached())
    recorder.until(end)
    return Record(
        times, *rows[:4],
        np.array([contact for _, contact in recorder.switches], dtype=np.int64),
        np.array([time for time, _ in recorder.switches]),
        recorder.run.reached(), recorder.run.steps, recorder.run.steps, recorder.status, recorder.warnings, taken=rows[4],
        kept=_KeptRun(recorder.kept.items) if recorder.kept else None,
    )  # fmt: skip


@dataclass
class _KeptRun:
    """A run that kept itself on its way."""

    runs: list[ExtendedRun]

    @on_one_thread
    def record(self, found: Record, times: Array) -> Record:
        """The record `found` of the run with its samples at `times`, which may lie beyond its end."""
        rows = empty_samples(times.size, found.end.overlap.size)
        starts = [float(run.time) for run in self.runs]
        for k, time in enumerate(times):
            run = deepcopy(self.runs[max(int(np.searchsorted(starts, time, side="right")) - 1, 0)])
            recorder = _Recorder(run, np.zeros(found.end.overlap.size, dtype=bool))
            recorder.until(float(time))
            _fill(rows, k, run.reached())
        sampled: dict[str, Any] = dict(zip(SAMPLED, (times, *rows), strict=True))
        return replace(found, kept=None, **sampled)


def _fill(rows: tuple[Array, ...], k: int, state: State) -> None:
    for row, value in zip(rows, (state.overlap, state.rate, state.anchor, state.force, state.taken), strict=True):
        row[k] = value
