"""Discrete gradient: energy and momentum to round-off at any step, for set-valued contacts, friction and loss too.

    verlet        d1 = d0 + h w0 - (h²/2) L f(midpoint)      w1 = w0 - h L f(midpoint)
    conserving    d1 = d0 + h w0 - (h²/2) L g                w1 = w0 - h L g,     g = (E(d1) - E(d0)) / (d1 - d0)

A step is one solve of `contact_solve`; a contact that touches (d0 = d1 = 0, 0 <= g <= preload) is one branch of its resolvent.
Where a bead turns round or stops in a step, or a contact with loss turns from pressing in to coming out, the step is cut there in
two: friction then acts on either side of the event as it should, and the order stays 2. What contacts and bed absorb is the
work of their mean forces, so energy closes to round-off at any step. What bounces within a step lose, to contacts and to the bed,
is taken after it, see `touching` and `settle_rubbing`.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.contact_solve import (
    DIAGONAL,
    END,
    FORCE_AT_HOLD,
    FREE,
    FREE_VELOCITY,
    FRICTION,
    HOLD,
    LEAST_AT_HOLD,
    SLOPE,
    SOLVER_ROWS,
    START_VELOCITY,
    loses,
    solve_contacts,
)
from softcradle.physics.numerics.graph_kernels import graph_fall, has_segments, settle_graph_forces
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.knots import add_half_work, put_mean
from softcradle.physics.numerics.law_kernels import energy
from softcradle.physics.numerics.records import EVALUATION, UNCONVERGED
from softcradle.physics.numerics.resolvent import SMALLEST
from softcradle.physics.numerics.switches import copy_into, has_stopped
from softcradle.physics.numerics.touching import TOUCHES, put_impulse, settle_touching

FIRST_FORCE = SOLVER_ROWS  # row (n,) of scratch memory beside those of the solver: forces before a step that may be cut
WORK_ROWS = SOLVER_ROWS + 1
# of a step: where the solver does not converge, shorter steps, which conserve no less, down to this
SMALLEST_PART = 2.0**-10
MOST_CUTS = 4  # of one step at events
NEAR_END = 0.02  # of a step: an event this near to its ends needs no cut
# of the slope that one which touches has in a step, and of the way at its rate: a contact as steep that moves no further bounces
RIGID, RETURNED = 0.99, 0.01
ROUND_OFF_MOVED = 1e-14  # of an overlap: one that a step moves by less tells nothing of its rate
ROUND_OFF_LEFT = 1e-12  # of a step: a rest this short after cuts is round-off


@inlined
def velocity_after(h, j, beads):
    """Velocity of bead j, on a bed, at the end of the step."""
    return 0.0 if math.isnan(beads[FRICTION, j]) else beads[FREE_VELOCITY, j] + h * beads[FRICTION, j]


@inlined
def is_held(i, motion, work):
    """Whether contact i ends the step where its loss holds it, and came to stand there.

    An overlap that a short step moves by its round-off alone is found there too, however fast it goes on.
    """
    overlap, hold = motion.overlap[i], work[HOLD, i]
    return work[END, i] == hold and (motion.rate[i] == 0.0 or abs(hold - overlap) > ROUND_OFF_MOVED * abs(overlap))


@inlined
def returns(h, i, moved, rate, work):
    """Whether contact i, which the step has `moved`, has bounced within it: it is where it was, as fast the other way."""
    rigid = 0.5 * h * h * work[DIAGONAL, i] * work[SLOPE, i] >= RIGID
    return rigid and rate != 0.0 and abs(moved) <= RETURNED * h * abs(rate)


@inlined
def first_event(h, chain, motion, beads, work):
    """Part of the step after which the first bead turns or contact with loss reverses, 1 where none does; an estimate."""
    first = 1.0
    bed, overlap, rate = chain.dissipation.bed, motion.overlap, motion.rate
    for i in range(overlap.size):
        least, full = work[LEAST_AT_HOLD, i], work[FORCE_AT_HOLD, i]
        if full > least and rate[i] != 0.0:
            ended = 2.0 * (work[END, i] - overlap[i]) / h - rate[i]
            if (ended < 0.0) == (rate[i] > 0.0) or is_held(i, motion, work):
                kept = full if rate[i] > 0.0 else least  # the force until it reverses
                free = ended - h * work[DIAGONAL, i] * (kept - motion.force[i])
                if (free < 0.0) == (rate[i] > 0.0):
                    first = min(first, rate[i] / (rate[i] - free))
    for j in range(bed.size):
        before = beads[START_VELOCITY, j]
        if bed[j] > 0.0 and before != 0.0:
            free = beads[FREE_VELOCITY, j] - math.copysign(h * bed[j], before)
            turns = (free < 0.0) == (before > 0.0)
            for i in range(max(j - 1, 0), min(j + 1, rate.size)):
                turns = turns and not returns(h, i, work[END, i] - overlap[i], rate[i], work)
            if turns:
                first = min(first, before / (before - free))
    return first


@inlined
def absorb(h, chain, motion, beads, work):
    """Add what contacts and bed absorb in the step: what they take of the motion less what is stored."""
    law, overlap, end, bed = chain.law, motion.overlap, work[END], chain.dissipation.bed
    for i in range(overlap.size):
        if has_segments(chain.graph, i):
            fall = graph_fall(chain.graph, i, overlap[i], end[i], False)
            motion.taken[0] += motion.force[i] * (end[i] - overlap[i]) + fall
        elif loses(chain.dissipation.loss[i], overlap[i], motion.rate[i]):
            fall = energy(law[i, 0], law[i, 1], law[i, 2], overlap[i])
            fall -= energy(law[i, 0], law[i, 1], law[i, 2], end[i])
            motion.taken[0] += motion.force[i] * (end[i] - overlap[i]) + fall
    for j in range(bed.size):
        if bed[j] > 0.0:
            before, ended = beads[START_VELOCITY, j], velocity_after(h, j, beads)
            sticks = math.isnan(beads[FRICTION, j])
            braked = beads[FREE_VELOCITY, j] / h if sticks else -beads[FRICTION, j]
            motion.taken[1] += 0.5 * h * braked * (before + ended) / chain.inverse_mass[j]


@inlined
def bead_acceleration(j, chain, force):
    """Acceleration of bead j by the contact forces (n,) and the push."""
    found = force[j - 1] * chain.inverse_mass[j] if j > 0 else 0.0
    if j < force.size:
        found -= force[j] * chain.inverse_mass[j]
    if chain.push.size:
        found += chain.push[j] * chain.inverse_mass[j]
    return found


@inlined
def rate_after(h, i, chain, motion, left, right, beads, work):
    """Rate of contact i at the end of the step by its finest formula, from the accelerations of its two beads.

    It is w0 - h L g, or 2 (d1 - d0)/h - w0 where the overlap is so small that this is the finer number.
    """
    start, rate, end = motion.overlap[i], motion.rate[i], work[END, i]
    slide, loss, bed = 0.0, chain.dissipation.loss, chain.dissipation.bed
    if loss.size:
        lossy = has_segments(chain.graph, i) or loses(loss[i], start, rate)
        if lossy and is_held(i, motion, work):
            return 0.0
        if bed.size:
            if math.isnan(beads[FRICTION, i]) or math.isnan(beads[FRICTION, i + 1]):
                return velocity_after(h, i, beads) - velocity_after(h, i + 1, beads)
            slide = beads[FRICTION, i] - beads[FRICTION, i + 1]
    if max(abs(start), abs(end)) < h * h * work[DIAGONAL, i] * motion.force[i]:
        return 2.0 * (end - start) / h - rate
    return rate + h * (left - right + slide)


@inlined
def move(h, chain, motion, beads, work):
    """Put the end of the step into the motion."""
    n, overlap, rate, anchor, bead = motion.rate.size, motion.overlap, motion.rate, motion.anchor, chain.anchor_bead
    by_velocity = chain.dissipation.bed.size > 0
    if by_velocity:
        ended = velocity_after(h, bead, beads)
        anchor[0] += 0.5 * h * (anchor[1] + ended)
        anchor[1] = ended
    else:
        acceleration = bead_acceleration(bead, chain, motion.force)
        anchor[0] += h * (anchor[1] + 0.5 * h * acceleration)
        anchor[1] += h * acceleration
    left = bead_acceleration(0, chain, motion.force)
    for i in range(n):
        right = bead_acceleration(i + 1, chain, motion.force)
        before = rate[i]
        rate[i] = rate_after(h, i, chain, motion, left, right, beads, work)
        firm = by_velocity and math.isnan(beads[FRICTION, i]) and math.isnan(beads[FRICTION, i + 1])
        overlap[i] = overlap[i] + 0.5 * h * before if firm else work[END, i]
        left = right


@inlined
def settle_rubbing(h, given, chain, motion, beads, work):
    """Take what friction takes of bounces within the step; by the velocity at its end it takes nothing of them.

    Under a steady load velocities go evenly from one end of a bounce to the other, which tells how far its beads go.
    """
    bed, rate = chain.dissipation.bed, motion.rate
    for i in range(rate.size):
        weight, lost = given[i] + given[i + 1], 0.0
        if weight > 0.0 and returns(h, i, motion.overlap[i] - work[FREE, i], rate[i], work):
            for j in range(i, i + 2):
                swing = given[j] * abs(rate[i]) / weight
                centre = velocity_after(h, j, beads) - math.copysign(swing, rate[i] if j == i else -rate[i])
                if abs(centre) < swing:
                    lost += 0.5 * h * bed[j] * (centre * centre + swing * swing) / (swing * given[j])
            impulse = min(lost / abs(rate[i]), abs(rate[i]) / weight)
            motion.taken[1] += impulse * (abs(rate[i]) - 0.5 * weight * impulse)
            put_impulse(i, math.copysign(impulse, rate[i]), weight, given, chain, motion)


@inlined
def settle(h, chain, motion, beads, work):
    """Take what the bed and contacts take of bounces where a step, from overlaps in row FREE on, came back to them; a bead that
    sticks stays so.
    """
    given, weight = beads[START_VELOCITY], work[DIAGONAL]
    for j in range(given.size):
        sticks = chain.dissipation.bed.size > 0 and math.isnan(beads[FRICTION, j])
        given[j] = 0.0 if sticks else chain.inverse_mass[j]
    if chain.dissipation.bed.size:
        settle_rubbing(h, given, chain, motion, beads, work)
    for i in range(weight.size):
        weight[i] = given[i] + given[i + 1]
    settle_touching(h, work[FREE], weight, given, chain, motion, motion.taken)


@inlined
def single_step(h, chain, motion, beads, work, forced, whole):
    """One step in place. Returns the iterations used, negative where they did not converge, and the part of the step at
    which it should be cut (1: nowhere). The motion stays as it was where it is not `forced` and did not converge, or where it
    should be cut and is not `whole`.
    """
    overlap, rate, outside, inverse_mass = motion.overlap, motion.rate, chain.push, chain.inverse_mass
    free, end, diagonal, dissipates = work[FREE], work[END], work[DIAGONAL], chain.dissipation.loss.size > 0
    for i in range(overlap.size):
        weight = inverse_mass[i] + inverse_mass[i + 1]
        # between beads that no force moves a row of its own, without effect
        diagonal[i] = weight if weight > 0.0 else 1.0
        if 0.0 < overlap[i] < SMALLEST:
            overlap[i] = 0.0
        if dissipates and abs(overlap[i]) < TOUCHES * h * h * diagonal[i] * chain.law[i, 0]:
            overlap[i] = 0.0
        free[i] = h * rate[i]
        if outside.size:
            free[i] += 0.5 * h * h * (outside[i] * inverse_mass[i] - outside[i + 1] * inverse_mass[i + 1])
        end[i] = overlap[i] if overlap[i] > 0.0 else overlap[i] + free[i]
    if chain.dissipation.bed.size:
        bead_velocities(rate, chain.anchor_bead, motion.anchor[1], beads[START_VELOCITY])
    used = solve_contacts(h, chain, motion, beads, work)
    if used < 0 and not forced:
        return used, 1.0
    for i in range(overlap.size):
        if inverse_mass[i] + inverse_mass[i + 1] == 0.0:
            end[i] = overlap[i] + free[i]
    if dissipates:
        if not whole:
            part = first_event(h, chain, motion, beads, work)
            if NEAR_END < part < 1.0 - NEAR_END:
                return used, part
        absorb(h, chain, motion, beads, work)
        copy_into(free, overlap)
    timed = chain.knots.time.size > 0
    if timed:
        add_half_work(h, chain, motion, beads[START_VELOCITY])
    move(h, chain, motion, beads, work)
    if timed:
        add_half_work(h, chain, motion, beads[START_VELOCITY])
    settle_graph_forces(chain.graph, motion)
    return used, 1.0


@inlined
def gradient_step(h, chain, motion, beads, work):
    """One step in place, in shorter ones where it does not converge and cut where a bead stops or a contact reverses.

    `work` (WORK_ROWS, n), `beads` (BEAD_ROWS, n+1). Returns the iterations used, negative where even the shortest step did
    not converge.
    """
    first_force, force = work[FIRST_FORCE], motion.force
    total, left, part, failed, cuts, event = 0, h, h, False, 0, False
    while left > 0.0:
        if chain.dissipation.loss.size:
            copy_into(first_force, force)
        shortest = part <= SMALLEST_PART * h
        used, cut = single_step(part, chain, motion, beads, work, shortest, event or cuts >= MOST_CUTS)
        total += abs(used)
        if used < 0 and not shortest:
            part *= 0.5
            for i in range(force.size):
                force[i] = 0.0
            continue
        failed |= used < 0
        if cut < 1.0:
            part *= cut
            cuts += 1
            event = True
            copy_into(force, first_force)
            continue
        event = False
        if chain.dissipation.loss.size:
            settle(part, chain, motion, beads, work)
        left -= part
        if left < ROUND_OFF_LEFT * h:
            break
        part = min(left, h if cuts else part)
    return -total if failed else total


@jit
def gradient_steps(most, time, h, chain, motion, closed, beads, work, counter):
    """Up to `most` steps from `time` on in place, until a contact leaves the state in `closed` or, with dissipation, all rest.

    Counts evaluations and steps that did not converge in `counter`. Returns the steps taken.
    """
    for step in range(most):
        if chain.knots.time.size:
            put_mean(time + step * h, h, chain.knots, chain.push, chain.dissipation.bed)
        used = gradient_step(h, chain, motion, beads, work)
        counter[EVALUATION] += abs(used)
        counter[UNCONVERGED] += 1 if used < 0 else 0
        if has_stopped(chain, motion, closed):
            return step + 1
    return most
