"""The contact law inside kernels: force and energy of one contact from its row (F, K, a) of the law table."""

from __future__ import annotations

import math

from softcradle.physics.numerics.jit import jit


@jit
def power(base, exponent):
    """``base**exponent`` for base > 0; the exponents 1 and 3/2 cost no call of pow."""
    if exponent == 1.0:
        return base
    if exponent == 1.5:
        return base * math.sqrt(base)
    return base**exponent


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
