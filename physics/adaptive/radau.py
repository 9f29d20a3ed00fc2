"""One step of Radau IIA with three stages (order 5), solved for force and overlap together, and its error estimate.

    d_k = d0 + h c_k w0 - h² sum_j (A²)_kj (L f_j)        w_k = w0 - h sum_j A_kj (L f_j),   k = 1..3

The unknowns (d, f) lie on the curve of the contact law, so an iteration costs one block-tridiagonal solve with 3x3
blocks and diagonal couplings. A touching contact is on the vertical part of its curve: its d stays, and its f is a
multiplier (Signorini condition). The error estimate compares two embedded quadratures with the step and filters their
difference by the stiff part of the motion (Hairer & Wanner, Solving ODEs II, IV.8).
"""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.adaptive.constants import (
    FORCE_PRECISION,
    HUGE,
    KINK,
    MARGIN,
    MOST_GUESSED,
    MOST_TRIES,
    NEWTON_PART,
    RATIO,
    ROUND_OFF,
)
from softcradle.physics.adaptive.step_records import COARSE_ERROR, COMPLIANCE, FINE_ERROR, UPPER
from softcradle.physics.numerics.elementary import exp, log
from softcradle.physics.numerics.exact_matrices import exact_inverse, exact_product
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.knots import drive_at
from softcradle.physics.numerics.law_curve import (
    NODES,
    ROOT6,
    SMALLEST,
    acceleration_of,
    anchor_acceleration,
    care,
    curve_force,
    curve_overlap,
    curve_slope,
    flow_into,
    larger,
    move_along,
    pressed_force,
)
from softcradle.physics.numerics.records import FROZEN, LOADED, OPEN, TOUCHING, ZERO
from softcradle.physics.numerics.swing import string_pull
from softcradle.physics.numerics.table_kernels import breakpoint_force, has_table

# Butcher matrix A of Radau IIA with three stages (Hairer & Wanner, Solving ODEs II, table IV.5.6)
TABLEAU = np.array(
    [
        [(88.0 - 7.0 * ROOT6) / 360.0, (296.0 - 169.0 * ROOT6) / 1800.0, (-2.0 + 3.0 * ROOT6) / 225.0],
        [(296.0 + 169.0 * ROOT6) / 1800.0, (88.0 + 7.0 * ROOT6) / 360.0, (-2.0 - 3.0 * ROOT6) / 225.0],
        [(16.0 - ROOT6) / 36.0, (16.0 + ROOT6) / 36.0, 1.0 / 9.0],
    ]
)
SQUARE_TABLEAU = exact_product(TABLEAU, TABLEAU)  # A²: overlaps of the stages from their accelerations
INVERSE = exact_inverse(TABLEAU)  # A^-1: rates of the stages from their overlaps
# A^-2, the matrix Q of docs/rows.md
SQUARE_INVERSE = exact_product(INVERSE, INVERSE)
GAMMA = 1.0 / 3.637834252744496  # 1 / real eigenvalue of A^-1, which is 3 + 9**(1/3) - 3**(1/3)
# Weights of the embedded error of order h**4 (Hairer & Wanner, IV.8)
EMBEDDED = GAMMA / 3.0 * np.array([-13.0 - 7.0 * ROOT6, -13.0 + 7.0 * ROOT6, -1.0])
# Weights of the quadrature through the last two nodes
_COARSE = np.array([0.0, 0.5 / (1.0 - NODES[1]), (0.5 - NODES[1]) / (1.0 - NODES[1])])
# Weights of its error, which is one order lower than the embedded error
COARSE = exact_product(TABLEAU[2] - _COARSE, INVERSE)
SHORT_EXPONENT = 1.0 / 32.0  # Largest argument for which the short series of exp and log are accurate to the last digit


@inlined
def log_grown(x):
    """Return ln(1 + x), where 1 + x counts as at least ROUND_OFF. For small x a short series is accurate enough for a
    guess.

    The short series is fast, and most contacts hardly change in most steps.
    """
    if abs(x) < SHORT_EXPONENT:
        return x * (1.0 - x * (1.0 / 2.0 - x * (1.0 / 3.0 - x * (1.0 / 4.0))))
    return log(max(1.0 + x, ROUND_OFF))


@inlined
def exp_near(x):
    """Return e**x. For small x a short series gives all digits."""
    if abs(x) < SHORT_EXPONENT:
        fourth = x * (1.0 / 24.0 + x * (1.0 / 120.0 + x * (1.0 / 720.0 + x * (1.0 / 5040.0))))
        return 1.0 + x * (1.0 + x * (1.0 / 2.0 + x * (1.0 / 6.0 + fourth)))
    return exp(x)


@inlined
def first_guess(h, chain, motion, trial):
    """Put initial guesses of the stages into `trial`.

    Soft contacts continue as a power of the time since an onset, d (1 + t/T)**(w T/d); the others keep their rate.
    Extrapolating the previous step instead would save only 3 % of the iterations.
    """
    law, graph, inverse_mass = chain.law, chain.graph, chain.inverse_mass
    overlap, rate, force, mode = motion.overlap, motion.rate, motion.force, motion.mode
    stage_overlap, stage_force = trial.overlap, trial.force
    since = time_since_onset(law, mode, overlap, rate, force)
    # First sweep: guesses from the motion of each contact itself.
    for i in range(overlap.size):
        preload, exponent, times, power, most, own = law[i, 0], law[i, 2], 0.0, 1.0, 0.0, False
        grows = mode[i] == LOADED and exponent < 1.0 and force[i] > preload
        # A soft contact that opens soon keeps its rate until d = 0, because its force has too little time to change it.
        # Any other soft contact varies with the time since the onset of the strongest contact.
        if grows and overlap[i] > SMALLEST:
            weight = inverse_mass[i] + inverse_mass[i + 1]
            stiff = weight * exponent * (force[i] - preload)  # local frequency squared times d
            own = rate[i] < 0.0 and overlap[i] * stiff < 4.0 * rate[i] * rate[i]
            time = overlap[i] / rate[i] if own else since
            times, power, most = h / time, 1.0 if own else rate[i] * time / overlap[i], MOST_GUESSED / exponent
        for k in range(3):
            flown = overlap[i] + h * NODES[k] * rate[i]
            # An open contact moves freely, a held one does not move.
            if mode[i] == OPEN:
                stage_overlap[k, i], stage_force[k, i] = flown, 0.0
            elif mode[i] == TOUCHING or mode[i] == FROZEN:
                stage_overlap[k, i], stage_force[k, i] = overlap[i], force[i]
            # A soft contact that will have opened before the node carries no force there.
            elif grows and own and flown <= 0.0 and preload == 0.0:
                stage_overlap[k, i], stage_force[k, i] = flown, 0.0
            # A soft contact: the power law in time. Its force grows with the power `exponent` of the overlap.
            elif grows and overlap[i] > SMALLEST:
                growth = min(max(power * log_grown(NODES[k] * times), -most), most)
                stage_overlap[k, i] = overlap[i] * exp_near(growth)
                stage_force[k, i] = preload + (force[i] - preload) * exp_near(exponent * growth)
                if has_table(graph, i):  # the guess above is that of a power law
                    stage_force[k, i] = curve_force(law, graph, i, stage_overlap[k, i])
            elif grows:
                stage_overlap[k, i], stage_force[k, i] = overlap[i], force[i]
            # A contact at d = 0 with zero rate: it starts to move if its left neighbour pushes.
            elif overlap[i] == 0.0 and rate[i] == 0.0:
                stage_overlap[k, i], stage_force[k, i] = 0.0, curve_force(law, graph, i, 0.0)
                if i > 0 and preload == 0.0:
                    set_pushed(h, chain, i, k, i, stage_force[k, i - 1], stage_overlap, stage_force)
            # Any other contact keeps its rate.
            else:
                stage_overlap[k, i] = flown
                stage_force[k, i] = curve_force(law, graph, i, flown)
    # Second sweep, from right to left: contacts at rest that a right neighbour or an external force pushes.
    for i in range(overlap.size - 2, -1, -1):
        for k in range(3):
            if mode[i] == LOADED and overlap[i] == 0.0 and rate[i] == 0.0 and stage_force[k, i] == 0.0:
                set_pushed(h, chain, i, k, i + 1, stage_force[k, i + 1], stage_overlap, stage_force)
                drive = drive_at(chain, i, h * NODES[k])
                # force that gives the two beads this relative acceleration: reduced mass times acceleration
                if law[i, 0] == 0.0:
                    push = drive / (inverse_mass[i] + inverse_mass[i + 1])
                    set_pushed(h, chain, i, k, i + 1, push, stage_overlap, stage_force)


@inlined
def time_since_onset(law, mode, overlap, rate, force):
    """Return the time [s] since the overlap of the strongest soft contact was zero, assuming a constant rate; negative
    before its opening.
    """
    largest, since = 0.0, 1e30
    # The strongest soft contact determines the time scale on which all forces grow.
    for i in range(overlap.size):
        if mode[i] == LOADED and law[i, 2] < 1.0 and overlap[i] > 0.0 and force[i] > largest and rate[i] != 0.0:
            largest, since = force[i], overlap[i] / rate[i]
    return since


@inlined
def set_pushed(h, chain, i, k, bead, push, stage_overlap, stage_force):
    """Put the guess for contact i at rest whose neighbour pushes `bead`: the overlap after free motion of the bead
    under the push.

    The contact passes on at most 80 % of the push.
    """
    if push <= 0.0:
        return
    # Free motion of the bead under the push would give this overlap; the force cannot exceed the push.
    time = h * NODES[k]
    flown = 0.5 * (time * time) * chain.inverse_mass[bead] * push
    stage_force[k, i] = min(0.8 * push, pressed_force(chain.law, chain.graph, i, flown))
    stage_overlap[k, i] = curve_overlap(chain.law, chain.graph, i, stage_force[k, i], 1.0)


@inlined
def direction(i, chain, mode, weight, overlap, force):
    """Return the direction (dd, df) of the curve of a contact, per unit of the variable z = d + `weight` f.

    In z the curve is never steep: dd/dz = 1 / (1 + weight s) and df/dz = s / (1 + weight s) with the slope s of the law
    (docs/rows.md).
    """
    if mode in (OPEN, FROZEN):
        return 1.0, 0.0
    # The graph of a touching contact is vertical: only its force changes.
    slope = curve_slope(chain.law, chain.graph, i, overlap, force) if mode == LOADED else math.inf
    if slope > HUGE:
        return 0.0, 1.0 / weight
    along = 1.0 / (1.0 + weight * slope)
    return along, slope * along


@inlined
def directions(h, first, last, chain, mode, trial, scratch):
    """Compute the directions of contacts [first, last) at every stage."""
    for i in range(first, last):
        weight = h * h * (chain.inverse_mass[i] + chain.inverse_mass[i + 1])
        for k in range(3):
            scratch.along[k, i], scratch.across[k, i] = direction(
                i, chain, mode[i], weight, trial.overlap[k, i], trial.force[k, i]
            )


@inlined
def move_stage(k, i, weight, change, chain, mode, trial, scratch):
    """Move contact i at stage k along its curve by a Newton change of z.

    Returns four numbers: the changes |dd| and |df| (or the wanted changes, if these are larger), and the differences of
    both from the wanted changes, beyond round-off.
    """
    d, f = trial.overlap[k, i], trial.force[k, i]
    by_overlap, by_force = scratch.along[k, i] * change, scratch.across[k, i] * change
    # On a curve the Newton step is corrected so that it stays on the curve; see `move_along`.
    if mode[i] == LOADED:
        end, pushes = move_along(chain.law, chain.graph, i, weight, d, f, by_overlap, by_force)
        trial.overlap[k, i], trial.force[k, i] = end, pushes
        dd, df = end - d, pushes - f
        missed_d = max(abs(dd - by_overlap) - ROUND_OFF * abs(end), 0.0)
        missed_f = max(abs(df - by_force) - ROUND_OFF * abs(pushes), 0.0)
        return max(abs(dd), abs(by_overlap)), max(abs(df), abs(by_force)), missed_d, missed_f
    if mode[i] == OPEN or mode[i] == FROZEN:
        trial.overlap[k, i] += by_overlap
    else:
        trial.force[k, i] += by_force
    return abs(by_overlap), abs(by_force), 0.0, 0.0


@inlined
def eliminate(h, first, last, chain, motion, trial, scratch):
    """Compute the Newton corrections z (3, n) of all stages of contacts [first, last) by block elimination (Thomas
    algorithm).

    Equation (k, i) is sum_j (A^-2)_kj (d_j - b_j) + h² (L f_k - e) = 0 with b_j = d0 + h c_j w0 and external
    acceleration e. The inverse diagonal blocks M = D'^-1 are kept in `scratch.block` (n, 9).
    """
    inverse_mass, overlap, rate = chain.inverse_mass, motion.overlap, motion.rate
    stage_overlap, stage_force, mode = trial.overlap, trial.force, motion.mode
    along, across, block, z = scratch.along, scratch.across, scratch.block, scratch.correction
    square, hangs = h * h, chain.strings.rest.size > 0
    # Forward sweep over the contacts.
    for i in range(first, last):
        left, right = square * inverse_mass[i], square * inverse_mass[i + 1]
        # Right-hand side: minus the residuals of the three stage equations of contact i.
        e0 = stage_overlap[0, i] - overlap[i] - h * NODES[0] * rate[i]
        e1 = stage_overlap[1, i] - overlap[i] - h * NODES[1] * rate[i]
        e2 = stage_overlap[2, i] - overlap[i] - h * NODES[2] * rate[i]
        for k in range(3):
            flow = square * flow_into(i, inverse_mass, stage_force[k])
            flow -= square * drive_at(chain, i, h * NODES[k])
            if hangs:
                flow -= square * string_pull(chain, i, stage_overlap[k, i])
            z[k, i] = -(SQUARE_INVERSE[k, 0] * e0 + SQUARE_INVERSE[k, 1] * e1 + SQUARE_INVERSE[k, 2] * e2 + flow)
        # Diagonal block: A^-2 couples the stages of one contact through its overlaps, and h² L_ii acts on the force of
        # each stage.
        m00 = SQUARE_INVERSE[0, 0] * along[0, i] + (left + right) * across[0, i]
        m11 = SQUARE_INVERSE[1, 1] * along[1, i] + (left + right) * across[1, i]
        m22 = SQUARE_INVERSE[2, 2] * along[2, i] + (left + right) * across[2, i]
        if hangs:  # the pull of the strings changes with the overlap of the same stage
            m00 += square * chain.strings.square * along[0, i]
            m11 += square * chain.strings.square * along[1, i]
            m22 += square * chain.strings.square * along[2, i]
        m01, m02 = SQUARE_INVERSE[0, 1] * along[1, i], SQUARE_INVERSE[0, 2] * along[2, i]
        m10, m12 = SQUARE_INVERSE[1, 0] * along[0, i], SQUARE_INVERSE[1, 2] * along[2, i]
        m20, m21 = SQUARE_INVERSE[2, 0] * along[0, i], SQUARE_INVERSE[2, 1] * along[1, i]
        # Eliminate the left neighbour. The coupling h²/m acts on forces of the same stage only, so the coupling blocks
        # are diagonal. A wall (left = 0) separates the chain.
        if i > first and left != 0.0:
            b0, b1, b2 = left * across[0, i - 1], left * across[1, i - 1], left * across[2, i - 1]
            c0, c1, c2 = left * across[0, i], left * across[1, i], left * across[2, i]
            m = block[i - 1]
            m00 -= b0 * m[0] * c0
            m01 -= b0 * m[1] * c1
            m02 -= b0 * m[2] * c2
            m10 -= b1 * m[3] * c0
            m11 -= b1 * m[4] * c1
            m12 -= b1 * m[5] * c2
            m20 -= b2 * m[6] * c0
            m21 -= b2 * m[7] * c1
            m22 -= b2 * m[8] * c2
            z[0, i] += b0 * z[0, i - 1]
            z[1, i] += b1 * z[1, i - 1]
            z[2, i] += b2 * z[2, i - 1]
        # Invert the block by its adjugate.
        i00, i01, i02 = m11 * m22 - m12 * m21, m02 * m21 - m01 * m22, m01 * m12 - m02 * m11
        i10, i11, i12 = m12 * m20 - m10 * m22, m00 * m22 - m02 * m20, m02 * m10 - m00 * m12
        i20, i21, i22 = m10 * m21 - m11 * m20, m01 * m20 - m00 * m21, m00 * m11 - m01 * m10
        free = mode[i] == TOUCHING and m00 <= ROUND_OFF * (left + right) * across[0, i]
        # A force from wall to wall through touching contacts does not move anything, so it is not determined. Leave it
        # unchanged.
        scale = 0.0 if free else 1.0 / (m00 * i00 + m01 * i10 + m02 * i20)
        m = block[i]
        m[0], m[1], m[2] = i00 * scale, i01 * scale, i02 * scale
        m[3], m[4], m[5] = i10 * scale, i11 * scale, i12 * scale
        m[6], m[7], m[8] = i20 * scale, i21 * scale, i22 * scale
        # Reduced right-hand side.
        r = (z[0, i], z[1, i], z[2, i])
        z[0, i] = m[0] * r[0] + m[1] * r[1] + m[2] * r[2]
        z[1, i] = m[3] * r[0] + m[4] * r[1] + m[5] * r[2]
        z[2, i] = m[6] * r[0] + m[7] * r[1] + m[8] * r[2]
    # Backward sweep: substitute the correction of the right neighbour.
    for i in range(last - 2, first - 1, -1):
        right = square * inverse_mass[i + 1]
        m = block[i]
        r0, r1, r2 = across[0, i + 1] * z[0, i + 1], across[1, i + 1] * z[1, i + 1], across[2, i + 1] * z[2, i + 1]
        z[0, i] += right * (m[0] * r0 + m[1] * r1 + m[2] * r2)
        z[1, i] += right * (m[3] * r0 + m[4] * r1 + m[5] * r2)
        z[2, i] += right * (m[6] * r0 + m[7] * r1 + m[8] * r2)


@inlined
def solve_stages(h, chain, motion, precision, trial, scratch):
    """Solve the stage equations by Newton's iteration, starting from the guess in `trial`. `precision` [m/s] is the
    wanted accuracy.

    A correction is measured as a velocity: by the force change, h L df, and by its energy, sqrt(L dd df). If a move
    along the curve is shorter than the wanted correction, the wanted one counts. The part that the last move missed may
    not exceed the precision. After the first iteration, only contacts whose corrections are significant are solved
    again, with their neighbours; all are solved again if a significant correction reaches the edge of this range.
    Returns the number of iterations, 0 if they did not converge.
    """
    law, inverse_mass, force, mode = chain.law, chain.inverse_mass, motion.force, motion.mode
    n = mode.size
    before, strongest, first, last = math.inf, 0.0, ZERO, n
    # Reference force of the convergence test: the largest force in the step so far.
    for i in range(n):
        strongest = max(strongest, abs(force[i]))
    for iteration in range(MOST_TRIES):
        # One iteration on the contacts [first, last).
        directions(h, first, last, chain, mode, trial, scratch)
        eliminate(h, first, last, chain, motion, trial, scratch)
        size, missed, settled, low, high = 0.0, 0.0, True, n, ZERO
        # Move each contact along its curve, and measure the corrections.
        for i in range(first, last):
            # Forces of soft contacts without preload differ by many orders of magnitude, so each has its own reference.
            # A touching contact may have an undetermined force.
            deep = law[i, 0] == 0.0 and law[i, 2] < 1.0
            own, changed, largest = 0.0, 0.0, max(abs(force[i]), FORCE_PRECISION * strongest) if deep else strongest
            weight = inverse_mass[i] + inverse_mass[i + 1]
            for k in range(3):
                # The iteration has diverged: the caller starts again from implicit Euler steps.
                if not math.isfinite(scratch.correction[k, i]):
                    return 0
                by_overlap, by_force, missed_d, missed_f = move_stage(
                    k, i, h * h * weight, scratch.correction[k, i], chain, mode, trial, scratch
                )
                if not abs(trial.overlap[k, i]) < HUGE:
                    return 0
                own = max(own, h * weight * by_force, math.sqrt(weight * (by_overlap * by_force)))
                missed = max(missed, h * weight * missed_f, math.sqrt(weight * (missed_d * missed_f)))
                changed, largest = max(changed, by_force), max(largest, abs(trial.force[k, i]))
            size, strongest = max(size, own), max(strongest, largest)
            # `settled`: all forces have converged. Contacts whose correction is not negligible form the next range.
            rests = changed <= FORCE_PRECISION * largest
            settled &= rests
            if own > NEWTON_PART * precision or not rests:
                low, high = min(low, i), i + 1
        # Converged if the corrections are below the precision, or shrink so quadratically that the next ones would be.
        shrinks = iteration > 0 and size <= 1e-2 * before and size * size <= precision * before
        if settled and (size <= precision or (shrinks and missed <= precision)):
            return iteration + 1
        before = size
        # Restrict the next iteration to the changing contacts, unless the change reached the edge of the range.
        at_edge = (low == first and first > 0) or (high == last and last < n)
        first, last = (ZERO, n) if at_edge else (max(low - MARGIN, 0), min(high + MARGIN, n))
    return 0


@inlined
def euler_change(k, time, chain, motion, trial, scratch):
    """Compute the Newton change of stage k as an implicit Euler step of length `time`.

    Its equation, d - d0 - t w0 + t² (L f - e) = 0, is tridiagonal and solved by the Thomas algorithm.
    """
    inverse_mass, along, across, z = chain.inverse_mass, scratch.along[k], scratch.across[k], scratch.correction[k]
    n, square, upper = motion.mode.size, time * time, scratch.block
    # Directions of the curves, as for the three-stage step.
    for i in range(n):
        weight = square * (inverse_mass[i] + inverse_mass[i + 1])
        along[i], across[i] = direction(i, chain, motion.mode[i], weight, trial.overlap[k, i], trial.force[k, i])
    for i in range(n):
        left, right = square * inverse_mass[i], square * inverse_mass[i + 1]
        # Residual, and elimination of the left neighbour.
        pushed = square * acceleration_of(i, chain, trial.overlap[k, i], trial.force[k], time)
        z[i] = motion.overlap[i] + time * motion.rate[i] - trial.overlap[k, i] + pushed
        pivot = along[i] + (left + right) * across[i]
        if chain.strings.rest.size:
            pivot += square * chain.strings.square * along[i]
        if i > 0:
            pivot -= left * across[i - 1] * upper[i - 1, 0]
            z[i] += left * across[i - 1] * z[i - 1]
        free = pivot <= ROUND_OFF * (left + right) * across[i]  # a force from wall to wall is not determined
        z[i] = 0.0 if free else z[i] / pivot
        upper[i, 0] = 0.0 if free or i == n - 1 else right * across[i + 1] / pivot
    # Backward sweep.
    for i in range(n - 2, -1, -1):
        z[i] += upper[i, 0] * z[i + 1]


@piece
def euler_stages(h, chain, motion, trial, scratch):
    """Put initial guesses into `trial` by an implicit Euler step to each node. Its equation is monotone, so it has one
    solution for every law.

    Collocation with three stages is not monotone if the slopes at the stages differ much, and Newton's iteration can
    diverge. Starting from the Euler solutions it converges.
    """
    for k in range(3):
        time = h * NODES[k]
        # Start from the present state.
        for i in range(motion.mode.size):
            trial.overlap[k, i], trial.force[k, i] = motion.overlap[i], motion.force[i]
        # Newton's iteration for one node, until all forces have converged.
        for _ in range(MOST_TRIES * MOST_TRIES):
            euler_change(k, time, chain, motion, trial, scratch)
            changed, largest = 0.0, 0.0
            for i in range(motion.mode.size):
                weight = time * time * (chain.inverse_mass[i] + chain.inverse_mass[i + 1])
                if not math.isfinite(scratch.correction[k, i]):
                    return
                _, by_force, _, _ = move_stage(
                    k, i, weight, scratch.correction[k, i], chain, motion.mode, trial, scratch
                )
                changed, largest = max(changed, by_force), max(largest, abs(trial.force[k, i]))
            if changed <= FORCE_PRECISION * largest:
                break


@inlined
def stage_rates(h, chain, motion, trial):
    """Compute the rates of all stages, by w0 - h sum_j A_kj (L f_j - e) or by (1/h) sum_j (A^-1)_kj (d_j - d0),
    whichever is more accurate.

    An error of d becomes an error d / h in the second formula, and h weight slope d in the first. So the second formula
    is more accurate for contacts that oscillate within the step, deep inside a cluster. These are the contacts whose
    overlaps are smaller than the displacements by their forces above the preload.
    """
    law, inverse_mass = chain.law, chain.inverse_mass
    overlap, rate, mode = motion.overlap, motion.rate, motion.mode
    stage_overlap, stage_force, stage_rate = trial.overlap, trial.force, trial.rate
    for i in range(overlap.size):
        # Accelerations at the stages (first formula), and displacements `moved` (second formula).
        a0 = acceleration_of(i, chain, stage_overlap[0, i], stage_force[0], h * NODES[0])
        a1 = acceleration_of(i, chain, stage_overlap[1, i], stage_force[1], h * NODES[1])
        a2 = acceleration_of(i, chain, stage_overlap[2, i], stage_force[2], h * NODES[2])
        moved = (stage_overlap[0, i] - overlap[i], stage_overlap[1, i] - overlap[i], stage_overlap[2, i] - overlap[i])
        # Compare the overlap with the displacement h² L_ii (f - F), as explained above.
        largest = max(abs(overlap[i]), abs(stage_overlap[0, i]), abs(stage_overlap[1, i]), abs(stage_overlap[2, i]))
        pushed = h * h * (inverse_mass[i] + inverse_mass[i + 1])
        f0, f1, f2 = stage_force[0, i] - law[i, 0], stage_force[1, i] - law[i, 0], stage_force[2, i] - law[i, 0]
        fine = mode[i] == TOUCHING or largest < pushed * max(abs(f0), abs(f1), abs(f2))
        for k in range(3):
            if fine:
                stage_rate[k, i] = (INVERSE[k, 0] * moved[0] + INVERSE[k, 1] * moved[1] + INVERSE[k, 2] * moved[2]) / h
            else:
                stage_rate[k, i] = rate[i] + h * (TABLEAU[k, 0] * a0 + TABLEAU[k, 1] * a1 + TABLEAU[k, 2] * a2)


@inlined
def hung_anchor(h, chain, anchor, trial):
    """Return the accelerations [m/s²] of the anchor bead by its string at the three stages.

    Its displacements y from rest solve y + (h omega)² A² y = y0 + h c v0 + h² A² a, three linear equations.
    """
    n, square = trial.force.shape[1], h * h * chain.strings.square
    a0 = anchor_acceleration(chain, trial.force[0], h * NODES[0])
    a1 = anchor_acceleration(chain, trial.force[1], h * NODES[1])
    a2 = anchor_acceleration(chain, trial.force[2], h * NODES[2])
    y0 = anchor[0] - chain.strings.rest[n]
    # right-hand sides and matrix, with A² in `SQUARE_TABLEAU`
    t = SQUARE_TABLEAU
    r0 = y0 + h * NODES[0] * anchor[1] + h * h * (t[0, 0] * a0 + t[0, 1] * a1 + t[0, 2] * a2)
    r1 = y0 + h * NODES[1] * anchor[1] + h * h * (t[1, 0] * a0 + t[1, 1] * a1 + t[1, 2] * a2)
    r2 = y0 + h * NODES[2] * anchor[1] + h * h * (t[2, 0] * a0 + t[2, 1] * a1 + t[2, 2] * a2)
    m00, m01, m02 = 1.0 + square * t[0, 0], square * t[0, 1], square * t[0, 2]
    m10, m11, m12 = square * t[1, 0], 1.0 + square * t[1, 1], square * t[1, 2]
    m20, m21, m22 = square * t[2, 0], square * t[2, 1], 1.0 + square * t[2, 2]
    # Cramer's rule
    c0, c1, c2 = m11 * m22 - m12 * m21, m12 * m20 - m10 * m22, m10 * m21 - m11 * m20
    scale = -chain.strings.square / (m00 * c0 + m01 * c1 + m02 * c2)
    d0, d1, d2 = m02 * m21 - m01 * m22, m00 * m22 - m02 * m20, m01 * m20 - m00 * m21
    e0, e1, e2 = m01 * m12 - m02 * m11, m02 * m10 - m00 * m12, m00 * m11 - m01 * m10
    return (
        scale * (c0 * r0 + d0 * r1 + e0 * r2),
        scale * (c1 * r0 + d1 * r1 + e1 * r2),
        scale * (c2 * r0 + d2 * r1 + e2 * r2),
    )


@inlined
def move_anchor(h, chain, anchor, trial):
    """Compute position and velocity of the anchor bead at the end of the step."""
    end_anchor = trial.anchor
    end_anchor[0], end_anchor[1] = anchor[0] + h * anchor[1], anchor[1]
    pulls = hung_anchor(h, chain, anchor, trial) if chain.strings.rest.size else (0.0, 0.0, 0.0)
    for j in range(3):
        # The same quadrature as for the overlaps: row 3 of A² for the position, of A for the velocity.
        acceleration = anchor_acceleration(chain, trial.force[j], h * NODES[j])
        if chain.strings.rest.size:
            acceleration += pulls[j]
        square = TABLEAU[2, 0] * TABLEAU[0, j] + TABLEAU[2, 1] * TABLEAU[1, j] + TABLEAU[2, 2] * TABLEAU[2, j]
        end_anchor[0] += h * h * square * acceleration
        end_anchor[1] += h * TABLEAU[2, j] * acceleration


@inlined
def radau_step(h, chain, motion, precision, trial, scratch):
    """Take one step into `trial`. Return the iterations of the solution (0 if the stages did not converge) and of all
    attempts.
    """
    first_guess(h, chain, motion, trial)
    used = solve_stages(h, chain, motion, precision, trial, scratch)
    tried = used
    # The fast guess failed: start again from implicit Euler steps.
    if used == 0:
        euler_stages(h, chain, motion, trial, scratch)
        used = solve_stages(h, chain, motion, precision, trial, scratch)
        tried = MOST_TRIES + (used if used > 0 else MOST_TRIES)
    if used > 0:
        stage_rates(h, chain, motion, trial)
        move_anchor(h, chain, motion.anchor, trial)
    return used, tried


@inlined
def compliance(chain, mode, i, overlap, force):
    """Return dd/df of contact i: 0 if it touches, -1 if it carries no force (a placeholder for an infinite value)."""
    if mode[i] == OPEN or mode[i] == FROZEN:
        return -1.0
    if mode[i] == TOUCHING:
        return 0.0
    slope = curve_slope(chain.law, chain.graph, i, overlap, force)
    return 1.0 / slope if slope > 0.0 else -1.0


@inlined
def embedded_error(h, chain, motion, trial, work):
    """Return the error of the step as a velocity [m/s] from two embedded quadratures, of orders h**4 and h**3. `work`
    (WORK_ROWS, n+1) is scratch memory.

    Both are filtered through (I - h gamma J)^-1, so that stiff contacts do not make the estimate too large (Hairer &
    Wanner, IV.8). With the compliance C = dd/df and the force error phi: (C + (h gamma)² L) phi = e_d + h gamma e_w.
    The errors are then e_w - h gamma L phi in the rate, and C phi in the overlap, which counts by its energy as sqrt(L
    C) phi. The error of each contact is corrected by its own ratio of the two estimates.
    """
    law, inverse_mass = chain.law, chain.inverse_mass
    overlap, rate, force, mode = motion.overlap, motion.rate, motion.force, motion.mode
    stage_overlap, stage_rate, stage_force = trial.overlap, trial.rate, trial.force
    n = overlap.size
    fine, coarse, upper, gives = work[FINE_ERROR, :n], work[COARSE_ERROR, :n], work[UPPER, :n], work[COMPLIANCE, :n]
    slowest = math.inf
    # h gamma, the length in the filter (I - h gamma J)^-1.
    reach = h * GAMMA
    # These rows are free now: the end of the step is the third row.
    fine_rate, coarse_rate = stage_rate[0], stage_rate[1]
    for i in range(n):
        # Unfiltered errors e_w and e_d of contact i, from the differences of the stages to the start.
        fine_w = reach * acceleration_of(i, chain, overlap[i], force, 0.0)
        fine_d = reach * rate[i]
        coarse_w, coarse_d = 0.0, 0.0
        for k in range(3):
            by_rate, by_overlap = stage_rate[k, i] - rate[i], stage_overlap[k, i] - overlap[i]
            fine_w += EMBEDDED[k] * by_rate
            fine_d += EMBEDDED[k] * by_overlap
            coarse_w += COARSE[k] * by_rate
            coarse_d += COARSE[k] * by_overlap
        fine_rate[i], coarse_rate[i] = fine_w, coarse_w
        give = compliance(chain, mode, i, stage_overlap[2, i], stage_force[2, i])
        gives[i], upper[i], fine[i], coarse[i] = give, 0.0, 0.0, 0.0
        # `slowest` is the lowest local frequency squared, which weights the errors of faster contacts (see `care`).
        if give > 0.0:
            slowest = min(slowest, (inverse_mass[i] + inverse_mass[i + 1]) / give)
        # Tridiagonal system for the force errors of both estimates: forward sweep. Contacts without force are left out.
        if give >= 0.0:
            lower = -reach * reach * inverse_mass[i] if i > 0 else 0.0
            pivot = reach * reach * (inverse_mass[i] + inverse_mass[i + 1]) + give
            fine[i], coarse[i] = fine_d + reach * fine_w, coarse_d + reach * coarse_w
            if i > 0:
                pivot -= lower * upper[i - 1]
                fine[i] -= lower * fine[i - 1]
                coarse[i] -= lower * coarse[i - 1]
            if pivot > ROUND_OFF * reach * reach * (inverse_mass[i] + inverse_mass[i + 1]):
                part = 1.0 / pivot
                fine[i] *= part
                coarse[i] *= part
                upper[i] = -reach * reach * inverse_mass[i + 1] * part
            else:  # A force from wall to wall through all beads does not move anything, so its error is not determined.
                fine[i], coarse[i] = 0.0, 0.0
    # Backward sweep.
    for i in range(n - 2, -1, -1):
        fine[i] -= upper[i] * fine[i + 1]
        coarse[i] -= upper[i] * coarse[i + 1]
    worst = 0.0
    # Error of each contact: of its rate, of its overlap by energy, of a kink of its law within the step. The largest
    # one counts.
    for i in range(n):
        by_fine = abs(fine_rate[i] - reach * flow_into(i, inverse_mass, fine))
        by_coarse = abs(coarse_rate[i] - reach * flow_into(i, inverse_mass, coarse))
        times = 1.0
        if mode[i] == LOADED:
            push = breakpoint_force(chain.graph, i, overlap[i], stage_overlap[2, i])
            worst = larger(worst, KINK * h * (inverse_mass[i] + inverse_mass[i + 1]) * push)
        if gives[i] > 0.0:
            weight = inverse_mass[i] + inverse_mass[i + 1]
            by_fine = larger(by_fine, math.sqrt(weight * gives[i]) * abs(fine[i]))
            by_coarse = larger(by_coarse, math.sqrt(weight * gives[i]) * abs(coarse[i]))
            times = care(law[i, 2], h * h * weight / gives[i], weight / gives[i] / slowest)
        worst = larger(worst, times * by_fine * min(1.0, RATIO * by_fine / max(by_coarse, 1e-300)))
    return worst
