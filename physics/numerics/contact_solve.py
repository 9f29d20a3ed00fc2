"""Mean forces of all contacts in one step of the discrete gradient, by Newton's method on a tridiagonal system.

The unknowns are the mean forces g_i and the overlaps d1_i at the end of the step. w0 and w1 are the rates at both ends:

    d1 = d0 + h w0 + (h²/2) e - (h²/2) L g,      g_i = q(d1_i),      q(d1) = (E(d1) - E(d0)) / (d1 - d0)

The map d1 -> g is monotone, so g is unique. With lambda_i = (h²/2) L_ii and s_i = d1_i + lambda_i g_i, the resolvent of
each contact determines (d1_i, g_i) from s_i. Neighbours are coupled by one tridiagonal Newton iteration on s, whose
matrix is a column-dominant M-matrix.

With dissipation, that is hysteretic loss of contacts and Coulomb friction of a bed with deceleration mu g:

    v1_j = S(u_j),  u_j = v0_j + h (g_(j-1) - g_j + p_j) / m_j,   S(u) = sign(u) max(0, |u| - h mu g)
    d1_i = d0_i + (h/2) (w0_i + w1_i),                            w = v_i - v_(i+1)
    g_i  = q(d1_i) times 1 if w1_i > 0, (1 - loss) if w1_i < 0, anything between if w1_i = 0

Friction depends on the velocity at the end of the step: it can stop a bead and hold it, but it never reverses its
velocity. Because w1 = 2 (d1 - d0)/h - w0, a contact with loss has a vertical piece of its graph at d0 + (h/2) w0, which
is one more branch of its resolvent. The step minimises a strictly convex function of v1, so v1 is unique. Forces
between beads that all stick need not be unique.

For contacts with several segments, and for loaded contacts with loss, the solver uses s_i - d0_i as the unknown.
Otherwise the force of a contact held by friction would be lost in the round-off of its overlap. The matrix has 0 in
place of 1/m_j if bead j sticks. If the slope of a contact between two sticking beads is 0, its row is moved to the next
breakpoint of its graph. If Newton's iteration cycles, Gauss-Seidel sweeps follow, which solve one row at a time.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.elementary import power
from softcradle.physics.numerics.graph_kernels import graph_mean, graph_resolvent, has_segments
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_kernels import EPSILON
from softcradle.physics.numerics.resolvent import mean_force, resolvent
from softcradle.physics.numerics.switches import copy_into

# Rows (n,) of the work array. The step writes the first three; END holds a guess of d1 on entry and d1 on return.
FREE = 0  # overlap without contact forces, less d0: h w0 + (h²/2) e
END = 1  # overlap d1 at the end of the step
DIAGONAL = 2  # diagonal L_ii of L [1/kg]
# rows that only the solver uses
UNKNOWN = 3  # s; s - d0 for contacts with several segments and for loaded contacts with loss
RESIDUAL = 4
SLOPE = 5  # derivative dg/ds
START_POWER = 6  # d0**a
UPPER = 7  # upper diagonal of the matrix after elimination
SHIFT = 8  # Newton's correction of s
HOLD = 9  # overlap d0 + (h/2) w0, at which the contact has rate 0 at the end of the step
FORCE_AT_HOLD = 10  # mean force q at the overlap HOLD on the loading branch; 0 without loss
OFFSET = 11  # d0 if the unknown is s - d0, else 0
BEST = 12  # the unknowns with the smallest residual so far
LEAST_AT_HOLD = 13  # mean force q at the overlap HOLD on the unloading branch
SOLVER_ROWS = 14

# rows (n+1,) of the work array of the beads
START_VELOCITY = 0  # velocity v0 at the start of the step
FREE_VELOCITY = 1  # velocity u at the end of the step without friction
FRICTION = 2  # acceleration by friction; STICKS if friction stops the bead
HUNG_MASS = 3  # inverse mass with which the solver takes a step of beads on strings
BEAD_ROWS = 4
STICKS = math.nan

# A row has converged if its residual is at most this fraction of the sum of its absolute terms (a few round-offs).
SOLVED = 8.0 * EPSILON
# Fraction of the largest unknown. A residual this small does not move a bead by a representable amount.
NEGLIGIBLE = 1e-16
NEARLY = 100.0  # Multiple of SOLVED that also counts as converged if the residual has stopped falling.
# Newton iterations from the forces of the previous step. If they do not converge, the solver restarts from zero force.
MOST_WARM = 14
# Newton iterations of a restart; n more are allowed, because each iteration may open or close one contact. The first
# restart begins without forces, the second one with the largest force on all beads.
MOST_NEWTON = 40
# Smallest damping factor of a Newton step. Once it is reached, the solver accepts a larger residual and takes the next
# full step.
LEAST_DAMPING = 1e-3

LOOSE = 1e-11  # Residual, as a fraction of the absolute terms of a row, that is accepted after Gauss-Seidel sweeps.
STEEP = 1e-3  # Pivot below which a Newton step may jump over a breakpoint of the graph.
MOST_SWEPT = 30  # largest number of rounds of sweeps
AFTER_SWEEPS = 20  # Newton iterations after each round of sweeps
# Bisection steps for one row in a sweep. Some of them widen the bracket, the others halve it down to round-off.
BISECTIONS = 120


@inlined
def loses(loss, start, rate):
    """Return True if a contact can lose energy in this step: it has loss, and it is loaded or is about to be loaded."""
    return loss > 0.0 and (start > 0.0 or (start == 0.0 and rate > 0.0))


@inlined
def begin_solve(h, chain, motion, work):
    """Fill the rows that are constant during a step, and guess s from the forces in `motion`.

    Without dissipation the guess uses the forces of the neighbours, with dissipation the force of the contact itself.
    """
    half, law, coupling, loss = 0.5 * h * h, chain.law, chain.inverse_mass, chain.dissipation.loss
    start, rate, force = motion.overlap, motion.rate, motion.force
    for i in range(start.size):
        work[START_POWER, i] = power(start[i], law[i, 2]) if start[i] > 0.0 else 0.0
        # conserving chain: s = d0 + free motion + (h²/2) (forces of both neighbours)
        if loss.size == 0:
            before = force[i - 1] if i > 0 else 0.0
            after = force[i + 1] if i < start.size - 1 else 0.0
            pushed = half * (coupling[i] * before + coupling[i + 1] * after)
            work[UNKNOWN, i] = start[i] + work[FREE, i] + pushed
            continue
        # The rate at the end vanishes at d1 = d0 + (h/2) w0. There the force may be anything between the unloading and
        # the loading branch, so the forces of both branches are stored.
        ahead = 0.5 * h * rate[i]
        work[HOLD, i] = start[i] + ahead
        work[FORCE_AT_HOLD, i], work[LEAST_AT_HOLD, i] = 0.0, 0.0
        if has_segments(chain.graph, i):
            work[OFFSET, i] = start[i]
            work[LEAST_AT_HOLD, i], _ = graph_mean(chain.graph, i, start[i], ahead, False)
            work[FORCE_AT_HOLD, i], _ = graph_mean(chain.graph, i, start[i], ahead, True)
            work[UNKNOWN, i] = work[END, i] - start[i] + half * work[DIAGONAL, i] * force[i]
            continue
        # count s from d0 if forces may be tiny compared with the overlap (see the module docstring)
        work[OFFSET, i] = start[i] if loss[i] > 0.0 and start[i] > 0.0 else 0.0
        if loses(loss[i], start[i], rate[i]) and work[HOLD, i] > 0.0:
            work[FORCE_AT_HOLD, i], _ = mean_force(
                law[i, 0], law[i, 1], law[i, 2], start[i], work[START_POWER, i], work[HOLD, i]
            )
            work[LEAST_AT_HOLD, i] = (1.0 - loss[i]) * work[FORCE_AT_HOLD, i]
        work[UNKNOWN, i] = work[END, i] - work[OFFSET, i] + half * work[DIAGONAL, i] * force[i]


@inlined
def begin_again(h, chain, start, pressed, work):
    """Set the unknowns as if every neighbour pushed with the force `pressed` [N]."""
    half, coupling = 0.5 * h * h, chain.inverse_mass
    for i in range(start.size):
        begin = start[i]
        if chain.dissipation.loss.size:
            begin -= work[OFFSET, i]
        work[UNKNOWN, i] = begin + work[FREE, i] + half * pressed * (coupling[i] + coupling[i + 1])


@inlined
def slide(h, j, chain, force, beads):
    """Write u and the friction of bead j (an acceleration) into `beads`, for the present contact forces."""
    bed, coupling = chain.dissipation.bed[j], chain.inverse_mass[j]
    before, after = force[j - 1] if j > 0 else 0.0, force[j] if j < force.size else 0.0
    # velocity without friction at the end of the step
    outside = chain.push[j] if chain.push.size else 0.0
    u = beads[START_VELOCITY, j] + h * coupling * (before - after + outside)
    beads[FREE_VELOCITY, j] = u
    # S(u) = 0 if friction can stop the bead within the step, up to the round-off of the terms of u
    most = h * bed
    terms = abs(beads[START_VELOCITY, j]) + h * coupling * (abs(before) + abs(after) + abs(outside)) + most
    stuck = abs(u) <= most + SOLVED * terms  # round-off alone must not set a bead in motion
    beads[FRICTION, j] = 0.0 if bed == 0.0 else (STICKS if stuck else math.copysign(bed, -u))


@inlined
def distance_to_bend(h, i, chain, rate, up, beads, work):
    """Return by how much s_i must change until the contact leaves its vertical piece or one of its beads starts to slide.

    The change is upwards if `up`, else downwards.
    """
    weight, ahead, s = 0.5 * h * h * work[DIAGONAL, i], 0.5 * h * rate, work[UNKNOWN, i]
    # ends of the vertical piece in s: at the overlap HOLD with loss, or at touch with a preload
    if work[FORCE_AT_HOLD, i] > work[LEAST_AT_HOLD, i]:
        low, high = ahead + weight * work[LEAST_AT_HOLD, i], ahead + weight * work[FORCE_AT_HOLD, i]
    else:
        low, high = 0.0, weight * chain.law[i, 0]
    found = high - s if up else s - low
    for j in range(i, i + 2):
        if chain.inverse_mass[j] > 0.0:
            # a larger force pushes the left bead back and the right bead forward
            sign = 1.0 if (j == i) == up else -1.0
            # change of the force at which friction of this bead reaches its limit, expressed as a change of s
            room = h * chain.dissipation.bed[j] + sign * beads[FREE_VELOCITY, j]
            found = min(found, weight * room / (h * chain.inverse_mass[j]))
    # a little farther, so that the next iteration lies on the other side of the breakpoint
    found = max(found, 0.0) * (1.0 + 1e-9) + 1e-15 * abs(s)
    return found if up else -found


@inlined
def solve_contact(h, i, chain, motion, work):
    """Write overlap, force and slope dg/ds of contact i of a chain with dissipation into their rows, for its present s."""
    law, loss, start_power = chain.law, chain.dissipation.loss, work[START_POWER, i]
    weight, start, rate = 0.5 * h * h * work[DIAGONAL, i], motion.overlap[i], motion.rate[i]
    s, guess, ahead = work[UNKNOWN, i], work[END, i], 0.5 * h * rate
    least, full = work[LEAST_AT_HOLD, i], work[FORCE_AT_HOLD, i]
    # several segments: the resolvent of the graph gives the change of the overlap
    if has_segments(chain.graph, i):
        moved, force, slope = graph_resolvent(chain.graph, i, start, ahead, least, full, weight, s)
        end = start + moved
    else:
        # One power law or table. With loss, the position of s relative to the vertical piece at the overlap HOLD
        # selects the branch: above it loading, below it unloading with (1 - loss) of the force, between them the
        # contact has rate 0 at the end.
        lossy, past = loses(loss[i], start, rate), s - ahead
        # the end of the step may be a state of rest of this contact while it is closed
        holds = lossy and start + ahead > 0.0
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
    """Return the residual of row i and the sum of the absolute values of its terms.

    The residual is s_i - lambda_i g_i - d1_i, where d1_i is the overlap at the end by the motion of the beads.
    """
    half, coupling, force, start = 0.5 * h * h, chain.inverse_mass, motion.force, motion.overlap[i]
    before = force[i - 1] if i > 0 else 0.0
    after = force[i + 1] if i < force.size - 1 else 0.0
    s, free = work[UNKNOWN, i], work[FREE, i]
    # conserving chain: s = d0 + free motion + (h²/2) (forces of both neighbours)
    if chain.dissipation.loss.size == 0:
        base, pushed = start + free, half * (coupling[i] * before + coupling[i + 1] * after)
        return s - base - pushed, abs(s) + abs(base) + abs(pushed)
    left, right = half * coupling[i] * before, half * coupling[i + 1] * after
    begin = start - work[OFFSET, i]
    # `own` is the share of lambda_i g_i that belongs to sticking beads: their velocity does not depend on the force
    own, base = 0.0, begin + free
    if chain.dissipation.bed.size:
        sticks_left, sticks_right = math.isnan(beads[FRICTION, i]), math.isnan(beads[FRICTION, i + 1])
        if sticks_left or sticks_right:
            # A sticking bead ends with the velocity 0. Add (h/2) w0 and the end velocities of the beads that do not
            # stick.
            base = begin + 0.5 * h * motion.rate[i]
            for j in range(2):
                if not math.isnan(beads[FRICTION, i + j]):
                    end = beads[START_VELOCITY, i + j] + h * beads[FRICTION, i + j]
                    if chain.push.size:
                        end += h * chain.push[i + j] * coupling[i + j]
                    base += 0.5 * h * (end if j == 0 else -end)
            # and leave out what the contact forces would do to the beads that stick
            if sticks_left:
                left, own = 0.0, half * coupling[i] * force[i]
            if sticks_right:
                right, own = 0.0, own + half * coupling[i + 1] * force[i]
        else:
            # both beads slide: friction is a known acceleration
            base = begin + (free + half * (beads[FRICTION, i] - beads[FRICTION, i + 1]))
    return s - own - base - (left + right), abs(s) + abs(own) + abs(base) + abs(left + right)


@inlined
def solve_all(h, chain, motion, beads, work):
    """Evaluate all contacts, then the friction of all beads, at the present unknowns."""
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
    """Solve each row for its own s by bisection, once from left to right and once back (symmetric Gauss-Seidel)."""
    n, s = motion.overlap.size, work[UNKNOWN]
    for k in range(2 * n):
        i = k if k < n else 2 * n - 1 - k
        # The residual rises with s. Its sign gives one end of the bracket.
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
            # as long as one end of the bracket is missing, go on in the same direction with doubled steps
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
    """Compute Newton's correction of s by Thomas' elimination: (I - (h²/2) offdiagonal(L) slope) shift = -residual."""
    residual, slope, upper, shift = work[RESIDUAL], work[SLOPE], work[UPPER], work[SHIFT]
    n, half, coupling = motion.overlap.size, 0.5 * h * h, chain.inverse_mass
    for i in range(n):
        lower = half * coupling[i] * slope[i - 1] if i > 0 else 0.0
        right = half * coupling[i + 1] * slope[i + 1] if i < n - 1 else 0.0
        # Part of the diagonal that beads which stick take away: their velocity does not depend on the forces.
        bound = 0.0
        if chain.dissipation.bed.size:
            firm_left = math.isnan(beads[FRICTION, i]) or coupling[i] == 0.0  # a wall does not move either
            firm_right = math.isnan(beads[FRICTION, i + 1]) or coupling[i + 1] == 0.0
            bound = half * slope[i] * ((coupling[i] if firm_left else 0.0) + (coupling[i + 1] if firm_right else 0.0))
            lower, right = 0.0 if firm_left else lower, 0.0 if firm_right else right
            # Both beads are fixed and the row is nearly singular (its graph is nearly vertical in s). Newton's step
            # could jump over breakpoints, so it is limited to the next one.
            if firm_left and firm_right and 1.0 - bound < STEEP:
                upper[i], shift[i] = 0.0, 0.0
                if abs(residual[i]) > SOLVED * (abs(work[UNKNOWN, i]) + NEGLIGIBLE * largest):
                    bend = distance_to_bend(h, i, chain, motion.rate[i], residual[i] < 0.0, beads, work)
                    far = -residual[i] / max(1.0 - bound, SOLVED)
                    shift[i] = bend if abs(bend) < abs(far) else far
                continue
        # forward elimination
        pivot = 1.0 - (lower * upper[i - 1] if i > 0 else 0.0) - bound
        # The pivot is 0 if all contacts between two walls touch: a force common to all of them is then undetermined.
        pivot = max(pivot, SOLVED)
        upper[i] = right / pivot
        shift[i] = (-residual[i] + (lower * shift[i - 1] if i > 0 else 0.0)) / pivot
    # back substitution
    for i in range(n - 2, -1, -1):
        shift[i] += upper[i] * shift[i + 1]


@jit
def solve_contacts(h, chain, motion, beads, work):
    """Solve one step for all contacts; the forces of `motion` are a guess of g on entry and g on return.

    `motion` holds d0 and w0. ``chain.inverse_mass`` (n+1,) is -L_(i-1,i) for each bead; in a straight row this is the
    inverse mass of the bead. `beads` (BEAD_ROWS, n+1) holds v0 in its first row if there is a bed. `work` (SOLVER_ROWS,
    n) holds the rows that the step writes; its row END returns d1.

    Return the number of iterations, negative if they did not converge.
    """
    n, dissipates = motion.overlap.size, chain.dissipation.loss.size > 0
    begin_solve(h, chain, motion, work)
    # The iteration has up to four phases, each longer than the last: from the guess, from zero force, from the largest
    # force, and with dissipation rounds of sweeps with Newton iterations between them. A chain with dissipation gets n
    # iterations more, because friction may change the state of each bead once.
    best, least, damping = math.inf, math.inf, 1.0
    spare = n if dissipates else 0
    warm = MOST_WARM + spare
    cold = warm + MOST_NEWTON + n + spare
    swept = cold + MOST_NEWTON + n + spare
    most = swept + MOST_SWEPT * AFTER_SWEEPS if dissipates else swept
    for iteration in range(most):
        # next phase: start from zero force, then from the largest force
        if iteration in (warm, cold):
            pressed = 0.0
            if iteration == cold:
                for i in range(n):
                    pressed = max(pressed, motion.force[i])
            begin_again(h, chain, motion.overlap, pressed, work)
            best = math.inf
        # Newton's iteration cycles: solve row by row, then try it again
        if dissipates and iteration >= swept and (iteration - swept) % AFTER_SWEEPS == 0:
            for _ in range(1 + n):
                sweep(h, chain, motion, beads, work)
            best = math.inf
        # residual of every row, relative to the terms that it consists of
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
        # converged, or as close as round-off allows
        if worst <= SOLVED or (total >= best and worst <= NEARLY * SOLVED):
            return iteration + 1
        if dissipates:
            # after sweeps accept a looser residual, and remember the best unknowns for the case that nothing converges
            if iteration >= swept and worst <= LOOSE:
                return iteration + 1
            if worst < least:
                least = worst
                copy_into(work[BEST], work[UNKNOWN])
        # The residual has grown: the step has jumped over a kink. Go half the way back.
        if total > max(best, SOLVED * terms) and damping > LEAST_DAMPING:
            damping *= 0.5
            for i in range(n):
                work[UNKNOWN, i] -= damping * work[SHIFT, i]
            continue
        # full Newton step
        best, damping = total, 1.0
        newton_shift(h, chain, motion, largest, beads, work)
        for i in range(n):
            work[UNKNOWN, i] += work[SHIFT, i]
    # not converged: leave the best state that was found
    if dissipates:
        copy_into(work[UNKNOWN], work[BEST])
        solve_all(h, chain, motion, beads, work)
    return -most
