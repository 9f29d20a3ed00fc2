"""Event search: the first time within a step at which a contact or a bed changes its mode.

Each unilateral constraint (row) is on one branch of its monotone graph during a step. Each side of a branch has a
guard: a polynomial over the step that is positive while the constraint stays on the branch.

    contact  OPEN      side 0   -d        closes; d is the quintic through both ends of the step
                       side 1    d + s    a coupler comes to the end s of its slack, and pulls
             LOADED    side 0    d        opens, if its law is continued to d < 0
                       side 1    w or -w  with loss: turns from loading to unloading, or back; cubic through both ends
                       side 2    t - d    comes to the end t of its segment (a coupler goes solid)
             TOUCHING  side 0   f - low   opens, or unloads;  side 1  high - f  yields; cubic through the stages
    bed      slides    side 0    v or -v  stops; cubic through both ends
             sticks    side 0    R + q    slips back;  side 1  R - q  slips forward; q is the friction that the bead
                                          needs, R the largest friction; cubic through the stages

Rows 0 to n-1 are the contacts, rows n to 2n the beds under the beads. The guards are in Bernstein form. A guard whose
coefficients have one sign has no root, and the convex hull of the coefficients gives a time before which it cannot
vanish. So the search never passes a root.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import FIRST_PART, MOST_MOVES, ROUND_OFF, SAFETY
from softcradle.physics.adaptive.row_graphs import (
    bead_acceleration,
    friction_needed,
    length_of,
    loss_of,
    most_friction,
    multiplier_bounds,
    side_of,
    slack_of,
)
from softcradle.physics.adaptive.step_records import (
    VELOCITY_AFTER,
    VELOCITY_BEFORE,
    Event,
)
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.jit import inlined
from softcradle.physics.numerics.law_curve import NODES, acceleration_of, curve_force, is_continued, is_smooth
from softcradle.physics.numerics.records import LOADED, NO_CONTACT, OPEN, TOUCHING, ZERO


@inlined
def closes_inactive(chain, i, inactive, rate, end_rate, end_overlap):
    """Return True if a contact closes so slowly, and with so little energy at the end of the step, that the event can
    be ignored.

    `inactive` [m/s] is the velocity that counts as zero.
    """
    law, inverse_mass = chain.law, chain.inverse_mass
    if law[i, 0] > 0.0 or max(rate, end_rate) > inactive:
        return False
    if end_overlap <= 0.0:
        return is_smooth(law, chain.graph, i)
    push = (inverse_mass[i] + inverse_mass[i + 1]) * curve_force(law, chain.graph, i, end_overlap)
    return push * end_overlap <= inactive * inactive


@inlined
def flies_apart(i, chain, regime, motion, trial):
    """Return True if open contact i is also open at the end of the step, and nothing pushes its beads at either end."""
    pulled = chain.external.size > 0 or chain.strings.rest.size > 0
    if trial.overlap[2, i] >= 0.0 or pulled or trial.overlap[2, i] <= -slack_of(regime, i):
        return False
    before = motion.force[i - 1] == 0.0 == trial.force[2, i - 1] if i > 0 else True
    return before and (motion.force[i + 1] == 0.0 == trial.force[2, i + 1] if i < motion.force.size - 1 else True)


@inlined
def turns(i, regime, motion, slow):
    """Return whether loaded contact i has hysteretic loss and is pressed in, so that it can turn from loading to
    unloading.
    """
    return loss_of(regime, i) > 0.0 and (motion.overlap[i] != 0.0 or side_of(regime, i) * motion.rate[i] > slow)


@inlined
def sides_of(row, chain, regime, motion, slow):
    """Return the range (first, end) of sides on which a contact or bed can leave its branch."""
    n = motion.mode.size
    # A bed: a sliding bead can stop (one side), a sticking bead can slip in either direction (two sides).
    if row >= n:
        return (0, 0) if regime.bed[row - n] == 0.0 else (0, 1 if regime.slide[row - n] != 0 else 2)
    if motion.mode[row] == OPEN:
        return 0, 1 if slack_of(regime, row) == math.inf else 2
    if motion.mode[row] == TOUCHING:
        return 0, 2
    if motion.mode[row] != LOADED:
        return 0, 0
    # A loaded contact that is not continued to d < 0 opens without an event, see `find_openings`; so its side 0 is left
    # out.
    end = 3 if length_of(regime, row) < math.inf else 2 if turns(row, regime, motion, slow) else 1
    return 0 if is_continued(chain.law, chain.graph, row) else 1, end


@inlined
def guard_of(row, side, h, ctx):
    """Return the Bernstein coefficients (degree 5) of the guard of a row on a side in the attempted step.

    Two rows of the work array contain the bead velocities at both ends. A contact that starts at an event
    with zero rate is assumed to move as its mode implies. Violations of at most ``bounds.slow`` are round-off.
    """
    chain, regime, motion, trial = ctx.chain, ctx.regime, ctx.motion, ctx.trial
    n, f, slow, work = motion.mode.size, trial.force, ctx.bounds.slow, ctx.scratch.work
    if row >= n:
        # A sliding bead stops when its velocity changes sign.
        j = row - n
        if regime.slide[j] != 0:
            sign, v0, v1 = float(regime.slide[j]), work[VELOCITY_BEFORE, j], work[VELOCITY_AFTER, j]
            a0 = bead_acceleration(j, chain, regime, motion.force, 0.0)
            a1 = bead_acceleration(j, chain, regime, f[2], h)
            return rate_guard(h, sign, v0, a0, v1, a1, slow)
        # A sticking bead slips when the friction that it needs exceeds the largest friction, which brakes change
        # linearly in time. The margin of ROUND_OFF keeps a bead that is exactly at its limit at rest.
        sign = 1.0 if side == 0 else -1.0
        first, last = most_friction(j, chain, regime, 0.0), most_friction(j, chain, regime, h)
        room, wider = first * (1.0 + ROUND_OFF), (last - first) * (1.0 + ROUND_OFF)
        return stage_cubic(
            room + sign * friction_needed(j, chain, regime, motion.force, 0.0),
            room + NODES[0] * wider + sign * friction_needed(j, chain, regime, f[0], h * NODES[0]),
            room + NODES[1] * wider + sign * friction_needed(j, chain, regime, f[1], h * NODES[1]),
            room + wider + sign * friction_needed(j, chain, regime, f[2], h),
        )
    if motion.mode[row] == TOUCHING:
        # The multiplier of a touching contact reaches its lower or upper bound. The margin is that of friction.
        low, high = multiplier_bounds(chain, regime, row, motion.overlap[row])
        slack = ROUND_OFF * max(high, -low)
        sign, offset = (1.0, slack - low) if side == 0 else (-1.0, high + slack)
        return stage_cubic(
            sign * motion.force[row] + offset, sign * f[0, row] + offset, sign * f[1, row] + offset,
            sign * f[2, row] + offset,
        )  # fmt: skip
    # A contact that moves. Multiplied by `sign`, the guard is positive inside the branch; `offset` moves its zero to
    # the slack or to the end of the segment.
    a0 = acceleration_of(row, chain, motion.overlap[row], motion.force, 0.0)
    a1 = acceleration_of(row, chain, trial.overlap[2, row], f[2], h)
    sign, offset = side_of(regime, row), 0.0
    # With loss: the turning point between loading and unloading is the zero of the rate.
    if motion.mode[row] == LOADED and side == 1:
        sign = -sign if regime.easing[row] != 0 else sign
        return rate_guard(h, sign, motion.rate[row], a0, trial.rate[2, row], a1, slow)
    if motion.mode[row] == OPEN and side == 1:
        offset = slack_of(regime, row)
    elif motion.mode[row] == OPEN or side == 2:
        sign, offset = -sign, length_of(regime, row) if side == 2 else 0.0
    # Otherwise the zero of the overlap, by the quintic through values, rates and accelerations of both ends. At an
    # event the contact leaves inward.
    start, rate, bend = sign * motion.overlap[row] + offset, sign * motion.rate[row], sign * a0
    if start == 0.0 and rate <= slow:
        rate, bend = max(rate, 0.0), max(bend, 0.0)
    return hermite_quintic(
        h, start, rate, bend, sign * trial.overlap[2, row] + offset, sign * trial.rate[2, row], sign * a1
    )


@inlined
def rate_guard(h, sign, v0, a0, v1, a1, slow):
    """Return the guard ``sign v`` of a rate or velocity: the cubic through both ends of the step."""
    # A velocity that is zero at the start up to round-off must not be found as an event.
    lift = slow if sign * v0 <= slow else 0.0
    y0, y1 = sign * v0 + lift, sign * v1 + lift
    return elevated(y0, y0 + h * (sign * a0) / 3.0, y1 - h * (sign * a1) / 3.0, y1)


@inlined
def stays(row, h, ctx):
    """Return True if the contact or bed surely keeps its mode during the step, even if its guard has a root.

    The polynomial through the stages of a held contact can be badly wrong. Without these rules, chains of random
    clusters, beds and couplers take up to a hundred times as many steps. They add to the guards, and none of them lets
    a step pass over an event: each requires that the constraint is well inside its branch at all nodes.
    """
    motion = ctx.motion
    if row >= motion.mode.size:
        return bed_stays(row - motion.mode.size, h, ctx)
    if motion.mode[row] == OPEN:
        return open_stays(row, ctx)
    return touching_stays(row, ctx) if motion.mode[row] == TOUCHING else onset_stays(row, h, ctx)


@inlined
def bed_stays(j, h, ctx):
    """Return True if bead j sticks and needs less than half of the largest friction at all nodes.

    Prevents: events of friction that is far below its limit, from a cubic that overshoots between the nodes.
    """
    chain, regime, f = ctx.chain, ctx.regime, ctx.trial.force
    if regime.slide[j] != 0:
        return False
    least = min(most_friction(j, chain, regime, 0.0), most_friction(j, chain, regime, h))
    needed = abs(friction_needed(j, chain, regime, ctx.motion.force, 0.0))
    for k in range(3):
        needed = max(needed, abs(friction_needed(j, chain, regime, f[k], h * NODES[k])))
    return needed < 0.5 * least


@inlined
def open_stays(i, ctx):
    """Return True if open contact i does not move, flies apart, or closes too slowly to matter.

    Prevents: closings by round-off, whose times are arbitrary, and searches for contacts that no force can close.
    """
    motion, trial = ctx.motion, ctx.trial
    if motion.rate[i] == 0.0 == trial.rate[2, i] and trial.overlap[2, i] == motion.overlap[i]:
        return True
    if flies_apart(i, ctx.chain, ctx.regime, motion, trial):
        return True
    return closes_inactive(ctx.chain, i, ctx.bounds.inactive, motion.rate[i], trial.rate[2, i], trial.overlap[2, i])


@inlined
def touching_stays(i, ctx):
    """Return True if the force of touching contact i is at all nodes in the half of its range away from yielding.

    For a pushing contact this is the lower half. Prevents: yielding of contacts that barely carry a force.
    """
    f = ctx.trial.force
    low, high = multiplier_bounds(ctx.chain, ctx.regime, i, ctx.motion.overlap[i])
    least, most = min(f[0, i], f[1, i], f[2, i]), max(f[0, i], f[1, i], f[2, i])
    half = 0.5 * (low + high)
    if low < 0.0:  # it pulls
        return least >= half and most <= high - ROUND_OFF * low
    return least >= low - ROUND_OFF * high and most <= half


@inlined
def onset_stays(i, h, ctx):
    """Return True if loaded contact i starts at d = 0 with zero rate and is pressed in at the end, or does not move.

    Prevents: openings at the onset of a force. The push that a neighbour passes on can start with any power of time, so
    the polynomial through both ends does not help here.
    """
    motion, trial, slow = ctx.motion, ctx.trial, ctx.bounds.slow
    inward, at_start = side_of(ctx.regime, i), motion.overlap[i] == 0.0 and abs(motion.rate[i]) <= slow
    d0, d1, d2 = inward * trial.overlap[0, i], inward * trial.overlap[1, i], inward * trial.overlap[2, i]
    pressed = 0.0 <= d0 <= d1 <= d2 and inward * trial.rate[2, i] >= 0.0
    still = abs(trial.overlap[2, i]) <= slow * h and abs(trial.rate[2, i]) <= slow  # no more than round-off
    return at_start and (still or (pressed and d2 < length_of(ctx.regime, i)))


@inlined
def first_corner(h, target_row, target_side, ctx):
    """Return the first Event in the attempted step of length `h`.

    The step should end at the event of `target_row` on `target_side` (-1: at no event). If the guard of this event
    decreases at the end of the step, ``Event.miss`` is the time by which the step is too short, from the end slope of
    the guard. Otherwise it is NaN, and this guard is searched like all others.
    """
    chain, regime, motion, trial, slow = ctx.chain, ctx.regime, ctx.motion, ctx.trial, ctx.bounds.slow
    row, at, part, miss, near = NO_CONTACT, ZERO, 1.0, math.nan, 1.0
    beds = regime.bed.size
    # The velocities of the beads are needed only for the guards of beds.
    if beds:
        bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], ctx.scratch.work[VELOCITY_BEFORE])
        bead_velocities(trial.rate[2], chain.anchor_bead, trial.anchor[1], ctx.scratch.work[VELOCITY_AFTER])
    for r in range(motion.mode.size + beds):
        first, end = sides_of(r, chain, regime, motion, slow)
        if first == end or (r != target_row and stays(r, h, ctx)):
            continue
        for side in range(first, end):
            # Side 1 of a loaded contact exists only with loss.
            if side == 1 and r < motion.mode.size and motion.mode[r] == LOADED and not turns(r, regime, motion, slow):
                continue
            b = guard_of(r, side, h, ctx)
            # The event at which the step should end: Newton's step for the end time, with the end slope of the guard
            # (5 (b5 - b4) per unit of the step).
            if r == target_row and side == target_side and b[5] < b[4]:
                miss = 0.2 * h * b[5] / (b[4] - b[5])
                continue
            # Any other guard: its first root by subdivision. The earliest root of all is the event.
            x = first_root(b)
            if x < part:
                row, at, part = ZERO + r, ZERO + side, x
            elif x == NONE and r < motion.mode.size and motion.mode[r] != LOADED:
                near = min(near, nearest(r, side, h, b, ctx))
    return Event(row, at, part, miss, near)


@inlined
def nearest(i, side, h, b, ctx):
    """Return the fraction of the step at which the guard `b` of contact i is closer to 0 than its polynomial is
    accurate; 1 if nowhere.

    A step that ends there is checked exactly, so a grazing event is not missed.
    """
    margin = inaccuracy(i, side, h, b, ctx)
    if min(b[1], b[2], b[3], b[4]) >= margin:
        return 1.0
    part, least = lowest(b)
    if part >= 1.0:
        return 1.0
    # A shallow dip is ignored: the guard must fall by more than it has left.
    return part if least < min(margin, min(b[0], b[5]) - least) else 1.0


@inlined
def inaccuracy(i, side, h, b, ctx):
    """Return by how much the guard `b` of contact i can be wrong within the step; 0 if its sign is not in doubt."""
    motion, trial = ctx.motion, ctx.trial
    d0, d1, w0, w1 = motion.overlap[i], trial.overlap[2, i], motion.rate[i], trial.rate[2, i]
    low, high = multiplier_bounds(ctx.chain, ctx.regime, i, d0)
    # a touching contact nearly yields: the safety margin of its range
    if motion.mode[i] == TOUCHING and (side == 1) == (low >= 0.0):
        return (1.0 - SAFETY) * (high - low)
    # an open contact nearly closes: difference of cubic and quintic in the middle
    if motion.mode[i] == OPEN and side == 0 and w0 > 0.0 > w1:
        middle = (b[0] + b[5] + 5.0 * (b[1] + b[4]) + 10.0 * (b[2] + b[3])) / 32.0
        return abs(middle + 0.5 * (d0 + d1) + 0.125 * h * (w0 - w1))
    return -math.inf


@inlined
def lowest(b):
    """Return the fraction of the step at which the guard `b` has its minimum, and its value there; 1 without a minimum
    inside.
    """
    # differences of the coefficients: the derivative of the guard, with negative sign
    c0, c1, c2, c3, c4 = b[0] - b[1], b[1] - b[2], b[2] - b[3], b[3] - b[4], b[4] - b[5]
    # The minimum of the guard is the first root of its derivative, raised to degree 5.
    fall = (c0, 0.2 * c0 + 0.8 * c1, 0.4 * c1 + 0.6 * c2, 0.6 * c2 + 0.4 * c3, 0.8 * c3 + 0.2 * c4, c4)
    part = first_root(fall)
    if part >= 1.0:
        return 1.0, b[5]
    return part, halves(part, b)[0][5]


NONE = 2.0  # Value of `first_root` for a polynomial without a root


@inlined
def hermite_quintic(h, y0, v0, a0, y1, v1, a1):
    """Return the Bernstein coefficients of the quintic through values, rates and accelerations at both ends of a step
    of length h.
    """
    return (
        y0,
        y0 + h * v0 / 5.0,
        y0 + h * (0.4 * v0 + 0.05 * h * a0),
        y1 - h * (0.4 * v1 - 0.05 * h * a1),
        y1 - h * v1 / 5.0,
        y1,
    )


@inlined
def elevated(b0, b1, b2, b3):
    """Return the coefficients of degree 5 of a cubic (degree elevation)."""
    return (
        b0,
        0.4 * b0 + 0.6 * b1,
        0.1 * b0 + 0.6 * b1 + 0.3 * b2,
        0.3 * b1 + 0.6 * b2 + 0.1 * b3,
        0.6 * b2 + 0.4 * b3,
        b3,
    )


@inlined
def stage_cubic(y0, y1, y2, y3):
    """Return the Bernstein coefficients (degree 5) of the cubic through the start and the three stages of a step."""
    # Newton's divided differences at 0, c1, c2 and 1, then conversion to Bernstein form.
    c1, c2 = NODES[0], NODES[1]
    first, second, third = (y1 - y0) / c1, (y2 - y1) / (c2 - c1), (y3 - y2) / (1.0 - c2)
    left, right = (second - first) / c2, (third - second) / (1.0 - c1)
    bend = right - left
    slope = first - c1 * left + c1 * c2 * bend
    b1 = y0 + slope / 3.0
    b2 = b1 + (slope + left - (c1 + c2) * bend) / 3.0
    return elevated(y0, b1, b2, y3)


@inlined
def halves(x, b):
    """Return the coefficients of the parts [0, x] and [x, 1] by de Casteljau's algorithm."""
    b0, b1, b2, b3, b4, b5 = b
    c0, c1, c2, c3, c4 = (
        b0 + x * (b1 - b0),
        b1 + x * (b2 - b1),
        b2 + x * (b3 - b2),
        b3 + x * (b4 - b3),
        b4 + x * (b5 - b4),
    )
    d0, d1, d2, d3 = c0 + x * (c1 - c0), c1 + x * (c2 - c1), c2 + x * (c3 - c2), c3 + x * (c4 - c3)
    e0, e1, e2 = d0 + x * (d1 - d0), d1 + x * (d2 - d1), d2 + x * (d3 - d2)
    f0, f1 = e0 + x * (e1 - e0), e1 + x * (e2 - e1)
    g = f0 + x * (f1 - f0)
    return (b0, c0, d0, e0, f0, g), (g, f1, e2, d3, c4, b5)


@inlined
def hull_crossing(c, points):
    """Return the first fraction at which the convex hull of the first control `points` of c reaches 0; 1 if it does
    not.
    """
    found = 1.0
    # The hull crosses 0 on a line from a control point above 0 to a later one below it.
    for k in range(1, points):
        if c[k] < 0.0:
            for j in range(k):
                if c[j] >= 0.0:
                    found = min(found, (j + (k - j) * c[j] / (c[j] - c[k])) / (points - 1))
    return found


@inlined
def safe_move(b):
    """Return a fraction of the interval within which the polynomial stays positive. b0 must be >= 0."""
    if b[0] > 0.0:
        return hull_crossing(b, 6)
    if b[1] > 0.0:  # A root at 0 is divided out.
        return hull_crossing((b[1], b[2] / 2.0, b[3] / 3.0, b[4] / 4.0, b[5] / 5.0, 0.0), 5)
    # Value and slope are 0 at the start: the event is now if the guard falls, otherwise skip a short part.
    return 0.0 if b[1] < 0.0 or b[2] < 0.0 else FIRST_PART


@inlined
def first_root(b):
    """Return the first x in [0, 1] at which the quintic with coefficients `b` changes from positive to negative; NONE
    without a root.
    """
    left, width = 0.0, 1.0
    # Round-off below 0 at the start is not a root.
    b = (max(b[0], 0.0), b[1], b[2], b[3], b[4], b[5])
    for _ in range(MOST_MOVES):
        # No coefficient is negative: by the convex hull property the rest of the interval contains no root.
        if min(b[1], b[2], b[3], b[4], b[5]) >= 0.0:
            return NONE
        # Move to the crossing of the hull. The search has converged if this does not move any more.
        move = safe_move(b)
        if move * width <= ROUND_OFF and (b[1] < 0.0 or width <= ROUND_OFF):
            return left
        _, b = halves(move, b)
        b = (max(b[0], 0.0), b[1], b[2], b[3], b[4], b[5])
        left += move * width
        width *= 1.0 - move
        # Then bisect, once in the middle and once just behind the start: keep the first part that contains a sign
        # change.
        for part in (0.5, min(0.5, max(2.0 * move, ROUND_OFF))):
            near, far = halves(part, b)
            if near[5] < 0.0:
                b, width = near, part * width
            elif min(near[1], near[2], near[3], near[4], near[5]) >= 0.0:
                b, left, width = far, left + part * width, (1.0 - part) * width
    return NONE
