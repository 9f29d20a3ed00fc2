"""A batch on its way: its chains in parts that kernels move one chain after the other, by fixed steps and by adaptive methods."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive.runner import DOUBT, error_growth
from softcradle.physics.adaptive.step_records import (
    ALLOWED,
    DOP853,
    empty_scratch,
    empty_steps,
    empty_trial,
)
from softcradle.physics.adaptive.usual_budget import usual_budget
from softcradle.physics.batch.batch_scales import BatchStart
from softcradle.physics.batch.chain_batch import ChainBatch
from softcradle.physics.batch.run_each import BatchData, BatchMotion
from softcradle.physics.confirm import MOST_GROWN, SOFTEST
from softcradle.physics.contact import stored_energy
from softcradle.physics.fixed_step import runner as fixed_step
from softcradle.physics.fixed_step.step_loop import DISCRETE_GRADIENT, SPLITTING
from softcradle.physics.kernel_records import NO_FLAGS
from softcradle.physics.numerics.kernel_arithmetic import kernel_arithmetic
from softcradle.physics.numerics.records import COUNTERS, DONE, NO_KNOTS, SEPARATED
from softcradle.physics.problem import MOST_STEPS
from softcradle.physics.scales import velocity_room

Array = NDArray[np.float64]

PARTS_A_THREAD = 8  # at the least: chains differ in cost, so the last thread to finish should not have much left
MOST_AT_ONCE = 1024  # chains in a part, so that progress is told often, and a run that is stopped ends soon
LEAST_AT_ONCE = 16  # chains in a part


@dataclass(frozen=True)
class BatchRun:
    """The arrays of a run, and whether chains stop when they are apart."""

    data: BatchData
    moving: BatchMotion
    stop: bool

    @classmethod
    def of(cls, batch: ChainBatch, start: BatchStart, steps: Array, ends: Array, stop: bool) -> BatchRun:
        """Of a batch from its start, with `steps` and `ends` (C,) [s]."""
        count, contacts = start.overlap.shape
        data = BatchData(
            batch.law_rows, batch.loss.copy(), batch.inverse_mass, batch.drive.copy(), batch.bed, steps, ends
        )
        closed, counter = np.zeros((count, contacts), dtype=np.int8), np.zeros((count, COUNTERS), dtype=np.int64)
        motion = start.overlap, start.rate, start.anchor, start.force, closed, counter
        return cls(data, BatchMotion(*motion, np.zeros(count, dtype=np.int64), np.zeros(count)), stop)


@dataclass(frozen=True)
class Part:
    """Chains of a batch that are alike in what takes energy, what gives it, and their anchor bead."""

    chains: NDArray[np.int64]
    driven: bool
    lossy: bool
    braked: bool
    bead: int


def parts_of(batch: ChainBatch, threads: int) -> Iterator[Part]:
    """All chains of a batch in parts, for that many threads."""
    size = max(LEAST_AT_ONCE, min(MOST_AT_ONCE, batch.chains // (threads * PARTS_A_THREAD)))
    kinds = np.stack([batch.driven, batch.lossy, batch.on_bed, batch.anchor], axis=1)
    found, number = np.unique(kinds, axis=0, return_inverse=True)
    for k, (driven, lossy, braked, bead) in enumerate(found.tolist()):
        alike = np.flatnonzero(number.reshape(-1) == k)
        for first in range(0, alike.size, size):
            yield Part(alike[first : first + size], bool(driven), bool(lossy), bool(braked), int(bead))


def march_part(kernel: Any, method: str, run: BatchRun, part: Part) -> None:
    """Move the chains of a part to their ends by a method of fixed steps."""
    scratch = fixed_step.Scratch.of(method, run.moving.overlap.shape[1])
    kind = DISCRETE_GRADIENT if method == "conserving" else SPLITTING
    log = scratch.log
    with kernel_arithmetic():
        kernel(
            part.chains, kind, *fixed_step.DRIFTS_AND_KICKS[method], run.stop, fixed_step.MOST_STEPS, part.driven,
            True if part.lossy or part.braked else None, part.braked, part.bead, tuple(run.data), tuple(run.moving),
            tuple(scratch.spare), tuple(scratch.samples), log.contact, log.time, tuple(scratch.checkpoints),
            tuple(scratch.pause), np.zeros(4), NO_FLAGS, NO_KNOTS, scratch.beads, scratch.work,
        )  # fmt: skip


@dataclass(frozen=True)
class Accuracy:
    """What an adaptive method is asked for, and what it finds of its errors."""

    method: str
    tolerance: float
    scale: Array  # (C,) speed [m/s] that the tolerance is relative to
    budget: NDArray[np.int64]  # (C,) steps, rejected ones included
    grown: Array  # (C, n) growth of errors by the last bounce of each contact
    turns: Array  # (C, n) turns of the oscillation of each contact
    control: Array  # (C, 2) growth by those before, and the sum of squares of the errors of steps

    @classmethod
    def of(cls, batch: ChainBatch, method: str, tolerance: float, scale: Array) -> Accuracy:
        """With the budget of `step_budget` at the start: a chain that takes more steps is run again."""
        steps = MOST_STEPS if ALLOWED[method] == DOP853 else usual_budget(batch.contacts, tolerance)
        budget = np.full(batch.chains, steps, dtype=np.int64)
        grown, turns, control = (np.zeros((batch.chains, count)) for count in (batch.contacts, batch.contacts, 2))
        return cls(method, tolerance, scale, budget, grown, turns, control)

    def errors(self) -> tuple[Array, Array]:
        """(C,) the error [m/s] that each chain states, and the factor by which errors have grown."""
        growth = error_growth(self.control[:, 0], self.grown, self.turns)
        return DOUBT * growth * np.sqrt(self.control[:, 1]), growth


def integrate_part(kernel: Any, accuracy: Accuracy, run: BatchRun, part: Part) -> None:
    """Move the chains of a part as far as an adaptive method goes by itself."""
    n = run.moving.overlap.shape[1]
    effective = np.zeros((n, 3)), np.zeros(n + 1), np.zeros(n + 1)
    modes = tuple(np.zeros(count, dtype=np.int8) for count in (n, n, n + 1, n))
    dissipates = part.lossy or part.braked
    memory = tuple(map(tuple, (empty_trial(n), empty_trial(n), empty_scratch(n), empty_steps(0, n, dissipates))))
    log = np.zeros(0, dtype=np.int64), np.zeros(0)
    with kernel_arithmetic():
        kernel(
            part.chains, ALLOWED[accuracy.method], run.stop, accuracy.budget, accuracy.scale, accuracy.tolerance, part.driven,
            part.lossy, part.braked, part.bead, tuple(run.data), tuple(run.moving), effective, modes, *memory, *log,
            np.zeros(4), NO_KNOTS, accuracy.grown, accuracy.turns, accuracy.control,
        )  # fmt: skip


def needs_another_run(
    batch: ChainBatch, velocity: Array, moving: BatchMotion, error: Array, growth: Array
) -> NDArray[np.bool_]:
    """(C,) whether more than one run decides on a chain from its start `velocity` (C, n+1): it gave up, errors have grown, its
    contacts are very soft, or its energy allows no such error."""
    soft = (batch.preload == 0.0) & (batch.exponent < SOFTEST)
    stored = stored_energy(batch.preload, batch.stiffness, batch.exponent, 0.0 - batch.gap).sum(axis=1)
    _, room = velocity_room(batch.mass, batch.on_bed, velocity, stored, batch.drive, moving.time)
    room[np.isinf(batch.mass)] = np.inf
    gave_up = (moving.status != DONE) & (moving.status != SEPARATED)
    found: NDArray[np.bool_] = gave_up | (growth > MOST_GROWN) | soft.any(axis=1) | (error > room.min(axis=1))
    return found
