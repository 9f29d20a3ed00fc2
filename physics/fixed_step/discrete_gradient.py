"""Discrete-gradient steps, which conserve energy and momentum to round-off with any step size.

They handle contacts with vertical pieces of their graph (maximal monotone), friction and hysteretic loss:

    verlet        d1 = d0 + h w0 - (h²/2) L f(midpoint)      w1 = w0 - h L f(midpoint)
    conserving    d1 = d0 + h w0 - (h²/2) L g                w1 = w0 - h L g,     g = (E(d1) - E(d0)) / (d1 - d0)

A step is one solve of `contact_solve`. A touching contact (d0 = d1 = 0, 0 <= g <= preload) is one branch of its
resolvent. If a bead reverses or stops within a step, or a contact with loss changes from loading to unloading, the step
is cut in two at this event. Friction and loss then have the right direction on both sides of it, so the order stays 2.
The dissipated energy is the work of the mean forces of contacts and bed, so the energy balance closes to round-off with
any step size. Bounces shorter than a step lose energy as well; this loss is applied after the step, see `touching` and
`settle_rubbing`.

Strings have a quadratic potential, so their discrete gradient is the mean of both ends. With q = 1 / (1 + (h omega)²/4),

    d1 = d0 + q (h w0 - (h²/2) (L g + omega² (d0 - r)))

which is the problem without strings for masses that are larger by the factor 1/q. So the same solver takes it.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.bead_velocities import bead_velocities, put_impulse
from softcradle.physics.numerics.contact_solve import (
    DIAGONAL,
    END,
    FORCE_AT_HOLD,
    FREE,
    FREE_VELOCITY,
    FRICTION,
    HOLD,
    HUNG_MASS,
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
from softcradle.physics.numerics.law_kernels import energy_fall
from softcradle.physics.numerics.records import EVALUATION, UNCONVERGED, ChainData
from softcradle.physics.numerics.resolvent import SMALLEST
from softcradle.physics.numerics.swing import string_pull
from softcradle.physics.numerics.switches import copy_into, has_stopped
from softcradle.physics.numerics.touching import TOUCHES, settle_touching

# Row (n,) of the work array after those of the solver: the forces before a step that may be cut.
FIRST_FORCE = SOLVER_ROWS
WORK_ROWS = SOLVER_ROWS + 1
# Fraction of a step. If the solver does not converge, the step is divided down to this length. Shorter steps conserve
# energy just as well.
SMALLEST_PART = 2.0**-10
MOST_CUTS = 4  # Largest number of cuts of one step at events. Later events in the same step are not located.
NEAR_END = 0.02  # Fraction of the step. An event this near to either end of the step needs no cut.
# A contact counts as bouncing within a step if its slope dg/ds is at least the fraction RIGID of a touching contact's
# slope, and if its overlap changes by at most the fraction RETURNED of the distance that its rate would cover.
RIGID, RETURNED = 0.99, 0.01
# Fraction of the overlap. A smaller change in a step is round-off and does not show whether the contact still moves.
ROUND_OFF_MOVED = 1e-14
ROUND_OFF_LEFT = 1e-12  # Fraction of the step. A remainder this short after cuts is round-off and is skipped.


@inlined
def velocity_after(h, j, beads):
    """Return the velocity [m/s] of bead j on a bed at the end of the step; 0 if friction stops it."""
    return 0.0 if math.isnan(beads[FRICTION, j]) else beads[FREE_VELOCITY, j] + h * beads[FRICTION, j]


@inlined
def is_held(i, motion, work):
    """Return True if contact i ends the step at rest, held between its unloading and its loading force.

    In a short step the overlap may change only by round-off, and the solver then also returns this overlap. Such a
    contact still moves, so it does not count as held.
    """
    overlap, hold = motion.overlap[i], work[HOLD, i]
    return work[END, i] == hold and (motion.rate[i] == 0.0 or abs(hold - overlap) > ROUND_OFF_MOVED * abs(overlap))


@inlined
def returns(h, i, moved, rate, work):
    """Return True if contact i has bounced within the step: its overlap is the same, and its rate is reversed.

    `moved` is the change of its overlap [m] during the step.
    """
    rigid = 0.5 * h * h * work[DIAGONAL, i] * work[SLOPE, i] >= RIGID
    return rigid and rate != 0.0 and abs(moved) <= RETURNED * h * abs(rate)


@inlined
def first_event(h, chain, motion, beads, work):
    """Return an estimate of the first event, as a fraction of the step; 1 without an event.

    An event is a bead that stops or reverses, or a contact with loss that changes between loading and unloading.
    """
    first = 1.0
    bed, overlap, rate = chain.dissipation.bed, motion.overlap, motion.rate
    # contacts with loss: assume the force before the reversal for the whole step, and interpolate the rate to 0
    for i in range(overlap.size):
        least, full = work[LEAST_AT_HOLD, i], work[FORCE_AT_HOLD, i]
        if full > least and rate[i] != 0.0:
            ended = 2.0 * (work[END, i] - overlap[i]) / h - rate[i]
            # the rate has changed its sign, or the contact is held at rest
            if (ended < 0.0) == (rate[i] > 0.0) or is_held(i, motion, work):
                kept = full if rate[i] > 0.0 else least  # force of the contact before its rate changes sign
                free = ended - h * work[DIAGONAL, i] * (kept - motion.force[i])
                if (free < 0.0) == (rate[i] > 0.0):
                    first = min(first, rate[i] / (rate[i] - free))
    # beads on the bed: assume the friction before the reversal for the whole step, and interpolate the velocity to 0
    for j in range(bed.size):
        before = beads[START_VELOCITY, j]
        if bed[j] > 0.0 and before != 0.0:
            free = beads[FREE_VELOCITY, j] - math.copysign(h * bed[j], before)
            turns = (free < 0.0) == (before > 0.0)
            # the bounce of a touching contact reverses a bead as well, but `settle_rubbing` accounts for its friction
            for i in range(max(j - 1, 0), min(j + 1, rate.size)):
                turns = turns and not returns(h, i, work[END, i] - overlap[i], rate[i], work)
            if turns:
                first = min(first, before / (before - free))
    return first


@inlined
def absorb(h, chain, motion, beads, work):
    """Add the energy [J] that contacts and bed dissipate in the step to ``motion.taken``."""
    law, overlap, end, bed = chain.law, motion.overlap, work[END], chain.dissipation.bed
    # work of the mean force on the motion, less the increase of the stored energy
    for i in range(overlap.size):
        if has_segments(chain.graph, i):
            fall = graph_fall(chain.graph, i, overlap[i], end[i], False)
            motion.taken[0] += motion.force[i] * (end[i] - overlap[i]) + fall
        elif loses(chain.dissipation.loss[i], overlap[i], motion.rate[i]):
            motion.taken[0] += motion.force[i] * (end[i] - overlap[i]) + energy_fall(law[i], overlap[i], end[i])
    # braking force times the mean velocity of the bead times the step
    for j in range(bed.size):
        if bed[j] > 0.0:
            before, ended = beads[START_VELOCITY, j], velocity_after(h, j, beads)
            sticks = math.isnan(beads[FRICTION, j])
            braked = beads[FREE_VELOCITY, j] / h if sticks else -beads[FRICTION, j]
            motion.taken[1] += 0.5 * h * braked * (before + ended) / chain.inverse_mass[j]


@inlined
def bead_acceleration(j, chain, force):
    """Return the acceleration [m/s²] of bead j by the contact forces (n,) and the external force."""
    found = force[j - 1] * chain.inverse_mass[j] if j > 0 else 0.0
    if j < force.size:
        found -= force[j] * chain.inverse_mass[j]
    if chain.push.size:
        found += chain.push[j] * chain.inverse_mass[j]
    return found


@inlined
def hung_mean(h, i, chain, value, rate, acceleration):
    """Return the mean acceleration [m/s²] in a step on strings of contact i; of the anchor bead if i is the number of contacts.

    `value` and `rate` are those at the start, `acceleration` that by all other forces. The strings pull with the mean of the
    displacements at both ends of the step.
    """
    square = chain.strings.square
    pulled = acceleration + string_pull(chain, i, value) - 0.5 * h * square * rate
    return pulled / (1.0 + 0.25 * h * h * square)


@inlined
def rate_after(h, i, chain, motion, left, right, beads, work):
    """Return the rate [m/s] of contact i at the end of the step, by the formula with the smaller round-off error.

    The formulas are w0 - h L g, with the accelerations `left` and `right` of both beads, and 2 (d1 - d0)/h - w0, which
    is more accurate for very small overlaps.
    """
    start, rate, end = motion.overlap[i], motion.rate[i], work[END, i]
    slide, loss, bed = 0.0, chain.dissipation.loss, chain.dissipation.bed
    # special cases with dissipation: exactly 0 if the contact is held, or the difference of both velocities if a bead
    # sticks
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
    change = left - right + slide
    if chain.strings.rest.size:
        change = hung_mean(h, i, chain, start, rate, change)
    return rate + h * change


@inlined
def move(h, chain, motion, beads, work):
    """Write the state at the end of the step into `motion`."""
    n, overlap, rate, anchor, bead = motion.rate.size, motion.overlap, motion.rate, motion.anchor, chain.anchor_bead
    by_velocity = chain.dissipation.bed.size > 0
    # anchor bead: by its velocities if there is friction, else by the acceleration
    if by_velocity:
        ended = velocity_after(h, bead, beads)
        anchor[0] += 0.5 * h * (anchor[1] + ended)
        anchor[1] = ended
    else:
        acceleration = bead_acceleration(bead, chain, motion.force)
        if chain.strings.rest.size:
            acceleration = hung_mean(h, n, chain, anchor[0], anchor[1], acceleration)
        anchor[0] += h * (anchor[1] + 0.5 * h * acceleration)
        anchor[1] += h * acceleration
    # contacts: `left` and `right` are the accelerations of both beads
    left = bead_acceleration(0, chain, motion.force)
    for i in range(n):
        right = bead_acceleration(i + 1, chain, motion.force)
        before = rate[i]
        rate[i] = rate_after(h, i, chain, motion, left, right, beads, work)
        # Two beads that stick slow down evenly from the rate w0 to 0.
        firm = by_velocity and math.isnan(beads[FRICTION, i]) and math.isnan(beads[FRICTION, i + 1])
        overlap[i] = overlap[i] + 0.5 * h * before if firm else work[END, i]
        left = right


@inlined
def settle_rubbing(h, given, chain, motion, beads, work):
    """Apply the friction losses of bounces within the step, which the velocity at the end of the step does not contain.

    Under constant load the velocity of each bead changes linearly between the ends of a bounce, which gives the
    distance that the bead slides.
    """
    bed, rate = chain.dissipation.bed, motion.rate
    for i in range(rate.size):
        weight, lost = given[i] + given[i + 1], 0.0
        if weight > 0.0 and returns(h, i, motion.overlap[i] - work[FREE, i], rate[i], work):
            # each bead oscillates about the velocity `centre` with the amplitude `swing`; friction acts against it in
            # both directions
            for j in range(i, i + 2):
                swing = given[j] * abs(rate[i]) / weight
                centre = velocity_after(h, j, beads) - math.copysign(swing, rate[i] if j == i else -rate[i])
                if abs(centre) < swing:
                    lost += 0.5 * h * bed[j] * (centre * centre + swing * swing) / (swing * given[j])
            # at most the impulse that stops the contact
            impulse = min(lost / abs(rate[i]), abs(rate[i]) / weight)
            motion.taken[1] += impulse * (abs(rate[i]) - 0.5 * weight * impulse)
            put_impulse(i, math.copysign(impulse, rate[i]), weight, given, chain, motion)


@inlined
def settle(h, chain, motion, beads, work):
    """Apply the losses of bounces within the step, by friction and by contacts. Beads that stick stay at rest.

    The row FREE of `work` holds the overlaps at the start of the step.
    """
    given, weight = beads[START_VELOCITY], work[DIAGONAL]
    # velocity change of each bead per impulse; 0 for beads that stick
    for j in range(given.size):
        sticks = chain.dissipation.bed.size > 0 and math.isnan(beads[FRICTION, j])
        given[j] = 0.0 if sticks else chain.inverse_mass[j]
    if chain.dissipation.bed.size:
        settle_rubbing(h, given, chain, motion, beads, work)
    # change of each rate per impulse of its contact
    for i in range(weight.size):
        weight[i] = given[i] + given[i + 1]
    settle_touching(h, work[FREE], weight, given, chain, motion, motion.taken)


@inlined
def single_step(h, chain, motion, beads, work, forced, whole):
    """Take one step in place. Return the number of iterations (negative: not converged) and the place of a cut.

    The second result is a fraction of the step, 1 without a cut. The motion stays unchanged if the step did not
    converge and is not `forced`, or if it should be cut and is not `whole`.
    """
    overlap, rate, outside, inverse_mass = motion.overlap, motion.rate, chain.push, chain.inverse_mass
    free, end, diagonal, dissipates = work[FREE], work[END], work[DIAGONAL], chain.dissipation.loss.size > 0
    # on strings the solver gets masses that are larger by the factor 1/q of the module docstring
    solved, hangs, part = chain, chain.strings.rest.size > 0, 1.0
    if hangs:
        part = 1.0 / (1.0 + 0.25 * h * h * chain.strings.square)
        for j in range(inverse_mass.size):
            beads[HUNG_MASS, j] = part * inverse_mass[j]
        solved = ChainData(
            chain.law, beads[HUNG_MASS], chain.push, chain.external, chain.anchor_bead, chain.graph, chain.knots,
            chain.dissipation, chain.strings,
        )  # fmt: skip
        inverse_mass = solved.inverse_mass
    # motion without contact forces, and a guess of the overlaps at the end
    for i in range(overlap.size):
        weight = inverse_mass[i] + inverse_mass[i + 1]
        # A contact between two beads that no force can move gets a dummy row without effect.
        diagonal[i] = weight if weight > 0.0 else 1.0
        # overlaps that are round-off of a touch are set to exactly 0, so that the resolvent finds the vertical piece
        if 0.0 < overlap[i] < SMALLEST:
            overlap[i] = 0.0
        if dissipates and abs(overlap[i]) < TOUCHES * h * h * diagonal[i] * chain.law[i, 0]:
            overlap[i] = 0.0
        free[i] = h * rate[i]
        if hangs:
            free[i] = part * (h * rate[i] + 0.5 * h * h * string_pull(chain, i, overlap[i]))
        if outside.size:
            free[i] += 0.5 * h * h * (outside[i] * inverse_mass[i] - outside[i + 1] * inverse_mass[i + 1])
        end[i] = overlap[i] if overlap[i] > 0.0 else overlap[i] + free[i]
    if chain.dissipation.bed.size:
        bead_velocities(rate, chain.anchor_bead, motion.anchor[1], beads[START_VELOCITY])
    # the solver also decides which beads stick and which contacts open
    used = solve_contacts(h, solved, motion, beads, work)
    if used < 0 and not forced:
        return used, 1.0
    # the overlap between two such beads changes without regard to forces
    for i in range(overlap.size):
        if inverse_mass[i] + inverse_mass[i + 1] == 0.0:
            end[i] = overlap[i] + free[i]
    # cut the step at an event, unless it is too near to an end of the step
    if dissipates:
        if not whole:
            part = first_event(h, chain, motion, beads, work)
            if NEAR_END < part < 1.0 - NEAR_END:
                return used, part
        absorb(h, chain, motion, beads, work)
        copy_into(free, overlap)
    # the work of forces over time is half from the velocities before and half from those after the step
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
    """Take one step in place. Divide it if it does not converge, and cut it when a bead stops or a contact reverses.

    `work` (WORK_ROWS, n) and `beads` (BEAD_ROWS, n+1) are scratch memory. Return the number of iterations, negative if
    even the shortest step did not converge.
    """
    first_force, force = work[FIRST_FORCE], motion.force
    total, left, part, failed, cuts, event = 0, h, h, False, 0, False
    while left > 0.0:
        if chain.dissipation.loss.size:
            copy_into(first_force, force)
        shortest = part <= SMALLEST_PART * h
        used, cut = single_step(part, chain, motion, beads, work, shortest, event or cuts >= MOST_CUTS)
        total += abs(used)
        # The solver did not converge: repeat the step with half its length, starting from zero forces.
        if used < 0 and not shortest:
            part *= 0.5
            for i in range(force.size):
                force[i] = 0.0
            continue
        failed |= used < 0
        # There is an event within the step: repeat the step up to the event.
        if cut < 1.0:
            part *= cut
            cuts += 1
            event = True
            copy_into(force, first_force)
            continue
        event = False
        # the step is accepted: apply the losses of bounces, then go on with the rest
        if chain.dissipation.loss.size:
            settle(part, chain, motion, beads, work)
        left -= part
        if left < ROUND_OFF_LEFT * h:
            break
        part = min(left, h if cuts else part)
    return -total if failed else total


@jit
def gradient_steps(most, time, h, chain, motion, closed, beads, work, counter):
    """Take up to `most` steps from `time` on in place. Return the number of steps taken.

    Stop earlier if a contact leaves the state in `closed` or, with dissipation, if all beads rest. Evaluations and
    steps that did not converge are counted in `counter`. Arrays are arguments and not records, so that a call from the
    loop stays cheap.
    """
    for step in range(most):
        # forces over time act with their mean over the step
        if chain.knots.time.size:
            put_mean(time + step * h, h, chain.knots, chain.push, chain.dissipation.bed)
        used = gradient_step(h, chain, motion, beads, work)
        counter[EVALUATION] += abs(used)
        counter[UNCONVERGED] += 1 if used < 0 else 0
        # the caller handles switches and the end of the motion
        if has_stopped(chain, motion, closed):
            return step + 1
    return most
