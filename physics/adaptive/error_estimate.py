"""Error estimate of the adaptive methods: local errors and round-off, times the error amplification along the motion.

The kernels add up the local errors and the amplification (`softcradle.physics.adaptive.switch_log`). This module
combines them for a single run, for a frame of live use and for a batch of chains. docs/error-estimate.md derives the
formulas and explains the purpose of each constant. If the amplification is large, `softcradle.physics.confirm` compares
several runs.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain, per_chain
from softcradle.physics.scales import SPEED_ROUND_OFF

Array = NDArray[np.float64]

# Safety factor of the estimated error. This factor multiplies the sum of all local errors of a run, or the difference
# between two runs.
DOUBT = 3.0
# Error amplification by each oscillation of a loaded contact. All earlier errors have shifted the phase of the
# oscillation.
TURN_GROWTH = 1.0 / 8.0
# Largest error amplification of a run that needs no confirmation by a second run. At an amplification of 10, the
# benchmark chain `mixed` has an error of 40 tolerances. A second run may repeat the amplification of the first one up
# to this limit.
MOST_GROWN = 8.0
# Largest velocity error that the library guarantees, in tolerances
GUARANTEED = 10.0
# Smallest tolerance to which the guarantee applies. With smaller tolerances, round-off dominates the error. The
# estimated error includes it.
LEAST_GUARANTEED = 1e-11
# Largest relative round-off of one floating-point operation
HALF_DIGIT = 0.5 * float(np.finfo(np.float64).eps)


def error_growth(before: Any, grown: Array, turns: Array) -> Any:
    """Return the error amplification.

    The amplification is the product of three factors: `before` from earlier bounces, `grown` from the present bounces,
    and a factor from the turning points `turns` (..., n) of the contacts.
    """
    return 1.0 + before + grown.sum(axis=-1) + TURN_GROWTH * turns.max(axis=-1)


def estimated_error(growth: Any, local_square: Any, roundings: Any, rounding: Any) -> Any:
    """Return the estimated error [m/s]: the sum of local errors and round-off, times the error amplification.

    The round-off consists of `roundings` rounding errors of size `rounding` [m/s].
    """
    return DOUBT * growth * np.sqrt(local_square + roundings * (rounding * rounding))


def guaranteed_error(tolerance: float, scale: float) -> float:
    """Return the largest velocity error [m/s] that the tolerance allows at the speed `scale` [m/s]."""
    return GUARANTEED * max(tolerance, LEAST_GUARANTEED) * scale


def rounding_of(mass: Array, velocity: Array) -> Any:
    """Return the round-off (...) [m/s] of a step for beads of `mass` (..., n+1) at `velocity` (..., n+1).

    A light bead can receive all the kinetic energy and become very fast. The velocities of heavy beads are computed
    from overlap rates, which are then as large as the velocity of the light bead. The round-off of these velocities
    returns to the light bead, amplified by the square root of the mass ratio. Walls are ignored.
    """
    finite = np.isfinite(mass)
    inertia = np.where(finite, mass, 0.0)
    lightest, heaviest = np.where(finite, mass, np.inf).min(axis=-1), inertia.max(axis=-1)
    # Round-off of the fastest bead and of the lightest bead. The docstring derives both.
    own = SPEED_ROUND_OFF * np.abs(velocity).max(axis=-1)
    return np.maximum(own, HALF_DIGIT * np.sqrt(heaviest * (inertia * velocity**2).sum(axis=-1)) / lightest)


def rounding_in(chain: Chain, velocity: Array) -> float:
    """Return the round-off [m/s] of a step for one chain at `velocity` (n+1,).

    The result equals that of :func:`rounding_of`, but avoids the cost of small arrays.
    """
    lightest, heaviest = _mass_range(chain)
    own = SPEED_ROUND_OFF * max(map(abs, velocity.tolist()))
    of_lightest = HALF_DIGIT * math.sqrt(heaviest * np.add.reduce(chain.finite_mass * velocity**2)) / lightest
    return own if own > of_lightest else of_lightest  # NaN if one of the velocities is NaN


@per_chain
def _mass_range(chain: Chain) -> tuple[float, float]:
    """Return the masses [kg] of the lightest and the heaviest bead."""
    finite = [mass for mass in chain.mass if mass < math.inf]
    return min(finite), max(finite)
