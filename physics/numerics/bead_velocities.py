"""Velocities or displacements of all beads, computed from the overlaps and the anchor bead; impulses between two beads;
test for a chain at rest.
"""

from __future__ import annotations

from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_kernels import EPSILON


@jit
def bead_velocities(rate, anchor_bead, anchor_velocity, velocity):
    """Write the velocities (n+1,) of the beads into `velocity`: sums of the rates (n,), from the anchor bead outwards.

    Also used for displacements. A result that is not larger than the round-off of its sum is set to 0.
    """
    velocity[anchor_bead] = anchor_velocity
    terms = abs(anchor_velocity)
    # rate_i = v_i - v_(i+1), so v_i = v_(i+1) + rate_i to the left of the anchor bead
    for j in range(anchor_bead - 1, -1, -1):
        velocity[j] = velocity[j + 1] + rate[j]
        terms += abs(rate[j])
    # and v_(i+1) = v_i - rate_i to the right of it
    for j in range(anchor_bead, rate.size):
        velocity[j + 1] = velocity[j] - rate[j]
        terms += abs(rate[j])
    # A bead at rest must have exactly the velocity 0: friction and the end of a run test for it.
    for j in range(velocity.size):
        if abs(velocity[j]) <= 2.0 * EPSILON * terms:
            velocity[j] = 0.0


@jit
def put_impulse(i, impulse, weight, coupling, chain, motion):
    """Apply an impulse [N s] that separates the beads of contact i.

    It changes the rate of the contact by `weight` per impulse, and the rates of its neighbours by `coupling`.
    """
    rate, anchor = motion.rate, motion.anchor
    # the contact itself, then both neighbours
    rate[i] -= impulse * weight
    if i > 0:
        rate[i - 1] += coupling[i] * impulse
    if i < rate.size - 1:
        rate[i + 1] += coupling[i + 1] * impulse
    # the velocity of the anchor bead is stored separately
    if anchor.size and chain.anchor_bead == i:
        anchor[1] -= coupling[i] * impulse
    elif anchor.size and chain.anchor_bead == i + 1:
        anchor[1] += coupling[i + 1] * impulse


@inlined
def bead_displacements(chain, overlap, anchor_position, difference, displacement):
    """Write the displacements (n+1,) [m] of beads on strings from their places of rest into `displacement`.

    `difference` (n or more,) is scratch memory.
    """
    n = overlap.size
    for i in range(n):
        difference[i] = overlap[i] - chain.strings.rest[i]
    bead_velocities(difference[:n], chain.anchor_bead, anchor_position - chain.strings.rest[n], displacement)


@inlined
def at_rest(motion):
    """Return True if no bead moves."""
    resting = motion.anchor[1] == 0.0
    for i in range(motion.rate.size):
        resting &= motion.rate[i] == 0.0
    return resting
