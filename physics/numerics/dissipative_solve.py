"""One step of `conserving` where something rubs: mean contact forces g with loss, and Coulomb friction of a bed.

    v1_j = S(u_j),  u_j = v0_j + h (g_(j-1) - g_j + p_j) / m_j,   S(u) = sign(u) max(0, |u| - h mu g)
    d1_i = d0_i + (h/2) (w0_i + w1_i),                            w = v_i - v_(i+1)
    g_i  = q(d1_i) times 1 if w1_i > 0, (1 - loss) if w1_i < 0, anything between if w1_i = 0,  q = (E(d1)-E(d0))/(d1-d0)

Friction is taken at the end of the step: it stops a bead and keeps it, but never turns it round. As w1 = 2 (d1 - d0)/h - w0,
a contact with loss has a vertical piece at `hold` = d0 + (h/2) w0, one more branch of its resolvent. The step minimises a
strictly convex function of v1, so v1 is unique; forces between beads that all stick need not be.

As in softcradle.physics.fixed_step.discrete_gradient the unknowns are s_i = d1_i + lambda_i g_i, less d0_i where a contact with loss is loaded,
so that the force of one that stands still does not drown in its overlap; the matrix of Newton's iteration has 0 in place
of 1/m_j where bead j sticks. Where that leaves a contact between two sticking beads without any slope, its row is moved
to the next place at which it bends. Where Newton goes round in circles, sweeps in which each row is solved alone lead out.
"""

from __future__ import annotations

import math

from softcradle.physics.fixed_step.discrete_gradient import MOST_NEWTON, MOST_WARM, NEGLIGIBLE, ROUND_OFF
from softcradle.physics.numerics.contact_law import power
from softcradle.physics.numerics.copying import copy_into
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.resolvent import mean_force, resolvent

SOLVER_ROWS = 10  # rows (n,) of scratch memory of `dry_forces`
BEAD_ROWS = 3  # rows (n+1,): v0, u, the friction as an acceleration
STICKS = math.nan  # in place of a friction: that which stops the bead
STEEP = 1e-3  # a pivot below asks whether Newton goes past a bend
MOST_SWEPT = 30  # rounds of sweeps, each followed by
AFTER_SWEEPS = 20  # iterations of Newton
LOOSE = 1e-11  # residual that is good enough then
BISECTIONS = 60  # of a row in a sweep


@jit
def lossy_resolvent(preload, stiffness, exponent, loss, start, start_power, ahead, at_hold, weight, s, guess):
    """The one (d1, g) with d1 - start + weight g = s, and dg/ds, for start >= 0; `at_hold` is q at the overlap
    start + `ahead` where w1 = 0."""
    kept = 1.0 - loss
    if start + ahead > 0.0:
        if s - ahead > weight * at_hold:
            return resolvent(preload, stiffness, exponent, start, start_power, weight, start + s, guess)
        if s - ahead >= weight * kept * at_hold:
            return start + ahead, (s - ahead) / weight, 1.0 / weight
    return resolvent(kept * preload, kept * stiffness, exponent, start, start_power, weight, start + s, guess)


@jit
def keeps(loss, start, rate):
    """Whether a contact can come out with loss in this step: it is loaded, or about to be."""
    return loss > 0.0 and (start > 0.0 or (start == 0.0 and rate > 0.0))


@jit
def contact_at(h, i, law, loss, diagonal, start, rate, overlap, force, work):
    """Put overlap, force and slope dg/ds of contact i at its s into their rows."""
    weight = 0.5 * h * h * diagonal[i]
    s, start_power, at_hold = work[0], work[3], work[7]
    if keeps(loss[i], start[i], rate[i]):
        overlap[i], force[i], work[2, i] = lossy_resolvent(
            law[i, 0], law[i, 1], law[i, 2], loss[i], start[i], start_power[i], 0.5 * h * rate[i], at_hold[i], weight,
            s[i], overlap[i],
        )  # fmt: skip
    else:
        overlap[i], force[i], work[2, i] = resolvent(
            law[i, 0], law[i, 1], law[i, 2], start[i], start_power[i], weight, s[i], overlap[i]
        )  # fmt: skip


@jit
def slide(h, j, inverse_mass, pushed, bed, force, beads):
    """Put u and the friction of bead j, as an acceleration, into `beads`, from the contact forces."""
    before, after = force[j - 1] if j > 0 else 0.0, force[j] if j < force.size else 0.0
    outside = pushed[j] if pushed.size else 0.0
    u = beads[0, j] + h * inverse_mass[j] * (before - after + outside)
    beads[1, j] = u
    most = h * bed[j]
    terms = abs(beads[0, j]) + h * inverse_mass[j] * (before + after + abs(outside)) + most
    stuck = abs(u) <= most + ROUND_OFF * terms  # what is no more than round-off does not set it going
    beads[2, j] = 0.0 if bed[j] == 0.0 else (STICKS if stuck else math.copysign(bed[j], -u))


@jit
def row_residual(h, i, coupling, pushed, bed, free, start, rate, force, beads, work):
    """What row i lacks, s_i - lambda_i g_i - (d1_i by the motion), and the sum of its terms without sign."""
    half = 0.5 * h * h
    left = half * coupling[i] * (force[i - 1] if i > 0 else 0.0)
    right = half * coupling[i + 1] * (force[i + 1] if i < force.size - 1 else 0.0)
    begin = start[i] - work[8, i]
    own, base = 0.0, begin + free[i]
    if bed.size:
        stuck_left, stuck_right = math.isnan(beads[2, i]), math.isnan(beads[2, i + 1])
        if stuck_left or stuck_right:
            base = begin + 0.5 * h * rate[i]
            for j in range(2):
                if not math.isnan(beads[2, i + j]):
                    end = beads[0, i + j] + h * beads[2, i + j]
                    if pushed.size:
                        end += h * pushed[i + j] * coupling[i + j]
                    base += 0.5 * h * (end if j == 0 else -end)
            if stuck_left:
                left, own = 0.0, half * coupling[i] * force[i]
            if stuck_right:
                right, own = 0.0, own + half * coupling[i + 1] * force[i]
        else:
            base = begin + (free[i] + half * (beads[2, i] - beads[2, i + 1]))
    s = work[0, i]
    return s - own - base - (left + right), abs(s) + own + abs(base) + abs(left + right)


@jit
def next_bend(h, i, law_loss, weight, at_hold, ahead, start, preload, s, up, inverse_mass, bed, beads):
    """How far s_i has to move (up, or down) until the contact leaves its vertical piece or a bead beside it breaks loose."""
    if start + ahead > 0.0 and law_loss > 0.0:
        low, high = ahead + weight * (1.0 - law_loss) * at_hold, ahead + weight * at_hold
    else:
        low, high = 0.0, weight * preload
    found = high - s if up else s - low
    for j in range(2):
        if inverse_mass[i + j] > 0.0:
            sign = 1.0 if (j == 0) == up else -1.0  # a greater force pushes the left bead back, the right one on
            room = h * bed[i + j] + sign * beads[1, i + j]
            found = min(found, weight * room / (h * inverse_mass[i + j]))
    found = max(found, 0.0) * (1.0 + 1e-9) + 1e-15 * abs(s)
    return found if up else -found


@jit
def sweep(h, law, loss, diagonal, coupling, pushed, bed, free, start, rate, overlap, force, beads, work):
    """Solve each row alone for its s, by bisection, once from left to right and once back."""
    n = start.size
    s = work[0]
    for k in range(2 * n):
        i = k if k < n else 2 * n - 1 - k
        low, high, width = s[i], s[i], 0.0
        for _tries in range(BISECTIONS + 60):
            contact_at(h, i, law, loss, diagonal, start, rate, overlap, force, work)
            if bed.size:
                slide(h, i, coupling, pushed, bed, force, beads)
                slide(h, i + 1, coupling, pushed, bed, force, beads)
            missing, terms = row_residual(h, i, coupling, pushed, bed, free, start, rate, force, beads, work)
            if abs(missing) <= ROUND_OFF * terms:
                break
            if missing < 0.0:
                low = s[i]
            else:
                high = s[i]
            if low == high or (low < s[i] and high <= low) or (high == s[i] and low >= high):
                width = max(2.0 * width, abs(missing))
                if missing < 0.0:
                    high = s[i] = low + width
                else:
                    low = s[i] = high - width
                continue
            s[i] = 0.5 * (low + high)


@jit
def newton_shift(h, law, loss, diagonal, coupling, bed, start, rate, largest, beads, work):
    """Solve the tridiagonal system of Newton's iteration, by Thomas, for the shift of s; columns of sticking beads lack 1/m."""
    s, residual, slope, upper, shift = work[0], work[1], work[2], work[4], work[5]
    n, half = start.size, 0.5 * h * h
    for i in range(n):
        loose_left = not (bed.size and (math.isnan(beads[2, i]) or coupling[i] == 0.0))  # a wall is as firm
        loose_right = not (bed.size and (math.isnan(beads[2, i + 1]) or coupling[i + 1] == 0.0))
        lower = half * coupling[i] * slope[i - 1] if i > 0 and loose_left else 0.0
        pivot = 1.0 - (lower * upper[i - 1] if i > 0 else 0.0)
        pivot -= half * slope[i] * ((0.0 if loose_left else coupling[i]) + (0.0 if loose_right else coupling[i + 1]))
        right = half * coupling[i + 1] * slope[i + 1] if i < n - 1 and loose_right else 0.0
        if pivot < STEEP and not (loose_left or loose_right):
            upper[i], shift[i] = 0.0, 0.0
            if abs(residual[i]) > ROUND_OFF * (abs(s[i]) + NEGLIGIBLE * largest):
                bend = next_bend(
                    h, i, loss[i], half * diagonal[i], work[7, i], 0.5 * h * rate[i], start[i], law[i, 0], s[i],
                    residual[i] < 0.0, coupling, bed, beads,
                )  # fmt: skip
                far = -residual[i] / max(pivot, ROUND_OFF)
                shift[i] = bend if abs(bend) < abs(far) else far
            continue
        pivot = max(pivot, ROUND_OFF)
        upper[i] = right / pivot
        shift[i] = (-residual[i] + (lower * shift[i - 1] if i > 0 else 0.0)) / pivot
    for i in range(n - 2, -1, -1):
        shift[i] += upper[i] * shift[i + 1]


@jit
def dry_forces(h, law, loss, diagonal, coupling, pushed, bed, free, start, rate, overlap, force, beads, work):
    """Solve one step for all contacts: g into `force` (on entry a guess), d1 into `overlap` (on entry a guess).

    `diagonal`, `coupling`, `start`: see `mean_forces`; `free` (n,) is h w0 (+ (h²/2) external), `rate` (n,) w0; `pushed`
    (n+1,) forces from outside [N], or empty; `bed` (n+1,) decelerations mu g, or empty; `beads` (BEAD_ROWS, n+1) holds
    v0 in row 0 where there is a bed, u and the friction (nan: sticks) are put into rows 1 and 2; `work` (SOLVER_ROWS, n).
    Returns the iterations used, negative where they did not converge.
    """
    n = start.size
    half = 0.5 * h * h
    s, residual, shift = work[0], work[1], work[5]
    for i in range(n):
        work[3, i] = power(start[i], law[i, 2]) if start[i] > 0.0 else 0.0
        work[6, i] = start[i] + 0.5 * h * rate[i]
        work[8, i] = start[i] if loss[i] > 0.0 and start[i] > 0.0 else 0.0
        if keeps(loss[i], start[i], rate[i]) and work[6, i] > 0.0:
            work[7, i], _ = mean_force(law[i, 0], law[i, 1], law[i, 2], start[i], work[3, i], work[6, i])
        s[i] = overlap[i] - work[8, i] + half * diagonal[i] * force[i]
    best, least = math.inf, math.inf
    damping = 1.0
    warm, below = MOST_WARM + n, MOST_WARM + MOST_NEWTON + 3 * n
    swept = below + MOST_NEWTON + 2 * n
    for iteration in range(swept + MOST_SWEPT * AFTER_SWEEPS):
        if iteration in (warm, below):
            highest = 0.0
            if iteration == below:
                for i in range(n):
                    highest = max(highest, force[i])
            for i in range(n):
                s[i] = start[i] - work[8, i] + free[i] + half * highest * (coupling[i] + coupling[i + 1])
            best = math.inf
        if iteration >= swept and (iteration - swept) % AFTER_SWEEPS == 0:
            for _ in range(1 + n):
                sweep(h, law, loss, diagonal, coupling, pushed, bed, free, start, rate, overlap, force, beads, work)
            best = math.inf
        total, terms, worst, largest = 0.0, 0.0, 0.0, 0.0
        for i in range(n):
            largest = max(largest, abs(s[i]))
            contact_at(h, i, law, loss, diagonal, start, rate, overlap, force, work)
        for j in range(bed.size):
            slide(h, j, coupling, pushed, bed, force, beads)
        for i in range(n):
            residual[i], scale = row_residual(h, i, coupling, pushed, bed, free, start, rate, force, beads, work)
            scale += NEGLIGIBLE * largest
            total += abs(residual[i])
            terms += scale
            if abs(residual[i]) > worst * scale:
                worst = abs(residual[i]) / scale
        if worst <= ROUND_OFF or (total >= best and worst <= 100.0 * ROUND_OFF):
            return iteration + 1
        if iteration >= swept and worst <= LOOSE:
            return iteration + 1
        if worst < least:  # what is given back if all fails
            least = worst
            copy_into(work[9], s)
        if total > max(best, ROUND_OFF * terms) and damping > 1e-3:  # Newton jumped over a kink: half the way back
            damping *= 0.5
            for i in range(n):
                s[i] -= damping * shift[i]
            continue
        best = total
        damping = 1.0
        newton_shift(h, law, loss, diagonal, coupling, bed, start, rate, largest, beads, work)
        for i in range(n):
            s[i] += shift[i]
    copy_into(s, work[9])
    for i in range(n):
        contact_at(h, i, law, loss, diagonal, start, rate, overlap, force, work)
    for j in range(bed.size):
        slide(h, j, coupling, pushed, bed, force, beads)
    return -iteration
