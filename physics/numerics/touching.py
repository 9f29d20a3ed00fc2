"""What bounces that a step of the discrete gradient does not tell apart lose.

A contact that a step carries from a touch to that touch ends at the opposite rate, for it stores nothing at either. With loss it
has bounced in between, pressed in against its preload P and come out by what the loss leaves of that, kP. Under the load f of
its beads' other forces one such bounce leaves

    e = sqrt((kP - f) / (P - f))      of the rate, sqrt(k) without load; 0 where f >= kP, for there it is held

and bounces follow each other in times that fall by the same factor, so that the rate falls evenly with time, to 0. What they
lose is taken after the step, by an impulse between the two beads: momentum stays, and the ledger has it.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.graph_kernels import graph_force, has_segments
from softcradle.physics.numerics.jit import inlined, jit

# of what a preload moves in a step: an overlap this small, of either sign, is the round-off of touching
TOUCHES = 1e-14


@inlined
def rate_left(h, rate, load, full, least, weight):
    """What bounces within a step of length `h` leave of a `rate` without sign; `load`, `full`, `least` are f, P and kP above."""
    if load >= least:
        return 0.0
    part = math.sqrt((least - load) / (full - load))
    if load <= 0.0:
        return part * rate
    in_and_out = 1.0 / (full - load) + part / (least - load)
    bounces = part * rate / weight * (2.0 / load + in_and_out) / (1.0 - part)  # how long they last, all of them
    return part * rate * max(0.0, 1.0 - h / bounces)


@jit
def put_impulse(i, impulse, weight, coupling, chain, motion):
    """Push the beads of contact i apart by an impulse, which changes its rate by `weight`, others by `coupling` as below."""
    rate, anchor = motion.rate, motion.anchor
    rate[i] -= impulse * weight
    if i > 0:
        rate[i - 1] += coupling[i] * impulse
    if i < rate.size - 1:
        rate[i + 1] += coupling[i + 1] * impulse
    if anchor.size and chain.anchor_bead == i:
        anchor[1] -= coupling[i] * impulse
    elif anchor.size and chain.anchor_bead == i + 1:
        anchor[1] += coupling[i + 1] * impulse


@jit
def settle_touching(h, before, weight, coupling, chain, motion, absorbed):
    """Take what bounces have lost where a step went from a touch, overlaps `before` (n,), to that touch, into `absorbed`.

    An impulse between its beads changes the rate of a contact by `weight` (n,), that of the one before by `coupling` (n+1,)
    at its index, that of the one after by the next.
    """
    overlap, rate, force = motion.overlap, motion.rate, motion.force
    for i in range(rate.size):
        several = has_segments(chain.graph, i)
        stays = before[i] == overlap[i] and force[i] != 0.0 and (several or overlap[i] == 0.0)
        if not stays or rate[i] == 0.0 or weight[i] == 0.0:
            continue
        full, least = chain.law[i, 0], (1.0 - chain.dissipation.loss[i]) * chain.law[i, 0]
        if several:
            side = math.copysign(1.0, force[i])
            full = side * graph_force(chain.graph, i, overlap[i], side, side > 0.0)
            least = side * graph_force(chain.graph, i, overlap[i], side, side < 0.0)
        if least >= full:
            continue
        turned = 2.0 * rate[i] / (h * weight[i])  # the force that has turned it round
        load = math.copysign(1.0, force[i]) * (force[i] + turned)
        ended = -math.copysign(rate_left(h, abs(rate[i]), load, full, least, weight[i]), force[i])
        impulse = (rate[i] - ended) / weight[i]
        absorbed[0] += 0.5 * impulse * (rate[i] + ended)
        force[i] += impulse / h
        put_impulse(i, impulse, weight[i], coupling, chain, motion)
