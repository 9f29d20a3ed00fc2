"""Stopping: a motion with friction is over when no contact pushes and no beads can meet again, or when all beads rest."""

from __future__ import annotations

import numpy as np
from softcradle.physics.chain import Chain
from softcradle.physics.state import State


def meets_again(chain: Chain, state: State, slow: float = 0.0) -> bool:
    """Whether two beads that are apart will meet if no contact pushes.

    With bed friction each bead slides v²/(2 mu g) and rests. All decelerate alike, so of two beads the faster gains on the
    other until both rest: they meet if the places where they would rest overlap. Rates up to `slow` [m/s] count as 0.
    """
    closing = state.rate > slow
    if not chain.on_bed or not closing.any():
        return bool(closing.any())
    velocity = state.velocity(chain)
    with np.errstate(divide="ignore", invalid="ignore"):
        path = np.where(velocity == 0.0, 0.0, 0.5 * velocity * np.abs(velocity) / chain.bed)  # inf for a wall
    return bool((closing & (state.overlap + path[:-1] - path[1:] > 0.0)).any())


def rests(chain: Chain, state: State) -> bool:
    """Whether no bead moves."""
    return not state.rate.any() and float(state.anchor[1]) == 0.0
