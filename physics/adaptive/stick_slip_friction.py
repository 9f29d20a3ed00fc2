"""Stick-slip on the bed: which beads slide which way, what pushes them, how they come to rest; friction is within -+ mu m g."""

from __future__ import annotations

from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.knots import put_values

# rows (n+1,) of the work array: known forces on beads, and the static friction of those at rest
LOAD, GIVE = 5, 6


@inlined
def is_firm(regime, j):
    """Whether bead j does not change its velocity: a wall, or a bead that sticks."""
    return regime.inverse_mass[j] == 0.0 or (regime.bed.size > 0 and regime.bed[j] > 0.0 and regime.slide[j] == 0)


@inlined
def is_at_rest(regime, j):
    """Whether bead j sticks on its bed."""
    return regime.bed[j] > 0.0 and regime.slide[j] == 0


@inlined
def bead_push(chain, regime, j):
    """Acceleration of bead j by what pushes it from outside and by kinetic friction [m/s²]."""
    if chain.inverse_mass[j] == 0.0:
        return 0.0
    found = regime.push[j] * regime.inverse_mass[j] if regime.push.size else 0.0
    return found - regime.slide[j] * regime.bed[j] if regime.bed.size else found


@inlined
def bead_bend(chain, regime, j):
    """By how much that acceleration changes [m/s³]."""
    knots = chain.knots
    if knots.bend.size == 0 or chain.inverse_mass[j] == 0.0:
        return 0.0
    found = knots.push_slope[j] * regime.inverse_mass[j]
    return found - regime.slide[j] * knots.brake_slope[j] if regime.bed.size and knots.brake_slope.size else found


@piece
def drive_overlaps(chain, regime):
    """What all contacts and the anchor bead see of the forces from outside, and of friction of beads that slide."""
    n, bend = regime.inverse_mass.size - 1, chain.knots.bend
    for i in range(n):
        chain.external[i] = bead_push(chain, regime, i) - bead_push(chain, regime, i + 1)
    chain.external[n] = bead_push(chain, regime, chain.anchor_bead)
    if bend.size:
        for i in range(n):
            bend[i] = bead_bend(chain, regime, i) - bead_bend(chain, regime, i + 1)
        bend[n] = bead_bend(chain, regime, chain.anchor_bead)


@piece
def put_drive(time, chain, regime):
    """Let forces and brakes be those at `time`; returns whether beads that nothing touches move otherwise than in parabolas."""
    acts = put_values(time, chain.knots, regime.push, regime.bed)
    drive_overlaps(chain, regime)
    return acts


@piece
def find_slides(chain, regime, motion, known, velocity):
    """Which way each bead slides, from the velocities; later only events change it: it is `known` where that is not 0.

    `velocity` (n+1,) is scratch memory.
    """
    if regime.bed.size:
        bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
        for j in range(velocity.size):
            if known[j] == 0.0:
                regime.slide[j] = 1 if velocity[j] > 0.0 else (-1 if velocity[j] < 0.0 else 0)


@inlined
def load_beads(regime, work):
    """Known forces on beads, and the static friction of those at rest. Returns whether any is at rest."""
    load, give, resting = work[LOAD], work[GIVE], False
    for j in range(regime.inverse_mass.size):
        load[j] = regime.push[j] if regime.push.size else 0.0
        give[j] = 0.0
        if regime.bed.size and regime.bed[j] > 0.0:
            most = regime.bed[j] / regime.inverse_mass[j]
            if regime.slide[j] == 0:
                give[j], resting = most, True
            else:
                load[j] -= regime.slide[j] * most
    return resting


@inlined
def rest_exactly(chain, regime, motion):
    """Take the round-off from the velocities of beads that stick beside each other."""
    for i in range(motion.mode.size):
        if is_at_rest(regime, i) and is_at_rest(regime, i + 1):
            motion.rate[i] = 0.0
    if is_at_rest(regime, chain.anchor_bead):
        motion.anchor[1] = 0.0


@inlined
def stands(regime, j, velocity, slow):
    """Whether bead j sticks on its bed, or is a wall no faster than `slow` [m/s], which is round-off."""
    return is_at_rest(regime, j) or (regime.inverse_mass[j] == 0.0 and abs(velocity[j]) <= slow)


@piece
def stop_bead(j, chain, regime, motion, slow, velocity):
    """Take the velocity that bead j still has at the end of its slide, and all beads that move as one with it.

    `velocity` (n+1,) is scratch memory.
    """
    n, rate = motion.rate.size, motion.rate
    bead_velocities(rate, chain.anchor_bead, motion.anchor[1], velocity)
    left, first, last = velocity[j], j, j
    while first > 0 and rate[first - 1] == 0.0:
        first -= 1
    while last < n and rate[last] == 0.0:
        last += 1
    for k in range(first, last + 1):
        regime.slide[k] = 0
    if first > 0:
        rate[first - 1] = 0.0 if stands(regime, first - 1, velocity, slow) else rate[first - 1] + left
    if last < n:
        rate[last] = 0.0 if stands(regime, last + 1, velocity, slow) else rate[last] - left
    if first <= chain.anchor_bead <= last:
        motion.anchor[1] = 0.0


@piece
def stop_beside(i, chain, regime, motion, slow, velocity):
    """Let a bead of contact i, whose rate has become 0, rest where the other one stands: they have one velocity now.

    `velocity` (n+1,) is scratch memory.
    """
    if regime.bed.size:
        bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
        for j, other in ((i, i + 1), (i + 1, i)):
            if regime.slide[j] != 0 and stands(regime, other, velocity, slow):
                stop_bead(j, chain, regime, motion, slow, velocity)
                return
