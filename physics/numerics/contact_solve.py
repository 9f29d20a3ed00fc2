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

The unknown s_i is then taken less d0_i in contacts with several segments and in loaded contacts with loss, so that the force of
a held contact does not drown in its overlap; the matrix has 0 in place of 1/m_j where bead j sticks. Where that leaves a contact
between two sticking beads without any slope, its row is moved to the next place at which it bends. Where Newton's iteration
cycles, sweeps that solve each row alone follow.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.graph_kernels import graph_mean, graph_resolvent, has_segments
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_kernels import EPSILON
from softcradle.physics.numerics.resolvent import mean_force, resolvent
from softcradle.physics.numerics.switches import copy_into

# rows (n,) of scratch memory: what a step gives, of which END is a guess on entry and then d1
FREE = 0  # h w0 + (h²/2) e
END = 1  # d1
DIAGONAL = 2  # L_ii
# and what the solver keeps
UNKNOWN = 3  # s, or s - d0 in contacts with several segments and where a contact with loss is loaded
RESIDUAL = 4
SLOPE = 5  # dg/ds
START_POWER = 6  # d0**a
UPPER = 7  # of the eliminated matrix
SHIFT = 8  # Newton's correction of s
HOLD = 9  # overlap d0 + (h/2) w0 at which a contact stands still at the end of the step
FORCE_AT_HOLD = 10  # q there, pressed in; 0 where nothing is lost
OFFSET = 11  # d0 where the unknown is taken less it, else 0
BEST = 12  # the unknowns of least residual
LEAST_AT_HOLD = 13  # q at the hold as it comes out
SOLVER_ROWS = 14

# rows (n+1,) of scratch memory by bead
START_VELOCITY = 0  # v0
FREE_VELOCITY = 1  # u
FRICTION = 2  # acceleration by the bed; STICKS in place of one that stops the bead
BEAD_ROWS = 3
STICKS = math.nan

SOLVED = 8.0 * EPSILON  # of the terms of a residual: converged
NEGLIGIBLE = 1e-16  # of the largest unknown: a residual this small moves no bead
NEARLY = 100.0  # times SOLVED: converged too, where the residual has ceased to fall
MOST_WARM = 14  # iterations from the forces of the step before; then the solver begins again from none
# iterations, and n more (each may close or open one contact), from none; then as many from the largest
MOST_NEWTON = 40
LEAST_DAMPING = 1e-3  # of a Newton step: a shorter one is not tried

LOOSE = 1e-11  # of the terms of a residual: good enough after sweeps
STEEP = 1e-3  # pivot below which Newton may overshoot a bend
MOST_SWEPT = 30  # rounds of sweeps
AFTER_SWEEPS = 20  # Newton iterations after each round of sweeps
BISECTIONS = 120  # of a row in a sweep, widening of its bracket included


@inlined
def loses(loss, start, rate):
    """Whether a contact can lose energy in this step: it has loss, and it is loaded or about to be."""
    return loss > 0.0 and (start > 0.0 or (start == 0.0 and rate > 0.0))


@inlined
def begin_solve(h, chain, motion, work):
    """Rows that one step needs, and the first s: by the neighbours' forces, or by a contact's own with dissipation."""
    half, law, coupling, loss = 0.5 * h * h, chain.law, chain.inverse_mass, chain.dissipation.loss
    start, rate, force = motion.overlap, motion.rate, motion.force
    for i in range(start.size):
        work[START_POWER, i] = power(start[i], law[i, 2]) if start[i] > 0.0 else 0.0
        if loss.size == 0:
            before = force[i - 1] if i > 0 else 0.0
            after = force[i + 1] if i < start.size - 1 else 0.0
            pushed = half * (coupling[i] * before + coupling[i + 1] * after)
            work[UNKNOWN, i] = start[i] + work[FREE, i] + pushed
            continue
        ahead = 0.5 * h * rate[i]
        work[HOLD, i] = start[i] + ahead
        work[FORCE_AT_HOLD, i], work[LEAST_AT_HOLD, i] = 0.0, 0.0
        if has_segments(chain.graph, i):
            work[OFFSET, i] = start[i]
            work[LEAST_AT_HOLD, i], _ = graph_mean(chain.graph, i, start[i], ahead, False)
            work[FORCE_AT_HOLD, i], _ = graph_mean(chain.graph, i, start[i], ahead, True)
            work[UNKNOWN, i] = work[END, i] - start[i] + half * work[DIAGONAL, i] * force[i]
            continue
        work[OFFSET, i] = start[i] if loss[i] > 0.0 and start[i] > 0.0 else 0.0
        if loses(loss[i], start[i], rate[i]) and work[HOLD, i] > 0.0:
            work[FORCE_AT_HOLD, i], _ = mean_force(
                law[i, 0], law[i, 1], law[i, 2], start[i], work[START_POWER, i], work[HOLD, i]
            )
            work[LEAST_AT_HOLD, i] = (1.0 - loss[i]) * work[FORCE_AT_HOLD, i]
        work[UNKNOWN, i] = work[END, i] - work[OFFSET, i] + half * work[DIAGONAL, i] * force[i]


@inlined
def begin_again(h, chain, start, pressed, work):
    """Unknowns as if all neighbours pushed with the force `pressed`."""
    half, coupling = 0.5 * h * h, chain.inverse_mass
    for i in range(start.size):
        begin = start[i]
        if chain.dissipation.loss.size:
            begin -= work[OFFSET, i]
        work[UNKNOWN, i] = begin + work[FREE, i] + half * pressed * (coupling[i] + coupling[i + 1])


@inlined
def slide(h, j, chain, force, beads):
    """Put u and the friction of bead j, as an acceleration, into `beads`, from the contact forces."""
    bed, coupling = chain.dissipation.bed[j], chain.inverse_mass[j]
    before, after = force[j - 1] if j > 0 else 0.0, force[j] if j < force.size else 0.0
    outside = chain.push[j] if chain.push.size else 0.0
    u = beads[START_VELOCITY, j] + h * coupling * (before - after + outside)
    beads[FREE_VELOCITY, j] = u
    most = h * bed
    terms = abs(beads[START_VELOCITY, j]) + h * coupling * (abs(before) + abs(after) + abs(outside)) + most
    stuck = abs(u) <= most + SOLVED * terms  # round-off alone sets no bead going
    beads[FRICTION, j] = 0.0 if bed == 0.0 else (STICKS if stuck else math.copysign(bed, -u))


@inlined
def distance_to_bend(h, i, chain, rate, up, beads, work):
    """How far s_i has to move (up, or down) until the contact leaves its vertical piece or a bead beside it breaks loose."""
    weight, ahead, s = 0.5 * h * h * work[DIAGONAL, i], 0.5 * h * rate, work[UNKNOWN, i]
    if work[FORCE_AT_HOLD, i] > work[LEAST_AT_HOLD, i]:
        low, high = ahead + weight * work[LEAST_AT_HOLD, i], ahead + weight * work[FORCE_AT_HOLD, i]
    else:
        low, high = 0.0, weight * chain.law[i, 0]
    found = high - s if up else s - low
    for j in range(i, i + 2):
        if chain.inverse_mass[j] > 0.0:
            sign = 1.0 if (j == i) == up else -1.0  # a greater force pushes the left bead back, the right one on
            room = h * chain.dissipation.bed[j] + sign * beads[FREE_VELOCITY, j]
            found = min(found, weight * room / (h * chain.inverse_mass[j]))
    found = max(found, 0.0) * (1.0 + 1e-9) + 1e-15 * abs(s)
    return found if up else -found


@inlined
def solve_contact(h, i, chain, motion, work):
    """Put overlap, force and slope dg/ds of contact i of a chain with dissipation at its s into their rows."""
    law, loss, start_power = chain.law, chain.dissipation.loss, work[START_POWER, i]
    weight, start, rate = 0.5 * h * h * work[DIAGONAL, i], motion.overlap[i], motion.rate[i]
    s, guess, ahead = work[UNKNOWN, i], work[END, i], 0.5 * h * rate
    least, full = work[LEAST_AT_HOLD, i], work[FORCE_AT_HOLD, i]
    if has_segments(chain.graph, i):
        moved, force, slope = graph_resolvent(chain.graph, i, start, ahead, least, full, weight, s)
        end = start + moved
    else:
        lossy, past = loses(loss[i], start, rate), s - ahead
        holds = lossy and start + ahead > 0.0  # there is an overlap at which it stands still at the end of the step
        presses = not lossy or (holds and past > weight * full)
        kept, begin = 1.0 if presses else 1.0 - loss[i], start if lossy else 0.0
        if holds and not presses and past >= weight * least:
            end, force, slope = start + ahead, past / weight, 1.0 / weight
        else:
            end, force, slope = resolvent(
                chain.graph, i, kept * law[i, 0], kept * law[i, 1], law[i, 2], start, start_power,
                weight, begin + s, guess,
            )  # fmt: skip
    work[END, i], motion.force[i], work[SLOPE, i] = end, force, slope


@inlined
def row_residual(h, i, chain, motion, beads, work):
    """What row i lacks, s_i - lambda_i g_i - (d1_i by the motion), and the sum of its terms without sign."""
    half, coupling, force, start = 0.5 * h * h, chain.inverse_mass, motion.force, motion.overlap[i]
    before = force[i - 1] if i > 0 else 0.0
    after = force[i + 1] if i < force.size - 1 else 0.0
    s, free = work[UNKNOWN, i], work[FREE, i]
    if chain.dissipation.loss.size == 0:
        base, pushed = start + free, half * (coupling[i] * before + coupling[i + 1] * after)
        return s - base - pushed, abs(s) + abs(base) + abs(pushed)
    left, right = half * coupling[i] * before, half * coupling[i + 1] * after
    begin = start - work[OFFSET, i]
    own, base = 0.0, begin + free
    if chain.dissipation.bed.size:
        sticks_left, sticks_right = math.isnan(beads[FRICTION, i]), math.isnan(beads[FRICTION, i + 1])
        if sticks_left or sticks_right:
            base = begin + 0.5 * h * motion.rate[i]
            for j in range(2):
                if not math.isnan(beads[FRICTION, i + j]):
                    end = beads[START_VELOCITY, i + j] + h * beads[FRICTION, i + j]
                    if chain.push.size:
                        end += h * chain.push[i + j] * coupling[i + j]
                    base += 0.5 * h * (end if j == 0 else -end)
            if sticks_left:
                left, own = 0.0, half * coupling[i] * force[i]
            if sticks_right:
                right, own = 0.0, own + half * coupling[i + 1] * force[i]
        else:
            base = begin + (free + half * (beads[FRICTION, i] - beads[FRICTION, i + 1]))
    return s - own - base - (left + right), abs(s) + abs(own) + abs(base) + abs(left + right)


@inlined
def solve_all(h, chain, motion, beads, work):
    """Contacts, then beads on a bed, at the present unknowns."""
    law, loss, start = chain.law, chain.dissipation.loss, motion.overlap
    if loss.size == 0:
        for i in range(start.size):
            weight, start_power = 0.5 * h * h * work[DIAGONAL, i], work[START_POWER, i]
            work[END, i], motion.force[i], work[SLOPE, i] = resolvent(
                chain.graph, i, law[i, 0], law[i, 1], law[i, 2], start[i], start_power, weight,
                work[UNKNOWN, i], work[END, i],
            )  # fmt: skip
    for i in range(loss.size):
        solve_contact(h, i, chain, motion, work)
    for j in range(chain.dissipation.bed.size):
        slide(h, j, chain, motion.force, beads)


@inlined
def sweep(h, chain, motion, beads, work):
    """Solve each row alone for its s, by bisection, once from left to right and once back."""
    n, s = motion.overlap.size, work[UNKNOWN]
    for k in range(2 * n):
        i = k if k < n else 2 * n - 1 - k
        low, high, width = s[i], s[i], 0.0
        for _ in range(BISECTIONS):
            solve_contact(h, i, chain, motion, work)
            if chain.dissipation.bed.size:
                slide(h, i, chain, motion.force, beads)
                slide(h, i + 1, chain, motion.force, beads)
            lacks, terms = row_residual(h, i, chain, motion, beads, work)
            if abs(lacks) <= SOLVED * terms:
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
def newton_shift(h, chain, motion, largest, beads, work):
    """Newton's correction of s, (I - half offdiagonal(L) slope) shift = -residual, by Thomas' elimination."""
    residual, slope, upper, shift = work[RESIDUAL], work[SLOPE], work[UPPER], work[SHIFT]
    n, half, coupling = motion.overlap.size, 0.5 * h * h, chain.inverse_mass
    for i in range(n):
        lower = half * coupling[i] * slope[i - 1] if i > 0 else 0.0
        right = half * coupling[i + 1] * slope[i + 1] if i < n - 1 else 0.0
        bound = 0.0  # of the diagonal: what beads that stick take from it
        if chain.dissipation.bed.size:
            firm_left = math.isnan(beads[FRICTION, i]) or coupling[i] == 0.0  # a wall is as firm as a bead that sticks
            firm_right = math.isnan(beads[FRICTION, i + 1]) or coupling[i + 1] == 0.0
            bound = half * slope[i] * ((coupling[i] if firm_left else 0.0) + (coupling[i + 1] if firm_right else 0.0))
            lower, right = 0.0 if firm_left else lower, 0.0 if firm_right else right
            if firm_left and firm_right and 1.0 - bound < STEEP:
                upper[i], shift[i] = 0.0, 0.0
                if abs(residual[i]) > SOLVED * (abs(work[UNKNOWN, i]) + NEGLIGIBLE * largest):
                    bend = distance_to_bend(h, i, chain, motion.rate[i], residual[i] < 0.0, beads, work)
                    far = -residual[i] / max(1.0 - bound, SOLVED)
                    shift[i] = bend if abs(bend) < abs(far) else far
                continue
        pivot = 1.0 - (lower * upper[i - 1] if i > 0 else 0.0) - bound
        pivot = max(pivot, SOLVED)  # 0 where all contacts between two walls touch: their common part is free
        upper[i] = right / pivot
        shift[i] = (-residual[i] + (lower * shift[i - 1] if i > 0 else 0.0)) / pivot
    for i in range(n - 2, -1, -1):
        shift[i] += upper[i] * shift[i + 1]


@jit
def solve_contacts(h, chain, motion, beads, work):
    """Solve one step for all contacts: g into the forces of `motion` (on entry a guess), d1 into the row END of `work`.

    `motion` holds d0 and w0; ``chain.inverse_mass`` (n+1,) is by bead -L_(i-1,i), its inverse mass in a straight row; `beads`
    (BEAD_ROWS, n+1) holds v0 in its first row where there is a bed; `work` (SOLVER_ROWS, n) what a step gives.
    Returns the iterations used, negative where they did not converge.
    """
    n, dissipates = motion.overlap.size, chain.dissipation.loss.size > 0
    begin_solve(h, chain, motion, work)
    best, least, damping = math.inf, math.inf, 1.0
    spare = n if dissipates else 0
    warm = MOST_WARM + spare
    cold = warm + MOST_NEWTON + n + spare
    swept = cold + MOST_NEWTON + n + spare
    most = swept + MOST_SWEPT * AFTER_SWEEPS if dissipates else swept
    for iteration in range(most):
        if iteration in (warm, cold):
            pressed = 0.0
            if iteration == cold:
                for i in range(n):
                    pressed = max(pressed, motion.force[i])
            begin_again(h, chain, motion.overlap, pressed, work)
            best = math.inf
        if dissipates and iteration >= swept and (iteration - swept) % AFTER_SWEEPS == 0:
            for _ in range(1 + n):
                sweep(h, chain, motion, beads, work)
            best = math.inf
        solve_all(h, chain, motion, beads, work)
        total, terms, worst, largest = 0.0, 0.0, 0.0, 0.0
        for i in range(n):
            largest = max(largest, abs(work[UNKNOWN, i]))
        for i in range(n):
            lacks, scale = row_residual(h, i, chain, motion, beads, work)
            work[RESIDUAL, i] = lacks
            scale += NEGLIGIBLE * largest
            total += abs(lacks)
            terms += scale
            if abs(lacks) > worst * scale:
                worst = abs(lacks) / scale
        if worst <= SOLVED or (total >= best and worst <= NEARLY * SOLVED):
            return iteration + 1
        if dissipates:
            if iteration >= swept and worst <= LOOSE:
                return iteration + 1
            if worst < least:
                least = worst
                copy_into(work[BEST], work[UNKNOWN])
        if total > max(best, SOLVED * terms) and damping > LEAST_DAMPING:  # a jump over a kink: half the way back
            damping *= 0.5
            for i in range(n):
                work[UNKNOWN, i] -= damping * work[SHIFT, i]
            continue
        best, damping = total, 1.0
        newton_shift(h, chain, motion, largest, beads, work)
        for i in range(n):
            work[UNKNOWN, i] += work[SHIFT, i]
    if dissipates:
        copy_into(work[UNKNOWN], work[BEST])
        solve_all(h, chain, motion, beads, work)
    return -most
