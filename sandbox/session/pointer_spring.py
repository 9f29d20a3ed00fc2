"""The hand: a damped spring from a bead to the pointer, as quick at the wall in every slow motion.

push = m (omega**2 (pointer - x) - 2 omega v),   omega = QUICKNESS * slow: critically damped

The pointer counts as no farther away than it takes to pull at MOST_SPEED times the scene's speed, so that a wide
gesture in slow motion does not throw a bead at a thousand times the speed of everything else.
"""

from __future__ import annotations

import math

from softcradle.sandbox.session.lane_setup import LaneSetup

QUICKNESS = 12.0  # 1/s at the wall: the bead follows the pointer within about a sixth of a second
MOST_SPEED = 10.0  # of the scene's closing speed


def quickness(slow: float) -> float:
    """Of the hand [1/s] in the model's time."""
    return QUICKNESS * slow


def push_of_hand(setup: LaneSetup, bead: int, offset: float, velocity: float, quick: float) -> float:
    """Force [N] on `bead`, which moves at `velocity`, from a pointer `offset` [m] ahead of it; 0 on a wall."""
    mass = setup.chain.mass[bead]
    if math.isinf(mass):
        return 0.0
    reach = 2.0 * MOST_SPEED * setup.speed / quick
    pull = min(max(offset, -reach), reach)
    return mass * (quick * quick * pull - 2.0 * quick * velocity)
