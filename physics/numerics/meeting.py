"""Whether a collision is over: no contact pushes beads apart any more, and none that are apart will meet again."""

from __future__ import annotations

import math

from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_kernels import energy


@inlined
def flight_time(joints, overlap, rate, still):
    """Time until the first contact closes, or coupler pulls, if no force acts; inf when none closes faster than `still`."""
    first = math.inf
    for i in range(overlap.size):
        if rate[i] > still:
            first = min(first, -overlap[i] / rate[i])
        elif joints.first.size and rate[i] < -still:
            first = min(first, (joints.pulls_below[i] - overlap[i]) / rate[i])
    return first


@inlined
def pushes_no_more(chain, motion, still):
    """Whether closed contacts can change no velocity by more than `still`; of laws of one's own and couplers it is not known."""
    if chain.own is not None or chain.joints.first.size > 0:
        return False
    for i in range(motion.overlap.size):
        if motion.overlap[i] > 0.0:
            stored = energy(chain.law[i, 0], chain.law[i, 1], chain.law[i, 2], motion.overlap[i])
            compliance = chain.inverse_mass[i] + chain.inverse_mass[i + 1]
            if abs(motion.rate[i]) > still or 2.0 * stored * compliance > still * still:
                return False
    return True


@jit
def sliding_path(velocity, deceleration):
    """How far a bead slides until it rests, v²/(2 mu g) with the sign of v; a wall goes on for ever."""
    if deceleration > 0.0:
        return 0.5 * velocity * abs(velocity) / deceleration
    return math.copysign(math.inf, velocity) if velocity != 0.0 else 0.0


@jit
def meets_again(chain, bed, motion, still, velocity):
    """Whether two beads that are apart will meet; rates up to `still` are round-off.

    `bed` (n+1,) are the decelerations of sliding beads, (0,) without friction: of two that all brake alike, the faster gains on
    the other until both rest, so they meet if the places where they would rest overlap. `velocity` (n+1,) is scratch memory.
    """
    if bed.size == 0:
        return flight_time(chain.joints, motion.overlap, motion.rate, still) < math.inf
    bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
    for i in range(motion.overlap.size):
        if motion.rate[i] > still:
            ahead, behind = sliding_path(velocity[i], bed[i]), sliding_path(velocity[i + 1], bed[i + 1])
            if motion.overlap[i] + ahead - behind > 0.0:
                return True
    return False
