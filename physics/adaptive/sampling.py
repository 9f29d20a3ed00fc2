"""Samples inside the steps of a run, taken when it is over: each is a shorter step of the method, or a flight.

A run keeps its steps, for without a duration it does not know before its end which samples are wanted.
"""

from __future__ import annotations

from softcradle.physics.adaptive.constants import ROUND_OFF, SAFETY
from softcradle.physics.adaptive.flight import bend_of, flight_work, flown
from softcradle.physics.adaptive.row_graphs import (
    ORIGIN,
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
from softcradle.physics.numerics.law_curve import BEFORE
from softcradle.physics.numerics.law_kernels import energy
from softcradle.physics.numerics.records import FROZEN, KEPT, SAMPLE, ChainData, Motion, Samples, SwitchLog
from softcradle.physics.numerics.switches import copy_into


@inlined
def absorbed_between(chain, regime, before, moved, end, path):
    """Energy [J] that (contacts, the bed) absorb while overlaps go from `before` to `end` (n,), and the anchor bead by `path`.

    `moved` (n+1,) is scratch memory. Modes are those of now, so what they absorb is a difference of potentials.
    """
    by_contacts, by_bed = 0.0, 0.0
    for i in range(regime.easing.size):
        if regime.easing[i] != 0:
            preload, stiffness, exponent, side = (
                regime.law[i, 0],
                regime.law[i, 1],
                regime.law[i, 2],
                side_of(regime, i),
            )
            way = regime.law[i, BEFORE] if regime.segment.size else 0.0
            fall = energy(preload, stiffness, exponent, way + side * before[i])
            fall -= energy(preload, stiffness, exponent, way + side * end[i])
            by_contacts += regime.loss[i] * fall
    if regime.bed.size:
        bead_paths(chain, before, end, path, moved)
        for j in range(moved.size):
            if regime.bed[j] > 0.0:
                by_bed += regime.slide[j] * regime.bed[j] / regime.inverse_mass[j] * moved[j]
    return by_contacts, by_bed


@inlined
def bead_paths(chain, before, end, path, moved):
    """Ways of the beads (n+1,) into `moved` while overlaps go from `before` to `end` (n,), and the anchor bead by `path`."""
    moved[chain.anchor_bead] = path
    for j in range(chain.anchor_bead - 1, -1, -1):
        moved[j] = moved[j + 1] + (end[j] - before[j])
    for j in range(chain.anchor_bead, before.size):
        moved[j + 1] = moved[j] - (end[j] - before[j])


@inlined
def changing_work(h, chain, regime, motion, trial, work):
    """(work of forces over time, what brakes absorb beyond their strength at the start) [J] in a step of length `h`.

    With x the way of a bead, a force p + s t gives it (p + s h) x - s times the integral of x, by the quintic through both ends.
    """
    moved, v0, v1, knots = work[0], work[1], work[2], chain.knots
    bead_paths(chain, motion.overlap, trial.overlap[2], trial.anchor[0] - motion.anchor[0], moved)
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
    """Keep the step or flight from `time` of `length` [s], with the motion at its start."""
    k = counter[KEPT]
    counter[KEPT] = k + 1
    steps.time[k], steps.length[k], steps.kind[k] = time, length, kind
    carry_step(True, k, chain, regime, motion, steps)


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
            passed = 0.0 if steps.kind[k] == RESTED else samples.time[counter[SAMPLE]] - steps.time[k]
            if steps.kind[k] == FLOWN or passed <= 0.0:  # before the step lies one of another method
                sample_flight(passed, chain, regime, motion, samples, counter[SAMPLE], scratch.work[0])
            else:
                sample_inside(passed, steps.kind[k], wanted, chain, regime, motion, trial, scratch, samples, log)
            count_from_touch(samples.overlap[counter[SAMPLE]], regime)
            counter[SAMPLE] += 1


@inlined
def shown_force(i, force, regime):
    """The force of contact i without what a law that goes on beyond d = 0 has there."""
    return min(force, 0.0) if side_of(regime, i) < 0.0 else max(force, 0.0)


@inlined
def count_from_touch(overlap, regime):
    """Let overlaps (n,) of couplers count from where they touch, no longer from the origins of their segments."""
    for i in range(regime.segment.size):
        overlap[i] += of_segment(regime, i, ORIGIN)


@piece
def sample_inside(passed, kind, wanted, chain, regime, motion, trial, scratch, samples, log):
    """Fill the next sample row, `passed` [s] after the start of a step, by a shorter step into `trial`.

    Where its stages do not converge, the step is made a little shorter and the rest drifts.
    """
    k, length, firm = log.counter[SAMPLE], passed, regime.bed.size > 0
    while take_step(length, kind, firm, chain, motion, wanted, trial, scratch, log) < 0.0:
        length *= SAFETY
        if length < ROUND_OFF * passed:
            break
    rest = passed - length
    for i in range(motion.mode.size):
        samples.overlap[k, i] = trial.overlap[2, i] + rest * trial.rate[2, i]
        samples.rate[k, i], samples.force[k, i] = trial.rate[2, i], shown_force(i, trial.force[2, i], regime)
    samples.anchor[k, 0] = trial.anchor[0] + rest * trial.anchor[1]
    samples.anchor[k, 1] = trial.anchor[1]
    path = samples.anchor[k, 0] - motion.anchor[0]
    absorbed = absorbed_between(chain, regime, motion.overlap, scratch.work[0], samples.overlap[k], path)
    samples.taken[k, 0] = motion.taken[0] + absorbed[0]
    samples.taken[k, 1] = motion.taken[1] + absorbed[1]
    if chain.knots.time.size:
        given, braked = changing_work(length, chain, regime, motion, trial, scratch.work)
        samples.taken[k, 1] += braked
        samples.taken[k, 2] = motion.taken[2] + given


@piece
def sample_flight(passed, chain, regime, motion, samples, k, velocity):
    """Fill sample row k, `passed` [s] after the start of a flight."""
    n = motion.mode.size
    for i in range(n):
        length = passed if motion.mode[i] != FROZEN else 0.0
        samples.overlap[k, i] = flown(motion.overlap[i], motion.rate[i], bend_of(chain, i), length)
        samples.rate[k, i] = motion.rate[i] + length * bend_of(chain, i)
        samples.force[k, i] = shown_force(i, motion.force[i], regime)
    bend = bend_of(chain, n) if passed > 0.0 else 0.0
    samples.anchor[k, 0] = motion.anchor[0] + passed * (motion.anchor[1] + 0.5 * passed * bend)
    samples.anchor[k, 1] = motion.anchor[1] + passed * bend
    copy_into(samples.taken[k], motion.taken)
    if regime.bed.size and passed > 0.0:
        samples.taken[k, 1] += flight_work(passed, chain, regime, motion, velocity)
