"""Samples inside the steps of a run, taken when it is over: each is a shorter step of the method, or a flight.

A run keeps its steps, for without a duration it does not know before its end which samples are wanted.
"""

from __future__ import annotations

from softcradle.physics.adaptive.constants import ROUND_OFF, SAFETY
from softcradle.physics.adaptive.flight import drift
from softcradle.physics.adaptive.row_graphs import (
    bead_acceleration,
    of_segment,
    put_drive,
    put_segment,
    side_of,
)
from softcradle.physics.adaptive.step_control import take_step
from softcradle.physics.adaptive.step_records import FLOWN, RESTED, Regime, Scratch, Steps, Trial
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.jit import inlined, piece, whole
from softcradle.physics.numerics.law_curve import LAW_BEFORE
from softcradle.physics.numerics.law_kernels import energy
from softcradle.physics.numerics.records import (
    FROZEN,
    KEPT,
    ORIGIN,
    SAMPLE,
    TOUCHING,
    ChainData,
    Motion,
    Samples,
    SwitchLog,
)
from softcradle.physics.numerics.switches import copy_into, copy_motion, row_of


@inlined
def absorb(h, chain, regime, motion, trial, work, taken):
    """Add to `taken` (4,) [J] what contacts and bed absorb in the step of length `h` to the `trial`, and the work of forces.

    Modes are those of now, so what is absorbed is a difference of potentials; `work` (3 or more, n+1) is scratch memory.
    """
    by_contacts, by_bed, moved, law = 0.0, 0.0, work[0], regime.law
    for i in range(regime.easing.size):
        if regime.easing[i] != 0:
            side, way = side_of(regime, i), law[i, LAW_BEFORE] if regime.segment.size else 0.0
            fall = energy(law[i, 0], law[i, 1], law[i, 2], way + side * motion.overlap[i])
            fall -= energy(law[i, 0], law[i, 1], law[i, 2], way + side * trial.overlap[2, i])
            by_contacts += regime.loss[i] * fall
    if regime.bed.size or chain.knots.time.size:
        n = motion.mode.size
        for i in range(n):
            work[1, i] = trial.overlap[2, i] - motion.overlap[i]
        bead_velocities(work[1, :n], chain.anchor_bead, trial.anchor[0] - motion.anchor[0], moved)
    for j in range(regime.bed.size):
        if regime.bed[j] > 0.0:
            by_bed += regime.slide[j] * regime.bed[j] / regime.inverse_mass[j] * moved[j]
    taken[0] += by_contacts
    taken[1] += by_bed
    if chain.knots.time.size:
        given, braked = changing_work(h, chain, regime, motion, trial, work)
        taken[1] += braked
        taken[2] += given


@inlined
def changing_work(h, chain, regime, motion, trial, work):
    """(work of forces over time, what brakes absorb beyond their strength at the start) [J] in a step of length `h`.

    With x the way of a bead, in the first row of `work`, a force p + s t gives it (p + s h) x - s times the integral of x, by the
    quintic through both ends.
    """
    moved, v0, v1, knots = work[0], work[1], work[2], chain.knots
    bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], v0)
    bead_velocities(trial.rate[2], chain.anchor_bead, trial.anchor[1], v1)
    given, braked = 0.0, 0.0
    for j in range(moved.size):
        if chain.inverse_mass[j] > 0.0:
            bend = bead_acceleration(j, chain, regime, motion.force, 0.0)
            bend += bead_acceleration(j, chain, regime, trial.force[2], h)
            late = h * (0.5 * moved[j] - h * (0.1 * (v0[j] - v1[j]) + h / 120.0 * bend))
            given += (chain.push[j] - knots.drive[j]) * moved[j] + knots.push_slope[j] * late
            if regime.bed.size and knots.brake_slope.size:
                braked += regime.slide[j] * knots.brake_slope[j] / regime.inverse_mass[j] * late
    return given, braked


@inlined
def carry(keeps, row, at, values):
    """Copy `values` (k,) into `row` from `at` on where it `keeps`, else out of it; returns where they end."""
    for i in range(values.size):
        if keeps:
            row[at + i] = values[i]
        else:
            values[i] = row[at + i]
    return at + values.size


@inlined
def carry_step(keeps, k, chain, regime, motion, steps):
    """Put row k of `steps` there where it `keeps`, else into the motion and, where something dissipates, the effective chain."""
    row, flags = steps.values[k], steps.flags[k]
    at = carry(keeps, row, carry(keeps, row, 0, motion.force), motion.overlap)
    at = carry(keeps, row, carry(keeps, row, at, motion.rate), motion.anchor)
    at, end = carry(keeps, row, at, motion.taken), carry(keeps, flags, 0, motion.mode)
    if regime.bed.size or regime.easing.size:
        for i in range(motion.mode.size):
            at = carry(keeps, row, at, chain.law[i])
        at = carry(keeps, row, carry(keeps, row, at, chain.inverse_mass), chain.external)
        end = carry(keeps, flags, carry(keeps, flags, end, regime.slide), regime.easing)
        for i in range(regime.segment.size):
            if keeps:
                flags[end + i] = regime.segment[i]
            else:
                overlap = motion.overlap[i]
                put_segment(i, flags[end + i], regime, motion)
                motion.overlap[i] = overlap


@inlined
def keep_step(time, length, kind, chain, regime, motion, steps, counter):
    """Keep the step or flight from `time` of `length` [s], with the motion at its start, where steps are kept."""
    if steps.time.size:
        k = counter[KEPT]
        counter[KEPT] = k + 1
        steps.time[k], steps.length[k], steps.kind[k] = time, length, kind
        carry_step(True, k, chain, regime, motion, steps)


@inlined
def accept_step(motion, trial):
    """Make the end of the trial the motion."""
    for i in range(motion.mode.size):
        motion.overlap[i], motion.rate[i], motion.force[i] = trial.overlap[2, i], trial.rate[2, i], trial.force[2, i]
        motion.held[i] = 0
        if motion.mode[i] == TOUCHING or motion.mode[i] == FROZEN:
            motion.rate[i] = 0.0
    copy_into(motion.anchor, trial.anchor)


@whole
def sample_steps(
    count, wanted, chain_fields, regime_fields, motion_fields, trial_fields, scratch_fields, steps_fields, sample_fields,
    log_fields,
):  # fmt: skip
    """Fill the rows of all samples before the end of the last of `count` steps; `wanted` [m/s] was their error bound."""
    chain, regime, motion = ChainData(*chain_fields), Regime(*regime_fields), Motion(*motion_fields)
    trial, scratch, steps = Trial(*trial_fields), Scratch(*scratch_fields), Steps(*steps_fields)
    samples, log = Samples(*sample_fields), SwitchLog(*log_fields)
    counter = log.counter
    for k in range(count):
        end = steps.time[k] + steps.length[k]
        if counter[SAMPLE] < samples.time.size and samples.time[counter[SAMPLE]] < end:
            carry_step(False, k, chain, regime, motion, steps)
            if chain.knots.time.size:
                put_drive(steps.time[k], chain, regime)
        while counter[SAMPLE] < samples.time.size and samples.time[counter[SAMPLE]] < end:
            row = row_of(samples, counter[SAMPLE], motion)
            copy_motion(row, motion)
            passed = 0.0 if steps.kind[k] == RESTED else max(samples.time[counter[SAMPLE]] - steps.time[k], 0.0)
            if steps.kind[k] == FLOWN or passed == 0.0:
                drift(passed, chain, regime, row, scratch.work[0])
            else:
                move_inside(passed, steps.kind[k], wanted, chain, regime, motion, trial, scratch, row, log)
            for i in range(row.force.size):  # without what a law that goes on beyond d = 0 has there
                row.force[i] = min(row.force[i], 0.0) if side_of(regime, i) < 0.0 else max(row.force[i], 0.0)
            count_from_touch(row.overlap, regime)
            counter[SAMPLE] += 1


@inlined
def count_from_touch(overlap, regime):
    """Let overlaps (n,) of couplers count from where they touch, no longer from the origins of their segments."""
    for i in range(regime.segment.size):
        overlap[i] += of_segment(regime, i, ORIGIN)


@piece
def move_inside(passed, kind, wanted, chain, regime, motion, trial, scratch, row, log):
    """Move `row`, a copy of the motion at the start of a step, on by `passed` [s] in it: by a shorter step into `trial`.

    Where its stages do not converge, the step is made a little shorter and the rest drifts.
    """
    length, firm = passed, regime.bed.size > 0
    while take_step(length, kind, firm, chain, motion, wanted, trial, scratch, log) < 0.0:
        length *= SAFETY
        if length < ROUND_OFF * passed:
            break
    rest = passed - length
    for i in range(motion.mode.size):
        trial.overlap[2, i] += rest * trial.rate[2, i]
    trial.anchor[0] += rest * trial.anchor[1]
    accept_step(row, trial)
    absorb(length, chain, regime, motion, trial, scratch.work, row.taken)
