"""Test for the end of a collision: no contact pushes its beads apart any more, and no two separate beads will meet again."""

from __future__ import annotations

import math

from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.graph_kernels import pulls_below
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_kernels import energy


@inlined
def flight_time(graph, overlap, rate, still):
    """Return the time [s] until the first contact closes or pulls in free flight.

    The result is inf if all contacts close more slowly than `still` [m/s].
    """
    first = math.inf
    for i in range(overlap.size):
        # an approaching contact closes at overlap 0, a separating one may reach the end of its slack
        if rate[i] > still:
            first = min(first, -overlap[i] / rate[i])
        elif graph.kind.size and rate[i] < -still:
            first = min(first, (pulls_below(graph, i) - overlap[i]) / rate[i])
    return first


@inlined
def pushes_no_more(chain, motion, still):
    """Return True if no closed contact can change a velocity by more than `still` [m/s]; False if a graph is not a power law."""
    if chain.graph.kind.size > 0:
        return False
    for i in range(motion.overlap.size):
        if motion.overlap[i] > 0.0:
            # the stored energy can produce at most the relative speed sqrt(2 E (1/m + 1/m'))
            stored = energy(chain.law[i, 0], chain.law[i, 1], chain.law[i, 2], motion.overlap[i])
            compliance = chain.inverse_mass[i] + chain.inverse_mass[i + 1]
            if abs(motion.rate[i]) > still or 2.0 * stored * compliance > still * still:
                return False
    return True


@inlined
def slid(velocity, deceleration, time):
    """Return the displacement [m] of a sliding bead in `time` [s]. It stops when its velocity is 0.

    A bead without friction, or a wall, keeps its velocity.
    """
    if deceleration > 0.0:
        time = min(time, abs(velocity) / deceleration)
    return (velocity - 0.5 * math.copysign(deceleration, velocity) * time) * time


@jit
def slides_into(overlap, rate, ahead, brake_ahead, behind, brake_behind, still):
    """Return True if a bead with velocity `ahead` slides into the next bead, which has velocity `behind`.

    The gap between both is -`overlap`. If both brake equally, the faster bead approaches until both are at rest.
    Otherwise the gap may be smallest earlier: when both are equally fast, or when one of them stops. Beads that are
    slower than `still` at this time only touch.
    """
    if brake_ahead == brake_behind and rate <= still:
        return False
    # times [s] at which each bead stops
    rest_ahead = abs(ahead) / brake_ahead if brake_ahead > 0.0 else math.inf
    rest_behind = abs(behind) / brake_behind if brake_behind > 0.0 else math.inf
    # a bead without friction still approaches after the other one has stopped
    if (ahead if brake_ahead == 0.0 else 0.0) - (behind if brake_behind == 0.0 else 0.0) > still:
        return True
    # the gap must close by more than the round-off `still` of the rates could cause
    least = 0.0 if rate > still else 0.5 * still * still / (brake_ahead + brake_behind)
    # the extrema of the gap: a bead stops, or both velocities are equal
    turn = math.copysign(brake_ahead, ahead) - math.copysign(brake_behind, behind)
    equal = rate / turn if turn != 0.0 else 0.0
    for time in (rest_ahead, rest_behind, min(max(equal, 0.0), rest_ahead, rest_behind)):
        if time < math.inf and overlap + slid(ahead, brake_ahead, time) - slid(behind, brake_behind, time) > least:
            return True
    return False


@jit
def meets_again(chain, bed, motion, still, velocity):
    """Return True if two separate beads will meet again. Rates up to `still` [m/s] count as round-off.

    `bed` (n+1,) are the decelerations of sliding beads, (0,) without friction. `velocity` (n+1,) is scratch memory.
    """
    if bed.size == 0:
        return flight_time(chain.graph, motion.overlap, motion.rate, still) < math.inf
    bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
    for i in range(motion.overlap.size):
        if slides_into(motion.overlap[i], motion.rate[i], velocity[i], bed[i], velocity[i + 1], bed[i + 1], still):
            return True
    return False
