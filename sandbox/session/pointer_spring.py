"""The pointer spring: a critically damped spring from a dragged bead to the pointer, equally quick in every slow motion.

force = m (omega**2 (pointer - x) - 2 omega v),   omega = FREQUENCY * slow

The pointer counts as no farther away than it takes to pull at MOST_SPEED times the scene's speed, so that a wide
gesture in slow motion does not throw a bead at a thousand times the speed of everything else.
"""

from __future__ import annotations

import math

from softcradle.sandbox.session.lane_setup import LaneSetup

FREQUENCY = 12.0  # 1/s of wall time: the bead follows the pointer within about a sixth of a second
MOST_SPEED = 10.0  # of the pull, relative to the scene's closing speed


def spring_frequency(slow: float) -> float:
    """Angular frequency omega of the spring [1/s of model time]."""
    return FREQUENCY * slow


def spring_force(setup: LaneSetup, bead: int, offset: float, velocity: float, frequency: float) -> float:
    """Force [N] on `bead`, which moves at `velocity`, from a pointer `offset` [m] ahead of it; 0 on a wall."""
    mass = setup.chain.mass[bead]
    if math.isinf(mass):
        return 0.0
    reach = 2.0 * MOST_SPEED * setup.speed / frequency
    stretch = min(max(offset, -reach), reach)
    return mass * (frequency * frequency * stretch - 2.0 * frequency * velocity)
