"""Modes of the unilateral constraints of a chain: the branch of the graph on which each contact and each bed is, with
forces and accelerations.

contact  OPEN      d < 0   f = 0                     LOADED   d > 0   f = F + K d**a, unloading: (1 - l) times that
         TOUCHING  the overlap is held: 0 <= f <= F at d = 0, (1 - l) f(d) <= f <= f(d) with loss and w = 0
bed      slides    v != 0  friction mu m g against v    sticks  v = 0, friction within -+ mu m g

These graphs are the maximal monotone graphs of the contact laws (Signorini condition with preload) and of Coulomb
friction.

A contact with several segments is on one of them: its overlap counts from the origin of this segment, and its row of
`law` contains the numbers of this segment. Past the ends of the segment it moves to the next one. Between the innermost
segments, in the slack, it is OPEN on the innermost segment that pushes. See `softcradle.physics.segments`.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.graph_kernels import segment_force
from softcradle.physics.numerics.jit import inlined
from softcradle.physics.numerics.knots import put_values
from softcradle.physics.numerics.law_curve import LAW_BEFORE, LAW_SIDE, LAW_STOP, curve_force
from softcradle.physics.numerics.records import (
    BEFORE,
    EXPONENT,
    LENGTH,
    LOSS,
    ORIGIN,
    PRELOAD,
    SIDE,
    STIFFNESS,
    STOP,
)


@inlined
def row_of_segment(regime, i):
    """Return the row of the segment that contact i is on, in a chain in which a contact has several."""
    return regime.graph.first[i] + regime.segment[i]


@inlined
def of_segment(regime, i, column):
    """Return an entry of the segment that contact i is on, in a chain in which a contact has several."""
    return regime.graph.segment[row_of_segment(regime, i), column]


@inlined
def side_of(regime, i):
    """Return -1 if contact i is on a segment that pulls, else 1: times this, overlap and rate are those of a push."""
    return of_segment(regime, i, SIDE) if regime.segment.size else 1.0


@inlined
def length_of(regime, i):
    """Return the displacement at which the next segment begins; inf for the last segment."""
    return of_segment(regime, i, LENGTH) if regime.segment.size else math.inf


@inlined
def is_innermost(regime, i):
    """Return whether contact i is on the segment of its side that ends at no force."""
    if regime.segment.size == 0:
        return True
    p, side = row_of_segment(regime, i), of_segment(regime, i, SIDE)
    inner = p - 1 if side > 0.0 else p + 1
    inside = regime.graph.first[i] <= inner < regime.graph.first[i + 1]
    return not inside or regime.graph.segment[inner, SIDE] != side


@inlined
def slack_of(regime, i):
    """Return how far contact i can go apart until it pulls; inf if it does not pull, or has not coupled yet."""
    if regime.segment.size == 0 or regime.segment[i] == 0 or regime.graph.coupled[i] == 0:
        return math.inf
    p = row_of_segment(regime, i)
    if regime.graph.segment[p, SIDE] < 0.0 or regime.graph.segment[p - 1, SIDE] > 0.0:
        return math.inf
    return -regime.graph.segment[p - 1, ORIGIN]


@inlined
def put_segment(i, number, regime, motion):
    """Put contact i on a segment: take its law and loss, and count the overlap from its origin."""
    before = of_segment(regime, i, ORIGIN)
    regime.segment[i] = number
    row, law = regime.graph.segment[row_of_segment(regime, i)], regime.law[i]
    law[0], law[1], law[2] = row[PRELOAD], row[STIFFNESS], row[EXPONENT]
    law[LAW_BEFORE], law[LAW_STOP], law[LAW_SIDE] = row[BEFORE], row[STOP], row[SIDE]
    regime.loss[i] = row[LOSS]
    motion.overlap[i] += before - row[ORIGIN]


@inlined
def find_segment(i, regime, motion, slow):
    """Put contact i on the segment that it is on, or moves to from an end of one."""
    for _ in range(regime.graph.first[i + 1] - regime.graph.first[i] + 2):
        side, number = side_of(regime, i), regime.segment[i]
        x, w = side * motion.overlap[i], side * motion.rate[i]
        outward = 1 if side > 0.0 else -1
        # Past the outer end of the segment: continue on the outer neighbour.
        if x > length_of(regime, i) or (x == length_of(regime, i) and w >= 0.0):
            put_segment(i, number + outward, regime, motion)
            motion.overlap[i] = side * max(side * motion.overlap[i], 0.0)
        # Past the inner end: return to the inner neighbour.
        elif not is_innermost(regime, i) and (x < 0.0 or (x == 0.0 and w < 0.0)):
            put_segment(i, number - outward, regime, motion)
            motion.overlap[i] = side * min(side * motion.overlap[i], length_of(regime, i))
        # A coupler that pulled has come to its slack.
        elif side < 0.0 and (x < 0.0 or (x == 0.0 and w < -slow)):
            put_segment(i, number + 1, regime, motion)
        # A coupler has come to the end of its slack, and pulls.
        elif x < -slack_of(regime, i) or (x == -slack_of(regime, i) and w < -slow):
            put_segment(i, number - 1, regime, motion)
        else:
            return


@inlined
def loss_of(regime, i):
    """Return the part of its energy that contact i dissipates."""
    return regime.loss[i] if regime.loss.size else 0.0


@inlined
def both_forces(chain, regime, i, overlap):
    """Return the force of contact i on loading and on unloading; the stop of a segment dissipates nothing."""
    pressed = curve_force(regime.law, chain.graph, i, overlap)
    stop = regime.loss[i] * regime.law[i, LAW_STOP] * overlap if regime.segment.size else 0.0
    return pressed, (1.0 - loss_of(regime, i)) * pressed + stop


@inlined
def inner_force(regime, i):
    """Return the force on unloading at the end of the segment inside that of contact i."""
    p, side = row_of_segment(regime, i), side_of(regime, i)
    row = regime.graph.segment[p - 1 if side > 0.0 else p + 1]
    return side * segment_force(row, row[LENGTH], True)


@inlined
def multiplier_bounds(chain, regime, i, overlap):
    """Return the least and the largest force that contact i may carry while its overlap is held."""
    full, least = both_forces(chain, regime, i, overlap)
    if overlap == 0.0:
        least = 0.0 if is_innermost(regime, i) else inner_force(regime, i)
    return (least, full) if full >= 0.0 else (full, least)


@inlined
def is_firm(regime, j):
    """Return whether bead j cannot change its velocity, because it is a wall or sticks to its bed."""
    return regime.inverse_mass[j] == 0.0 or (regime.bed.size > 0 and regime.bed[j] > 0.0 and regime.slide[j] == 0)


@inlined
def is_at_rest(regime, j):
    """Return whether bead j sticks to its bed."""
    return regime.bed[j] > 0.0 and regime.slide[j] == 0


@inlined
def bead_push(chain, regime, j):
    """Return the acceleration of bead j by external forces and kinetic friction [m/s²]."""
    if chain.inverse_mass[j] == 0.0:
        return 0.0
    found = chain.push[j] * regime.inverse_mass[j] if chain.push.size else 0.0
    return found - regime.slide[j] * regime.bed[j] if regime.bed.size else found


@inlined
def bead_bend(chain, regime, j):
    """Return the time derivative of this acceleration [m/s³]."""
    knots = chain.knots
    if knots.bend.size == 0 or chain.inverse_mass[j] == 0.0:
        return 0.0
    found = knots.push_slope[j] * regime.inverse_mass[j]
    return found - regime.slide[j] * knots.brake_slope[j] if regime.bed.size and knots.brake_slope.size else found


@inlined
def drive_overlaps(chain, regime):
    """Compute the accelerations of all overlaps and of the anchor bead by external forces and kinetic friction."""
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
    """Set forces and brakes to their values at `time`. Return whether free beads do not move along parabolas."""
    acts = put_values(time, chain.knots, chain.push, regime.bed)
    drive_overlaps(chain, regime)
    return acts


@inlined
def bead_acceleration(j, chain, regime, force, passed):
    """Return the acceleration of bead j by the contact forces (n,) and external forces, `passed` [s] after now."""
    before = force[j - 1] if j > 0 else 0.0
    after = force[j] if j < force.size else 0.0
    found = (before - after) * chain.inverse_mass[j] + bead_push(chain, regime, j)
    return found + passed * bead_bend(chain, regime, j)


@inlined
def friction_needed(j, chain, regime, force, passed):
    """Return the friction [N] that bead j needs to stay at rest under the contact forces (n,), `passed` [s] after now."""
    found = chain.push[j] if chain.push.size else 0.0
    if chain.knots.push_slope.size:
        found += passed * chain.knots.push_slope[j]
    if j > 0:
        found += force[j - 1]
    return found - force[j] if j < force.size else found


@inlined
def most_friction(j, chain, regime, passed):
    """Return the largest friction [N] that bead j can have, `passed` [s] after now."""
    found = regime.bed[j]
    if chain.knots.brake_slope.size:
        found += passed * chain.knots.brake_slope[j]
    return found / regime.inverse_mass[j]
