"""What a runner gets and what it gives back: one Problem in, one Record out, whatever the method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.numerics.records import Samples
from softcradle.physics.state import MOVING, State
from softcradle.physics.status import Status, Warnings

Array = NDArray[np.float64]
Kept = TypeVar("Kept")

MOST_STEPS = 200_000  # steps of an adaptive method, rejected ones included, before a run gives up
NO_TIMES = np.zeros(0)
MOST_CHECKPOINTS = 512  # of a run in Python


@dataclass(frozen=True)
class Problem:
    """A motion to compute.

    Attributes:
        chain, state: the chain and its start.
        method: name of the method.
        duration: time to run [s], or None: until every contact is open and none can close again.
        step: fixed step [s]; 0 for adaptive methods.
        tolerance: wanted error; 0 for fixed steps.
        samples: number of evenly spaced samples, or their times (T,) [s].
        budget: steps after which an adaptive run rattles more than it determines; None: what its chain and tolerance tell.
        later: whether the record is to keep the run, for times of samples that are not known yet.
        most_steps: what an adaptive method may take for a frame of live use; None: a whole motion, as long as it takes.
    """

    chain: Chain
    state: State
    method: str
    duration: float | None
    step: float = 0.0
    tolerance: float = 0.0
    samples: int | Array = field(default_factory=lambda: NO_TIMES)
    most_steps: int | None = None
    budget: int | None = None
    later: bool = False

    @cached_property
    def velocity(self) -> Array:
        """(n+1,) bead velocities [m/s] at the start."""
        return self.state.velocity(self.chain)

    @property
    def end(self) -> float:
        """When the run ends [s]; inf without a duration."""
        return np.inf if self.duration is None else self.state.time + self.duration

    @property
    def ends_alone(self) -> bool:
        """Whether the samples wanted are the start and the end of the run."""
        return isinstance(self.samples, int) and self.samples == 2

    @property
    def keeps(self) -> bool:
        """Whether the run has to keep what samples are taken from when it is over."""
        return self.later or (self.duration is None and not self.ends_alone)

    def sample_times(self, end: float) -> Array:
        """(T,) sample times [s] for a run that ends at `end`."""
        start = self.state.time
        if self.ends_alone:
            return np.array((start, start + (end - start)))
        if isinstance(self.samples, int):
            return start + np.linspace(0.0, end - start, self.samples)
        return self.samples


@dataclass
class Record:
    """What a runner found: samples, contact switches in order of time, the end, the cost.

    Attributes:
        chain: whose motion it is.
        samples: fewer than wanted where it gave up.
        switch_contact, switch_time: every change of a contact between open and closed (all start open).
        end: State at the end of the run.
        steps, evaluations: cost.
        status: how the run ended.
        warnings: what may be wrong.
        seconds: wall time of the solver, loading of kernels left out; 0 where the runner leaves the clock to `simulate`.
        velocity_error: (n+1,) estimated error [m/s] of the bead velocities at the end; empty where none is estimated.
        growth: factor by which errors of velocities grow along the motion, as far as its bounces tell.
        unseen: the part of that error [m/s] that finer runs make as well, so that it is no difference between them.
        kept: what the run kept of its motion, while samples are still to be taken from it.
    """

    chain: Chain
    samples: Samples
    switch_contact: NDArray[np.int64]
    switch_time: Array
    end: State
    steps: int
    evaluations: int
    status: Status = Status.DONE
    warnings: Warnings = ()
    seconds: float = 0.0
    velocity_error: Array = field(default_factory=lambda: np.zeros(0))
    growth: float = 1.0
    unseen: float = 0.0
    kept: KeptRun | None = None

    @cached_property
    def velocity(self) -> Array:
        """(n+1,) bead velocities [m/s] at the end."""
        return self.end.velocity(self.chain)

    def with_samples(self, samples: Samples) -> Record:
        """This record, with the samples that were still to be taken."""
        self.samples, self.kept = samples, None
        return self


class KeptRun(Protocol):
    """What a run without a duration keeps of its motion, for the times of its samples are known at its end alone."""

    def record(self, found: Record, times: Array, /) -> Record:
        """The record `found` of the run with its samples at `times` (T,) [s]."""


class CheckpointList(Generic[Kept]):
    """What a run keeps every few steps; where it is full, every second one goes and the steps between them double.

    Attributes:
        items: what is kept, in order.
        due: steps after which the next one is kept.
    """

    def __init__(self, spacing: int) -> None:
        """With `spacing` steps between two at first."""
        self.items: list[Kept] = []
        self.due = 0
        self._spacing = spacing

    def offer(self, steps: int, make: Callable[[], Kept]) -> None:
        """Keep what `make` gives, if it is due after so many `steps` of the run."""
        if steps < self.due:
            return
        if len(self.items) == MOST_CHECKPOINTS:
            self.items = self.items[::2]
            self._spacing *= 2
        self.items.append(make())
        self.due = steps + self._spacing


class Runner(Protocol):
    """What moves chains by the methods of one family; a module with these two functions is one."""

    def run(self, problem: Problem, /) -> Record:
        """Compute the whole motion; ``problem.state`` stays as it is."""

    def advance(self, problem: Problem, /) -> Status:
        """Move ``problem.state`` on by the duration in place; it stops early with a status that says so."""


def continued_switches(closed: NDArray[np.bool_], start: float, record: Record) -> list[tuple[int, float]]:
    """(contact, time) of the switches in the `record` of a run that goes on from `start` [s]; `closed` (n,) is updated.

    A run logs its closed contacts as closing at its start: those that were `closed` before have not switched, and those that
    were and are not logged have opened.
    """
    begun, now = np.zeros(closed.size, dtype=bool), np.zeros(closed.size, dtype=bool)
    kept = []
    for contact, time in zip(record.switch_contact.tolist(), record.switch_time.tolist(), strict=True):
        now[contact] = not now[contact]
        if time <= start and now[contact] and not begun[contact]:
            begun[contact] = True
            if closed[contact]:
                continue
        kept.append((contact, time))
    opened = np.flatnonzero(closed & ~begun)
    closed[:] = now
    return [*((int(contact), start) for contact in opened), *kept]


def empty_samples(times: Array, contacts: int) -> Samples:
    """Rows for the samples at `times` (T,) [s]."""
    count, wide = times.size, (times.size, contacts)
    return Samples(times, np.zeros(wide), np.zeros(wide), np.zeros((count, 2)), np.zeros(wide), np.zeros((count, 4)))


def first_samples(samples: Samples, count: int) -> Samples:
    """The first `count` of the samples."""
    return Samples(*(rows[:count] for rows in samples))


Pass = Callable[[Problem, float, Array, bool], Record]


def run_to_end(problem: Problem, once: Pass) -> Record:
    """Run `once(problem, end, sample times, stop)` to the duration; without one, to the end it finds itself.

    Samples between are then taken from what the run kept. Where it kept nothing, a second run takes them.
    """
    if problem.duration is not None and not problem.later:
        return once(problem, problem.end, problem.sample_times(problem.end), False)
    found = once(problem, problem.end, NO_TIMES, problem.duration is None)
    if problem.later:
        return found
    times = problem.sample_times(found.end.time)
    if problem.ends_alone:
        return with_ends_as_samples(found, problem.state, times)
    if found.kept is not None:
        began = perf_counter()
        found = found.kept.record(found, times)
        found.seconds += perf_counter() - began
        return found
    return replace(found, samples=once(problem, max(found.end.time, float(times[-1])), times, False).samples)


def with_ends_as_samples(found: Record, start: State, times: Array) -> Record:
    """The record with its `start` or its end as the samples at `times`, none of which lies between them."""
    states = [found.end if time > start.time else start for time in times.tolist()]
    if not states:
        return found.with_samples(empty_samples(times, start.overlap.size))
    rows = (np.array([getattr(state, name) for state in states]) for name in MOVING)
    return found.with_samples(Samples(times, *rows))
