"""Explicit steps for chains that rub: drifts and kicks as in softcradle.physics.fixed_step.splitting, with the two frictions in the kick.

    kick(c h)   v -= c h (forces),  force = f(d) if w >= 0, (1 - loss) f(d) if w < 0;  then |v| falls by c h mu g, to 0 at most

So the bed can stop a bead in a kick, never turn it round. Energy is booked where it goes: loss * (fall of the stored energy)
in a drift that lets a contact out, the fall of the kinetic energy in the friction's part of a kick. Only for steps forward.
"""

from __future__ import annotations

import math

from softcradle.physics.fixed_step.dissipative_gradient import bead_velocities
from softcradle.physics.numerics.contact_law import energy
from softcradle.physics.numerics.contact_law import force as law_force
from softcradle.physics.numerics.jit import jit


@jit
def drift(part, law, loss, overlap, rate, anchor, absorbed):
    """Move on for the time `part` at the present rates; book what contacts that come out keep."""
    for i in range(overlap.size):
        before = overlap[i]
        overlap[i] += part * rate[i]
        if loss[i] > 0.0 and rate[i] < 0.0 and before > 0.0:
            fall = energy(law[i, 0], law[i, 1], law[i, 2], before)
            absorbed[0] += loss[i] * (fall - energy(law[i, 0], law[i, 1], law[i, 2], overlap[i]))
    anchor[0] += part * anchor[1]


@jit
def kick(part, inverse_mass, push, bed, anchor_bead, rate, anchor, force, absorbed, beads):
    """Change velocities by the forces during `part`, then brake them on the bed."""
    n = rate.size
    if bed.size:
        bead_velocities(rate, anchor_bead, anchor[1], beads[0])
    for j in range(n + 1):
        net = (force[j - 1] if j > 0 else 0.0) - (force[j] if j < n else 0.0) + (push[j] if push.size else 0.0)
        beads[1, j] = part * net * inverse_mass[j]
        if bed.size and bed[j] > 0.0:
            pushed, brake = beads[0, j] + beads[1, j], part * bed[j]
            ended = 0.0 if abs(pushed) <= brake else pushed - math.copysign(brake, pushed)
            absorbed[1] += 0.5 * (pushed - ended) * (pushed + ended) / inverse_mass[j]
            beads[1, j] = -beads[0, j] if ended == 0.0 else beads[1, j] - math.copysign(brake, pushed)
    anchor[1] += beads[1, anchor_bead]
    for i in range(n):
        rate[i] += beads[1, i] - beads[1, i + 1]
        if bed.size and beads[1, i] == -beads[0, i] and beads[1, i + 1] == -beads[0, i + 1]:
            rate[i] = 0.0


@jit
def dry_split_steps(
    most, h, drifts, kicks, law, loss, inverse_mass, push, bed, anchor_bead, overlap, rate, anchor, force, closed, absorbed,
    beads,
):  # fmt: skip
    """Up to `most` steps in place; stops after the first in which a contact leaves the state in `closed`, or all rest.

    `drifts`, `kicks` as in `split_steps`, none negative; `beads` (2 or more, n+1). Returns the steps taken.
    """
    n = overlap.size
    for step in range(most):
        for stage in range(kicks.size):
            drift(h * drifts[stage], law, loss, overlap, rate, anchor, absorbed)
            for i in range(n):
                force[i] = law_force(law[i, 0], law[i, 1], law[i, 2], overlap[i])
                if rate[i] < 0.0:
                    force[i] *= 1.0 - loss[i]
            kick(h * kicks[stage], inverse_mass, push, bed, anchor_bead, rate, anchor, force, absorbed, beads)
        if drifts[kicks.size] != 0.0:
            drift(h * drifts[kicks.size], law, loss, overlap, rate, anchor, absorbed)
        switched, moving = False, anchor[1] != 0.0
        for i in range(n):
            switched |= (overlap[i] > 0.0) != (closed[i] != 0)
            moving |= rate[i] != 0.0
        if switched or not moving:
            return step + 1
    return most
