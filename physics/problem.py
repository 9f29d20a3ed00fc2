"""What `simulate` hands to a method and what it gets back: one Problem in, one Record out, whatever the method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.state import State

Array = NDArray[np.float64]

MOST_STEPS = 200_000  # steps and rejected steps of an adaptive method; contacts that rattle on beyond are reported


@dataclass(frozen=True)
class Problem:
    """A motion to compute.

    Attributes:
        chain, state: the chain and its start; a runner leaves `state` alone.
        method: name of the method.
        duration: time to run [s], or None: until every contact is open and none can close again.
        step: fixed step [s]; 0 for adaptive methods.
        tolerance: wanted error; 0 for fixed steps.
        samples: number of evenly spaced samples, or their times (T,) [s].
        most_steps: what an adaptive method may take for a frame of live use; None: a whole motion, as long as it takes.
    """

    chain: Chain
    state: State
    method: str
    duration: float | None
    step: float
    tolerance: float
    samples: int | Array
    most_steps: int | None = None

    def sample_times(self, end: float) -> Array:
        """(T,) sample times [s] for a run that ends at `end`."""
        if isinstance(self.samples, int):
            return self.state.time + np.linspace(0.0, end - self.state.time, self.samples)
        return self.samples


@dataclass
class Record:
    """What a runner found: sample rows, contact switches in order of time, the end, the cost.

    Attributes:
        time (T,), overlap (T, n), rate (T, n), anchor (T, 2), force (T, n): the samples.
        switch_contact, switch_time: every change of a contact between open and closed (all start open).
        end: State at the end of the run.
        steps, evaluations: cost.
        warnings: sentences on what may be wrong.
        absorbed: (T, 2) energy [J] absorbed by contacts and by the bed up to each sample; empty where nothing rubs.
        seconds: wall time of the solver, loading of kernels left out; 0 where the runner leaves the clock to `simulate`.
        gave_up: why the run stopped before its end, a sentence without an end; empty where it did not.
    """

    time: Array
    overlap: Array
    rate: Array
    anchor: Array
    force: Array
    switch_contact: NDArray[np.int64]
    switch_time: Array
    end: State
    steps: int
    evaluations: int
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0
    absorbed: Array = field(default_factory=lambda: np.zeros((0, 2)))
    gave_up: str = ""


def empty_samples(count: int, contacts: int) -> tuple[Array, Array, Array, Array]:
    """Rows for `count` samples: overlap, rate, anchor, force."""
    return (
        np.zeros((count, contacts)),
        np.zeros((count, contacts)),
        np.zeros((count, 2)),
        np.zeros((count, contacts)),
    )


Pass = Callable[[Problem, float, Array, bool], Record]
NO_TIMES = np.zeros(0)


def run_to_end(problem: Problem, once: Pass) -> Record:
    """Run `once(problem, end, sample times, stop)` to the duration; without one, first to the end it finds itself.

    The first pass then gives the end, the switches and the cost, a second one the samples, if any lie in between.
    """
    if problem.duration is not None:
        end = problem.state.time + problem.duration
        return once(problem, end, problem.sample_times(end), False)
    found = once(problem, np.inf, NO_TIMES, True)
    times = problem.sample_times(found.end.time)
    if isinstance(problem.samples, int) and problem.samples == 2:
        first, last = problem.state, found.end
        return replace(
            found,
            time=times,
            overlap=np.array([first.overlap, last.overlap]),
            rate=np.array([first.rate, last.rate]),
            anchor=np.array([first.anchor, last.anchor]),
            force=np.array([first.force, last.force]),
            absorbed=np.array([first.absorbed, last.absorbed]),
        )
    sampled = once(problem, max(found.end.time, float(times[-1])), times, False)
    return replace(
        found,
        time=sampled.time,
        overlap=sampled.overlap,
        rate=sampled.rate,
        anchor=sampled.anchor,
        force=sampled.force,
        absorbed=sampled.absorbed,
    )
