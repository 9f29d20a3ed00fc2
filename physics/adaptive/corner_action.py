"""The one action at a corner: the row is put on it, then the problem of accelerations tells the branch of every row at rest.

Three kinds of row are held by a bounded multiplier: a contact that touches, a contact with loss that stands still, and a bead
that sticks. Which of them give way is one problem for all, see `yield_or_slip`. Its known forces are those of a moment later: at
the corner itself a contact that has just closed does not push yet, and rows that reach their bounds together are on them to the
last digit, so that each could give way in place of the other for ever.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import FORCE_PRECISION, MOMENT, ROUND_OFF, TOLERANCE_PART
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
    AT_ONCE,
    FLOWN,
    LAST,
    NEXT,
)
from softcradle.physics.adaptive.switch_log import begin_estimate, log_switches
from softcradle.physics.adaptive.yield_or_slip import balance
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.graph_kernels import has_segments
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.law_curve import acceleration_of, is_continued, is_smooth
from softcradle.physics.numerics.records import FROZEN, LOADED, NO_CONTACT, OPEN, TOUCHING

# rows (n+1,) of the work array: velocities of beads; known forces on them and the static friction of those at rest; bounds of the
# contact forces, accelerations and forces that the problem gives; 1 for contacts that may be held
VELOCITY, LOAD, GIVE, LOW, HIGH, ACCELERATION, CARRIED, CANDIDATE = 0, 5, 6, 7, 8, 9, 10, 11


@inlined
def moment_of(chain, regime, motion, slow):
    """How much later [s] forces are taken: until the largest of them gives a velocity well above `slow` [m/s]."""
    largest = 0.0
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
    """Force of contact i, loaded, `late` [s] after now."""
    pressed, eased = both_forces(chain, regime, i, motion.overlap[i] + late * motion.rate[i])
    return eased if regime.easing.size and regime.easing[i] != 0 else pressed


@inlined
def classify(late, chain, regime, motion, slow, work):
    """Modes as far as overlaps and rates tell them, and bounds of the forces `late` [s] after now.

    A contact that has just been moved over a corner keeps its mode (``motion.held`` nonzero). Returns whether any may be held.
    """
    overlap, rate, force, mode = motion.overlap, motion.rate, motion.force, motion.mode
    low, high, candidate = work[LOW], work[HIGH], work[CANDIDATE]
    undetermined = False
    for i in range(mode.size):
        candidate[i] = 0.0
        if motion.held[i] == 0:
            if has_segments(chain.graph, i):
                find_segment(i, regime, motion, slow)
            x, w = side_of(regime, i) * overlap[i], side_of(regime, i) * rate[i]
            at_rest = x == 0.0 and abs(w) <= slow
            stands = x > 0.0 and w == 0.0 and loss_of(regime, i) > 0.0
            mode[i] = LOADED
            if x < 0.0 or (x == 0.0 and w < 0.0 and not at_rest):
                mode[i] = OPEN
            elif (
                at_rest and (regime.law[i, 0] != 0.0 or has_segments(chain.graph, i) or chain.external.size > 0)
            ) or stands:
                mode[i], candidate[i], undetermined = TOUCHING, 1.0, True
            if regime.easing.size:
                eases = mode[i] == LOADED and loss_of(regime, i) > 0.0 and x > 0.0 and w < 0.0
                regime.easing[i] = 1 if eases else 0
        if candidate[i] != 0.0:
            low[i], high[i] = multiplier_bounds(chain, regime, i, overlap[i])
            continue
        force[i] = known_force(i, 0.0, chain, regime, motion) if mode[i] == LOADED else 0.0
        low[i] = high[i] = known_force(i, late, chain, regime, motion) if mode[i] == LOADED else 0.0
    return undetermined


@inlined
def load_beads(late, slipping, chain, regime, motion, slow, work):
    """Known forces on beads `late` [s] after now, and the static friction of those at rest; returns whether any is.

    Bead `slipping` is not, however slow it is.
    """
    load, give, resting, knots = work[LOAD], work[GIVE], False, chain.knots
    if regime.bed.size:
        bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], work[VELOCITY])
    for j in range(regime.inverse_mass.size):
        load[j] = chain.push[j] if chain.push.size else 0.0
        if knots.push_slope.size:
            load[j] += late * knots.push_slope[j]
        give[j] = 0.0
        if regime.bed.size and regime.bed[j] > 0.0:
            most = most_friction(j, chain, regime, late)
            if j != slipping and (regime.slide[j] == 0 or abs(work[VELOCITY, j]) <= slow):
                give[j], resting = most, True
            else:
                load[j] -= regime.slide[j] * most
    return resting


@inlined
def settle_contact(i, regime, motion, work):
    """The mode of a contact that may be held, from the accelerations of its beads."""
    side, low, high = side_of(regime, i), work[LOW, i], work[HIGH, i]
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
    """Let contact i come out, from rest."""
    side = side_of(regime, i)
    if motion.overlap[i] == 0.0 and not is_innermost(regime, i):
        put_segment(i, regime.segment[i] - (1 if side > 0.0 else -1), regime, motion)
        motion.overlap[i] = side * length_of(regime, i)
    motion.mode[i] = LOADED if motion.overlap[i] != 0.0 else OPEN
    if regime.easing.size:
        regime.easing[i] = 1 if motion.overlap[i] != 0.0 and loss_of(regime, i) > 0.0 else 0
    if motion.mode[i] == OPEN and side < 0.0:
        put_segment(i, regime.segment[i] + 1, regime, motion)


@inlined
def take_velocity(left, first, last, chain, motion):
    """Take the velocity `left` from beads `first` to `last`, which move as one."""
    if first > 0:
        motion.rate[first - 1] += left
    if last < motion.rate.size:
        motion.rate[last] -= left
    if first <= chain.anchor_bead <= last:
        motion.anchor[1] = 0.0


@inlined
def stop_bead(j, chain, regime, motion, velocity):
    """Take the velocity that bead j still has from it and from all that move as one with it; `velocity` (n+1,) is scratch."""
    n, rate = motion.rate.size, motion.rate
    bead_velocities(rate, chain.anchor_bead, motion.anchor[1], velocity)
    first, last = j, j
    while first > 0 and rate[first - 1] == 0.0:
        first -= 1
    while last < n and rate[last] == 0.0:
        last += 1
    take_velocity(velocity[j], first, last, chain, motion)


@inlined
def settle_bead(j, chain, regime, motion, work):
    """Which way a bead slides that may stick, from its acceleration; one that sticks has no velocity at all."""
    a = work[ACCELERATION, j]
    regime.slide[j] = 1 if a > 0.0 else (-1 if a < 0.0 else 0)
    if regime.slide[j] == 0 and work[VELOCITY, j] != 0.0:
        take_velocity(work[VELOCITY, j], j, j, chain, motion)


@inlined
def make_effective(chain, regime, motion):
    """The chain that the next steps see."""
    n = motion.mode.size
    if regime.loss.size:
        for i in range(n):
            part = 1.0 - regime.loss[i] if regime.easing[i] != 0 else 1.0
            chain.law[i, 0], chain.law[i, 1] = part * regime.law[i, 0], part * regime.law[i, 1]
            for k in range(2, chain.law.shape[1]):
                chain.law[i, k] = regime.law[i, k]
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
    for i in range(n):
        held = motion.mode[i] == LOADED or motion.mode[i] == TOUCHING
        if held and motion.rate[i] == 0.0 and chain.inverse_mass[i] == 0.0 and chain.inverse_mass[i + 1] == 0.0:
            motion.mode[i] = FROZEN


@piece
def decide(slipping, chain, regime, motion, slow, scratch):
    """The branch of every row, forces and the effective chain, from overlaps, rates and slides; at rest is what is slower than
    `slow` [m/s]. Bead `slipping` (-1: none) slides already."""
    work, late = scratch.work, moment_of(chain, regime, motion, slow)
    undetermined = classify(late, chain, regime, motion, slow, work)
    if load_beads(late, slipping, chain, regime, motion, slow, work) or undetermined:
        n = motion.mode.size
        balance(
            regime.inverse_mass, work[LOAD], work[GIVE], work[LOW, :n], work[HIGH, :n], work[ACCELERATION],
            work[CARRIED, :n], scratch.bounds, scratch.knots,
        )  # fmt: skip
        for i in range(n):
            if work[CANDIDATE, i] != 0.0:
                settle_contact(i, regime, motion, work)
        for j in range(regime.slide.size):
            if work[GIVE, j] > 0.0:
                settle_bead(j, chain, regime, motion, work)
    make_effective(chain, regime, motion)


@inlined
def carried(row, chain, regime, motion):
    """What a row carries, force of a contact or friction of a bead, and the most that it can; 0 if it is not held."""
    n = motion.mode.size
    if row >= n:
        most = most_friction(row - n, chain, regime, 0.0) if regime.slide[row - n] == 0 else 0.0
        return friction_needed(row - n, chain, regime, motion.force, 0.0), most
    low, high = multiplier_bounds(chain, regime, row, motion.overlap[row])
    return motion.force[row], max(high, -low) if motion.mode[row] == TOUCHING else 0.0


@piece
def cross(row, side, time, chain, regime, motion, bounds, scratch, log):
    """Move a row over its corner on that side, and decide all rows anew.

    One that was held gives way, unless another that did has relieved it.
    """
    n, control = motion.mode.size, scratch.control
    before, held = carried(row, chain, regime, motion)
    if held > 0.0:
        held *= FORCE_PRECISION
    elif row >= n:
        stop_bead(row - n, chain, regime, motion, scratch.work[VELOCITY])
    elif motion.mode[row] == LOADED and side == 1:
        motion.rate[row] = 0.0
    elif side == 2:
        motion.overlap[row] = side_of(regime, row) * length_of(regime, row)
    elif side == 1:
        put_segment(row, regime.segment[row] - 1, regime, motion)
        motion.overlap[row] = 0.0
    else:
        motion.overlap[row] = 0.0
        if motion.mode[row] == OPEN:
            restart_control(control, min(control[NEXT], onset_step(chain, row, motion.rate[row], bounds.wanted)))
    decide(NO_CONTACT, chain, regime, motion, bounds.slow, scratch)
    after, most = carried(row, chain, regime, motion)
    if held > 0.0 and most > 0.0 and abs(after - before) <= held:
        slipping = NO_CONTACT
        if row >= n:
            slipping = row - n
            regime.slide[slipping] = 1 if side == 1 else -1
        else:
            motion.mode[row], motion.held[row] = LOADED, 1
            if (side == 0) == (side_of(regime, row) > 0.0):
                ease(row, regime, motion)
            elif regime.easing.size:
                regime.easing[row] = 0
        decide(slipping, chain, regime, motion, bounds.slow, scratch)
    log_switches(time, time, NO_CONTACT, chain, regime, motion, bounds, scratch, log)


@piece
def stop_rate(i, chain, motion):
    """Give the two beads of contact i the velocity of their centre of mass: this takes its rate and leaves momentum alone.

    Beside soft contacts, which are stiff where they are deep, and touching ones only the rate itself is set to 0.
    """
    inverse_mass, rate = chain.inverse_mass, motion.rate
    for k in range(max(i - 1, 0), min(i + 2, motion.mode.size)):
        if chain.law[k, 2] < 1.0 or motion.mode[k] == TOUCHING:
            rate[i] = 0.0
            return
    weight = inverse_mass[i] + inverse_mass[i + 1]
    impulse = rate[i] / weight if weight > 0.0 else 0.0
    if i > 0:
        rate[i - 1] += impulse * inverse_mass[i]
    if i + 1 < motion.mode.size:
        rate[i + 1] += impulse * inverse_mass[i + 1]
    if chain.anchor_bead == i:
        motion.anchor[1] -= impulse * inverse_mass[i]
    elif chain.anchor_bead == i + 1:
        motion.anchor[1] += impulse * inverse_mass[i + 1]
    rate[i] = 0.0


@inlined
def is_touch(i, h, motion, trial, slow):
    """Return True if the overlap of contact i, of either sign, is that of a touch after a step of length `h`.

    That is at most what a rate of `slow` [m/s], which counts as none, moves in the step, and the round-off of its overlaps.
    """
    depth = max(abs(trial.overlap[0, i]), abs(trial.overlap[1, i]))
    return abs(motion.overlap[i]) <= slow * h + ROUND_OFF * depth


@inlined
def open_passed(row, h, time, chain, regime, motion, trial, bounds, scratch):
    """Open the contacts that the step of length `h`, the `trial`, has carried past d = 0; return True if there are any.

    A gap or overlap larger than round-off stays as it is. A force with an exponent above 1 vanishes so smoothly that a step goes
    far past the opening, and the beads may stop there: on a bed they are then at rest, and apart.
    """
    any_passed, inactive = False, TOLERANCE_PART * bounds.wanted
    for i in range(motion.mode.size):
        inward = side_of(regime, i) * motion.overlap[i]
        if inward == 0.0 or (inward < 0.0) == (motion.mode[i] == OPEN) or i == row:
            continue
        if motion.mode[i] == OPEN:
            rate, touches = motion.rate[i], is_touch(i, h, motion, trial, inactive)
            # at d > 0, where nothing has pushed it back yet, it would gain energy
            if (
                touches
                and is_smooth(chain.law, chain.graph, i)
                and closes_inactive(chain, i, inactive, rate, rate, inward)
            ):
                motion.overlap[i] = 0.0
            else:  # its event could not be met
                motion.mode[i] = LOADED
        elif motion.mode[i] == LOADED and not is_continued(chain.law, chain.graph, i):
            any_passed = True
            motion.force[i] = 0.0
            bend = acceleration_of(i, chain, motion.force, 0.0)
            touches = is_touch(i, h, motion, trial, bounds.slow) and abs(motion.rate[i]) <= bounds.slow
            if not touches or bend < 0.0:
                motion.mode[i] = OPEN
            else:  # pushed from both sides, or not at all, and too slow to count: it stays at 0
                if bend == 0.0 and scratch.parting[i] == 0.0:
                    scratch.parting[i], scratch.parted[i] = abs(motion.rate[i]), time
                motion.overlap[i] = 0.0
                stop_rate(i, chain, motion)
            if regime.easing.size and regime.easing[i] != 0:
                regime.easing[i] = 0
                chain.law[i, 0], chain.law[i, 1] = regime.law[i, 0], regime.law[i, 1]
    return any_passed


@piece
def fly_to_event(time, end, chain, regime, motion, bounds, scratch, steps, log):
    """Open all loaded contacts, fly to the first event, and carry it out. Returns the time and the row (-1: none)."""
    for i in range(motion.mode.size):
        if motion.mode[i] == LOADED:
            motion.mode[i], motion.force[i] = OPEN, 0.0
            if side_of(regime, i) < 0.0:
                put_segment(i, regime.segment[i] + 1, regime, motion)
    log_switches(time, time, NO_CONTACT, chain, regime, motion, bounds, scratch, log)
    scratch.control[NEXT] = math.inf
    until, row, side = next_event(time, end, chain, regime, motion, bounds.negligible, scratch.work[0])
    if until < math.inf:
        keep_step(time, until - time, FLOWN, chain, regime, motion, steps, log.counter)
        drift(until - time, chain, regime, motion, scratch.work[0])
        time = until
    if row >= 0:
        cross(row, side, time, chain, regime, motion, bounds, scratch, log)
    return time, row


@piece
def find_slides(begins, chain, regime, motion, velocity):
    """Which way each bead slides, from the velocities; after the run `begins` only events change it where it is braked already.

    `velocity` (n+1,) is scratch memory.
    """
    if regime.bed.size:
        bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
        for j in range(velocity.size):
            if begins or regime.bed[j] == 0.0:
                regime.slide[j] = 1 if velocity[j] > 0.0 else (-1 if velocity[j] < 0.0 else 0)


@piece
def begin(time, chain, regime, motion, bounds, scratch, log):
    """Modes, first step and log at the start of a run."""
    first = math.inf
    for i in range(motion.mode.size):
        motion.held[i] = 0
        if regime.segment.size:
            put_segment(i, regime.segment[i], regime, motion)
    find_slides(True, chain, regime, motion, scratch.work[0])
    decide(NO_CONTACT, chain, regime, motion, bounds.slow, scratch)
    for i in range(motion.mode.size):
        if motion.mode[i] == LOADED and motion.overlap[i] == 0.0:
            first = min(first, onset_step(chain, i, max(motion.rate[i], 0.0), bounds.wanted))
    restart_control(scratch.control, first)
    scratch.control[AT_ONCE] = 0.0
    begin_estimate(time, motion, scratch)
    for i in range(motion.mode.size):
        scratch.pressed[i] = math.inf
    log_switches(time, time, NO_CONTACT, chain, regime, motion, bounds, scratch, log)


@piece
def pass_knot(time, chain, regime, motion, bounds, scratch, log):
    """Go on under the forces and brakes after a knot; what is held is resolved anew. Returns what `put_drive` does."""
    find_slides(False, chain, regime, motion, scratch.work[0])  # by the brakes before the knot
    acts = put_drive(time, chain, regime)
    for i in range(motion.mode.size):
        motion.held[i] = 0
    decide(NO_CONTACT, chain, regime, motion, bounds.slow, scratch)
    scratch.control[LAST] = 0.0
    log_switches(time, time, NO_CONTACT, chain, regime, motion, bounds, scratch, log)
    return acts
