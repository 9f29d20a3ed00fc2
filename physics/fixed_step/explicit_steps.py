"""Explicit steps in overlap coordinates (symplectic splitting): each method is a sequence of drifts and kicks.

    drift(c h)   d += c h w              kick(c h)   w -= c h L f(d)

    euler        drift(1) kick(1)                                        order 1; equal to a pymunk step
    verlet       drift(1/2) kick(1) drift(1/2)                           order 2
    yoshida4     drift(a/2) kick(a) drift((a+b)/2) kick(b) drift((a+b)/2) kick(a) drift(a/2)
                 order 4: three leapfrogs, the middle one backwards; a = 1/(2 - 2**(1/3)), b = 1 - 2a (Yoshida 1990)

With dissipation, for methods without a backward part:

    force        f(d) if w >= 0, (1 - loss) f(d) if w < 0
    kick(c h)    v -= c h (forces);  then |v| decreases by c h mu g, at most to 0: friction stops a bead but never
        reverses it

In a drift, contacts dissipate loss * (decrease of the stored energy). In a kick, the bed dissipates the impulse of
friction times the mean of the velocities before and after it, so nothing for a bead that stays at rest.

With a preload the force jumps at overlap 0. These methods take f = 0 there, so a contact that should stay in touch
chatters.
"""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.graph_kernels import graph_fall, graph_force, has_segments, settle_graph_forces
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.knots import add_half_work, put_mean
from softcradle.physics.numerics.law_kernels import energy_fall
from softcradle.physics.numerics.law_kernels import force as power_force
from softcradle.physics.numerics.swing import string_pull
from softcradle.physics.numerics.switches import has_stopped
from softcradle.physics.numerics.table_kernels import has_table, table_value

# step fractions a and b of `yoshida4`
_OUTER = 1.0 / (2.0 - 1.2599210498948732)
_INNER = 1.0 - 2.0 * _OUTER

# Drifts and kicks as fractions of the step. There is one drift more than kicks.
EULER = np.array([1.0, 0.0]), np.array([1.0])
VERLET = np.array([0.5, 0.5]), np.array([1.0])
YOSHIDA4 = (
    np.array([0.5 * _OUTER, 0.5 * (_OUTER + _INNER), 0.5 * (_OUTER + _INNER), 0.5 * _OUTER]),
    np.array([_OUTER, _INNER, _OUTER]),
)


@inlined
def drift(part, chain, motion):
    """Move the overlaps for the time `part` [s] at the present rates. Add the energy that contacts with loss dissipate."""
    law, loss, overlap, rate = chain.law, chain.dissipation.loss, motion.overlap, motion.rate
    if loss.size == 0:  # a separate loop, which the compiler can vectorise for long chains
        for i in range(overlap.size):
            overlap[i] += part * rate[i]
    for i in range(loss.size):
        before = overlap[i]
        overlap[i] += part * rate[i]
        # loss occurs while a contact unloads
        if has_segments(chain.graph, i):
            motion.taken[0] += graph_fall(chain.graph, i, before, overlap[i], True)
        elif loss[i] > 0.0 and rate[i] < 0.0 and before > 0.0:
            motion.taken[0] += loss[i] * energy_fall(law[i], before, overlap[i])
    motion.anchor[0] += part * motion.anchor[1]


@inlined
def loading_force(chain, i, overlap):
    """Return the force [N] of contact i, a power law or a table, at `overlap` during loading; 0 if it is open."""
    if has_table(chain.graph, i):
        return table_value(chain.graph, chain.graph.force, chain.graph.first[i], overlap) if overlap > 0.0 else 0.0
    return power_force(chain.law[i, 0], chain.law[i, 1], chain.law[i, 2], overlap)


@inlined
def push(chain, motion):
    """Update the contact forces to the present overlaps and rates."""
    loss, force = chain.dissipation.loss, motion.force
    # without dissipation the force depends only on the overlap
    if loss.size == 0 and chain.graph.kind.size == 0:  # without a branch for each contact
        for i in range(force.size):
            force[i] = power_force(chain.law[i, 0], chain.law[i, 1], chain.law[i, 2], motion.overlap[i])
    elif loss.size == 0:
        for i in range(force.size):
            force[i] = loading_force(chain, i, motion.overlap[i])
    for i in range(loss.size):
        if has_segments(chain.graph, i):
            force[i] = graph_force(chain.graph, i, motion.overlap[i], 0.0, motion.rate[i] >= 0.0)
            continue
        force[i] = loading_force(chain, i, motion.overlap[i])
        # unloading
        if motion.rate[i] < 0.0:
            force[i] *= 1.0 - loss[i]


@inlined
def swing_back(part, chain, motion):
    """Change the rates and the velocity of the anchor bead by the pull of the strings during `part` [s]."""
    n = motion.rate.size
    for i in range(n):
        motion.rate[i] += part * string_pull(chain, i, motion.overlap[i])
    motion.anchor[1] += part * string_pull(chain, n, motion.anchor[0])


@inlined
def kick(part, chain, motion):
    """Change the rates by all forces during `part` [s], through the accelerations of the beads: w_i += h (a_i - a_(i+1))."""
    n, inverse_mass, outside = motion.rate.size, chain.inverse_mass, chain.push
    rate, anchor, force, bead = motion.rate, motion.anchor, motion.force, chain.anchor_bead
    # external forces
    if outside.size:
        anchor[1] += part * outside[bead] * inverse_mass[bead]
        for i in range(n):
            rate[i] += part * (outside[i] * inverse_mass[i] - outside[i + 1] * inverse_mass[i + 1])
    if chain.strings.rest.size:
        swing_back(part, chain, motion)
    # contact forces on the anchor bead, then on all contacts from left to right
    before = force[bead - 1] if bead > 0 else 0.0
    after = force[bead] if bead < n else 0.0
    anchor[1] += part * (before - after) * inverse_mass[bead]
    left = -force[0] * inverse_mass[0]
    for i in range(n - 1):
        right = (force[i] - force[i + 1]) * inverse_mass[i + 1]
        rate[i] += part * (left - right)
        left = right
    rate[n - 1] += part * (left - force[n - 1] * inverse_mass[n])


@inlined
def kick_and_brake(part, chain, motion, beads):
    """Change the bead velocities by all forces during `part` [s], then apply friction. `beads` (2 or more, n+1) is scratch."""
    n, inverse_mass, bed = motion.rate.size, chain.inverse_mass, chain.dissipation.bed
    rate, anchor, force = motion.rate, motion.anchor, motion.force
    if chain.strings.rest.size:  # without a bed, so that the order of both changes does not matter
        swing_back(part, chain, motion)
    if bed.size:
        bead_velocities(rate, chain.anchor_bead, anchor[1], beads[0])
    # beads[0]: velocities before; beads[1]: velocity changes
    for j in range(n + 1):
        net = (force[j - 1] if j > 0 else 0.0) - (force[j] if j < n else 0.0)
        net += chain.push[j] if chain.push.size else 0.0
        beads[1, j] = part * net * inverse_mass[j]
        # friction reduces the speed, and holds the bead if it would reverse it
        if bed.size and bed[j] > 0.0:
            pushed, brake = beads[0, j] + beads[1, j], part * bed[j]
            ended = 0.0 if abs(pushed) <= brake else pushed - math.copysign(brake, pushed)
            motion.taken[1] += 0.5 * (pushed - ended) * (beads[0, j] + ended) / inverse_mass[j]
            beads[1, j] = -beads[0, j] if ended == 0.0 else beads[1, j] - math.copysign(brake, pushed)
    anchor[1] += beads[1, chain.anchor_bead]
    for i in range(n):
        rate[i] += beads[1, i] - beads[1, i + 1]
        # between two beads at rest the rate is exactly 0
        if bed.size and beads[1, i] == -beads[0, i] and beads[1, i + 1] == -beads[0, i + 1]:
            rate[i] = 0.0


@jit
def split_steps(most, time, h, drifts, kicks, chain, motion, closed, beads):
    """Take up to `most` steps from `time` on in place. Return the number of steps taken.

    Stop earlier if a contact leaves the state in `closed` or, with dissipation, if all beads rest. `drifts` and `kicks`
    are those of the method; with dissipation none may be negative. Each kick gives the impulse that forces over time
    have in its part of the step. Arrays are arguments and not records, so that a call from the loop stays cheap.
    """
    stages, timed, dissipates = kicks.size, chain.knots.time.size > 0, chain.dissipation.loss.size > 0
    for step in range(most):
        begun = time + step * h
        for stage in range(stages):
            drift(h * drifts[stage], chain, motion)
            push(chain, motion)
            length = h * kicks[stage]
            # mean of the forces over time during this kick
            if timed:
                put_mean(begun, length, chain.knots, chain.push, chain.dissipation.bed)
                begun += length
                # their work is the impulse times the mean velocity: half before and half after the kick
                add_half_work(length, chain, motion, beads[0])
            if dissipates:
                kick_and_brake(length, chain, motion, beads)
            else:
                kick(length, chain, motion)
            if timed:
                add_half_work(length, chain, motion, beads[0])
        if drifts[stages] != 0.0:
            drift(h * drifts[stages], chain, motion)
        # after a step the forces must agree with the overlaps, because their signs show which contacts are closed
        settle_graph_forces(chain.graph, motion)
        if has_stopped(chain, motion, closed):
            return step + 1
    return most
