"""The hand: a damped spring from a bead to the pointer. It works at the speed of the wall clock, whatever the slow motion.

push = m (omega**2 (pointer - x) - 2 omega v),   omega = QUICKNESS / slow: critically damped

The pointer counts as no farther away than it takes to pull at MOST_SPEED times the scene's speed, so that a wide gesture
in slow motion does not throw a bead at a thousand times the speed of everything else.
"""

from __future__ import annotations

import math

from sandbox.session.setup import Setup

QUICKNESS = 12.0  # 1/s at the wall: the bead follows the pointer within about a sixth of a second
MOST_SPEED = 10.0  # of the scene's closing speed


def push_of_hand(setup: Setup, lane: int, bead: int, offset: float, velocity: float) -> float:
    """Force [N] on `bead`, which moves at `velocity`, from a pointer `offset` [m] ahead of it; 0 on a wall."""
    mass = setup.lanes[lane].chain.mass[bead]
    if math.isinf(mass):
        return 0.0
    quickness = QUICKNESS / setup.slow
    reach = 2.0 * MOST_SPEED * setup.lanes[lane].speed / quickness
    pull = min(max(offset, -reach), reach)
    return mass * (quickness * quickness * pull - 2.0 * quickness * velocity)
