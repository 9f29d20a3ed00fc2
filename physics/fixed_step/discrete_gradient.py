"""Discrete gradient in resolvent form: energy and momentum to round-off at any step, for set-valued contacts too.

    verlet        d1 = d0 + h w0 - (h²/2) L f(midpoint)      w1 = w0 - h L f(midpoint)
    conserving    d1 = d0 + h w0 - (h²/2) L g                w1 = w0 - h L g,     g = (E(d1) - E(d0)) / (d1 - d0)

The map d1 -> g is monotone, so g is unique. With lambda_i = (h²/2) L_ii and s_i = d1_i + lambda_i g_i each contact
returns (d1_i, g_i) from s_i alone (its resolvent); neighbours couple through one tridiagonal Newton on s, whose matrix
is a column-dominant M-matrix. A contact that touches (d0 = d1 = 0, 0 <= g <= preload) is one branch of the resolvent.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.contact_law import power
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.resolvent import EPSILON, SMALLEST, resolvent

NEGLIGIBLE = 1e-16  # of the largest: rows below need not be solved to their own round-off, no bead would feel it
ROUND_OFF = 8.0 * EPSILON  # of a residual, relative to its terms
MOST_WARM = 14  # iterations of the chain from the forces of the step before, then
MOST_NEWTON = 40  # (and n more: a row may close or open one contact an iteration) from none, then from the largest
SOLVER_ROWS = 6  # rows (n,) of scratch memory of `mean_forces`
WORK_ROWS = SOLVER_ROWS + 3  # and of a step
SMALLEST_PART = 2.0**-10  # of a step: where Newton does not settle, shorter steps, which conserve no less, down to this


@jit
def mean_forces(h, law, diagonal, coupling, target, start, overlap, force, work):
    """Solve one step for all contacts: g into `force` (on entry a guess), d1 into `overlap` (on entry a guess).

    `diagonal` (n,) is L_ii, `coupling` (n+1,) by bead -L_(i-1,i): its inverse mass in a straight row; `target` (n,) is
    d0 + h w0 (+ (h²/2) external), `start` (n,) d0, `work` (SOLVER_ROWS, n). Returns the iterations used, negative where
    they did not converge.
    """
    n = start.size
    half = 0.5 * h * h
    s, residual, slope, start_power, upper, shift = work[0], work[1], work[2], work[3], work[4], work[5]
    for i in range(n):
        start_power[i] = power(start[i], law[i, 2]) if start[i] > 0.0 else 0.0
        before = force[i - 1] if i > 0 else 0.0
        after = force[i + 1] if i < n - 1 else 0.0
        s[i] = target[i] + half * (coupling[i] * before + coupling[i + 1] * after)
    best = math.inf
    damping = 1.0
    warm, below = MOST_WARM, MOST_WARM + MOST_NEWTON + n
    for iteration in range(below + MOST_NEWTON + n):
        if iteration in (warm, below):
            highest = 0.0
            if iteration == below:
                for i in range(n):
                    highest = max(highest, force[i])
            for i in range(n):
                s[i] = target[i] + half * highest * (coupling[i] + coupling[i + 1])
            best = math.inf
        total, terms, worst, largest = 0.0, 0.0, 0.0, 0.0
        for i in range(n):
            largest = max(largest, abs(s[i]))
            weight = half * diagonal[i]
            overlap[i], force[i], slope[i] = resolvent(
                law[i, 0], law[i, 1], law[i, 2], start[i], start_power[i], weight, s[i], overlap[i]
            )  # fmt: skip
        for i in range(n):
            before = force[i - 1] if i > 0 else 0.0
            after = force[i + 1] if i < n - 1 else 0.0
            pushed = half * (coupling[i] * before + coupling[i + 1] * after)
            residual[i] = s[i] - target[i] - pushed
            total += abs(residual[i])
            scale = abs(s[i]) + abs(target[i]) + abs(pushed) + NEGLIGIBLE * largest
            terms += scale
            if abs(residual[i]) > worst * scale:
                worst = abs(residual[i]) / scale
        if worst <= ROUND_OFF or (total >= best and worst <= 100.0 * ROUND_OFF):
            return iteration + 1
        if total > max(best, ROUND_OFF * terms) and damping > 1e-3:  # Newton jumped over a kink: half the way back
            damping *= 0.5
            for i in range(n):
                s[i] -= damping * shift[i]
            continue
        best = total
        damping = 1.0
        for i in range(n):  # (I - half offdiagonal(L) slope) shift = -residual, by Thomas
            lower = half * coupling[i] * slope[i - 1] if i > 0 else 0.0
            pivot = 1.0 - (lower * upper[i - 1] if i > 0 else 0.0)
            pivot = max(pivot, ROUND_OFF)  # 0 where all contacts between two walls touch: their common part is free
            right = half * coupling[i + 1] * slope[i + 1] if i < n - 1 else 0.0
            upper[i] = right / pivot
            shift[i] = (-residual[i] + (lower * shift[i - 1] if i > 0 else 0.0)) / pivot
        s[n - 1] += shift[n - 1]
        for i in range(n - 2, -1, -1):
            shift[i] += upper[i] * shift[i + 1]
            s[i] += shift[i]
    return -iteration


@jit
def single_step(h, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, work, forced):
    """One step in place; `work` (WORK_ROWS, n). Returns the iterations used, negative where they did not converge: then
    the state stays as it was, unless `forced`.

    The new rate is w0 - h L g, or 2 (d1 - d0)/h - w0 where the overlap is so small that the latter is the finer number.
    """
    n = overlap.size
    target, end, diagonal = work[SOLVER_ROWS], work[SOLVER_ROWS + 1], work[SOLVER_ROWS + 2]
    for i in range(n):
        if 0.0 < overlap[i] < SMALLEST:
            overlap[i] = 0.0
        target[i] = overlap[i] + h * rate[i]
        if push.size:
            target[i] += 0.5 * h * h * (push[i] * inverse_mass[i] - push[i + 1] * inverse_mass[i + 1])
        end[i] = overlap[i] if overlap[i] > 0.0 else target[i]
        diagonal[i] = inverse_mass[i] + inverse_mass[i + 1]
    used = mean_forces(h, law, diagonal, inverse_mass, target, overlap, end, force, work)
    if used < 0 and not forced:
        for i in range(n):
            force[i] = 0.0
        return used
    left = -force[0] * inverse_mass[0]
    if push.size:
        left += push[0] * inverse_mass[0]
    if anchor_bead == 0:
        anchor[0] += h * (anchor[1] + 0.5 * h * left)
        anchor[1] += h * left
    for i in range(n):
        right = force[i] * inverse_mass[i + 1]
        if i < n - 1:
            right -= force[i + 1] * inverse_mass[i + 1]
        if push.size:
            right += push[i + 1] * inverse_mass[i + 1]
        if i + 1 == anchor_bead:
            anchor[0] += h * (anchor[1] + 0.5 * h * right)
            anchor[1] += h * right
        weight = h * h * (inverse_mass[i] + inverse_mass[i + 1]) * force[i]
        if max(abs(overlap[i]), abs(end[i])) < weight:
            rate[i] = 2.0 * (end[i] - overlap[i]) / h - rate[i]
        else:
            rate[i] += h * (left - right)
        overlap[i] = end[i]
        left = right
    return used


@jit
def conserving_step(h, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, work):
    """One step in place, in shorter ones where it does not converge; `work` (WORK_ROWS, n).

    Returns the iterations used, negative where even the shortest did not converge.
    """
    used = single_step(h, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, work, False)
    if used >= 0:
        return used
    total, left, part, failed = -used, h, 0.5 * h, False
    while left > 0.0:
        last = part <= SMALLEST_PART * h
        used = single_step(part, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, work, last)
        total += abs(used)
        if used < 0 and not last:
            part *= 0.5
            continue
        failed |= used < 0
        left -= part
    return -total if failed else total


@jit
def conserving_steps(
    most, h, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, closed, work, tally
):  # fmt: skip
    """Up to `most` steps in place; stops after the first in which a contact leaves the state in `closed`.

    Adds to `tally`: [0] evaluations of all contacts, [1] steps that did not converge. Returns the steps taken.
    """
    for step in range(most):
        used = conserving_step(h, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, work)
        tally[0] += abs(used)
        tally[1] += 1 if used < 0 else 0
        switched = False
        for i in range(overlap.size):
            switched |= (overlap[i] > 0.0 or (overlap[i] == 0.0 and force[i] > 0.0)) != (closed[i] != 0)
        if switched:
            return step + 1
    return most
