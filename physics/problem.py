"""Interface of the runners. For every method, the input is a Problem and the output is a Record."""

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

MOST_STEPS = 200_000  # Number of steps of an adaptive method after which a run gives up. Rejected steps count.
NO_TIMES = np.zeros(0)


@dataclass(frozen=True)
class Problem:
    """Motion to compute: a chain, its start, a method and its settings.

    Attributes:
        chain, state: the chain, and its state at the start.
        method: name of the method.
        duration: time to run [s]. None means until every contact is open and none can close again.
        step: fixed time step [s]; 0 for adaptive methods.
        tolerance: wanted error of velocities, relative to the speed scale; 0 for fixed steps.
        samples: number of evenly spaced samples, or their times (T,) [s].
        budget: number of steps after which an adaptive run counts as chattering. None means the usual budget for
            its chain and tolerance.
        most_steps: largest number of adaptive steps in a frame of live use. None means a whole motion without this
            limit.
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
        """Bead velocities [m/s] at the start, shape (n+1,)."""
        return self.state.velocity(self.chain)

    @cached_property
    def scale(self) -> float:
        """Speed [m/s] to which the tolerance is relative: the largest possible closing speed, see `closing_scale`."""
        external = self.state.external(self.chain)
        return closing_scale(self.chain, self.velocity, self.state.overlap, external, self.duration, self.tolerance)

    @property
    def end(self) -> float:
        """End time of the run [s]; inf without a duration."""
        return np.inf if self.duration is None else self.state.time + self.duration

    @property
    def ends_alone(self) -> bool:
        """True if the only wanted samples are the start and the end of the run."""
        return isinstance(self.samples, int) and self.samples == 2

    @property
    def keeps(self) -> bool:
        """True if the run has to store data from which samples are computed after its end."""
        return self.duration is None and not self.ends_alone

    def sample_times(self, end: float) -> Array:
        """Return the (T,) sample times [s] of a run that ends at `end`."""
        start = self.state.time
        if self.ends_alone:
            return np.array((start, start + (end - start)))
        if isinstance(self.samples, int):
            return start + np.linspace(0.0, end - start, self.samples)
        return self.samples


@dataclass
class Record:
    """Result of a runner: samples, contact switches in order of time, the state at the end, and the cost.

    Attributes:
        chain: the chain.
        samples: samples of the motion. There are fewer than wanted if the run gave up.
        switch_contact, switch_time: contact and time of every change between open and closed. All contacts start
            open.
        end: state at the end of the run.
        steps, evaluations: cost.
        status: how the run ended.
        warnings: possible problems.
        seconds: computing time of the solver [s], without loading of kernels. If it is 0, `simulate` measures the
            time.
        velocity_error: (n+1,) estimated error [m/s] of the bead velocities at the end; empty without an estimate.
        growth: error amplification by the bounces of the motion.
        carried_from: time [s] at which the step budget ended, so that `conserving` computed the rest of the motion.
            Otherwise NaN.
        kept: stored data of the run from which samples are still to be computed.
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
    carried_from: float = np.nan
    kept: KeptRun | None = None

    @cached_property
    def velocity(self) -> Array:
        """Bead velocities [m/s] at the end, shape (n+1,)."""
        return self.end.velocity(self.chain)

    def with_samples(self, samples: Samples) -> Record:
        """Return this record, completed by the given samples."""
        self.samples, self.kept = samples, None
        return self


class KeptRun(Protocol):
    """Interface of the stored data of a run without a duration. The sample times of such a run are known only after its
    end.
    """

    def record(self, found: Record, times: Array, /) -> Record:
        """Add samples at `times` (T,) [s] to the record `found` of the run."""


class Runner(Protocol):
    """Interface of a runner, which moves chains with the methods of one family.

    A module with these two functions is a runner.
    """

    def run(self, problem: Problem, /) -> Record:
        """Compute the whole motion; ``problem.state`` stays unchanged."""

    def advance(self, problem: Problem, /) -> Status:
        """Move ``problem.state`` forward by the duration in place. The status shows if it stopped early."""


def empty_samples(times: Array, contacts: int) -> Samples:
    """Return empty rows for the samples at `times` (T,) [s]."""
    count, wide = times.size, (times.size, contacts)
    return Samples(times, np.zeros(wide), np.zeros(wide), np.zeros((count, 2)), np.zeros(wide), np.zeros((count, 4)))


NO_SAMPLES = empty_samples(NO_TIMES, 0)  # Samples of a record whose samples are still to be computed


def first_samples(samples: Samples, count: int) -> Samples:
    """Return the first `count` samples."""
    return Samples(*(rows[:count] for rows in samples))


def run_to_end(problem: Problem, once: Callable[[Problem, Array], Record]) -> Record:
    """Run `once(problem, sample times)` and return its record.

    Without a duration, the samples are computed afterwards from the stored data of the run.
    """
    if problem.duration is not None:
        return once(problem, problem.sample_times(problem.end))
    found = once(problem, NO_TIMES)
    times = problem.sample_times(found.end.time)
    return found.kept.record(found, times) if found.kept else with_ends_as_samples(found, problem.state, times)


def with_ends_as_samples(found: Record, start: State, times: Array) -> Record:
    """Return the record with samples at `times`, each of which is the start or the end of the run.

    Samples at the start come from `start`. No time may lie between start and end.
    """
    states = [found.end if time > start.time else start for time in times.tolist()]
    if not states:
        return found.with_samples(empty_samples(times, start.overlap.size))
    rows = (np.array([getattr(state, name) for state in states]) for name in MOVING)
    return found.with_samples(Samples(times, *rows))
