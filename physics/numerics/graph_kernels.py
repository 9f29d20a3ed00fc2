"""Kernels for contacts whose graph has several segments: force, energy, mean force and resolvent.

The force rises with the overlap d along a monotone graph. Loading and unloading have different graphs, because a
segment with loss l keeps only (1 - l) of its power law during unloading. A pushing segment (side 1) is loaded while d
rises, a pulling segment (side -1) while d falls. So there is a force f_up(d) for rising d and a force f_down(d) <=
f_up(d) for falling d.

A discrete-gradient step from d0 to d0 + x has the mean force

    g(x) = (E(d0 + x) - E(d0)) / x,    E the integral of f_up for x > 0, of f_down for x < 0,

which rises with x. The pulling segments of a coupler are ignored until it has coupled.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_kernels import EPSILON, MOST_SCALAR, energy, newton_in_bracket
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
    """Return True if the graph of contact i has more segments than a single power law from overlap 0 on."""
    return graph.kind.size > 0 and graph.kind[i] == SEGMENTS


@inlined
def first_row(graph, i):
    """Return the row of the first active segment of contact i. Pulling segments come first and are skipped before coupling."""
    p = graph.first[i]
    while graph.coupled[i] == 0 and graph.segment[p, SIDE] < 0.0:
        p += 1
    return p


@inlined
def pulls_below(graph, i):
    """Return the overlap [m] below which contact i pulls, or -inf if it never pulls."""
    found = -math.inf
    if has_segments(graph, i):
        for p in range(first_row(graph, i), graph.first[i + 1]):
            if graph.segment[p, SIDE] < 0.0:
                found = graph.segment[p, ORIGIN]
    return found


@inlined
def segment_force(row, x, unloading):
    """Return the force [N] of a segment at the displacement x >= 0 [m] from its origin, without the sign of its side."""
    y = x + row[BEFORE]
    law = row[PRELOAD] + (row[STIFFNESS] * power(y, row[EXPONENT]) if y > 0.0 else 0.0)
    return (1.0 - row[LOSS] if unloading else 1.0) * law + row[STOP] * x


@jit
def graph_force(graph, i, overlap, beside, up):
    """Return the force [N] of contact i at `overlap`, on the graph for a rising overlap if `up`, else for a falling one.

    `beside` selects the limit from the left (-1) or from the right (1) if the force has a step there. With 0 the
    smaller force is returned.
    """
    found = 0.0
    for p in range(first_row(graph, i), graph.first[i + 1]):
        row = graph.segment[p]
        side = row[SIDE]
        # displacement from the origin of the segment; negative: the segment is not reached
        x = side * (overlap - row[ORIGIN])
        if x > 0.0 or (x == 0.0 and side * beside > 0.0):
            found = side * segment_force(row, x, (side > 0.0) != up)
            # The outermost segment that is reached determines the force: the first on the pulling side, the last on the
            # pushing side.
            if side < 0.0:
                break
    return found


@jit
def graph_fall(graph, i, start, end, lost):
    """Return by how much the stored energy [J] of contact i falls between two overlaps; if `lost`, the dissipated part of it."""
    fall = 0.0
    for p in range(first_row(graph, i), graph.first[i + 1]):
        row = graph.segment[p]
        before = row[BEFORE]
        # the part of the way that lies within this segment
        a = min(max(row[SIDE] * (start - row[ORIGIN]), 0.0), row[LENGTH])
        b = min(max(row[SIDE] * (end - row[ORIGIN]), 0.0), row[LENGTH])
        of_law = energy(row[PRELOAD], row[STIFFNESS], row[EXPONENT], a + before)
        of_law -= energy(row[PRELOAD], row[STIFFNESS], row[EXPONENT], b + before)
        fall += row[LOSS] * max(of_law, 0.0) if lost else of_law + 0.5 * row[STOP] * (a - b) * (a + b)
    return fall


@inlined
def segment_mean(row, a, b, unloading):
    """Return the mean force of a segment between the displacements a and b >= 0, and its derivative by b, without its side."""
    before, exponent = row[BEFORE], row[EXPONENT]
    start, end = a + before, b + before
    # only the power law has loss; the stop is an elastic spring
    share = 1.0 - row[LOSS] if unloading else 1.0
    if start == 0.0 and end == 0.0:
        return share * row[PRELOAD], 0.0
    if end > 0.0:
        start_power = power(start, exponent) if start > 0.0 else 0.0
        mean, slope = mean_force(row[PRELOAD], row[STIFFNESS], exponent, start, start_power, end)
    else:  # b is the origin. The mean force does not depend on the direction, so a and b may be exchanged.
        mean, _ = mean_force(row[PRELOAD], row[STIFFNESS], exponent, 0.0, 0.0, start)
        slope = (mean - row[PRELOAD]) / start
    return share * mean + 0.5 * row[STOP] * (a + b), share * slope + 0.5 * row[STOP]


@inlined
def graph_mean(graph, i, start, moved, up):
    """Return the mean force [N] of contact i from overlap `start` to `start` + `moved`, and its derivative by `moved`.

    `up` selects the graph for a rising overlap, else the graph for a falling overlap is used. If `moved` is 0, return
    the force at the start, as the limit from that side.
    """
    if moved == 0.0:
        return graph_force(graph, i, start, 1.0 if up else -1.0, up), 0.0
    work = 0.0
    for p in range(first_row(graph, i), graph.first[i + 1]):
        row = graph.segment[p]
        side, length = row[SIDE], row[LENGTH]
        # clip the way of the overlap to this segment
        begin = side * (start - row[ORIGIN])
        way = side * moved
        a, b = min(max(begin, 0.0), length), min(max(begin + way, 0.0), length)
        whole = a == begin and b == begin + way
        if a == b and not whole:
            continue
        mean, slope = segment_mean(row, a, b, (side > 0.0) != up)
        # The whole way lies within one segment. Its own formula avoids the cancellation in a difference of energies.
        if whole:
            return side * mean, slope
        work += mean * (b - a)
    # the way covers several segments: their work, divided by the length of the way
    mean = work / moved
    end = graph_force(graph, i, start + moved, 0.0, up)
    return mean, max((end - mean) / moved, 0.0)


@inlined
def graph_resolvent(graph, i, start, ahead, low_force, high_force, weight, s):
    """Return the unique (x, g) of contact i with x + weight g(x) = s, and dg/ds.

    x is the change of the overlap and g the mean force. At x = `ahead` the contact has rate 0 at the end of the step;
    `low_force` and `high_force` are the values of g there for a falling and a rising overlap. At this x, and at x = 0
    if a preload begins there, the graph is vertical: g may have any value between its limits.
    """
    # on the vertical piece at x = ahead
    if ahead + weight * low_force <= s <= ahead + weight * high_force and high_force > low_force:
        return ahead, (s - ahead) / weight, 1.0 / weight
    # Above this vertical piece the overlap rises during the step, below it the overlap falls.
    up = s > ahead + weight * high_force
    low, high = (ahead, math.inf) if up else (-math.inf, ahead)
    # x = 0 lies within the range of this branch and may be a vertical piece (a step of the force at the start)
    if (up and ahead <= 0.0) or (not up and ahead >= 0.0):
        below, above = graph_force(graph, i, start, -1.0, up), graph_force(graph, i, start, 1.0, up)
        if weight * below <= s <= weight * above:
            return 0.0, s / weight, 1.0 / weight if above > below else 0.0
        if s > weight * above:
            low = max(low, 0.0)
        else:
            high = min(high, 0.0)
    # a regular point of the branch
    return search_resolvent(graph, i, start, up, low, high, weight, s)


@jit
def search_resolvent(graph, i, start, up, low, high, weight, s):
    """Return x in (low, high), g and dg/ds by Newton's method with a bracket.

    The residual x + weight g(x) - s has a slope of at least 1.
    """
    # start from x = s, the solution without force
    x = min(max(s, low), high)
    if not (low < x < high):
        x = low + 1.0 if high == math.inf else (high - 1.0 if low == -math.inf else 0.5 * (low + high))
    g, slope = 0.0, 0.0
    for _ in range(2 * MOST_SCALAR):
        g, slope = graph_mean(graph, i, start, x, up)
        # because the slope is at least 1, the root is at most `excess` away: both ends of the bracket move
        excess = x + weight * g - s
        low, high = (max(low, x - excess), high) if excess >= 0.0 else (low, min(high, x - excess))
        following, low, high = newton_in_bracket(x, excess, 1.0 + weight * slope, low, high)
        if abs(following - x) <= 2.0 * EPSILON * abs(x) or high - low <= 2.0 * EPSILON * max(abs(low), abs(high)):
            x = following
            break
        x = following
    # If the graph is steep, (s - x) / weight gives the force with less round-off.
    g, slope = graph_mean(graph, i, start, x, up)
    return x, (s - x) / weight if weight * slope > 1.0 else g, resolvent_slope(slope, weight)


@inlined
def settle_graph_forces(graph, motion):
    """Replace the mean force of a contact that crossed an end of its slack during the step by the force at its present overlap.

    Afterwards the sign of the force shows whether the contact pushes or pulls; 0 means that it does neither.
    """
    if graph.kind.size:
        for i in range(motion.overlap.size):
            if not has_segments(graph, i):
                continue
            # the sign of the mean force contradicts the overlap: a force inside the slack, or the wrong sign beyond it
            overlap, force, below = motion.overlap[i], motion.force[i], pulls_below(graph, i)
            wrong = force != 0.0 if below < overlap < 0.0 else (overlap < below and force >= 0.0)
            if wrong or (overlap > 0.0 and force < 0.0):
                motion.force[i] = graph_force(graph, i, overlap, 0.0, motion.rate[i] >= 0.0)


@inlined
def closing_overlap(graph, i, overlap, rate):
    """Return the overlap [m] at which contact i has last closed or opened: 0, or the end of the slack."""
    below = pulls_below(graph, i)
    return 0.0 if overlap > 0.0 or (overlap >= below and rate < 0.0) or below == -math.inf else below
