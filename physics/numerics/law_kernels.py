"""Contact law inside kernels: force and energy of one contact from its row (F, K, a) of the law table."""

from __future__ import annotations

from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.jit import inlined, jit

# relative spacing of floats at 1
EPSILON = 2.220446049250313e-16
# Largest number of iterations for one contact. A bracket that is halved that often has shrunk to round-off.
MOST_SCALAR = 100


@jit
def force(preload, stiffness, exponent, overlap):
    """Return the force ``F + K d**a`` [N] for d > 0, else 0."""
    if overlap <= 0.0:
        return 0.0
    if stiffness == 0.0:
        return preload
    return preload + stiffness * power(overlap, exponent)


@inlined
def newton_in_bracket(x, excess, slope, low, high):
    """Return x after a step of Newton's iteration for the root of a rising function, and the new bracket (low, high).

    The function has the value `excess` and the derivative `slope` >= 0 at x, and its sign changes in the bracket. The
    sign of `excess` shows which end moves to x. A step out of the bracket is replaced by bisection.
    """
    if excess >= 0.0:
        high = x
    else:
        low = x
    following = x - excess / slope if slope > 0.0 else high
    if not low < following < high:
        following = 0.5 * (low + high)
    return following, low, high


@jit
def energy(preload, stiffness, exponent, overlap):
    """Return the stored energy ``F d + K d**(1+a) / (1+a)`` [J] for d > 0, else 0."""
    if overlap <= 0.0:
        return 0.0
    return (preload + stiffness * power(overlap, exponent) / (1.0 + exponent)) * overlap


@inlined
def energy_fall(law, start, end):
    """Return by how much the stored energy [J] of a power law, a row (F, K, a, ...), falls from overlap `start` to `end`."""
    fall = energy(law[0], law[1], law[2], start)
    fall -= energy(law[0], law[1], law[2], end)
    return fall
