"""Rows of a chain: which branch of its graph each contact and each bed is on, and the forces and accelerations that go with it.

contact  OPEN      d < 0   f = 0                     LOADED   d > 0   f = F + K d**a, (1 - l) times that as it comes out
         TOUCHING  the overlap is held: 0 <= f <= F at d = 0, (1 - l) f(d) <= f <= f(d) where one with loss stands still
bed      slides    v != 0  friction mu m g against v    sticks  v = 0, friction within -+ mu m g
"""

from __future__ import annotations

from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.knots import drive_at, put_values
from softcradle.physics.numerics.law_curve import flow_into, signed_force


@inlined
def loss_of(regime, i):
    """The part of its energy that contact i keeps."""
    return regime.loss[i] if regime.loss.size else 0.0


@inlined
def pressed_force(regime, i, overlap):
    """The force of contact i as it is pressed in."""
    return signed_force(regime.law[i, 0], regime.law[i, 1], regime.law[i, 2], overlap)


@inlined
def multiplier_bounds(regime, i, overlap):
    """(least, largest) force that contact i may carry while its overlap is held."""
    if overlap > 0.0:
        full = pressed_force(regime, i, overlap)
        return (1.0 - loss_of(regime, i)) * full, full
    return 0.0, regime.law[i, 0]


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


@inlined
def acceleration_of(i, chain, force, passed):
    """w' of contact i under the contact forces (n,), `passed` [s] after now."""
    return drive_at(chain, i, passed) - flow_into(i, chain.inverse_mass, force)


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
    found = regime.push[j] if regime.push.size else 0.0
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
