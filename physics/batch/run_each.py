"""Kernels that run one chain of a batch after the other: any method of fixed steps, and the adaptive ones.

They call the kernels of single runs by their entries, so that these are compiled once for both.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive.step_records import ENDING, GROWTH, LOCAL_SQUARE, Scratch
from softcradle.physics.numerics.jit import called_at, inlined, jit
from softcradle.physics.numerics.records import Dissipation

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

NO_PAUSE = False, 2**62  # no run is resumed, and none is interrupted


class BatchData(NamedTuple):
    """What does not move: a row a chain."""

    law: Array  # (C, n, 3)
    loss: Array  # (C, n)
    inverse_mass: Array  # (C, n+1)
    bed: Array  # (C, n+1)
    anchor_bead: Whole  # (C,)
    lossy: NDArray[np.bool_]  # (C,)
    braked: NDArray[np.bool_]  # (C,)
    step: Array  # (C,) [s]; 0 for adaptive methods
    end: Array  # (C,) [s]; inf: none


class BatchMotion(NamedTuple):
    """What moves, and what the end is: a row a chain."""

    overlap: Array  # (C, n)
    rate: Array  # (C, n)
    anchor: Array  # (C, 2)
    force: Array  # (C, n)
    closed: NDArray[np.int8]  # (C, n)
    counter: Whole  # (C, COUNTERS)
    status: Whole  # (C,)
    time: Array  # (C,) when the run ended


@inlined
def march_arguments(c, stepper, stop, most_steps, batch_fields, motion_fields, memory, nothing):
    """What `march` is called with for chain c.

    `stepper` is (drifts, kicks); `memory` holds the fields of Samples, columns of the log, checkpoints, the fields of a Pause,
    energies taken, and the memory of steps; `nothing` flags, Joints and Knots without rows.
    """
    batch, moving = BatchData(*batch_fields), BatchMotion(*motion_fields)
    sample_fields, switches, checkpoints, pause_fields, taken, of_steps = memory
    (flags, joints, knots), (drifts, kicks) = nothing, stepper
    loss, bed = batch.loss[c], batch.bed[c]
    none, braked = bed[:0], batch.braked[c]
    dissipation = Dissipation(loss if batch.lossy[c] or braked else loss[:0], bed if braked else none)
    chain = batch.law[c], batch.inverse_mass[c], none, none, batch.anchor_bead[c], None, joints, knots, dissipation
    motion = moving.overlap[c], moving.rate[c], moving.anchor[c], moving.force[c], taken, flags, flags
    log = switches[0], switches[1], moving.closed[c], moving.counter[c]
    return (
        (drifts, kicks, batch.step[c]), (0.0, batch.end[c], stop, most_steps), chain, motion, sample_fields, log, checkpoints,
        pause_fields, of_steps,
    )  # fmt: skip


@jit
def march_each(entry, which, stepper, stop, most_steps, batch_fields, motion_fields, memory, nothing):
    """`march`, whose `entry` this is, for each of the chains `which`."""
    moving = BatchMotion(*motion_fields)
    for k in range(which.size):
        c = which[k]
        moving.status[c], moving.time[c] = called_at(
            entry, march_arguments(c, stepper, stop, most_steps, batch_fields, motion_fields, memory, nothing)
        )


@inlined
def clear(row):
    """Put zeros into a row."""
    for i in range(row.size):
        row[i] = 0


@inlined
def integrate_arguments(c, accuracy, stop, most_steps, batch_fields, motion_fields, memory, nothing):
    """What `integrate` is called with for chain c; the chain of its steps is put into the memory, and the rest of that cleared.

    `accuracy` is (allowed, tolerance, scales (C,)). `memory` holds arrays (n, 3), (n+1,), (n+1,) and (4,) for the chain of the
    steps and what is absorbed, flags (4n+1,) for the modes, and one block with the fields of the records that follow it: two
    Trials, a Scratch and Steps. `nothing` are columns of a log, Joints and Knots without rows, and a pause that never comes.
    """
    batch, moving = BatchData(*batch_fields), BatchMotion(*motion_fields)
    allowed, tolerance, scale = accuracy
    (law, inverse_mass, external, taken), flags, block, (trial, look, scratch, steps) = memory
    contact, switch_time, joints, knots, pause = nothing
    none, n = external[:0], law.shape[0]
    mode, held, easing, slide = flags[:n], flags[n : 2 * n], flags[2 * n : 3 * n], flags[3 * n :]
    clear(block)
    clear(flags)
    clear(taken)
    for j in range(n + 1):
        inverse_mass[j], external[j] = batch.inverse_mass[c, j], 0.0
    for i in range(n):
        for column in range(3):
            law[i, column] = batch.law[c, i, column]
    lossy, braked = batch.lossy[c], batch.braked[c]
    bed, loss = batch.bed[c] if braked else none, batch.loss[c] if lossy else none
    chain = (
        law, inverse_mass, none, external if braked else none, batch.anchor_bead[c], None, joints, knots,
        Dissipation(none, none),
    )  # fmt: skip
    regime = (
        batch.law[c], batch.inverse_mass[c], loss, bed, slide if braked else slide[:0],
        easing if lossy else easing[:0], easing[:0], law[:0], contact[:0],
    )  # fmt: skip
    motion = moving.overlap[c], moving.rate[c], moving.anchor[c], moving.force[c], taken, mode, held
    log = contact, switch_time, moving.closed[c], moving.counter[c]
    return (
        (0.0, batch.end[c], stop, most_steps), pause, (allowed, tolerance, scale[c]), chain, regime, motion, trial, look, scratch,
        steps, log,
    )  # fmt: skip


@jit
def integrate_each(entry, which, accuracy, stop, most_steps, batch_fields, motion_fields, memory, nothing, errors):
    """`integrate`, whose `entry` this is, for each of the chains `which`.

    Of `errors`, the rows of the first (C, n) get the growth by the last bounces, those of the second (C, n) the turns of
    oscillations, those of the third (C, 2) the growth by other bounces and the sum of squares of the errors of steps.
    """
    moving, scratch = BatchMotion(*motion_fields), Scratch(*memory[3][2])
    grown, turns, control = errors
    for k in range(which.size):
        c = which[k]
        moving.status[c], moving.time[c] = called_at(
            entry, integrate_arguments(c, accuracy, stop, most_steps, batch_fields, motion_fields, memory, nothing)
        )
        for i in range(grown.shape[1]):
            grown[c, i], turns[c, i] = scratch.grown[i], scratch.turns[i]
        control[c, 0], control[c, 1] = scratch.control[GROWTH] + scratch.control[ENDING], scratch.control[LOCAL_SQUARE]
