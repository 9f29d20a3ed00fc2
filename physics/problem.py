"""What a runner gets and what it gives back: one Problem in, one Record out, whatever the method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.numerics.records import Samples
from softcradle.physics.scales import closing_scale
from softcradle.physics.state import MOVING, State
from softcradle.physics.status import Status, Warnings

Array = NDArray[np.float64]

MOST_STEPS = 200_000  # steps of an adaptive method, rejected ones included, before a run gives up
NO_TIMES = np.zeros(0)


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

    @cached_property
    def velocity(self) -> Array:
        """(n+1,) bead velocities [m/s] at the start."""
        return self.state.velocity(self.chain)

    @cached_property
    def scale(self) -> float:
        """The speed [m/s] that the tolerance is relative to: that of the fastest closing there can be, see `closing_scale`."""
        external = self.state.external(self.chain)
        return closing_scale(self.chain, self.velocity, self.state.overlap, external, self.duration, self.tolerance)

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
        return self.duration is None and not self.ends_alone

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
        carried_from: time [s] from which `conserving` computed the rest because the step budget ended; NaN if it did not.
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
    carried_from: float = np.nan
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


class Runner(Protocol):
    """What moves chains by the methods of one family; a module with these two functions is one."""

    def run(self, problem: Problem, /) -> Record:
        """Compute the whole motion; ``problem.state`` stays as it is."""

    def advance(self, problem: Problem, /) -> Status:
        """Move ``problem.state`` on by the duration in place; it stops early with a status that says so."""


def empty_samples(times: Array, contacts: int) -> Samples:
    """Rows for the samples at `times` (T,) [s]."""
    count, wide = times.size, (times.size, contacts)
    return Samples(times, np.zeros(wide), np.zeros(wide), np.zeros((count, 2)), np.zeros(wide), np.zeros((count, 4)))


NO_SAMPLES = empty_samples(NO_TIMES, 0)  # where they are still to be taken


def first_samples(samples: Samples, count: int) -> Samples:
    """The first `count` of the samples."""
    return Samples(*(rows[:count] for rows in samples))


def run_to_end(problem: Problem, once: Callable[[Problem, Array], Record]) -> Record:
    """Run `once(problem, sample times)`; without a duration, samples between are taken from what the run kept."""
    if problem.duration is not None:
        return once(problem, problem.sample_times(problem.end))
    found = once(problem, NO_TIMES)
    times = problem.sample_times(found.end.time)
    return found.kept.record(found, times) if found.kept else with_ends_as_samples(found, problem.state, times)


def with_ends_as_samples(found: Record, start: State, times: Array) -> Record:
    """The record with its `start` or its end as the samples at `times`, none of which lies between them."""
    states = [found.end if time > start.time else start for time in times.tolist()]
    if not states:
        return found.with_samples(empty_samples(times, start.overlap.size))
    rows = (np.array([getattr(state, name) for state in states]) for name in MOVING)
    return found.with_samples(Samples(times, *rows))
