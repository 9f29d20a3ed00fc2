"""Rows of a chain: which branch of its graph each contact and each bed is on, and the forces and accelerations that go with it.

contact  OPEN      d < 0   f = 0                     LOADED   d > 0   f = F + K d**a, (1 - l) times that as it comes out
         TOUCHING  the overlap is held: 0 <= f <= F at d = 0, (1 - l) f(d) <= f <= f(d) where one with loss stands still
bed      slides    v != 0  friction mu m g against v    sticks  v = 0, friction within -+ mu m g

A coupler is a contact whose graph has more segments, one beside the other: solid and pulling, pulling, solid and pushing beside
pushing. On each, x = side (d - origin) is the way since its origin, and f = side (F + K (x + before)**a + S x): `before` is the
way of the gear until it is solid, and the stop S loses nothing. After a `length` the next begins. While a contact is on a segment
its overlap is counted from the origin; between them, in the slack, it is OPEN on the one that pushes.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.jit import inlined
from softcradle.physics.numerics.knots import put_values
from softcradle.physics.numerics.law_curve import BEFORE, LAW_SIDE, STOP, curve_force

SIDE, ORIGIN, LAW, LOSS, LENGTH = 0, 1, 2, 7, 8  # columns of the segments; from LAW on F, K, a, and


@inlined
def is_coupler(regime, i):
    """Whether contact i has more than one segment."""
    return regime.segment.size > 0 and regime.first[i + 1] > regime.first[i] + 1


@inlined
def of_segment(regime, i, column):
    """An entry of the segment that contact i of a chain with couplers is on."""
    return regime.segments[regime.first[i] + regime.segment[i], column]


@inlined
def side_of(regime, i):
    """1 where contact i pushes, or does nothing, -1 where it pulls: what makes of its overlap and rate those of a contact."""
    return of_segment(regime, i, SIDE) if regime.segment.size else 1.0


@inlined
def length_of(regime, i):
    """The overlap at which the next segment begins; inf without one."""
    return of_segment(regime, i, LENGTH) if regime.segment.size else math.inf


@inlined
def slack_of(regime, i):
    """The way that contact i can go apart until it pulls; inf where it does not."""
    if regime.segment.size == 0 or regime.segment[i] == 0 or regime.segments[regime.first[i], SIDE] > 0.0:
        return math.inf
    return -regime.segments[regime.first[i] + regime.segment[i] - 1, ORIGIN] if is_gear(regime, i) else math.inf


@inlined
def is_gear(regime, i):
    """Whether contact i is on a segment that ends at no force, not a solid one."""
    return regime.segment.size == 0 or of_segment(regime, i, LAW + BEFORE) == 0.0


@inlined
def put_segment(i, number, regime, motion):
    """Put contact i on a segment: law and loss are those of it, and its overlap counts from there."""
    before = of_segment(regime, i, ORIGIN)
    regime.segment[i] = number
    row = regime.segments[regime.first[i] + number]
    for k in range(5):
        regime.law[i, k] = row[LAW + k]
    regime.law[i, LAW_SIDE], regime.loss[i] = row[SIDE], row[LOSS]
    motion.overlap[i] += before - row[ORIGIN]


@inlined
def find_segment(i, regime, motion, slow):
    """Put contact i on the segment that it is on, or moves to from an end of one."""
    for _ in range(4):
        side, number = side_of(regime, i), regime.segment[i]
        x, w = side * motion.overlap[i], side * motion.rate[i]
        outward = 1 if side > 0.0 else -1
        if x > length_of(regime, i) or (x == length_of(regime, i) and w >= 0.0):
            put_segment(i, number + outward, regime, motion)
            motion.overlap[i] = side * max(side * motion.overlap[i], 0.0)
        elif not is_gear(regime, i) and (x < 0.0 or (x == 0.0 and w < 0.0)):
            put_segment(i, number - outward, regime, motion)
            motion.overlap[i] = side * min(side * motion.overlap[i], length_of(regime, i))
        elif side < 0.0 and (x < 0.0 or (x == 0.0 and w < -slow)):
            put_segment(i, number + 1, regime, motion)
        elif x < -slack_of(regime, i) or (x == -slack_of(regime, i) and w < -slow):
            put_segment(i, number - 1, regime, motion)
        else:
            return


@inlined
def loss_of(regime, i):
    """The part of its energy that contact i loses."""
    return regime.loss[i] if regime.loss.size else 0.0


@inlined
def both_forces(chain, regime, i, overlap):
    """Force of contact i as it is pressed in, and as it comes out: the stop of a coupler loses nothing."""
    pressed = curve_force(regime.law, chain.own, i, overlap)
    stop = regime.loss[i] * regime.law[i, STOP] * overlap if regime.segment.size else 0.0
    return pressed, (1.0 - loss_of(regime, i)) * pressed + stop


@inlined
def multiplier_bounds(chain, regime, i, overlap):
    """(least, largest) force that contact i may carry while its overlap is held."""
    full, least = both_forces(chain, regime, i, overlap)
    if overlap == 0.0 and is_gear(regime, i):
        least = 0.0
    return (least, full) if full >= 0.0 else (full, least)


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
    found = chain.push[j] * regime.inverse_mass[j] if chain.push.size else 0.0
    return found - regime.slide[j] * regime.bed[j] if regime.bed.size else found


@inlined
def bead_bend(chain, regime, j):
    """By how much that acceleration changes [m/s³]."""
    knots = chain.knots
    if knots.bend.size == 0 or chain.inverse_mass[j] == 0.0:
        return 0.0
    found = knots.push_slope[j] * regime.inverse_mass[j]
    return found - regime.slide[j] * knots.brake_slope[j] if regime.bed.size and knots.brake_slope.size else found


@inlined
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


@inlined
def put_drive(time, chain, regime):
    """Let forces and brakes be those at `time`; returns whether beads that nothing touches move otherwise than in parabolas."""
    acts = put_values(time, chain.knots, chain.push, regime.bed)
    drive_overlaps(chain, regime)
    return acts


@inlined
def bead_acceleration(j, chain, regime, force, passed):
    """Acceleration of bead j under the contact forces (n,), `passed` [s] after now."""
    before = force[j - 1] if j > 0 else 0.0
    after = force[j] if j < force.size else 0.0
    found = (before - after) * chain.inverse_mass[j] + bead_push(chain, regime, j)
    return found + passed * bead_bend(chain, regime, j)


@inlined
def friction_needed(j, chain, regime, force, passed):
    """The friction [N] that bead j needs to stay at rest under the contact forces (n,), `passed` [s] after now."""
    found = chain.push[j] if chain.push.size else 0.0
    if chain.knots.push_slope.size:
        found += passed * chain.knots.push_slope[j]
    if j > 0:
        found += force[j - 1]
    return found - force[j] if j < force.size else found


@inlined
def most_friction(j, chain, regime, passed):
    """The friction [N] that bead j can have, `passed` [s] after now."""
    found = regime.bed[j]
    if chain.knots.brake_slope.size:
        found += passed * chain.knots.brake_slope[j]
    return found / regime.inverse_mass[j]
