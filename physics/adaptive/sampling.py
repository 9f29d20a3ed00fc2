"""Dense output of adaptive runs, and the energy balance of a step.

A sample inside a stored step is computed by a shorter step of the same method, or by a flight. A run stores its steps
because without a duration the sample times are known only at its end.
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
from softcradle.physics.adaptive.step_records import (
    DISPLACEMENT,
    FLOWN,
    OVERLAP_CHANGE,
    PLACE_AFTER,
    PLACE_BEFORE,
    RESTED,
    VELOCITY,
    VELOCITY_AFTER,
    VELOCITY_BEFORE,
    Regime,
    Scratch,
    StepContext,
    Steps,
    Trial,
    bounds_of,
)
from softcradle.physics.numerics.bead_velocities import bead_displacements, bead_velocities
from softcradle.physics.numerics.jit import inlined, piece, whole
from softcradle.physics.numerics.law_curve import LAW_BEFORE
from softcradle.physics.numerics.law_kernels import energy_fall
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
    """Add the energies [J] of the step of length `h` to `taken` (4,): dissipated by contacts, by the bed, and the work
    of forces over time.

    `trial` is the end of the step. The modes are those during the step, so the dissipated energy is a difference of
    potentials. `work` (WORK_ROWS, n+1) is scratch memory.
    """
    by_contacts, by_bed, moved, law = 0.0, 0.0, work[DISPLACEMENT], regime.law
    # An unloading contact dissipates the fraction `loss` of the energy that its power law releases.
    for i in range(regime.easing.size):
        if regime.easing[i] != 0:
            side, way = side_of(regime, i), law[i, LAW_BEFORE] if regime.segment.size else 0.0
            fall = energy_fall(law[i], way + side * motion.overlap[i], way + side * trial.overlap[2, i])
            by_contacts += regime.loss[i] * fall
    # Displacements of the beads, from the changes of the overlaps and of the anchor bead.
    if regime.bed.size or chain.knots.time.size:
        n = motion.mode.size
        for i in range(n):
            work[OVERLAP_CHANGE, i] = trial.overlap[2, i] - motion.overlap[i]
        bead_velocities(work[OVERLAP_CHANGE, :n], chain.anchor_bead, trial.anchor[0] - motion.anchor[0], moved)
    # Kinetic friction is steady within a step: its work is force times displacement.
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
    """Return two energies [J] of a step of length `h`: the work of forces over time, and the energy dissipated because
    brakes change in the step.

    A force p + s t does the work p x + s times the integral of t v, with the displacement x of the bead and its velocity
    v. The integral is that of the quintic through both ends of the step.
    """
    moved, v0, v1, knots = work[DISPLACEMENT], work[VELOCITY_BEFORE], work[VELOCITY_AFTER], chain.knots
    bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], v0)
    bead_velocities(trial.rate[2], chain.anchor_bead, trial.anchor[1], v1)
    given, braked = 0.0, 0.0
    # beads on strings: their displacements at both ends of the step
    if chain.strings.rest.size:
        bead_displacements(chain, motion.overlap, motion.anchor[0], work[OVERLAP_CHANGE], work[PLACE_BEFORE])
        bead_displacements(chain, trial.overlap[2], trial.anchor[0], work[OVERLAP_CHANGE], work[PLACE_AFTER])
    for j in range(moved.size):
        if chain.inverse_mass[j] > 0.0:
            # `late` is the integral of t v. Integration by parts gives h x(h) minus the integral of x. For a quintic
            # the latter is h x(h)/2 + h² (v0 - v1)/10 + h³ (a0 + a1)/120.
            bend = bead_acceleration(j, chain, regime, motion.force, 0.0)
            bend += bead_acceleration(j, chain, regime, trial.force[2], h)
            if chain.strings.rest.size:
                bend -= chain.strings.square * (work[PLACE_BEFORE, j] + work[PLACE_AFTER, j])
            late = h * (0.5 * moved[j] - h * (0.1 * (v0[j] - v1[j]) + h / 120.0 * bend))
            given += (chain.push[j] - knots.drive[j]) * moved[j] + knots.push_slope[j] * late
            if regime.bed.size and knots.brake_slope.size:
                braked += regime.slide[j] * knots.brake_slope[j] / regime.inverse_mass[j] * late
    return given, braked


@inlined
def carry(keeps, row, at, values):
    """Copy `values` (k,) into `row` from position `at` on if `keeps` is true, otherwise out of it. Return the next
    position.
    """
    for i in range(values.size):
        if keeps:
            row[at + i] = values[i]
        else:
            values[i] = row[at + i]
    return at + values.size


@inlined
def carry_step(keeps, k, chain, regime, motion, steps):
    """Store the motion in row k of `steps` if `keeps` is true, otherwise restore it. With dissipation, do the same for
    the effective chain.
    """
    row, flags = steps.values[k], steps.flags[k]
    # The motion: forces, overlaps, rates, anchor, energies, and modes.
    at = carry(keeps, row, carry(keeps, row, 0, motion.force), motion.overlap)
    at = carry(keeps, row, carry(keeps, row, at, motion.rate), motion.anchor)
    at, end = carry(keeps, row, at, motion.taken), carry(keeps, flags, 0, motion.mode)
    # The effective chain, which changes at events.
    if regime.bed.size or regime.easing.size:
        for i in range(motion.mode.size):
            at = carry(keeps, row, at, chain.law[i])
        at = carry(keeps, row, carry(keeps, row, at, chain.inverse_mass), chain.external)
        end = carry(keeps, flags, carry(keeps, flags, end, regime.slide), regime.easing)
        # To restore a segment, also restore its law; the overlap is already counted from its origin.
        for i in range(regime.segment.size):
            if keeps:
                flags[end + i] = regime.segment[i]
            else:
                overlap = motion.overlap[i]
                put_segment(i, flags[end + i], regime, motion)
                motion.overlap[i] = overlap


@inlined
def keep_step(time, length, kind, ctx):
    """Store the step or flight from `time` of `length` [s] with the motion at its start, if steps are stored."""
    steps, counter = ctx.steps, ctx.log.counter
    if steps.time.size:
        k = counter[KEPT]
        counter[KEPT] = k + 1
        steps.time[k], steps.length[k], steps.kind[k] = time, length, kind
        carry_step(True, k, ctx.chain, ctx.regime, ctx.motion, steps)


@inlined
def accept_step(motion, trial):
    """Make the end of the trial the current motion."""
    for i in range(motion.mode.size):
        motion.overlap[i], motion.rate[i], motion.force[i] = trial.overlap[2, i], trial.rate[2, i], trial.force[2, i]
        motion.held[i] = 0
        # A held contact has rate 0; its computed rate is round-off.
        if motion.mode[i] == TOUCHING or motion.mode[i] == FROZEN:
            motion.rate[i] = 0.0
    copy_into(motion.anchor, trial.anchor)


@whole
def sample_steps(
    count, wanted, chain_fields, regime_fields, motion_fields, trial_fields, scratch_fields, steps_fields, sample_fields,
    log_fields,
):  # fmt: skip
    """Fill the rows of all samples before the end of the last of `count` steps; `wanted` [m/s] is the error bound of
    these steps. Each record is an argument, a plain tuple of its fields, because tuples are cheap to pass from Python.
    """
    chain, motion = ChainData(*chain_fields), Motion(*motion_fields)
    regime = Regime(*regime_fields, chain.graph)  # type: ignore[call-arg]
    trial, scratch, steps = Trial(*trial_fields), Scratch(*scratch_fields), Steps(*steps_fields)
    samples, log = Samples(*sample_fields), SwitchLog(*log_fields)
    # Samples need no probe steps, and only the limits that follow from the error bound.
    ctx = StepContext(chain, regime, motion, trial, trial, bounds_of(wanted, 0.0), scratch, log, steps)
    counter = log.counter
    for k in range(count):
        end = steps.time[k] + steps.length[k]
        # Restore the motion, the effective chain and the forces at the start of the step, once for all samples in it.
        if counter[SAMPLE] < samples.time.size and samples.time[counter[SAMPLE]] < end:
            carry_step(False, k, chain, regime, motion, steps)
            if chain.knots.time.size:
                put_drive(steps.time[k], chain, regime)
        while counter[SAMPLE] < samples.time.size and samples.time[counter[SAMPLE]] < end:
            row = row_of(samples, counter[SAMPLE], motion)
            copy_motion(row, motion)
            # Move a copy of this motion forward to the sample time.
            passed = 0.0 if steps.kind[k] == RESTED else max(samples.time[counter[SAMPLE]] - steps.time[k], 0.0)
            if steps.kind[k] == FLOWN or passed == 0.0:
                drift(passed, chain, regime, row, scratch.work[VELOCITY])
            else:
                move_inside(passed, steps.kind[k], ctx, row)
            for i in range(row.force.size):  # Without the continuation of a law beyond d = 0
                row.force[i] = min(row.force[i], 0.0) if side_of(regime, i) < 0.0 else max(row.force[i], 0.0)
            count_from_touch(row.overlap, regime)
            counter[SAMPLE] += 1


@inlined
def count_from_touch(overlap, regime):
    """Count the overlaps (n,) of contacts with several segments from the position at which the beads touch, not from
    the origins of their segments.
    """
    for i in range(regime.segment.size):
        overlap[i] += of_segment(regime, i, ORIGIN)


@piece
def move_inside(passed, kind, ctx, row):
    """Move `row`, a copy of the motion at the start of a step, forward by `passed` [s] in it by a shorter step.

    If the stages of this step do not converge, a slightly shorter step is taken and the rest is a drift with constant
    velocities.
    """
    motion, trial, length = ctx.motion, ctx.trial, passed
    # Try the step to the sample, and shorten it a little until its stages converge.
    while take_step(length, kind, ctx, trial) < 0.0:
        length *= SAFETY
        if length < ROUND_OFF * passed:
            break
    # Drift over the rest.
    rest = passed - length
    for i in range(motion.mode.size):
        trial.overlap[2, i] += rest * trial.rate[2, i]
    trial.anchor[0] += rest * trial.anchor[1]
    accept_step(row, trial)
    absorb(length, ctx.chain, ctx.regime, motion, trial, ctx.scratch.work, row.taken)
