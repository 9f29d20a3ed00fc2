"""Forces and brakes over time on the beads: values, means over a step and work. They are piecewise linear between breakpoints."""

from __future__ import annotations

import math

from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.jit import inlined, jit

# Fraction of the time between two breakpoints. At a breakpoint, values are taken this much inside the interval, so that
# a force that starts there at 0 already has its sign.
BESIDE = 1e-13


@inlined
def knots_until(time, knots):
    """Return the number of breakpoints at `time` or earlier."""
    # binary search
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
    """Return the acceleration w' [m/s²] of contact i by external forces, `passed` [s] from now.

    If i is the number of contacts, return the acceleration of the anchor bead.
    """
    if chain.external.size == 0:
        return 0.0
    found = chain.external[i]
    if chain.knots.bend.size:
        found += passed * chain.knots.bend[i]
    return found


@inlined
def next_knot(time, end, knots):
    """Return the first breakpoint after `time`, or `end` if that is earlier."""
    k = knots_until(time, knots)
    return min(end, knots.time[k]) if k < knots.time.size else end


@inlined
def rows_differ(k, knots):
    """Return True if a force or a brake changes from breakpoint k - 1 to breakpoint k."""
    differ = False
    for j in range(knots.push.shape[1]):
        differ |= knots.push[k - 1, j] != knots.push[k, j]
    for j in range(knots.brake.shape[1]):
        differ |= knots.brake[k - 1, j] != knots.brake[k, j]
    return differ


@jit
def steady_until(time, knots):
    """Return the time until which all forces and brakes keep their values.

    The result is `time` if they change now, and inf after the last breakpoint.
    """
    k, count = knots_until(time, knots), knots.time.size
    if k == 0:  # all forces over time are 0 before the first breakpoint
        return knots.time[0]
    # skip breakpoints at which nothing changes
    last = time
    while k < count and not rows_differ(k, knots):
        last = knots.time[k]
        k += 1
    return last if k < count else math.inf


@inlined
def add_row(part, k, knots, push, bed):
    """Add a fraction `part` of the forces and brakes at breakpoint k to `push` and `bed`."""
    if part != 0.0:
        for j in range(push.size):
            push[j] += part * knots.push[k, j]
        for j in range(min(bed.size, knots.brake.shape[1])):
            bed[j] += part * knots.brake[k, j]


@inlined
def put_steady(knots, push, bed):
    """Write the constant forces into `push` (n+1,) [N] and the constant decelerations into `bed` (n+1,) [m/s²]."""
    for j in range(push.size):
        push[j] = knots.drive[j]
    for j in range(min(bed.size, knots.brake.shape[1])):
        bed[j] = knots.friction[j]


@jit
def put_mean(begun, h, knots, push, bed):
    """Write the mean values of all forces from time `begun` over the step `h` [s] into `push` and `bed`.

    The means are exact, even if the step contains breakpoints.
    """
    first, last, count = min(begun, begun + h), max(begun, begun + h), knots.time.size
    put_steady(knots, push, bed)
    k = knots_until(first, knots)
    while True:
        # the part of the step between breakpoints k - 1 and k
        low = max(first, knots.time[k - 1]) if k > 0 else first
        high = min(last, knots.time[k]) if k < count else last
        part = (high - low) / (last - first) if last > first else 1.0
        # after the last breakpoint the forces keep their last value
        if k == count:
            add_row(part, k - 1, knots, push, bed)
            return
        # the mean of a linear function is its value in the middle of the interval
        if k > 0 and part > 0.0:
            late = (0.5 * (low + high) - knots.time[k - 1]) / (knots.time[k] - knots.time[k - 1])
            add_row(part * (1.0 - late), k - 1, knots, push, bed)
            add_row(part * late, k, knots, push, bed)
        if knots.time[k] >= last:
            return
        k += 1


@jit
def put_values(time, knots, push, bed):
    """Write all forces at `time` into `push` and `bed`, and their time derivatives into the slopes of `knots`.

    Return True if a force changes or a force over time acts, so that beads in free flight do not move under constant
    forces.
    """
    k, count = knots_until(time, knots), knots.time.size
    put_steady(knots, push, bed)
    # weights of the breakpoints before and after `time`
    length, late, before, after = 1.0, 0.0, k - 1, k - 1
    if 0 < k < count:
        length, after = knots.time[k] - knots.time[k - 1], k
        late = min(max((time - knots.time[k - 1]) / length, BESIDE), 1.0 - BESIDE)
    if k > 0:
        add_row(1.0 - late, before, knots, push, bed)
        add_row(late, after, knots, push, bed)
    # slopes, and whether any force differs from its constant part
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
    """Add the work [J] of the forces over time during half a step at the present velocities to ``motion.taken[2]``.

    The forces must already be means over the step. `velocity` (n+1,) is scratch memory.
    """
    bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
    for j in range(velocity.size):
        if chain.inverse_mass[j] > 0.0:
            motion.taken[2] += 0.5 * h * (chain.push[j] - chain.knots.drive[j]) * velocity[j]
