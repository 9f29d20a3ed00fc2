"""Steps of `conserving` for chains that rub: dry friction of the bed, contacts with loss, and the ledger of both.

Each step is one solve of softcradle.physics.numerics.dissipative_solve. Where a bead turns round or stops in it, or a contact with loss goes
from pressing in to coming out, it is cut there in two: friction then acts on either side of the event as it should, and the
order stays 2. What contacts and bed absorb is the work of their mean forces, so energy closes to round-off at any step.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.contact_law import energy
from softcradle.physics.numerics.dissipative_solve import SOLVER_ROWS, dry_forces, keeps
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.resolvent import EPSILON, SMALLEST

WORK_ROWS = SOLVER_ROWS + 4  # rows (n,) of scratch memory of a step: free, end, diagonal, forces to begin from
SMALLEST_PART = 2.0**-10  # of a step: where Newton does not settle, shorter steps, which conserve no less, down to this
TOUCHES = 1e-14  # of what a preload moves in a step: an overlap this small, of either sign, is round-off of touching
MOST_CUTS = 4  # of a step at events
NEAR_END = 0.02  # of a step: an event this near to its ends needs no cut


@jit
def bead_velocities(rate, anchor_bead, anchor_velocity, velocity):
    """Rebuild the velocities (n+1,) of the beads from rates and anchor; what is round-off of the sum is 0."""
    velocity[anchor_bead] = anchor_velocity
    terms = abs(anchor_velocity)
    for j in range(anchor_bead - 1, -1, -1):
        velocity[j] = velocity[j + 1] + rate[j]
        terms += abs(rate[j])
    for j in range(anchor_bead, rate.size):
        velocity[j + 1] = velocity[j] - rate[j]
        terms += abs(rate[j])
    for j in range(velocity.size):
        if abs(velocity[j]) <= 2.0 * EPSILON * terms:
            velocity[j] = 0.0


@jit
def bead_end(h, j, beads, bed):
    """Velocity of bead j at the end of the step."""
    if math.isnan(beads[2, j]):
        return 0.0
    return beads[1, j] + h * beads[2, j] if bed.size else beads[1, j]


@jit
def first_event(h, diagonal, loss, rate, end, overlap, force, bed, beads, work):
    """Part of the step after which the first bead turns or contact with loss reverses, 1 where none does; an estimate."""
    first = 1.0
    for i in range(overlap.size):
        if loss[i] > 0.0 and overlap[i] > 0.0 and rate[i] != 0.0 and work[6, i] > 0.0:
            ended = 2.0 * (end[i] - overlap[i]) / h - rate[i]
            full = work[7, i]  # q where the rate is 0
            kept = full if rate[i] > 0.0 else (1.0 - loss[i]) * full
            free = ended - h * diagonal[i] * (kept - force[i]) if end[i] == work[6, i] else ended
            if (free < 0.0) == (rate[i] > 0.0):
                first = min(first, rate[i] / (rate[i] - free))
    for j in range(bed.size):
        before = beads[0, j]
        if bed[j] > 0.0 and before != 0.0:
            free = beads[1, j] - math.copysign(h * bed[j], before)
            if (free < 0.0) == (before > 0.0):
                first = min(first, before / (before - free))
    return first


@jit
def book_losses(h, law, loss, inverse_mass, rate, overlap, end, force, bed, beads, absorbed):
    """Add what contacts and bed have absorbed in the step: what they took of the motion less what is stored."""
    for i in range(overlap.size):
        if keeps(loss[i], overlap[i], rate[i]):
            fall = energy(law[i, 0], law[i, 1], law[i, 2], overlap[i])
            fall -= energy(law[i, 0], law[i, 1], law[i, 2], end[i])
            absorbed[0] += force[i] * (end[i] - overlap[i]) + fall
    for j in range(bed.size):
        if bed[j] > 0.0:
            before, ended = beads[0, j], bead_end(h, j, beads, bed)
            braked = beads[1, j] / h if math.isnan(beads[2, j]) else -beads[2, j]
            absorbed[1] += 0.5 * h * braked * (before + ended) / inverse_mass[j]


@jit
def new_rate(h, i, inverse_mass, push, force, start, end, rate, hold, loss, bed, beads):
    """Rate of contact i at the end of the step, by its finest formula."""
    if keeps(loss[i], start, rate) and end == hold:
        return 0.0
    slipping = 0.0
    if bed.size:
        left, right = beads[2, i], beads[2, i + 1]
        if math.isnan(left) or math.isnan(right):
            return bead_end(h, i, beads, bed) - bead_end(h, i + 1, beads, bed)
        slipping = left - right
    n = force.size
    if max(abs(start), abs(end)) < h * h * (inverse_mass[i] + inverse_mass[i + 1]) * force[i]:
        return 2.0 * (end - start) / h - rate
    left = ((force[i - 1] if i > 0 else 0.0) - force[i]) * inverse_mass[i]
    right = (force[i] - (force[i + 1] if i < n - 1 else 0.0)) * inverse_mass[i + 1]
    if push.size:
        left += push[i] * inverse_mass[i]
        right += push[i + 1] * inverse_mass[i + 1]
    return rate + h * (left - right + slipping)


@jit
def single_dry_step(
    h, law, loss, inverse_mass, push, bed, anchor_bead, overlap, rate, anchor, force, absorbed, work, beads, forced, whole
):  # fmt: skip
    """One step in place. Returns the iterations used, negative where they did not converge, and the part of the step at
    which it should be cut (1: nowhere). The state stays as it was where it is not `forced` and did not converge, or where it
    should be cut and is not `whole`.
    """
    n = overlap.size
    free, end, diagonal = work[SOLVER_ROWS], work[SOLVER_ROWS + 1], work[SOLVER_ROWS + 2]
    for i in range(n):
        diagonal[i] = inverse_mass[i] + inverse_mass[i + 1]
        if 0.0 < overlap[i] < SMALLEST or abs(overlap[i]) < TOUCHES * h * h * diagonal[i] * law[i, 0]:
            overlap[i] = 0.0
        free[i] = h * rate[i]
        if push.size:
            free[i] += 0.5 * h * h * (push[i] * inverse_mass[i] - push[i + 1] * inverse_mass[i + 1])
        end[i] = overlap[i] if overlap[i] > 0.0 else overlap[i] + free[i]
    if bed.size:
        bead_velocities(rate, anchor_bead, anchor[1], beads[0])
    used = dry_forces(
        h, law, loss, diagonal, inverse_mass, push, bed, free, overlap, rate, end, force, beads, work
    )  # fmt: skip
    if used < 0 and not forced:
        return used, 1.0
    if not whole:
        part = first_event(h, diagonal, loss, rate, end, overlap, force, bed, beads, work)
        if NEAR_END < part < 1.0 - NEAR_END:
            return used, part
    book_losses(h, law, loss, inverse_mass, rate, overlap, end, force, bed, beads, absorbed)
    before = force[anchor_bead - 1] if anchor_bead > 0 else 0.0
    after = force[anchor_bead] if anchor_bead < n else 0.0
    pushed = before - after + (push[anchor_bead] if push.size else 0.0)
    moved = anchor[1] + h * inverse_mass[anchor_bead] * pushed
    if bed.size:
        moved = bead_end(h, anchor_bead, beads, bed)
    anchor[0] += 0.5 * h * (anchor[1] + moved)
    anchor[1] = moved
    for i in range(n):
        was = rate[i]
        firm = bed.size and math.isnan(beads[2, i]) and math.isnan(beads[2, i + 1])
        rate[i] = new_rate(h, i, inverse_mass, push, force, overlap[i], end[i], was, work[6, i], loss, bed, beads)
        overlap[i] = overlap[i] + 0.5 * h * was if firm else end[i]
    return used, 1.0


@jit
def dry_step(h, law, loss, inverse_mass, push, bed, anchor_bead, overlap, rate, anchor, force, absorbed, work, beads):
    """One step in place, in shorter ones where it does not converge and cut where something stops or turns.

    `work` (WORK_ROWS, n), `beads` (BEAD_ROWS, n+1). Returns the iterations used, negative where even the
    shortest did not converge.
    """
    kept = work[SOLVER_ROWS + 3]
    total, left, part, failed, cuts, event = 0, h, h, False, 0, False
    while left > 0.0:
        for i in range(force.size):
            kept[i] = force[i]
        last = part <= SMALLEST_PART * h
        used, cut = single_dry_step(
            part, law, loss, inverse_mass, push, bed, anchor_bead, overlap, rate, anchor, force, absorbed, work, beads,
            last, event or cuts >= MOST_CUTS,
        )  # fmt: skip
        total += abs(used)
        if used < 0 and not last:
            part *= 0.5
            for i in range(force.size):
                force[i] = 0.0
            continue
        failed |= used < 0
        if cut < 1.0:
            part *= cut
            cuts += 1
            event = True
            for i in range(force.size):
                force[i] = kept[i]
            continue
        event = False
        left -= part
        if left < 1e-12 * h:
            break
        part = min(left, h if cuts else part)
    return -total if failed else total


@jit
def dry_steps(
    most, h, law, loss, inverse_mass, push, bed, anchor_bead, overlap, rate, anchor, force, closed, absorbed, work, beads,
    tally,
):  # fmt: skip
    """Up to `most` steps in place; stops after the first in which a contact leaves the state in `closed`, or all rest.

    Adds to `tally`: [0] evaluations of all contacts, [1] steps that did not converge. Returns the steps taken.
    """
    for step in range(most):
        used = dry_step(
            h, law, loss, inverse_mass, push, bed, anchor_bead, overlap, rate, anchor, force, absorbed, work, beads
        )  # fmt: skip
        tally[0] += abs(used)
        tally[1] += 1 if used < 0 else 0
        switched, moving = False, anchor[1] != 0.0
        for i in range(overlap.size):
            switched |= (overlap[i] > 0.0 or (overlap[i] == 0.0 and force[i] > 0.0)) != (closed[i] != 0)
            moving |= rate[i] != 0.0
        if switched or not moving:
            return step + 1
    return most
