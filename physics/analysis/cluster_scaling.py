"""Scaling variables of a struck homogeneous cluster: what decides its spread, and how deep the evanescent mode reaches."""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.analysis.critical_speed import common_law
from softcradle.physics.chain import Chain
from softcradle.physics.trajectory import Trajectory


def spread_variable(n: int, alpha: float) -> float:
    """``(n+1) exp(-1/(2 n alpha))``: one on `n` with different n and alpha has the same velocity spread where this is equal.

    The first inner overlap stores ``psi ~ exp(-1/(n alpha))`` of length at a force near 1, which after the detachment drives
    its beads apart by about ``sqrt(psi)``; the velocity of a rigid cluster is 2/(n+1).

    >>> round(spread_variable(4, 0.1), 3)
    1.433
    """
    return (n + 1) * math.exp(-1.0 / (2.0 * n * alpha))


def chain_spread_variable(chain: Chain, struck: int) -> float | None:
    """The `spread_variable` of one bead on others, all alike, without preload or loss; None for every other chain."""
    law, n = common_law(chain), chain.contacts
    if law is None or law.preload or law.loss or n < 2 or struck not in (0, n - 1) or len(set(chain.mass)) > 1:
        return None
    return spread_variable(n, law.exponent)


def penetration_depth(trajectory: Trajectory, struck: int = 0) -> float:
    """Contacts over which the overlap falls by a factor e, at the moment when the first contact inside is pressed most.

    From the straight line through the logarithms of the overlaps behind the contact `struck`; the paper's bound on Eq. (7)
    has n alpha. 0 where no second contact inside is pressed.
    """
    inner = trajectory.overlap[:, struck + 1 :]
    if inner.shape[1] < 2:
        return 0.0
    row = inner[int(np.argmax(inner[:, 0]))]
    count = int(np.argmax(row <= 0.0)) if (row <= 0.0).any() else row.size
    if count < 2:
        return 0.0
    slope = float(np.polyfit(np.arange(count), np.log(row[:count]), 1)[0])
    return -1.0 / slope
