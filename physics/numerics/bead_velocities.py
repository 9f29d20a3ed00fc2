"""Velocities or ways of the beads from those of overlaps and the anchor, and whether all beads rest."""

from __future__ import annotations

from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_kernels import EPSILON


@jit
def bead_velocities(rate, anchor_bead, anchor_velocity, velocity):
    """Rebuild the velocities (n+1,) of the beads, or their ways; one that is no more than the round-off of its sum is 0."""
    velocity[anchor_bead] = anchor_velocity
    terms = abs(anchor_velocity)
    for j in range(anchor_bead - 1, -1, -1):
        velocity[j] = velocity[j + 1] + rate[j]
        terms += abs(rate[j])
    for j in range(anchor_bead, rate.size):
        velocity[j + 1] = velocity[j] - rate[j]
        terms += abs(rate[j])
    for j in range(velocity.size):
        if abs(velocity[j]) <= 2.0 * EPSILON * terms:
            velocity[j] = 0.0


@inlined
def at_rest(motion):
    """Whether no bead moves."""
    resting = motion.anchor[1] == 0.0
    for i in range(motion.rate.size):
        resting &= motion.rate[i] == 0.0
    return resting
