"""Contacts whose graph has several segments, in kernels: force, energy, mean force and resolvent.

The force rises with the overlap d. It is one monotone graph on loading and another on unloading, where a segment with loss l
keeps (1 - l) of its power law. A segment that pushes (side 1) is loaded as d rises, one that pulls (side -1) as d falls. So a
graph has one force f_up(d) on the way up and one f_down(d) <= f_up(d) on the way down.

A discrete-gradient step from d0 to d0 + x has the mean force

    g(x) = (E(d0 + x) - E(d0)) / x,    E the integral of f_up for x > 0, of f_down for x < 0,

which rises with x. A coupler that has not coupled yet has no segments that pull.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_kernels import EPSILON, MOST_SCALAR, energy
from softcradle.physics.numerics.records import (
    BEFORE,
    EXPONENT,
    LENGTH,
    LOSS,
    ORIGIN,
    PRELOAD,
    SEGMENTS,
    SIDE,
    STIFFNESS,
    STOP,
)
from softcradle.physics.numerics.resolvent import mean_force, resolvent_slope


@inlined
def has_segments(graph, i):
    """Return whether the graph of contact i has more segments than one power law from overlap 0 on."""
    return graph.kind.size > 0 and graph.kind[i] == SEGMENTS


@inlined
def first_row(graph, i):
    """Return the row of the first segment of contact i that acts; pulling segments stand first."""
    p = graph.first[i]
    while graph.coupled[i] == 0 and graph.segment[p, SIDE] < 0.0:
        p += 1
    return p


@inlined
def pulls_below(graph, i):
    """Return the overlap below which contact i pulls; -inf if it does not."""
    found = -math.inf
    if has_segments(graph, i):
        for p in range(first_row(graph, i), graph.first[i + 1]):
            if graph.segment[p, SIDE] < 0.0:
                found = graph.segment[p, ORIGIN]
    return found


@inlined
def segment_force(row, x, unloading):
    """Return the force of a segment at the displacement x >= 0 from its origin, without its side."""
    y = x + row[BEFORE]
    law = row[PRELOAD] + (row[STIFFNESS] * power(y, row[EXPONENT]) if y > 0.0 else 0.0)
    return (1.0 - row[LOSS] if unloading else 1.0) * law + row[STOP] * x


@jit
def graph_force(graph, i, overlap, beside, up):
    """Return the force of contact i at `overlap` on the way `up` or down.

    `beside` selects the limit from the left (-1) or from the right (1) if the force jumps there; 0: the smaller one.
    """
    found = 0.0
    for p in range(first_row(graph, i), graph.first[i + 1]):
        row = graph.segment[p]
        side = row[SIDE]
        x = side * (overlap - row[ORIGIN])
        if x > 0.0 or (x == 0.0 and side * beside > 0.0):
            found = side * segment_force(row, x, (side > 0.0) != up)
            # the outermost segment counts: on the pulling side it is the first, on the pushing side the last
            if side < 0.0:
                break
    return found


@jit
def graph_fall(graph, i, start, end, lost):
    """Return how far the stored energy of contact i falls from one overlap to another; if `lost`, the part that it dissipates."""
    fall = 0.0
    for p in range(first_row(graph, i), graph.first[i + 1]):
        row = graph.segment[p]
        before = row[BEFORE]
        a = min(max(row[SIDE] * (start - row[ORIGIN]), 0.0), row[LENGTH])
        b = min(max(row[SIDE] * (end - row[ORIGIN]), 0.0), row[LENGTH])
        of_law = energy(row[PRELOAD], row[STIFFNESS], row[EXPONENT], a + before)
        of_law -= energy(row[PRELOAD], row[STIFFNESS], row[EXPONENT], b + before)
        fall += row[LOSS] * max(of_law, 0.0) if lost else of_law + 0.5 * row[STOP] * (a - b) * (a + b)
    return fall


@inlined
def segment_mean(row, a, b, unloading):
    """Return the mean force of a segment between the displacements a and b >= 0, without its side, and its slope by b."""
    before, exponent = row[BEFORE], row[EXPONENT]
    start, end = a + before, b + before
    share = 1.0 - row[LOSS] if unloading else 1.0
    if start == 0.0 and end == 0.0:
        return share * row[PRELOAD], 0.0
    if end > 0.0:
        start_power = power(start, exponent) if start > 0.0 else 0.0
        mean, slope = mean_force(row[PRELOAD], row[STIFFNESS], exponent, start, start_power, end)
    else:  # to the origin: the mean is the same both ways
        mean, _ = mean_force(row[PRELOAD], row[STIFFNESS], exponent, 0.0, 0.0, start)
        slope = (mean - row[PRELOAD]) / start
    return share * mean + 0.5 * row[STOP] * (a + b), share * slope + 0.5 * row[STOP]


@inlined
def graph_mean(graph, i, start, moved, up):
    """Return the mean force of contact i from overlap `start` to `start` + `moved`, and its slope by `moved`.

    `up` selects the graph of the way up or down. If `moved` is 0, return the force at the start, on that side of it.
    """
    if moved == 0.0:
        return graph_force(graph, i, start, 1.0 if up else -1.0, up), 0.0
    work = 0.0
    for p in range(first_row(graph, i), graph.first[i + 1]):
        row = graph.segment[p]
        side, length = row[SIDE], row[LENGTH]
        begin = side * (start - row[ORIGIN])
        way = side * moved
        a, b = min(max(begin, 0.0), length), min(max(begin + way, 0.0), length)
        whole = a == begin and b == begin + way
        if a == b and not whole:
            continue
        mean, slope = segment_mean(row, a, b, (side > 0.0) != up)
        if whole:  # no other segment takes part, and no digits are lost in a difference
            return side * mean, slope
        work += mean * (b - a)
    mean = work / moved
    end = graph_force(graph, i, start + moved, 0.0, up)
    return mean, max((end - mean) / moved, 0.0)


@inlined
def graph_resolvent(graph, i, start, ahead, low_force, high_force, weight, s):
    """Return the one (x, g) of contact i with x + weight g(x) = s, and dg/ds; x is the change of its overlap, g the mean force.

    At x = `ahead` it stands still at the end of the step; `low_force` and `high_force` are g there on the way down and up. There,
    and at x = 0 if a preload begins there, g may have any value between.
    """
    if ahead + weight * low_force <= s <= ahead + weight * high_force and high_force > low_force:
        return ahead, (s - ahead) / weight, 1.0 / weight
    up = s > ahead + weight * high_force
    low, high = (ahead, math.inf) if up else (-math.inf, ahead)
    if (up and ahead <= 0.0) or (not up and ahead >= 0.0):
        below, above = graph_force(graph, i, start, -1.0, up), graph_force(graph, i, start, 1.0, up)
        if weight * below <= s <= weight * above:
            return 0.0, s / weight, 1.0 / weight if above > below else 0.0
        if s > weight * above:
            low = max(low, 0.0)
        else:
            high = min(high, 0.0)
    return search_resolvent(graph, i, start, up, low, high, weight, s)


@jit
def search_resolvent(graph, i, start, up, low, high, weight, s):
    """Return x in (low, high) by Newton's method with a bracket: x + weight g(x) - s rises by at least 1 for each 1 of x."""
    x = min(max(s, low), high)
    if not (low < x < high):
        x = low + 1.0 if high == math.inf else (high - 1.0 if low == -math.inf else 0.5 * (low + high))
    g, slope = 0.0, 0.0
    for _ in range(2 * MOST_SCALAR):
        g, slope = graph_mean(graph, i, start, x, up)
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
    g, slope = graph_mean(graph, i, start, x, up)
    return x, (s - x) / weight if weight * slope > 1.0 else g, resolvent_slope(slope, weight)


@inlined
def settle_graph_forces(graph, motion):
    """Replace the mean force of a contact that a step has carried over an end of its slack by the force at its overlap.

    The sign of this force shows whether the contact pushes or pulls, and 0 that it does neither.
    """
    if graph.kind.size:
        for i in range(motion.overlap.size):
            if not has_segments(graph, i):
                continue
            overlap, force, below = motion.overlap[i], motion.force[i], pulls_below(graph, i)
            wrong = force != 0.0 if below < overlap < 0.0 else (overlap < below and force >= 0.0)
            if wrong or (overlap > 0.0 and force < 0.0):
                motion.force[i] = graph_force(graph, i, overlap, 0.0, motion.rate[i] >= 0.0)


@inlined
def closing_overlap(graph, i, overlap, rate):
    """Return the overlap at which contact i has closed or opened last: 0, or the end of the slack at which it pulls."""
    below = pulls_below(graph, i)
    return 0.0 if overlap > 0.0 or (overlap >= below and rate < 0.0) or below == -math.inf else below
