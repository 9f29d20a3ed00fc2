"""Kernels that run one chain of a batch after the other: any method of fixed steps, and the adaptive ones."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive.adaptive_loop import integrate
from softcradle.physics.adaptive.step_records import GROWTH, LOCAL_SQUARE, Scratch, Trial
from softcradle.physics.fixed_step.step_loop import march
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.records import Dissipation

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

NEVER = 2**62  # steps: a run is not interrupted


class BatchData(NamedTuple):
    """What does not move: a row a chain."""

    law: Array  # (C, n, 3)
    loss: Array  # (C, n)
    inverse_mass: Array  # (C, n+1)
    push: Array  # (C, n+1)
    bed: Array  # (C, n+1)
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


@jit
def march_each(
    which, kind, drifts, kicks, stop, most_steps, driven, dissipates, braked, bead, batch_fields, motion_fields,
    spare_fields, sample_fields, contact, switch_time, checkpoint_fields, pause_fields, taken, flags, knots, beads, work,
):  # fmt: skip
    """`march` for each of the chains `which`; all have the anchor bead `bead`, and `dissipates` is None where none does."""
    batch, moving = BatchData(*batch_fields), BatchMotion(*motion_fields)
    for k in range(which.size):
        c = which[k]
        push, bed = batch.push[c], batch.bed[c]
        push = push if driven else push[:0]
        chain = batch.law[c], batch.inverse_mass[c], push, push, bead, None, None, knots
        motion = moving.overlap[c], moving.rate[c], moving.anchor[c], moving.force[c], taken, flags, flags
        log = contact, switch_time, moving.closed[c], moving.counter[c]
        if dissipates is None:
            moving.status[c], moving.time[c] = march(
                kind, drifts, kicks, batch.step[c], 0.0, batch.end[c], stop, most_steps, chain, None, motion,
                spare_fields, sample_fields, log, checkpoint_fields, pause_fields, beads, work,
            )  # fmt: skip
        else:
            dissipation = Dissipation(batch.loss[c], bed if braked else bed[:0])
            moving.status[c], moving.time[c] = march(
                kind, drifts, kicks, batch.step[c], 0.0, batch.end[c], stop, most_steps, chain, dissipation, motion,
                spare_fields, sample_fields, log, checkpoint_fields, pause_fields, beads, work,
            )  # fmt: skip


@inlined
def clear_row(row):
    """Put zeros into a row."""
    for i in range(row.size):
        row[i] = 0.0


@inlined
def clear_rows(rows):
    """Put zeros into rows."""
    for k in range(rows.shape[0]):
        for i in range(rows.shape[1]):
            rows[k, i] = 0.0


@jit
def clear_trial(trial):
    """Make the memory of a step tried as it is before the first."""
    clear_rows(trial.overlap)
    clear_rows(trial.rate)
    clear_rows(trial.force)
    clear_row(trial.anchor)


@jit
def clear_scratch(scratch):
    """Make the memory of the steps as it is before the first."""
    clear_row(scratch.control)
    clear_rows(scratch.past)
    clear_row(scratch.opening)
    clear_row(scratch.opened)
    clear_row(scratch.lateness)
    clear_row(scratch.grown)
    clear_row(scratch.most_grown)
    clear_rows(scratch.along)
    clear_rows(scratch.across)
    clear_rows(scratch.correction)
    clear_rows(scratch.block)
    clear_rows(scratch.acceleration)
    clear_row(scratch.anchor_acceleration)
    clear_rows(scratch.work)
    clear_rows(scratch.bounds)
    clear_rows(scratch.knots)
    clear_row(scratch.course)
    clear_row(scratch.turns)


@jit
def integrate_each(
    which, allowed, stop, most_steps, scale, tolerance, driven, lossy, braked, bead, batch_fields, motion_fields,
    effective, modes, trial_fields, look_fields, scratch_fields, steps_fields, contact, switch_time, taken,
    knots, grown, turns, control,
):  # fmt: skip
    """`integrate` for each of the chains `which`; all have the anchor bead `bead`.

    `effective` are arrays (n, 3), (n+1,), (n+1,) for the chain of the steps, `modes` (n,), (n,), (n+1,), (n,) flags. The
    rows of `grown` (C, n) get the growth of errors by the last bounces, those of `turns` (C, n) the turns of oscillations, those
    of `control` (C, 2) the growth by earlier bounces and the sum of squares of the errors of steps.
    """
    batch, moving = BatchData(*batch_fields), BatchMotion(*motion_fields)
    trial, look, scratch = Trial(*trial_fields), Trial(*look_fields), Scratch(*scratch_fields)
    law, inverse_mass, external = effective
    mode, held, slide, easing = modes
    n = mode.size
    for k in range(which.size):
        c = which[k]
        clear_trial(trial)
        clear_trial(look)
        clear_scratch(scratch)
        clear_row(taken)
        for i in range(n):
            mode[i], held[i], easing[i] = 0, 0, 0
            law[i, 0], law[i, 1], law[i, 2] = batch.law[c, i, 0], batch.law[c, i, 1], batch.law[c, i, 2]
        for j in range(n + 1):
            slide[j], inverse_mass[j] = 0, batch.inverse_mass[c, j]
            external[j] = batch.push[c, j] * batch.inverse_mass[c, j]
        last = external[bead]
        for i in range(n):
            external[i] = external[i] - external[i + 1]
        external[n] = last
        push, bed, loss = batch.push[c], batch.bed[c], batch.loss[c]
        push = push if driven else push[:0]
        forced = external if driven or braked else external[:0]
        chain = law, inverse_mass, push, forced, bead, None, None, knots
        regime = (
            batch.law[c], batch.inverse_mass[c], push, loss if lossy else loss[:0], bed if braked else bed[:0],
            slide if braked else slide[:0], easing if lossy else easing[:0], easing[:0], law[:0], which[:0],
        )  # fmt: skip
        motion = moving.overlap[c], moving.rate[c], moving.anchor[c], moving.force[c], taken, mode, held
        log = contact, switch_time, moving.closed[c], moving.counter[c]
        moving.status[c], moving.time[c] = integrate(
            allowed, False, 0.0, batch.end[c], stop, most_steps[c], NEVER, scale[c], tolerance, chain, regime, motion,
            trial_fields, look_fields, scratch_fields, steps_fields, log,
        )  # fmt: skip
        for i in range(n):
            grown[c, i] = scratch.grown[i]
            turns[c, i] = scratch.turns[i]
        control[c, 0], control[c, 1] = scratch.control[GROWTH], scratch.control[LOCAL_SQUARE]
