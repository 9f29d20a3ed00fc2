"""Chains of a batch by the adaptive methods, one after the other in compiled code; what takes several runs is left to `solve`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive.runner import SOFTEST, error_growth
from softcradle.physics.adaptive.step_records import (
    ALLOWED,
    DOP853,
    empty_scratch,
    empty_steps,
    empty_trial,
)
from softcradle.physics.adaptive.undetermined import DOUBT, MOST_GROWN
from softcradle.physics.adaptive.usual_budget import usual_budget
from softcradle.physics.batch.batch_parts import BatchRun, Part
from softcradle.physics.batch.chain_batch import ChainBatch
from softcradle.physics.batch.lockstep_loop import BatchMotion
from softcradle.physics.contact import stored_energy
from softcradle.physics.numerics.kernel_arithmetic import kernel_arithmetic
from softcradle.physics.numerics.records import DONE, SEPARATED
from softcradle.physics.problem import MOST_STEPS
from softcradle.physics.scales import velocity_room

Array = NDArray[np.float64]


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


def accuracy_of(batch: ChainBatch, method: str, tolerance: float, scale: Array) -> Accuracy:
    """With the budget of `step_budget` at the start: a chain that takes more steps is run again."""
    n = batch.contacts
    steps = MOST_STEPS if ALLOWED[method] == DOP853 else usual_budget(n, tolerance)
    budget = np.full(batch.chains, steps, dtype=np.int64)
    grown, turns, control = (np.zeros((batch.chains, count)) for count in (n, n, 2))
    return Accuracy(method, tolerance, scale, budget, grown, turns, control)


def run_part(kernel: Any, accuracy: Accuracy, run: BatchRun, part: Part) -> None:
    """Move the chains of a part as far as the method goes by itself."""
    n = run.moving.overlap.shape[1]
    effective = np.zeros((n, 3)), np.zeros(n + 1), np.zeros(n + 1)
    modes = tuple(np.zeros(count, dtype=np.int8) for count in (n, n, n + 1, n))
    rest = tuple(map(tuple, (empty_trial(n), empty_trial(n), empty_scratch(n), empty_steps(0, n, part.dissipates))))
    log = np.zeros(0, dtype=np.int64), np.zeros(0)
    with kernel_arithmetic():
        kernel(
            part.chains, ALLOWED[accuracy.method], run.stop, accuracy.budget, accuracy.scale, accuracy.tolerance, part.driven,
            part.lossy, part.braked, part.bead, tuple(run.data), tuple(run.moving), effective, modes, *rest, *log, np.zeros(2),
            accuracy.grown, accuracy.turns, accuracy.control,
        )  # fmt: skip


def errors(accuracy: Accuracy) -> tuple[Array, Array]:
    """(C,) the error [m/s] that each chain states, and the factor by which errors have grown."""
    growth = error_growth(accuracy.control[:, 0], accuracy.grown, accuracy.turns)
    return DOUBT * growth * np.sqrt(accuracy.control[:, 1]), growth


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
