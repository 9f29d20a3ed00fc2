"""Discrete gradient in resolvent form: energy and momentum to round-off at any step, for set-valued contacts too.

    verlet        d1 = d0 + h w0 - (h²/2) L f(midpoint)      w1 = w0 - h L f(midpoint)
    conserving    d1 = d0 + h w0 - (h²/2) L g                w1 = w0 - h L g,     g = (E(d1) - E(d0)) / (d1 - d0)

The map d1 -> g is monotone, so g is unique. With lambda_i = (h²/2) L_ii and s_i = d1_i + lambda_i g_i each contact
returns (d1_i, g_i) from s_i alone (its resolvent); neighbours couple through one tridiagonal Newton on s, whose matrix
is a column-dominant M-matrix. A contact that touches (d0 = d1 = 0, 0 <= g <= preload) is one branch of the resolvent.
"""

from __future__ import annotations

import math

from physics.kernels.jit import jit
from physics.kernels.law import power

EPSILON = 2.220446049250313e-16
NEGLIGIBLE = 1e-40  # of the largest: a term too small to be felt by any bead
SMALLEST = 1e-280  # overlaps and energies below are zero: what is computed from them would be denormal
ROUND_OFF = 8.0 * EPSILON  # of a residual, relative to its terms
MOST_SCALAR = 100  # iterations of one contact; a bracket halved that often is closed
MOST_WARM = 14  # iterations of the chain from the forces of the step before, then
MOST_NEWTON = 40  # (and n more: a row may close or open one contact an iteration) from none, then from the largest
SOLVER_ROWS = 6  # rows (n,) of scratch memory of `mean_forces`
WORK_ROWS = SOLVER_ROWS + 3  # and of a step


@jit
def mean_force(preload, stiffness, exponent, start, start_power, overlap):
    """Mean force g = (E(d1)-E(d0))/(d1-d0) and slope dg/dd1 for d1 > 0, without cancellation where d1 is near d0.

    `start_power` is d0**a where d0 > 0. Near d0: (r**p - 1)/(p (r - 1)) = expm1(p log1p(x)) / (p x), r = 1 + x, p = 1 + a.
    """
    p = 1.0 + exponent
    if start > 0.0:
        x = (overlap - start) / start
        if -0.5 < x < 1.0:
            scale = stiffness * start_power
            if abs(x) < 1e-7:
                return preload + scale * (1.0 + 0.5 * exponent * x), 0.5 * scale * exponent / start
            logarithm = math.log1p(x)
            mean = math.expm1(p * logarithm) / (p * x)
            slope = (math.exp(exponent * logarithm) - mean) / x if abs(x) > 1e-4 else 0.5 * exponent
            return preload + scale * mean, scale * slope / start
        end_power = power(overlap, exponent)
        mean = stiffness * (overlap * end_power - start * start_power) / (p * (overlap - start))
        return preload + mean, (stiffness * end_power - mean) / (overlap - start)
    end_power = power(overlap, exponent)
    mean = (preload + stiffness * end_power / p) * (overlap / (overlap - start))
    return mean, (preload + stiffness * end_power - mean) / (overlap - start)


@jit
def quadratic_root(a, b, c):
    """The root x > 0 of a x² + b x + c = 0 for a > 0, c <= 0, without cancellation."""
    root = math.sqrt(b * b - 4.0 * a * c)
    return -2.0 * c / (b + root) if b > 0.0 else (root - b) / (2.0 * a)


@jit
def solve_loaded(preload, stiffness, exponent, start, start_power, weight, s, guess):
    """d1 > 0 with d1 + weight g(d1) = s by a bracketed Newton: to smaller d1 in its logarithm, to larger in d1 itself.

    Returns d1, g, dg/dd1.
    """
    low, high = 0.0, s
    overlap = guess if 0.0 < guess < s else 0.5 * s
    precision = 4.0 * EPSILON * max(1.0, 1.0 / exponent)
    force, slope = 0.0, 0.0
    for _ in range(MOST_SCALAR):
        force, slope = mean_force(preload, stiffness, exponent, start, start_power, overlap)
        excess = overlap + weight * force - s
        if excess > 0.0:
            high = overlap
        else:
            low = overlap
        move = -excess / (1.0 + weight * slope)
        if abs(move) <= 1e-9 * overlap:  # Newton squares this: the moved point is exact to round-off
            return overlap + move, force + slope * move, slope
        following = overlap + move if move > 0.0 else overlap * math.exp(max(move / overlap, -200.0))
        if not low <= following <= high:
            following = math.sqrt(low * high) if low > 0.0 and high > 4.0 * low else 0.5 * (low + high)
        if abs(following - overlap) <= precision * overlap:
            break
        overlap = following
        if overlap < SMALLEST:  # too small for a number, not for a force: it touches
            return 0.0, s / weight, math.inf
    return overlap, force, slope


@jit
def resolvent_slope(slope, weight):
    """dg/ds = 1 / (1/slope + weight), from slope = dg/dd1 in [0, inf]."""
    return 1.0 / (1.0 / slope + weight) if slope > 0.0 else 0.0


@jit
def resolvent(preload, stiffness, exponent, start, start_power, weight, s, guess):
    """The one (d1, g) with d1 + weight g = s, and dg/ds; `start` is d0, `guess` a d1 to begin from."""
    if start > 0.0:
        energy = (preload + stiffness * start_power / (1.0 + exponent)) * start
        if s * start <= weight * energy:  # the contact opens within the step: g = E(d0) / (d0 - d1)
            if weight * energy < SMALLEST:
                return min(s, 0.0), 0.0, 0.0
            apart = quadratic_root(1.0, s - start, -weight * energy)
            return start - apart, energy / apart, 1.0 / (apart * apart / energy + weight)
    elif s < 0.0:
        return s, 0.0, 0.0
    elif start == 0.0 and s <= weight * preload:
        return 0.0, s / weight, 1.0 / weight
    elif s == 0.0:  # at the kink: the slope on the side of contact, so that one Newton step reaches a whole cluster
        return 0.0, 0.0, 1.0 / weight if start == 0.0 and exponent < 1.0 else 0.0
    if exponent == 1.0:
        half = 0.5 * stiffness
        if start >= 0.0:
            overlap = max((s - weight * (preload + half * start)) / (1.0 + weight * half), 0.0)
        else:
            overlap = quadratic_root(1.0 + weight * half, weight * preload - start - s, s * start)
        force, slope = mean_force(preload, stiffness, exponent, start, start_power, overlap)
        return overlap, force, resolvent_slope(slope, weight)
    if s < SMALLEST:
        return 0.0, 0.0, 0.0
    if not 0.0 < guess < s:
        reach = (s / weight - preload) * (1.0 + exponent) / stiffness
        guess = min(s, reach ** (1.0 / exponent)) if reach > 0.0 else 0.5 * s
    overlap, force, slope = solve_loaded(preload, stiffness, exponent, start, start_power, weight, s, guess)
    return overlap, force, resolvent_slope(slope, weight)


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
        total, worst, largest = 0.0, 0.0, 0.0
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
            if abs(residual[i]) > worst * scale:
                worst = abs(residual[i]) / scale
        if worst <= ROUND_OFF or (total >= best and worst <= 100.0 * ROUND_OFF):
            return iteration + 1
        if total > best and damping > 1e-3:  # Newton jumped over a kink: half the way back
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
def conserving_step(h, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, work):
    """One step in place; `work` (WORK_ROWS, n). Returns the iterations used, negative where they did not converge.

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
