"""The contact law inside kernels: force and energy of one contact from its row (F, K, a) of the law table."""

from __future__ import annotations

from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.jit import jit

EPSILON = 2.220446049250313e-16
MOST_SCALAR = 100  # iterations of one contact; a bracket halved that often is closed


@jit
def force(preload, stiffness, exponent, overlap):
    """``F + K d**a`` for d > 0, else 0."""
    if overlap <= 0.0:
        return 0.0
    if stiffness == 0.0:
        return preload
    return preload + stiffness * power(overlap, exponent)


@jit
def energy(preload, stiffness, exponent, overlap):
    """``F d + K d**(1+a) / (1+a)`` for d > 0, else 0."""
    if overlap <= 0.0:
        return 0.0
    return (preload + stiffness * power(overlap, exponent) / (1.0 + exponent)) * overlap
