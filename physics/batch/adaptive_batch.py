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
from softcradle.physics.numerics.kernel_arithmetic import kernel_arithmetic
from softcradle.physics.numerics.records import DONE, SEPARATED
from softcradle.physics.problem import MOST_STEPS

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


def accuracy_of(
    batch: ChainBatch, method: str, tolerance: float, scale: Array, times: Array, durations: Array
) -> Accuracy:
    """With the budget of `step_budget` for contacts that take `times` (C, n) [s]."""
    n = batch.contacts
    budget = np.full(batch.chains, MOST_STEPS, dtype=np.int64)
    if ALLOWED[method] != DOP853:
        passes = np.where(np.isfinite(durations), durations, 0.0) / times.max(axis=1)
        budget = np.minimum(usual_budget(n, tolerance, passes), MOST_STEPS).astype(np.int64)
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


def needs_another_run(batch: ChainBatch, status: NDArray[np.int64], growth: Array) -> NDArray[np.bool_]:
    """(C,) whether more than one run decides on a chain: it gave up, errors have grown, or contacts are very soft."""
    soft = (batch.preload == 0.0) & (batch.exponent < 1.0)
    driven = batch.driven & soft.any(axis=1)
    softest = (soft & (batch.exponent < SOFTEST)).any(axis=1)
    found: NDArray[np.bool_] = ((status != DONE) & (status != SEPARATED)) | (growth > MOST_GROWN) | driven | softest
    return found
