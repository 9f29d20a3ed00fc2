"""The forces of all contacts in one step of the discrete gradient, by Newton's method on a tridiagonal system.

Unknown are the mean forces g_i and the overlaps d1_i at the end of the step, w0, w1 the rates at its ends:

    d1 = d0 + h w0 + (h²/2) e - (h²/2) L g,      g_i = q(d1_i),      q(d1) = (E(d1) - E(d0)) / (d1 - d0)

The map d1 -> g is monotone, so g is unique. With lambda_i = (h²/2) L_ii and s_i = d1_i + lambda_i g_i each contact returns
(d1_i, g_i) from s_i alone (its resolvent); neighbours couple through one tridiagonal Newton iteration on s, whose matrix is a
column-dominant M-matrix.

With dissipation, loss of contacts and Coulomb friction of a bed with deceleration mu g:

    v1_j = S(u_j),  u_j = v0_j + h (g_(j-1) - g_j + p_j) / m_j,   S(u) = sign(u) max(0, |u| - h mu g)
    d1_i = d0_i + (h/2) (w0_i + w1_i),                            w = v_i - v_(i+1)
    g_i  = q(d1_i) times 1 if w1_i > 0, (1 - loss) if w1_i < 0, anything between if w1_i = 0

Friction acts by the velocity at the end of the step: it stops a bead and holds it, but never turns it round. As
w1 = 2 (d1 - d0)/h - w0, a contact with loss has a vertical piece at d0 + (h/2) w0, one more branch of its resolvent. The step
minimises a strictly convex function of v1, so v1 is unique; forces between beads that all stick need not be.

The unknown s_i is then taken less d0_i in couplers and where a contact with loss is loaded, so that the force of one that
is held does not drown in its overlap; the matrix has 0 in place of 1/m_j where bead j sticks. Where that leaves a contact
between two sticking beads without any slope, its row is moved to the next place at which it bends. Where Newton's iteration
cycles, sweeps that solve each row alone follow.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.coupler_kernels import is_joint, joint_resolvent
from softcradle.physics.numerics.fixed_step_friction import distance_to_bend, slide
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.own_contacts import own_resolvent
from softcradle.physics.numerics.resolvent import resolvent
from softcradle.physics.numerics.solver_rows import (
    BEST,
    FORCE_AT_HOLD,
    FRICTION,
    LEAST_AT_HOLD,
    OFFSET,
    RESIDUAL,
    ROUND_OFF,
    SHIFT,
    SLOPE,
    START_POWER,
    START_VELOCITY,
    UNKNOWN,
    UPPER,
    begin_again,
    begin_solve,
    loses,
)
from softcradle.physics.numerics.switches import copy_into

NEGLIGIBLE = 1e-16  # of the largest unknown: a residual this small moves no bead
NEARLY = 100.0  # times ROUND_OFF: converged too, where the residual has ceased to fall
MOST_WARM = 14  # iterations from the forces of the step before; then the solver begins again from none
# iterations, and n more (each may close or open one contact), from none; then as many from the largest
MOST_NEWTON = 40
LEAST_DAMPING = 1e-3  # of a Newton step: a shorter one is not tried

LOOSE = 1e-11  # of the terms of a residual: good enough after sweeps
STEEP = 1e-3  # pivot below which Newton may overshoot a bend
MOST_SWEPT = 30  # rounds of sweeps
AFTER_SWEEPS = 20  # Newton iterations after each round of sweeps
BISECTIONS = 120  # of a row in a sweep, widening of its bracket included


@jit
def lossy_resolvent(preload, stiffness, exponent, loss, start, start_power, ahead, least, at_hold, weight, s, guess):
    """The one (d1, g) with d1 - start + weight g = s, and dg/ds, for start >= 0; q is from `least` to `at_hold` at the overlap
    start + `ahead` where w1 = 0."""
    kept = 1.0 - loss
    if start + ahead > 0.0:
        if s - ahead > weight * at_hold:
            return resolvent(preload, stiffness, exponent, start, start_power, weight, start + s, guess)
        if s - ahead >= weight * least:
            return start + ahead, (s - ahead) / weight, 1.0 / weight
    return resolvent(kept * preload, kept * stiffness, exponent, start, start_power, weight, start + s, guess)


@inlined
def solve_contact(h, i, law, own, joints, dissipation, diagonal, start, rate, overlap, force, work):
    """Put overlap, force and slope dg/ds of contact i at its s into their rows."""
    weight = 0.5 * h * h * diagonal[i]
    if is_joint(joints, i):
        moved, force[i], work[SLOPE, i] = joint_resolvent(
            joints, i, start[i], 0.5 * h * rate[i], weight, work[UNKNOWN, i]
        )
        overlap[i] = start[i] + moved
        return
    if own is not None and own.number[i] >= 0:
        overlap[i], force[i], work[SLOPE, i] = own_resolvent(
            own, own.number[i], law[i, 0], start[i], weight, work[UNKNOWN, i], overlap[i]
        )
        return
    if dissipation is not None and loses(dissipation.loss[i], start[i], rate[i]):
        overlap[i], force[i], work[SLOPE, i] = lossy_resolvent(
            law[i, 0], law[i, 1], law[i, 2], dissipation.loss[i], start[i], work[START_POWER, i], 0.5 * h * rate[i],
            work[LEAST_AT_HOLD, i], work[FORCE_AT_HOLD, i], weight, work[UNKNOWN, i], overlap[i],
        )  # fmt: skip
    else:
        overlap[i], force[i], work[SLOPE, i] = resolvent(
            law[i, 0], law[i, 1], law[i, 2], start[i], work[START_POWER, i], weight, work[UNKNOWN, i], overlap[i]
        )  # fmt: skip


@inlined
def row_residual(h, i, dissipation, coupling, push, free, start, rate, force, beads, work):
    """What row i lacks, s_i - lambda_i g_i - (d1_i by the motion), and the sum of its terms without sign."""
    half = 0.5 * h * h
    before = force[i - 1] if i > 0 else 0.0
    after = force[i + 1] if i < force.size - 1 else 0.0
    s = work[UNKNOWN, i]
    if dissipation is None:
        base, pushed = start[i] + free[i], half * (coupling[i] * before + coupling[i + 1] * after)
        return s - base - pushed, abs(s) + abs(base) + abs(pushed)
    bed = dissipation.bed
    left, right = half * coupling[i] * before, half * coupling[i + 1] * after
    begin = start[i] - work[OFFSET, i]
    own, base = 0.0, begin + free[i]
    if bed.size:
        sticks_left, sticks_right = math.isnan(beads[FRICTION, i]), math.isnan(beads[FRICTION, i + 1])
        if sticks_left or sticks_right:
            base = begin + 0.5 * h * rate[i]
            for j in range(2):
                if not math.isnan(beads[FRICTION, i + j]):
                    end = beads[START_VELOCITY, i + j] + h * beads[FRICTION, i + j]
                    if push.size:
                        end += h * push[i + j] * coupling[i + j]
                    base += 0.5 * h * (end if j == 0 else -end)
            if sticks_left:
                left, own = 0.0, half * coupling[i] * force[i]
            if sticks_right:
                right, own = 0.0, own + half * coupling[i + 1] * force[i]
        else:
            base = begin + (free[i] + half * (beads[FRICTION, i] - beads[FRICTION, i + 1]))
    return s - own - base - (left + right), abs(s) + abs(own) + abs(base) + abs(left + right)


@inlined
def solve_all(h, law, own, joints, dissipation, diagonal, coupling, push, start, rate, overlap, force, beads, work):
    """Contacts, then beads on a bed, at the present unknowns."""
    for i in range(start.size):
        solve_contact(h, i, law, own, joints, dissipation, diagonal, start, rate, overlap, force, work)
    if dissipation is not None:
        for j in range(dissipation.bed.size):
            slide(h, j, coupling, push, dissipation.bed, force, beads)


@jit
def sweep(h, law, own, joints, dissipation, diagonal, coupling, push, free, start, rate, overlap, force, beads, work):
    """Solve each row alone for its s, by bisection, once from left to right and once back."""
    n, bed = start.size, dissipation.bed
    s = work[UNKNOWN]
    for k in range(2 * n):
        i = k if k < n else 2 * n - 1 - k
        low, high, width = s[i], s[i], 0.0
        for _ in range(BISECTIONS):
            solve_contact(h, i, law, own, joints, dissipation, diagonal, start, rate, overlap, force, work)
            if bed.size:
                slide(h, i, coupling, push, bed, force, beads)
                slide(h, i + 1, coupling, push, bed, force, beads)
            lacks, terms = row_residual(h, i, dissipation, coupling, push, free, start, rate, force, beads, work)
            if abs(lacks) <= ROUND_OFF * terms:
                break
            if lacks < 0.0:
                low = s[i]
            else:
                high = s[i]
            if low == high or (low < s[i] and high <= low) or (high == s[i] and low >= high):
                width = max(2.0 * width, abs(lacks))
                if lacks < 0.0:
                    high = s[i] = low + width
                else:
                    low = s[i] = high - width
                continue
            s[i] = 0.5 * (low + high)


@inlined
def newton_shift(h, law, dissipation, diagonal, coupling, start, rate, largest, beads, work):
    """Newton's correction of s, (I - half offdiagonal(L) slope) shift = -residual, by Thomas' elimination."""
    residual, slope, upper, shift = work[RESIDUAL], work[SLOPE], work[UPPER], work[SHIFT]
    n, half = start.size, 0.5 * h * h
    for i in range(n):
        lower = half * coupling[i] * slope[i - 1] if i > 0 else 0.0
        right = half * coupling[i + 1] * slope[i + 1] if i < n - 1 else 0.0
        bound = 0.0  # of the diagonal: what beads that stick take from it
        if dissipation is not None and dissipation.bed.size:
            firm_left = math.isnan(beads[FRICTION, i]) or coupling[i] == 0.0  # a wall is as firm as a bead that sticks
            firm_right = math.isnan(beads[FRICTION, i + 1]) or coupling[i + 1] == 0.0
            bound = half * slope[i] * ((coupling[i] if firm_left else 0.0) + (coupling[i + 1] if firm_right else 0.0))
            lower, right = 0.0 if firm_left else lower, 0.0 if firm_right else right
            if firm_left and firm_right and 1.0 - bound < STEEP:
                upper[i], shift[i] = 0.0, 0.0
                if abs(residual[i]) > ROUND_OFF * (abs(work[UNKNOWN, i]) + NEGLIGIBLE * largest):
                    bend = distance_to_bend(
                        h, i, half * diagonal[i], rate[i], law[i, 0], residual[i] < 0.0,
                        coupling, dissipation.bed, beads, work,
                    )  # fmt: skip
                    far = -residual[i] / max(1.0 - bound, ROUND_OFF)
                    shift[i] = bend if abs(bend) < abs(far) else far
                continue
        pivot = 1.0 - (lower * upper[i - 1] if i > 0 else 0.0) - bound
        pivot = max(pivot, ROUND_OFF)  # 0 where all contacts between two walls touch: their common part is free
        upper[i] = right / pivot
        shift[i] = (-residual[i] + (lower * shift[i - 1] if i > 0 else 0.0)) / pivot
    for i in range(n - 2, -1, -1):
        shift[i] += upper[i] * shift[i + 1]


@jit
def solve_contacts(
    h, law, own, joints, dissipation, diagonal, coupling, push, free, start, rate, overlap, force, beads, work
):
    """Solve one step for all contacts: g into `force` (on entry a guess), d1 into `overlap` (on entry a guess).

    `diagonal` (n,) is L_ii; `coupling` (n+1,) by bead -L_(i-1,i), its inverse mass in a straight row; `push` (n+1,) forces
    from outside [N], or empty; `free` (n,) is h w0 (+ (h²/2) external), `start` (n,) d0, `rate` (n,) w0; `beads`
    (BEAD_ROWS, n+1) holds v0 in its first row where there is a bed; `work` (SOLVER_ROWS, n).
    Returns the iterations used, negative where they did not converge.
    """
    n = start.size
    begin_solve(h, law, joints, dissipation, diagonal, coupling, free, start, rate, overlap, force, work)
    best, least, damping = math.inf, math.inf, 1.0
    spare = 0 if dissipation is None else n
    warm = MOST_WARM + spare
    cold = warm + MOST_NEWTON + n + spare
    swept = cold + MOST_NEWTON + n + spare
    most = swept if dissipation is None else swept + MOST_SWEPT * AFTER_SWEEPS
    for iteration in range(most):
        if iteration in (warm, cold):
            pressed = 0.0
            if iteration == cold:
                for i in range(n):
                    pressed = max(pressed, force[i])
            begin_again(h, dissipation, coupling, free, start, pressed, work)
            best = math.inf
        if dissipation is not None and iteration >= swept and (iteration - swept) % AFTER_SWEEPS == 0:
            for _ in range(1 + n):
                sweep(
                    h,
                    law,
                    own,
                    joints,
                    dissipation,
                    diagonal,
                    coupling,
                    push,
                    free,
                    start,
                    rate,
                    overlap,
                    force,
                    beads,
                    work,
                )
            best = math.inf
        solve_all(h, law, own, joints, dissipation, diagonal, coupling, push, start, rate, overlap, force, beads, work)
        total, terms, worst, largest = 0.0, 0.0, 0.0, 0.0
        for i in range(n):
            largest = max(largest, abs(work[UNKNOWN, i]))
        for i in range(n):
            lacks, scale = row_residual(h, i, dissipation, coupling, push, free, start, rate, force, beads, work)
            work[RESIDUAL, i] = lacks
            scale += NEGLIGIBLE * largest
            total += abs(lacks)
            terms += scale
            if abs(lacks) > worst * scale:
                worst = abs(lacks) / scale
        if worst <= ROUND_OFF or (total >= best and worst <= NEARLY * ROUND_OFF):
            return iteration + 1
        if dissipation is not None:
            if iteration >= swept and worst <= LOOSE:
                return iteration + 1
            if worst < least:
                least = worst
                copy_into(work[BEST], work[UNKNOWN])
        if total > max(best, ROUND_OFF * terms) and damping > LEAST_DAMPING:  # a jump over a kink: half the way back
            damping *= 0.5
            for i in range(n):
                work[UNKNOWN, i] -= damping * work[SHIFT, i]
            continue
        best, damping = total, 1.0
        newton_shift(h, law, dissipation, diagonal, coupling, start, rate, largest, beads, work)
        for i in range(n):
            work[UNKNOWN, i] += work[SHIFT, i]
    if dissipation is not None:
        copy_into(work[UNKNOWN], work[BEST])
        solve_all(h, law, own, joints, dissipation, diagonal, coupling, push, start, rate, overlap, force, beads, work)
    return -most
