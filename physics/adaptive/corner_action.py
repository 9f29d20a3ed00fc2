"""Mode transition at an event: the constraint is put on its corner, then one complementarity problem decides all
constraints at rest.

Three kinds of constraint carry a bounded multiplier: a touching contact, a contact with loss that stands still, and a
sticking bead. One complementarity problem decides for all of them together which ones yield, see `yield_or_slip`. Its
known forces are those a moment later. At the event itself a contact that has just closed does not push yet, and
constraints that reach their bounds together are exactly on them. Without the delay each of them could yield instead of
the other, forever.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import FORCE_PRECISION, MOMENT, ROUND_OFF
from softcradle.physics.adaptive.corner_search import closes_inactive
from softcradle.physics.adaptive.flight import drift, next_event
from softcradle.physics.adaptive.row_graphs import (
    both_forces,
    drive_overlaps,
    find_segment,
    friction_needed,
    is_at_rest,
    is_firm,
    is_innermost,
    length_of,
    loss_of,
    most_friction,
    multiplier_bounds,
    put_drive,
    put_segment,
    side_of,
)
from softcradle.physics.adaptive.sampling import keep_step
from softcradle.physics.adaptive.step_control import onset_step, restart_control
from softcradle.physics.adaptive.step_records import (
    ACCELERATION,
    AT_ONCE,
    CANDIDATE,
    CARRIED,
    FLOWN,
    HIGH,
    LAST,
    LOAD,
    LOW,
    NEXT,
    STATIC_FRICTION,
    VELOCITY,
)
from softcradle.physics.adaptive.switch_log import begin_estimate, log_switches
from softcradle.physics.adaptive.yield_or_slip import balance
from softcradle.physics.numerics.bead_velocities import bead_displacements, bead_velocities, put_impulse
from softcradle.physics.numerics.graph_kernels import has_segments
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.law_curve import acceleration_of, is_continued, is_smooth
from softcradle.physics.numerics.records import FROZEN, LOADED, NO_CONTACT, OPEN, TOUCHING


@inlined
def moment_of(chain, regime, motion, slow):
    """Return the delay [s] after which forces are evaluated: the largest force changes a velocity by more than `slow`
    [m/s] in it.
    """
    largest = 0.0
    # Largest acceleration by a contact force or a preload, then by external forces and friction.
    for i in range(motion.mode.size):
        weight = regime.inverse_mass[i] + regime.inverse_mass[i + 1]
        largest = max(largest, weight * max(abs(motion.force[i]), abs(regime.law[i, 0])))
    for j in range(regime.inverse_mass.size):
        if chain.push.size:
            largest = max(largest, abs(chain.push[j]) * regime.inverse_mass[j])
        if regime.bed.size:
            largest = max(largest, regime.bed[j])
    return MOMENT * slow / largest if largest > 0.0 else 0.0


@inlined
def known_force(i, late, chain, regime, motion):
    """Return the force of loaded contact i `late` [s] after now."""
    pressed, eased = both_forces(chain, regime, i, motion.overlap[i] + late * motion.rate[i])
    return eased if regime.easing.size and regime.easing[i] != 0 else pressed


@inlined
def is_pulled(i, chain):
    """Return True if external forces act, or if strings pull the beads of contact i apart or together at overlap 0."""
    return chain.external.size > 0 or (chain.strings.rest.size > 0 and chain.strings.rest[i] != 0.0)


@inlined
def classify(late, chain, regime, motion, slow, work):
    """Set the modes that overlaps and rates determine, and the bounds of all contact forces `late` [s] after now.

    A contact whose mode an event has just set keeps this mode (``motion.held`` nonzero). Returns whether the mode of
    any contact is undetermined, so that the complementarity problem must decide it.
    """
    overlap, rate, force, mode = motion.overlap, motion.rate, motion.force, motion.mode
    low, high, candidate = work[LOW], work[HIGH], work[CANDIDATE]
    undetermined = False
    for i in range(mode.size):
        candidate[i] = 0.0
        if motion.held[i] == 0:
            # A contact with several segments is first put on the segment of its overlap.
            if has_segments(chain.graph, i):
                find_segment(i, regime, motion, slow)
            x, w = side_of(regime, i) * overlap[i], side_of(regime, i) * rate[i]
            # A contact may be held at d = 0, or at d > 0 on the vertical part of the graph of a contact with loss.
            at_rest = x == 0.0 and abs(w) <= slow
            stands = x > 0.0 and w == 0.0 and loss_of(regime, i) > 0.0
            mode[i] = LOADED
            if x < 0.0 or (x == 0.0 and w < 0.0 and not at_rest):
                mode[i] = OPEN
            # At d = 0 without a preload the force is 0 whatever the mode, unless external forces or segments act.
            elif (
                at_rest and (regime.law[i, 0] != 0.0 or has_segments(chain.graph, i) or is_pulled(i, chain))
            ) or stands:
                mode[i], candidate[i], undetermined = TOUCHING, 1.0, True
            if regime.easing.size:
                eases = mode[i] == LOADED and loss_of(regime, i) > 0.0 and x > 0.0 and w < 0.0
                regime.easing[i] = 1 if eases else 0
        # A contact that may be held is bounded by its graph. A contact with a known force gets equal bounds.
        if candidate[i] != 0.0:
            low[i], high[i] = multiplier_bounds(chain, regime, i, overlap[i])
            continue
        force[i] = known_force(i, 0.0, chain, regime, motion) if mode[i] == LOADED else 0.0
        low[i] = high[i] = known_force(i, late, chain, regime, motion) if mode[i] == LOADED else 0.0
    return undetermined


@inlined
def load_beads(late, slipping, chain, regime, motion, slow, work):
    """Compute the known forces on the beads `late` [s] after now, and the static friction of beads at rest. Return
    whether any rests.

    Bead `slipping` counts as sliding, however slow it is.
    """
    load, give, resting, knots = work[LOAD], work[STATIC_FRICTION], False, chain.knots
    if regime.bed.size:
        bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], work[VELOCITY])
    if chain.strings.rest.size:
        bead_displacements(chain, motion.overlap, motion.anchor[0], give, work[VELOCITY])
    for j in range(regime.inverse_mass.size):
        # External force, which may change linearly in time.
        load[j] = chain.push[j] if chain.push.size else 0.0
        if chain.strings.rest.size and regime.inverse_mass[j] > 0.0:
            load[j] -= chain.strings.square / regime.inverse_mass[j] * work[VELOCITY, j]
        if knots.push_slope.size:
            load[j] += late * knots.push_slope[j]
        give[j] = 0.0
        # A bead at rest gets static friction as a bound, a sliding bead gets kinetic friction as a known force.
        if regime.bed.size and regime.bed[j] > 0.0:
            most = most_friction(j, chain, regime, late)
            if j != slipping and (regime.slide[j] == 0 or abs(work[VELOCITY, j]) <= slow):
                give[j], resting = most, True
            else:
                load[j] -= regime.slide[j] * most
    return resting


@inlined
def settle_contact(i, regime, motion, work):
    """Set the mode of a contact that may be held, from the accelerations of its two beads."""
    side, low, high = side_of(regime, i), work[LOW, i], work[HIGH, i]
    # Complementarity: if the beads accelerate towards each other, the force is at its upper bound and the contact is
    # loaded. If they accelerate apart, it is at its lower bound and the contact opens or unloads. Otherwise it stays
    # held.
    pressed = side * (work[ACCELERATION, i] - work[ACCELERATION, i + 1])
    none = ROUND_OFF * (regime.inverse_mass[i] + regime.inverse_mass[i + 1]) * max(high, -low)
    motion.force[i] = work[CARRIED, i]
    if pressed > none or (low == high and pressed >= -none):
        motion.mode[i], motion.force[i] = LOADED, high if side > 0.0 else low
    elif pressed < -none:
        motion.force[i] = low if side > 0.0 else high
        ease(i, regime, motion)
    else:
        motion.rate[i] = 0.0


@inlined
def ease(i, regime, motion):
    """Let contact i unload, starting with zero rate."""
    side = side_of(regime, i)
    # At the origin of an outer segment, unloading moves the contact to the end of the inner segment.
    if motion.overlap[i] == 0.0 and not is_innermost(regime, i):
        put_segment(i, regime.segment[i] - (1 if side > 0.0 else -1), regime, motion)
        motion.overlap[i] = side * length_of(regime, i)
    motion.mode[i] = LOADED if motion.overlap[i] != 0.0 else OPEN
    if regime.easing.size:
        regime.easing[i] = 1 if motion.overlap[i] != 0.0 and loss_of(regime, i) > 0.0 else 0
    # A contact that stops pulling is in its slack; an open contact is on its innermost pushing segment.
    if motion.mode[i] == OPEN and side < 0.0:
        put_segment(i, regime.segment[i] + 1, regime, motion)


@inlined
def take_velocity(left, first, last, chain, motion):
    """Subtract the velocity `left` from the beads `first` to `last`, which move as one body."""
    # Only the rates at both ends of the group change; the anchor bead stops if it belongs to the group.
    if first > 0:
        motion.rate[first - 1] += left
    if last < motion.rate.size:
        motion.rate[last] -= left
    if first <= chain.anchor_bead <= last:
        motion.anchor[1] = 0.0


@inlined
def stop_bead(j, chain, regime, motion, velocity):
    """Subtract the remaining velocity of bead j from it and from all beads that move as one body with it. `velocity`
    (n+1,) is scratch memory.
    """
    n, rate = motion.rate.size, motion.rate
    bead_velocities(rate, chain.anchor_bead, motion.anchor[1], velocity)
    # The group: all neighbours with rate 0.
    first, last = j, j
    while first > 0 and rate[first - 1] == 0.0:
        first -= 1
    while last < n and rate[last] == 0.0:
        last += 1
    take_velocity(velocity[j], first, last, chain, motion)


@inlined
def settle_bead(j, chain, regime, motion, work):
    """Set the direction in which a bead on a bed slides, from its acceleration. A sticking bead gets velocity 0."""
    # A bead at rest slides in the direction of its acceleration, or sticks if static friction balances the forces.
    a = work[ACCELERATION, j]
    regime.slide[j] = 1 if a > 0.0 else (-1 if a < 0.0 else 0)
    if regime.slide[j] == 0 and work[VELOCITY, j] != 0.0:
        take_velocity(work[VELOCITY, j], j, j, chain, motion)


@inlined
def make_effective(chain, regime, motion):
    """Compute the effective chain, without dissipation, that the next steps integrate."""
    n = motion.mode.size
    # Unloading with loss l: the power law is weaker by the factor 1 - l.
    if regime.loss.size:
        for i in range(n):
            part = 1.0 - regime.loss[i] if regime.easing[i] != 0 else 1.0
            chain.law[i, 0], chain.law[i, 1] = part * regime.law[i, 0], part * regime.law[i, 1]
            for k in range(2, chain.law.shape[1]):
                chain.law[i, k] = regime.law[i, k]
    # A sticking bead is a wall: its inverse mass is 0, and rates between two of them are round-off.
    if regime.bed.size:
        for j in range(n + 1):
            chain.inverse_mass[j] = 0.0 if is_firm(regime, j) else regime.inverse_mass[j]
        for i in range(n):
            if is_at_rest(regime, i) and is_at_rest(regime, i + 1):
                motion.rate[i] = 0.0  # round-off
        if is_at_rest(regime, chain.anchor_bead):
            motion.anchor[1] = 0.0
    if regime.bed.size or chain.knots.bend.size:
        drive_overlaps(chain, regime)
    # A closed contact between two fixed beads does not move, and its force is not determined: take it out.
    for i in range(n):
        held = motion.mode[i] == LOADED or motion.mode[i] == TOUCHING
        if held and motion.rate[i] == 0.0 and chain.inverse_mass[i] == 0.0 and chain.inverse_mass[i + 1] == 0.0:
            motion.mode[i] = FROZEN


@piece
def decide(slipping, ctx):
    """Decide the mode of every contact and bead, the forces and the effective chain, from overlaps, rates and
    directions of sliding.

    Rates and velocities below ``bounds.slow`` count as zero. Bead `slipping` (-1: none) counts as sliding.
    """
    chain, regime, motion, slow, scratch = ctx.chain, ctx.regime, ctx.motion, ctx.bounds.slow, ctx.scratch
    work, late = scratch.work, moment_of(chain, regime, motion, slow)
    undetermined = classify(late, chain, regime, motion, slow, work)
    # Solve the complementarity problem only if a mode is undetermined.
    if load_beads(late, slipping, chain, regime, motion, slow, work) or undetermined:
        n = motion.mode.size
        balance(
            regime.inverse_mass, work[LOAD], work[STATIC_FRICTION], work[LOW, :n], work[HIGH, :n], work[ACCELERATION],
            work[CARRIED, :n], scratch.bounds, scratch.knots,
        )  # fmt: skip
        # The signs of the relative accelerations give the modes, see `settle_contact` and `settle_bead`.
        for i in range(n):
            if work[CANDIDATE, i] != 0.0:
                settle_contact(i, regime, motion, work)
        for j in range(regime.slide.size):
            if work[STATIC_FRICTION, j] > 0.0:
                settle_bead(j, chain, regime, motion, work)
    make_effective(chain, regime, motion)


@inlined
def carried(row, chain, regime, motion):
    """Return the force of a contact, or the friction of a bead [N], and its largest possible value; 0 if the row is not
    held.
    """
    n = motion.mode.size
    if row >= n:
        most = most_friction(row - n, chain, regime, 0.0) if regime.slide[row - n] == 0 else 0.0
        return friction_needed(row - n, chain, regime, motion.force, 0.0), most
    low, high = multiplier_bounds(chain, regime, row, motion.overlap[row])
    return motion.force[row], max(high, -low) if motion.mode[row] == TOUCHING else 0.0


@inlined
def put_on_corner(row, side, ctx):
    """Put a moving contact or bed exactly on the corner of its graph that the event has reached, by kind of event.

    A held constraint is on its corner already: its force is at a bound.
    """
    chain, regime, motion, control = ctx.chain, ctx.regime, ctx.motion, ctx.scratch.control
    n = motion.mode.size
    # A sliding bead has stopped.
    if row >= n:
        stop_bead(row - n, chain, regime, motion, ctx.scratch.work[VELOCITY])
    # A contact with loss has reached a turning point.
    elif motion.mode[row] == LOADED and side == 1:
        motion.rate[row] = 0.0
    # The end of a segment.
    elif side == 2:
        motion.overlap[row] = side_of(regime, row) * length_of(regime, row)
    # The end of the slack: a coupler begins to pull.
    elif side == 1:
        put_segment(row, regime.segment[row] - 1, regime, motion)
        motion.overlap[row] = 0.0
    # Overlap 0. A contact that closes starts with a step short enough for the onset of its force.
    else:
        motion.overlap[row] = 0.0
        if motion.mode[row] == OPEN:
            onset = onset_step(chain, row, motion.rate[row], ctx.bounds.wanted)
            restart_control(control, min(control[NEXT], onset))


@inlined
def make_yield(row, side, ctx):
    """Let a held contact yield, or a held bead slip, in the direction of its bound. Return the bead that slips, or -1."""
    regime, motion = ctx.regime, ctx.motion
    n = motion.mode.size
    if row >= n:
        regime.slide[row - n] = 1 if side == 1 else -1
        return row - n
    motion.mode[row], motion.held[row] = LOADED, 1
    if (side == 0) == (side_of(regime, row) > 0.0):
        ease(row, regime, motion)
    elif regime.easing.size:
        regime.easing[row] = 0
    return NO_CONTACT


@piece
def cross(row, side, time, ctx):
    """Carry out the mode transition of a contact or bed at its event, and decide all modes again.

    A held constraint yields, unless another constraint has yielded and relieved it.
    """
    before, held = carried(row, ctx.chain, ctx.regime, ctx.motion)
    if not held > 0.0:
        put_on_corner(row, side, ctx)
    decide(NO_CONTACT, ctx)
    # The constraint was at its bound, is still held, and carries the same force as before: the delay was too short to
    # show that it yields. Then force it to yield, and decide the others again. Example: a bead whose friction limit is
    # reached by a force that grows very slowly.
    after, most = carried(row, ctx.chain, ctx.regime, ctx.motion)
    if held > 0.0 and most > 0.0 and abs(after - before) <= FORCE_PRECISION * held:
        decide(make_yield(row, side, ctx), ctx)
    log_switches(time, time, NO_CONTACT, ctx)


@piece
def stop_rate(i, chain, motion):
    """Set the rate of contact i to 0 and conserve momentum: both beads get the velocity of their centre of mass.

    If this contact or a neighbour is soft or touching, only its own rate is set to 0. Soft contacts are stiff if they
    are deep, so a change of a neighbour's rate would excite them.
    """
    inverse_mass, rate = chain.inverse_mass, motion.rate
    # The impulse would excite soft neighbours, and it is not known how touching neighbours share it.
    for k in range(max(i - 1, 0), min(i + 2, motion.mode.size)):
        if chain.law[k, 2] < 1.0 or motion.mode[k] == TOUCHING:
            rate[i] = 0.0
            return
    # The impulse between the two beads also changes the rates of the neighbours and the velocity of the anchor bead.
    weight = inverse_mass[i] + inverse_mass[i + 1]
    if weight > 0.0:
        put_impulse(i, rate[i] / weight, weight, inverse_mass, chain, motion)
    rate[i] = 0.0


@inlined
def is_touch(i, h, motion, trial, slow):
    """Return True if the overlap of contact i (of either sign) after a step of length `h` is round-off of a touching
    contact.

    The limit is `slow` [m/s], the rate that counts as zero, times the step length, plus the round-off of the overlaps.
    """
    depth = max(abs(trial.overlap[0, i]), abs(trial.overlap[1, i]))
    return abs(motion.overlap[i]) <= slow * h + ROUND_OFF * depth


@inlined
def open_passed(row, h, time, ctx):
    """Open the contacts that the step of length `h` (the `trial`) has moved past d = 0. Return True if there are any.

    A gap or overlap larger than round-off stays as it is. A force with an exponent above 1 vanishes so smoothly that a
    step can go far past the opening, and the beads may stop there: on a bed they are then at rest, and apart.
    """
    chain, regime, motion, trial = ctx.chain, ctx.regime, ctx.motion, ctx.trial
    any_passed, inactive, slow, scratch = False, ctx.bounds.inactive, ctx.bounds.slow, ctx.scratch
    for i in range(motion.mode.size):
        # Skip contacts whose mode agrees with their overlap, and the contact whose event ends the step.
        inward = side_of(regime, i) * motion.overlap[i]
        if inward == 0.0 or (inward < 0.0) == (motion.mode[i] == OPEN) or i == row:
            continue
        if motion.mode[i] == OPEN:
            rate, touches = motion.rate[i], is_touch(i, h, motion, trial, inactive)
            # An open contact has closed. If it is too slow to count, put it back to d = 0. At d > 0 it would gain
            # energy, because nothing has pushed it back yet.
            if (
                touches
                and is_smooth(chain.law, chain.graph, i)
                and closes_inactive(chain, i, inactive, rate, rate, inward)
            ):
                motion.overlap[i] = 0.0
            else:  # the step could not end at the event: another event ends it, or round-off decides which one is first
                motion.mode[i] = LOADED
                # Estimate when it closed, from its overlap and rate: `log_switches` needs the time since which it pushes.
                scratch.pressed[i] = time - inward / max(abs(rate), inward / h)
        # A loaded contact has opened without an event: its force vanishes.
        elif motion.mode[i] == LOADED and not is_continued(chain.law, chain.graph, i):
            any_passed = True
            motion.force[i] = 0.0
            # The strings pull back a contact that has opened by round-off, so they count at overlap 0 only.
            bend = acceleration_of(i, chain, 0.0, motion.force, 0.0)
            touches = is_touch(i, h, motion, trial, slow) and abs(motion.rate[i]) <= slow
            if not touches or bend < 0.0:
                motion.mode[i] = OPEN
            else:  # pushed from both sides, or not at all, and too slow to count: the contact stays at d = 0
                # Record the rate that is set to 0: the error estimate counts it when the contact is pushed again
                # (`count_parting`).
                if bend == 0.0 and scratch.parting[i] == 0.0:
                    scratch.parting[i], scratch.parted[i] = abs(motion.rate[i]), time
                motion.overlap[i] = 0.0
                stop_rate(i, chain, motion)
            if regime.easing.size and regime.easing[i] != 0:
                regime.easing[i] = 0
                chain.law[i, 0], chain.law[i, 1] = regime.law[i, 0], regime.law[i, 1]
    return any_passed


@piece
def fly_to_event(time, end, ctx):
    """Open all loaded contacts, fly to the first event, and carry out its transition. Return the time and the row of
    the event (-1: none).
    """
    chain, regime, motion, scratch = ctx.chain, ctx.regime, ctx.motion, ctx.scratch
    # Contacts that are still loaded push too little to count: open them.
    for i in range(motion.mode.size):
        if motion.mode[i] == LOADED:
            motion.mode[i], motion.force[i] = OPEN, 0.0
            if side_of(regime, i) < 0.0:
                put_segment(i, regime.segment[i] + 1, regime, motion)
    log_switches(time, time, NO_CONTACT, ctx)
    # After a flight, no earlier step predicts the length of the next one.
    scratch.control[NEXT] = math.inf
    until, row, side = next_event(time, end, chain, regime, motion, ctx.bounds.negligible, scratch.work[VELOCITY])
    # Without any further event the beads fly apart forever.
    if until < math.inf:
        keep_step(time, until - time, FLOWN, ctx)
        drift(until - time, chain, regime, motion, scratch.work[VELOCITY])
        time = until
    if row >= 0:
        cross(row, side, time, ctx)
    return time, row


@piece
def find_slides(begins, chain, regime, motion, velocity):
    """Set the directions of sliding from the velocities of the beads. `begins` is true at the start of a run.

    Later, only events change the direction of a bead that friction already brakes. `velocity` (n+1,) is scratch memory.
    """
    if regime.bed.size:
        bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
        for j in range(velocity.size):
            # A bead without friction so far takes the direction of its velocity, so that a brake acts against it.
            if begins or regime.bed[j] == 0.0:
                regime.slide[j] = 1 if velocity[j] > 0.0 else (-1 if velocity[j] < 0.0 else 0)


@piece
def begin(time, ctx):
    """Set the modes, the first step length and the log of switches at the start of a run."""
    chain, regime, motion, scratch, first = ctx.chain, ctx.regime, ctx.motion, ctx.scratch, math.inf
    # Take the law of the segment on which each contact is, and no mode from an earlier run.
    for i in range(motion.mode.size):
        motion.held[i] = 0
        if regime.segment.size:
            put_segment(i, regime.segment[i], regime, motion)
    find_slides(True, chain, regime, motion, scratch.work[VELOCITY])
    decide(NO_CONTACT, ctx)
    # The first step must resolve the onset of each contact that is about to close.
    for i in range(motion.mode.size):
        if motion.mode[i] == LOADED and motion.overlap[i] == 0.0:
            first = min(first, onset_step(chain, i, max(motion.rate[i], 0.0), ctx.bounds.wanted))
    restart_control(scratch.control, first)
    scratch.control[AT_ONCE] = 0.0
    begin_estimate(time, motion, scratch)
    for i in range(motion.mode.size):
        scratch.pressed[i] = math.inf
    log_switches(time, time, NO_CONTACT, ctx)


@piece
def pass_knot(time, ctx):
    """Continue after a breakpoint of the forces over time: held contacts are decided again. Return what `put_drive`
    returns.
    """
    chain, regime, motion, scratch = ctx.chain, ctx.regime, ctx.motion, ctx.scratch
    find_slides(False, chain, regime, motion, scratch.work[VELOCITY])  # with the brakes before the breakpoint
    acts = put_drive(time, chain, regime)
    for i in range(motion.mode.size):
        motion.held[i] = 0
    decide(NO_CONTACT, ctx)
    scratch.control[LAST] = 0.0
    log_switches(time, time, NO_CONTACT, ctx)
    return acts
