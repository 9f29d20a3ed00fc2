"""Chains of a batch by the methods of fixed steps: explicit ones side by side in vector lanes, the rest one after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.batch.batch_parts import BatchRun, Part
from softcradle.physics.batch.lockstep_loop import empty_state, march_lanes
from softcradle.physics.batch.lockstep_steps import LANES, empty_lanes
from softcradle.physics.batch.run_each import march_each
from softcradle.physics.fixed_step.explicit_steps_simd import LONG
from softcradle.physics.fixed_step.runner import DRIFTS_AND_KICKS, MOST_STEPS, Scratch
from softcradle.physics.fixed_step.step_loop import DISCRETE_GRADIENT, SPLITTING, SPLITTING_SIMD
from softcradle.physics.kernel_records import NO_FLAGS
from softcradle.physics.numerics.float_bits import COMPILED
from softcradle.physics.numerics.kernel_arithmetic import kernel_arithmetic

LOCKSTEP_METHODS = ("euler", "verlet", "yoshida4")
LEAST_AT_ONCE = 8 * LANES  # chains in a part: lanes that run out of chains are a small share of its work


def in_lockstep(method: str, contacts: int) -> bool:
    """Whether chains are stepped side by side: long ones have vector code of their own, plain Python has none."""
    return method in LOCKSTEP_METHODS and contacts < LONG and COMPILED


def kernel_of(method: str, contacts: int) -> Any:
    """The kernel that moves chains of so many contacts."""
    return march_lanes if in_lockstep(method, contacts) else march_each


def run_part(kernel: Any, method: str, run: BatchRun, part: Part) -> None:
    """Move the chains of a part to their ends."""
    drifts, kicks = DRIFTS_AND_KICKS[method]
    contacts = run.moving.overlap.shape[1]
    which: NDArray[np.int64] = part.chains
    records = tuple(run.data), tuple(run.moving)
    kinds = part.driven, part.dissipates, part.braked, part.bead
    with kernel_arithmetic():
        if in_lockstep(method, contacts):
            lanes, state = tuple(empty_lanes(contacts)), tuple(empty_state(contacts))
            kernel(which, drifts, kicks, run.stop, MOST_STEPS, *kinds, *records, lanes, state)
            return
        scratch = Scratch.of(method, contacts)
        vectors = method != "conserving" and contacts >= LONG and not part.dissipates
        kind = DISCRETE_GRADIENT if method == "conserving" else SPLITTING_SIMD if vectors else SPLITTING
        log = scratch.log
        kernel(
            which, kind, drifts, kicks, run.stop, MOST_STEPS, part.driven, True if part.dissipates else None, part.braked,
            part.bead, *records, tuple(scratch.spare), tuple(scratch.samples), log.contact, log.time,
            tuple(scratch.checkpoints), tuple(scratch.pause), np.zeros(2), NO_FLAGS, scratch.beads, scratch.work,
        )  # fmt: skip
