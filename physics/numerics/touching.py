"""Energy loss of bounces that are too short for a step of the discrete gradient.

If a step begins and ends at the same touch, the contact stores no energy at either end, so its rate is exactly
reversed. A contact with loss has bounced in between: it was loaded against its preload P and unloaded against the
fraction k of it that the loss leaves, kP. If the other forces on its beads give the load f, one such bounce multiplies
the rate by

    e = sqrt((kP - f) / (P - f))      or sqrt(k) without load; e = 0 for f >= kP, because the contact is then held

The durations of successive bounces shrink by the same factor, so the rate falls linearly with time to 0 (chattering).
The step applies this loss afterwards as an impulse between both beads: momentum is conserved, and the energy balance
contains the loss.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.bead_velocities import put_impulse
from softcradle.physics.numerics.graph_kernels import graph_force, has_segments
from softcradle.physics.numerics.jit import inlined, jit

# Fraction of the overlap that the preload causes in a step. A smaller overlap, of either sign, counts as touching.
TOUCHES = 1e-14


@inlined
def rate_left(h, rate, load, full, least, weight):
    """Return how much of `rate` >= 0 [m/s] is left after the bounces within a step of length `h` [s].

    `load`, `full` and `least` are f, P and kP of the module docstring [N].
    """
    if load >= least:
        return 0.0
    part = math.sqrt((least - load) / (full - load))
    # without load on the contact the beads separate after one bounce
    if load <= 0.0:
        return part * rate
    in_and_out = 1.0 / (full - load) + part / (least - load)
    # duration of the infinite sequence of bounces, a geometric series
    bounces = part * rate / weight * (2.0 / load + in_and_out) / (1.0 - part)
    return part * rate * max(0.0, 1.0 - h / bounces)


@jit
def settle_touching(h, before, weight, coupling, chain, motion, absorbed):
    """Apply the loss of unresolved bounces to each contact whose step began and ended at the same touch; add it to `absorbed`.

    `before` (n,) are the overlaps at the start of the step. An impulse between its beads changes the rate of contact i
    by `weight[i]`, that of the previous contact by `coupling[i]` and that of the next one by `coupling[i + 1]`.
    """
    overlap, rate, force = motion.overlap, motion.rate, motion.force
    for i in range(rate.size):
        # A contact bounces if the step begins and ends at the same touch while it moves and pushes or pulls.
        several = has_segments(chain.graph, i)
        stays = before[i] == overlap[i] and force[i] != 0.0 and (several or overlap[i] == 0.0)
        if not stays or rate[i] == 0.0 or weight[i] == 0.0:
            continue
        # forces of loading and unloading at the touch, P and kP above
        full, least = chain.law[i, 0], (1.0 - chain.dissipation.loss[i]) * chain.law[i, 0]
        if several:
            side = math.copysign(1.0, force[i])
            full = side * graph_force(chain.graph, i, overlap[i], side, side > 0.0)
            least = side * graph_force(chain.graph, i, overlap[i], side, side < 0.0)
        if least >= full:
            continue
        # The mean force consists of the load of the other forces and of a part that reverses the rate.
        turned = 2.0 * rate[i] / (h * weight[i])  # force that has reversed the rate
        load = math.copysign(1.0, force[i]) * (force[i] + turned)
        ended = -math.copysign(rate_left(h, abs(rate[i]), load, full, least, weight[i]), force[i])
        # impulse that leaves the rate after the bounces, and the energy that it takes
        impulse = (rate[i] - ended) / weight[i]
        absorbed[0] += 0.5 * impulse * (rate[i] + ended)
        force[i] += impulse / h
        put_impulse(i, impulse, weight[i], coupling, chain, motion)
