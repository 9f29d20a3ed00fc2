"""Forces and brakes over time, linear between knots, on the beads of a chain: their values, their means, their work."""

from __future__ import annotations

import math

from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.jit import inlined, jit

# of the time between two knots: values at a knot are taken so far beside it, so that what begins there at 0 has its sign
BESIDE = 1e-13


@inlined
def knots_until(time, knots):
    """How many knots lie at `time` or before."""
    first, last = 0, knots.time.size
    while first < last:
        middle = (first + last) // 2
        if knots.time[middle] <= time:
            first = middle + 1
        else:
            last = middle
    return first


@inlined
def drive_at(chain, i, passed):
    """w' of contact i by forces from outside, `passed` [s] after now; a' of the anchor bead where i is the number of contacts."""
    if chain.external.size == 0:
        return 0.0
    found = chain.external[i]
    if chain.knots.bend.size:
        found += passed * chain.knots.bend[i]
    return found


@inlined
def next_knot(time, end, knots):
    """The first knot after `time`, or `end` where that is earlier."""
    k = knots_until(time, knots)
    return min(end, knots.time[k]) if k < knots.time.size else end


@inlined
def rows_differ(k, knots):
    """Return True if a force or a brake changes from knot k - 1 to knot k."""
    differ = False
    for j in range(knots.push.shape[1]):
        differ |= knots.push[k - 1, j] != knots.push[k, j]
    for j in range(knots.brake.shape[1]):
        differ |= knots.brake[k - 1, j] != knots.brake[k, j]
    return differ


@jit
def steady_until(time, knots):
    """Return the time until which all forces and brakes keep their values: `time` if they change now, inf after the last knot."""
    k, count = knots_until(time, knots), knots.time.size
    if k == 0:  # they are 0 before the first knot
        return knots.time[0]
    last = time
    while k < count and not rows_differ(k, knots):
        last = knots.time[k]
        k += 1
    return last if k < count else math.inf


@inlined
def add_row(part, k, knots, push, bed):
    """Add a part of the forces and brakes at knot k."""
    if part != 0.0:
        for j in range(push.size):
            push[j] += part * knots.push[k, j]
        for j in range(min(bed.size, knots.brake.shape[1])):
            bed[j] += part * knots.brake[k, j]


@inlined
def put_steady(knots, push, bed):
    """Put what does not change into `push` (n+1,) [N] and `bed` (n+1,) [m/s²]."""
    for j in range(push.size):
        push[j] = knots.drive[j]
    for j in range(min(bed.size, knots.brake.shape[1])):
        bed[j] = knots.friction[j]


@jit
def put_mean(begun, h, knots, push, bed):
    """Put the means of all forces from `begun` on over `h` [s] into `push` and `bed`: of what is linear, and over knots too."""
    first, last, count = min(begun, begun + h), max(begun, begun + h), knots.time.size
    put_steady(knots, push, bed)
    k = knots_until(first, knots)
    while True:
        low = max(first, knots.time[k - 1]) if k > 0 else first
        high = min(last, knots.time[k]) if k < count else last
        part = (high - low) / (last - first) if last > first else 1.0
        if k == count:
            add_row(part, k - 1, knots, push, bed)
            return
        if k > 0 and part > 0.0:
            late = (0.5 * (low + high) - knots.time[k - 1]) / (knots.time[k] - knots.time[k - 1])
            add_row(part * (1.0 - late), k - 1, knots, push, bed)
            add_row(part * late, k, knots, push, bed)
        if knots.time[k] >= last:
            return
        k += 1


@jit
def put_values(time, knots, push, bed):
    """Put all forces at `time` into `push` and `bed`, and by how much they change a second into the slopes of `knots`.

    Returns whether they do, or a force over time acts: whether beads that nothing touches do not move under steady forces.
    """
    k, count = knots_until(time, knots), knots.time.size
    put_steady(knots, push, bed)
    length, late, before, after = 1.0, 0.0, k - 1, k - 1
    if 0 < k < count:
        length, after = knots.time[k] - knots.time[k - 1], k
        late = min(max((time - knots.time[k - 1]) / length, BESIDE), 1.0 - BESIDE)
    if k > 0:
        add_row(1.0 - late, before, knots, push, bed)
        add_row(late, after, knots, push, bed)
    acts = False
    for j in range(push.size):
        knots.push_slope[j] = (knots.push[after, j] - knots.push[before, j]) / length if k > 0 else 0.0
        acts |= knots.push_slope[j] != 0.0 or push[j] != knots.drive[j]
    for j in range(min(bed.size, knots.brake.shape[1])):
        knots.brake_slope[j] = (knots.brake[after, j] - knots.brake[before, j]) / length if k > 0 else 0.0
        acts |= knots.brake_slope[j] != 0.0
    return acts


@inlined
def add_half_work(h, chain, motion, velocity):
    """Add what forces over time, now means of a step, give in half of it at the present velocities; `velocity` (n+1,) scratch."""
    bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
    for j in range(velocity.size):
        if chain.inverse_mass[j] > 0.0:
            motion.taken[2] += 0.5 * h * (chain.push[j] - chain.knots.drive[j]) * velocity[j]
