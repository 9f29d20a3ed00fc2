"""Couplers inside kernels: a joint of several contacts between the same two beads, each with a side and an origin of its own.

A part pushes (side 1) or pulls (side -1) by the preloaded power law of its own overlap x = side (d - origin). The force of the
joint, sum of side * force, rises with d whatever its parts are. Where a part with loss comes out it has (1 - loss) of its force:
pushing parts come out as d falls, pulling ones as it rises, so that the joint has one force on the way up and a smaller one on
the way down.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_kernels import EPSILON, MOST_SCALAR, energy, force
from softcradle.physics.numerics.resolvent import mean_force, resolvent_slope

PRELOAD, STIFFNESS, EXPONENT, LOSS, SIDE, ORIGIN = 0, 1, 2, 3, 4, 5  # columns of the parts


@inlined
def is_joint(joints, i):
    """Whether contact i is a coupler."""
    return joints.first.size > 0 and joints.first[i + 1] > joints.first[i]


@inlined
def joint_force(joints, i, overlap, rate):
    """Force of coupler i at `overlap`, by the sign of its rate; 0 or more is the way up."""
    total = 0.0
    for p in range(joints.first[i], joints.first[i + 1]):
        part = joints.part[p]
        own = force(part[PRELOAD], part[STIFFNESS], part[EXPONENT], part[SIDE] * (overlap - part[ORIGIN]))
        total += part[SIDE] * own * (1.0 - part[LOSS] if part[SIDE] * rate < 0.0 else 1.0)
    return total


@jit
def joint_fall(joints, i, before, after, lost):
    """By how much the energy of coupler i falls from one overlap to another; if `lost`, what it loses of that."""
    fall = 0.0
    for p in range(joints.first[i], joints.first[i + 1]):
        part = joints.part[p]
        start, end = part[SIDE] * (before - part[ORIGIN]), part[SIDE] * (after - part[ORIGIN])
        of_part = energy(part[PRELOAD], part[STIFFNESS], part[EXPONENT], start)
        of_part -= energy(part[PRELOAD], part[STIFFNESS], part[EXPONENT], end)
        fall += part[LOSS] * max(of_part, 0.0) if lost else of_part
    return fall


@inlined
def joint_mean_force(joints, i, start, moved, up):
    """Mean force of coupler i from overlap `start` to `start` + `moved`, on the way `up` or down, and its slope by `moved`.

    For `moved` = 0 the force at its start, on that side of it.
    """
    total, slope = 0.0, 0.0
    for p in range(joints.first[i], joints.first[i + 1]):
        part = joints.part[p]
        begin, way = part[SIDE] * (start - part[ORIGIN]), part[SIDE] * moved
        end = begin + way
        if end <= 0.0 and (begin < 0.0 or (begin == 0.0 and (way < 0.0 or (way == 0.0 and (part[SIDE] > 0.0) != up)))):
            continue
        if end > 0.0 or way == 0.0:
            begin_power = power(begin, part[EXPONENT]) if begin > 0.0 else 0.0
            if begin == 0.0 and way == 0.0:
                own, rise = part[PRELOAD], 0.0
            else:
                own, rise = mean_force(part[PRELOAD], part[STIFFNESS], part[EXPONENT], begin, begin_power, end)
        else:  # it comes out altogether
            stored = energy(part[PRELOAD], part[STIFFNESS], part[EXPONENT], begin)
            own, rise = -stored / way, stored / (way * way)
        kept = 1.0 - part[LOSS] if (part[SIDE] > 0.0) != up else 1.0
        total += part[SIDE] * kept * own
        slope += kept * rise
    return total, slope


@inlined
def joint_resolvent(joints, i, start, ahead, low_force, high_force, weight, s):
    """The one (x, g) of coupler i with x + weight g = s, and dg/ds: x the way of its overlap, g the mean force over it.

    `ahead` is the way at whose end it stands still, `low_force` and `high_force` g there on the way down and up. There the two
    meet, and at x = 0 a preload may begin: at both g may be anything between.
    """
    if ahead + weight * low_force <= s <= ahead + weight * high_force and high_force > low_force:
        return ahead, (s - ahead) / weight, 1.0 / weight
    up = s > ahead + weight * high_force
    low, high = (ahead, math.inf) if up else (-math.inf, ahead)
    if (up and ahead <= 0.0) or (not up and ahead >= 0.0):
        below, above = joint_edges(joints, i, start, up)
        if weight * below <= s <= weight * above:
            return 0.0, s / weight, 1.0 / weight if above > below else 0.0
        if s > weight * above:
            low = max(low, 0.0)
        else:
            high = min(high, 0.0)
    return joint_search(joints, i, start, up, low, high, weight, s)


@jit
def joint_edges(joints, i, start, up):
    """(g just below x = 0, g just above it) of coupler i on the way `up` or down: they differ by preloads that begin there."""
    below, above = 0.0, 0.0
    for p in range(joints.first[i], joints.first[i + 1]):
        part = joints.part[p]
        begin = part[SIDE] * (start - part[ORIGIN])
        kept = 1.0 - part[LOSS] if (part[SIDE] > 0.0) != up else 1.0
        if begin > 0.0:
            own = kept * force(part[PRELOAD], part[STIFFNESS], part[EXPONENT], begin)
            below += part[SIDE] * own
            above += part[SIDE] * own
        elif begin == 0.0 and part[SIDE] > 0.0:
            above += kept * part[PRELOAD]
        elif begin == 0.0:
            below -= kept * part[PRELOAD]
    return below, above


@jit
def joint_search(joints, i, start, up, low, high, weight, s):
    """x in (low, high) by Newton's method, bracketed: x + weight g(x) - s rises by at least 1 for each 1 of x."""
    x = min(max(s, low), high)
    if not (low < x < high):
        x = low + 1.0 if high == math.inf else (high - 1.0 if low == -math.inf else 0.5 * (low + high))
    g, slope = 0.0, 0.0
    for _ in range(2 * MOST_SCALAR):
        g, slope = joint_mean_force(joints, i, start, x, up)
        excess = x + weight * g - s
        if excess > 0.0:
            high = x
            low = max(low, x - excess)
        else:
            low = x
            high = min(high, x - excess)
        move = -excess / (1.0 + weight * slope)
        following = x + move
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - x) <= 2.0 * EPSILON * abs(x) or high - low <= 2.0 * EPSILON * max(abs(low), abs(high)):
            x = following
            break
        x = following
    g, slope = joint_mean_force(joints, i, start, x, up)
    return x, (s - x) / weight if weight * slope > 1.0 else g, resolvent_slope(slope, weight)


@inlined
def settle_joint_forces(joints, motion):
    """Give couplers that have been carried over an end of their slack the force of where they are, in place of a mean.

    The sign of the force of a coupler tells whether it pushes or pulls, and 0 that it does neither.
    """
    if joints.first.size:
        for i in range(motion.overlap.size):
            overlap, present = motion.overlap[i], motion.force[i]
            pulls, pushes = overlap < joints.pulls_below[i], overlap > 0.0
            between = joints.pulls_below[i] < overlap < 0.0
            if is_joint(joints, i) and (
                (between and present != 0.0) or (pulls and present >= 0.0) or (pushes and present < 0.0)
            ):
                motion.force[i] = joint_force(joints, i, overlap, motion.rate[i])


@inlined
def crossed_overlap(joints, i, overlap, rate):
    """The overlap at which contact i has closed or opened last: 0, or the end of the slack at which a coupler pulls."""
    if joints.first.size == 0:
        return 0.0
    below = joints.pulls_below[i]
    return 0.0 if overlap > 0.0 or (overlap >= below and rate < 0.0) or below == -math.inf else below
