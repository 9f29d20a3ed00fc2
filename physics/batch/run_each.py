"""Kernels that run one chain of a batch after the other, with any fixed-step or adaptive method.

They call the kernels of single runs through their entry points, so each of these is compiled only once for both uses.
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

NO_PAUSE = False, 2**62  # The run is not resumed and never interrupted.


class BatchData(NamedTuple):
    """Constant data of the chains, one row per chain."""

    law: Array  # (C, n, 3) preload, stiffness, exponent
    loss: Array  # (C, n) hysteretic loss
    inverse_mass: Array  # (C, n+1) inverse masses [1/kg]
    bed: Array  # (C, n+1) decelerations of sliding beads [m/s²]
    anchor_bead: Whole  # (C,) index of the anchor bead
    lossy: NDArray[np.bool_]  # (C,) True if a contact has loss
    braked: NDArray[np.bool_]  # (C,) True if the bed brakes beads
    step: Array  # (C,) time step [s]; 0 for adaptive methods
    end: Array  # (C,) end time [s]; infinity means until the beads separate


class BatchMotion(NamedTuple):
    """State of the chains during the run, and its result, one row per chain."""

    overlap: Array  # (C, n) overlaps [m]
    rate: Array  # (C, n) rates of the overlaps [m/s]
    anchor: Array  # (C, 2) position [m] and velocity [m/s] of the anchor bead
    force: Array  # (C, n) contact forces [N]
    closed: NDArray[np.int8]  # (C, n) 1 if the contact is closed
    counter: Whole  # (C, COUNTERS) counters such as steps and evaluations
    status: Whole  # (C,) status of the run
    time: Array  # (C,) end time of the run [s]


@inlined
def march_arguments(c, stepper, stop, most_steps, batch_fields, motion_fields, memory, nothing):
    """Return the arguments of `march` for chain c.

    `stepper` is (drifts, kicks). `memory` contains the fields of Samples, the columns of the log, the checkpoints, the
    fields of a Pause, the absorbed energies, and the memory of the steps. `nothing` contains empty flags, Graphs,
    Knots and Strings.
    """
    batch, moving = BatchData(*batch_fields), BatchMotion(*motion_fields)
    sample_fields, switches, checkpoints, pause_fields, taken, of_steps = memory
    (flags, graph, knots, strings), (drifts, kicks) = nothing, stepper
    loss, bed = batch.loss[c], batch.bed[c]
    none, braked = bed[:0], batch.braked[c]
    dissipation = Dissipation(loss if batch.lossy[c] or braked else loss[:0], bed if braked else none)
    chain = batch.law[c], batch.inverse_mass[c], none, none, batch.anchor_bead[c], graph, knots, dissipation, strings
    motion = moving.overlap[c], moving.rate[c], moving.anchor[c], moving.force[c], taken, flags, flags
    log = switches[0], switches[1], moving.closed[c], moving.counter[c]
    return (
        (drifts, kicks, batch.step[c]), (0.0, batch.end[c], stop, most_steps), chain, motion, sample_fields, log, checkpoints,
        pause_fields, of_steps,
    )  # fmt: skip


@jit
def march_each(entry, which, stepper, stop, most_steps, batch_fields, motion_fields, memory, nothing):
    """Run `march`, whose entry point is `entry`, for each of the chains `which`.

    The other arguments are those of `march_arguments`.
    """
    moving = BatchMotion(*motion_fields)
    for k in range(which.size):
        c = which[k]
        moving.status[c], moving.time[c] = called_at(
            entry, march_arguments(c, stepper, stop, most_steps, batch_fields, motion_fields, memory, nothing)
        )


@inlined
def clear(row):
    """Set a row to zero."""
    for i in range(row.size):
        row[i] = 0


@inlined
def integrate_arguments(c, accuracy, stop, most_steps, batch_fields, motion_fields, memory, nothing):
    """Return the arguments of `integrate` for chain c. Copy its laws and masses into the memory, and clear the rest of
    the memory.

    `accuracy` is (allowed, tolerance, scales (C,)). `memory` contains four arrays (n, 3), (n+1,), (n+1,) and (4,) for
    the effective chain of the steps and the absorbed energies, flags (4n+1,) for the modes, one block, and the records
    whose fields are views into that block: two Trials, a Scratch and Steps. `nothing` contains empty columns of a log,
    empty Graphs, Knots and Strings, and a pause that never occurs.
    """
    batch, moving = BatchData(*batch_fields), BatchMotion(*motion_fields)
    allowed, tolerance, scale = accuracy
    (law, inverse_mass, external, taken), flags, block, (trial, look, scratch, steps) = memory
    contact, switch_time, graph, knots, strings, pause = nothing
    none, n = external[:0], law.shape[0]
    mode, held, easing, slide = flags[:n], flags[n : 2 * n], flags[2 * n : 3 * n], flags[3 * n :]
    # The memory still contains values of the previous chain of this thread.
    clear(block)
    clear(flags)
    clear(taken)
    # The steps work on an effective chain, in which modes change laws and masses. It starts as a copy of the chain.
    for j in range(n + 1):
        inverse_mass[j], external[j] = batch.inverse_mass[c, j], 0.0
    for i in range(n):
        for column in range(3):
            law[i, column] = batch.law[c, i, column]
    # Empty arrays for loss and friction select the faster code paths without them.
    lossy, braked = batch.lossy[c], batch.braked[c]
    bed, loss = batch.bed[c] if braked else none, batch.loss[c] if lossy else none
    chain = (
        law, inverse_mass, none, external if braked else none, batch.anchor_bead[c], graph, knots,
        Dissipation(none, none), strings,
    )  # fmt: skip
    # The regime contains the unchanged chain and the directions of sliding and of unloading.
    regime = (
        batch.law[c], batch.inverse_mass[c], loss, bed, slide if braked else slide[:0],
        easing if lossy else easing[:0], easing[:0],
    )  # fmt: skip
    motion = moving.overlap[c], moving.rate[c], moving.anchor[c], moving.force[c], taken, mode, held
    log = contact, switch_time, moving.closed[c], moving.counter[c]
    return (
        (0.0, batch.end[c], stop, most_steps), pause, (allowed, tolerance, scale[c]), chain, regime, motion, trial, look, scratch,
        steps, log,
    )  # fmt: skip


@jit
def integrate_each(entry, which, accuracy, stop, most_steps, batch_fields, motion_fields, memory, nothing, errors):
    """Run `integrate`, whose entry point is `entry`, for each of the chains `which`.

    The other arguments are those of `integrate_arguments`. `errors` are three arrays for the error estimate. The first
    (C, n) receives the error amplification by the last bounces. The second (C, n) receives the turns of oscillations.
    The third (C, 2) receives the error amplification by other bounces and the sum of the squared errors of the steps.
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
