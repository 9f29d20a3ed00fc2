"""Coulomb friction of the bed in a step of the discrete gradient: which beads stick, and when a contact lets one go.

v1 = S(u),  u = v0 + h (g_before - g_after + p) / m,   S(u) = sign(u) max(0, |u| - h mu g)
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.solver_rows import (
    FORCE_AT_HOLD,
    FREE_VELOCITY,
    FRICTION,
    LEAST_AT_HOLD,
    ROUND_OFF,
    START_VELOCITY,
    STICKS,
    UNKNOWN,
)


@inlined
def slide(h, j, coupling, push, bed, force, beads):
    """Put u and the friction of bead j, as an acceleration, into `beads`, from the contact forces."""
    before, after = force[j - 1] if j > 0 else 0.0, force[j] if j < force.size else 0.0
    outside = push[j] if push.size else 0.0
    u = beads[START_VELOCITY, j] + h * coupling[j] * (before - after + outside)
    beads[FREE_VELOCITY, j] = u
    most = h * bed[j]
    terms = abs(beads[START_VELOCITY, j]) + h * coupling[j] * (abs(before) + abs(after) + abs(outside)) + most
    stuck = abs(u) <= most + ROUND_OFF * terms  # round-off alone sets no bead going
    beads[FRICTION, j] = 0.0 if bed[j] == 0.0 else (STICKS if stuck else math.copysign(bed[j], -u))


@jit
def distance_to_bend(h, i, weight, rate, preload, up, coupling, bed, beads, work):
    """How far s_i has to move (up, or down) until the contact leaves its vertical piece or a bead beside it breaks loose."""
    ahead, s = 0.5 * h * rate, work[UNKNOWN, i]
    if work[FORCE_AT_HOLD, i] > work[LEAST_AT_HOLD, i]:
        low, high = ahead + weight * work[LEAST_AT_HOLD, i], ahead + weight * work[FORCE_AT_HOLD, i]
    else:
        low, high = 0.0, weight * preload
    found = high - s if up else s - low
    for j in range(2):
        if coupling[i + j] > 0.0:
            sign = 1.0 if (j == 0) == up else -1.0  # a greater force pushes the left bead back, the right one on
            room = h * bed[i + j] + sign * beads[FREE_VELOCITY, i + j]
            found = min(found, weight * room / (h * coupling[i + j]))
    found = max(found, 0.0) * (1.0 + 1e-9) + 1e-15 * abs(s)
    return found if up else -found
