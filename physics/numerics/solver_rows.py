"""Scratch memory of one solve for all contacts, and the unknowns that it begins with."""

from __future__ import annotations

import math

from softcradle.physics.numerics.coupler_kernels import is_joint, joint_mean_force
from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.jit import inlined
from softcradle.physics.numerics.resolvent import EPSILON, mean_force

ROUND_OFF = 8.0 * EPSILON  # of the terms of a residual: converged

# rows (n,) of scratch memory
UNKNOWN = 0  # s, or s - d0 in couplers and where a contact with loss is loaded
RESIDUAL = 1
SLOPE = 2  # dg/ds
START_POWER = 3  # d0**a
UPPER = 4  # of the eliminated matrix
SHIFT = 5  # Newton's correction of s
HOLD = 6  # overlap d0 + (h/2) w0 at which a contact stands still at the end of the step
FORCE_AT_HOLD = 7  # q there, pressed in; 0 where nothing is lost
OFFSET = 8  # d0 where the unknown is taken less it, else 0
BEST = 9  # the unknowns of least residual
LEAST_AT_HOLD = 10  # q at the hold as it comes out
SOLVER_ROWS = 11

# rows (n+1,) of scratch memory by bead
START_VELOCITY = 0  # v0
FREE_VELOCITY = 1  # u
FRICTION = 2  # acceleration by the bed; STICKS in place of one that stops the bead
BEAD_ROWS = 3
STICKS = math.nan


@inlined
def loses(loss, start, rate):
    """Whether a contact can lose energy in this step: it has loss, and it is loaded or about to be."""
    return loss > 0.0 and (start > 0.0 or (start == 0.0 and rate > 0.0))


@inlined
def begin_solve(h, law, joints, dissipation, diagonal, coupling, free, start, rate, overlap, force, work):
    """Rows that one step needs, and the first s: by the neighbours' forces, or by a contact's own with dissipation."""
    half = 0.5 * h * h
    for i in range(start.size):
        work[START_POWER, i] = power(start[i], law[i, 2]) if start[i] > 0.0 else 0.0
        if dissipation is None:
            before = force[i - 1] if i > 0 else 0.0
            after = force[i + 1] if i < start.size - 1 else 0.0
            pushed = half * (coupling[i] * before + coupling[i + 1] * after)
            work[UNKNOWN, i] = start[i] + free[i] + pushed
            continue
        loss = dissipation.loss[i]
        work[HOLD, i] = start[i] + 0.5 * h * rate[i]
        work[FORCE_AT_HOLD, i], work[LEAST_AT_HOLD, i] = 0.0, 0.0
        if is_joint(joints, i):
            work[OFFSET, i], ahead = start[i], 0.5 * h * rate[i]
            work[LEAST_AT_HOLD, i], _ = joint_mean_force(joints, i, start[i], ahead, False)
            work[FORCE_AT_HOLD, i], _ = joint_mean_force(joints, i, start[i], ahead, True)
            work[UNKNOWN, i] = overlap[i] - start[i] + half * diagonal[i] * force[i]
            continue
        work[OFFSET, i] = start[i] if loss > 0.0 and start[i] > 0.0 else 0.0
        if loses(loss, start[i], rate[i]) and work[HOLD, i] > 0.0:
            work[FORCE_AT_HOLD, i], _ = mean_force(
                law[i, 0], law[i, 1], law[i, 2], start[i], work[START_POWER, i], work[HOLD, i]
            )
            work[LEAST_AT_HOLD, i] = (1.0 - loss) * work[FORCE_AT_HOLD, i]
        work[UNKNOWN, i] = overlap[i] - work[OFFSET, i] + half * diagonal[i] * force[i]


@inlined
def begin_again(h, dissipation, coupling, free, start, pressed, work):
    """Unknowns as if all neighbours pushed with the force `pressed`."""
    half = 0.5 * h * h
    for i in range(start.size):
        begin = start[i]
        if dissipation is not None:
            begin -= work[OFFSET, i]
        work[UNKNOWN, i] = begin + free[i] + half * pressed * (coupling[i] + coupling[i + 1])
