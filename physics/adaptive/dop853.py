"""One step of DOP853, the explicit method of order 8 by Dormand and Prince, in overlap coordinates. For contacts that
are not stiff.

    d_s = d0 + c_s h w0 + h² sum_k (A²)_sk a_k,   a_k = e - L f(d_k),   s = 1..12

For y'' = f(y) the stages of the rates drop out. A and b are the coefficients of the method (Hairer, Norsett & Wanner,
Solving ODEs I, 2nd ed., II.10). Forces of touching contacts are multipliers: at every stage they solve (L f)_i = e_i,
one tridiagonal system.

Only ranges of active contacts are integrated. Between them no contact pushes enough to matter, and overlaps change at
constant rates.
"""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.adaptive.constants import BEGINS, ENDS, GRAZE, KINK, MARGIN, ROUND_OFF
from softcradle.physics.adaptive.corner_search import halves, hermite_quintic
from softcradle.physics.adaptive.step_records import (
    CONTACT_ERROR,
    FIFTH_OVERLAP,
    FIFTH_RATE,
    SQUARE_FREQUENCY,
    STAGES,
    THIRD_OVERLAP,
    THIRD_RATE,
)
from softcradle.physics.numerics.exact_matrices import exact_product
from softcradle.physics.numerics.graph_kernels import has_segments
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.knots import drive_at
from softcradle.physics.numerics.law_curve import NODES as OUTPUT_NODES
from softcradle.physics.numerics.law_curve import (
    anchor_acceleration,
    care,
    curve_force,
    curve_slope,
    is_smooth,
    larger,
    pressed_force,
)
from softcradle.physics.numerics.records import FROZEN, LOADED, OPEN, TOUCHING, ZERO
from softcradle.physics.numerics.swing import string_pull
from softcradle.physics.numerics.table_kernels import breakpoint_force

# fmt: off
NODES = np.array([
    0.0, 0.05260015195876773, 0.0789002279381516, 0.1183503419072274, 0.2816496580927726, 0.3333333333333333, 0.25,
    0.3076923076923077, 0.6512820512820513, 0.6, 0.8571428571428571, 1.0,
])
# Nodes c, matrix A and weights b of the method
_TABLEAU = np.zeros((STAGES, STAGES))
_TABLEAU[1, [0]] = [0.05260015195876773]
_TABLEAU[2, [0, 1]] = [0.0197250569845379, 0.0591751709536137]
_TABLEAU[3, [0, 2]] = [0.02958758547680685, 0.08876275643042054]
_TABLEAU[4, [0, 2, 3]] = [0.2413651341592667, -0.8845494793282861, 0.924834003261792]
_TABLEAU[5, [0, 3, 4]] = [0.037037037037037035, 0.17082860872947386, 0.12546768756682242]
_TABLEAU[6, [0, 3, 4, 5]] = [0.037109375, 0.17025221101954405, 0.06021653898045596, -0.017578125]
_TABLEAU[7, [0, 3, 4, 5, 6]] = [
    0.03709200011850479, 0.17038392571223998, 0.10726203044637328, -0.015319437748624402, 0.008273789163814023,
]
_TABLEAU[8, [0, 3, 4, 5, 6, 7]] = [
    0.6241109587160757, -3.3608926294469414, -0.868219346841726, 27.59209969944671, 20.154067550477894,
    -43.48988418106996,
]
_TABLEAU[9, [0, 3, 4, 5, 6, 7, 8]] = [
    0.47766253643826434, -2.4881146199716677, -0.590290826836843, 21.230051448181193, 15.279233632882423,
    -33.28821096898486, -0.020331201708508627,
]
_TABLEAU[10, [0, 3, 4, 5, 6, 7, 8, 9]] = [
    -0.9371424300859873, 5.186372428844064, 1.0914373489967295, -8.149787010746927, -18.52006565999696,
    22.739487099350505, 2.4936055526796523, -3.0467644718982196,
]
_TABLEAU[11, [0, 3, 4, 5, 6, 7, 8, 9, 10]] = [
    2.273310147516538, -10.53449546673725, -2.0008720582248625, -17.9589318631188, 27.94888452941996,
    -2.8589982771350235, -8.87285693353063, 12.360567175794303, 0.6433927460157636,
]
WEIGHTS = np.zeros(STAGES)
WEIGHTS[[0, 5, 6, 7, 8, 9, 10, 11]] = [
    0.054293734116568765, 4.450312892752409, 1.8915178993145003, -5.801203960010585, 0.3111643669578199,
    -0.1521609496625161, 0.20136540080403034, 0.04471061572777259,
]
THIRD = WEIGHTS.copy()  # Weights of the embedded error of order 3
THIRD[[0, 8, 11]] -= [0.2440944881889764, 0.7338466882816118, 0.022058823529411766]
FIFTH = np.zeros(STAGES)  # Weights of the embedded error of order 5
FIFTH[[0, 5, 6, 7, 8, 9, 10, 11]] = [
    0.01312004499419488, -1.2251564463762044, -0.4957589496572502, 1.6643771824549864, -0.35032884874997366,
    0.3341791187130175, 0.08192320648511571, -0.022355307863886294,
]
# fmt: on

SQUARE = exact_product(_TABLEAU, _TABLEAU)  # A²: overlaps of the stages from the accelerations
WEIGHTS_SQUARE = exact_product(WEIGHTS, _TABLEAU)  # b A: overlap at the end from the accelerations
# The same products for the errors of the overlap at the end
THIRD_SQUARE, FIFTH_SQUARE = exact_product(THIRD, _TABLEAU), exact_product(FIFTH, _TABLEAU)


@inlined
def is_active(i, h, inactive, chain, motion):
    """Return whether contact i takes part in the step.

    A contact is inactive if it closes no faster than `inactive` [m/s] and, now and at the end of a step at this rate,
    neither stores more energy nor changes velocities by more than that. A pushing contact with preload is active
    however short the step to its opening is; if it were left out, it would stand still. A touching contact is active
    because it passes on every push at once.
    """
    if motion.mode[i] == OPEN:
        return False
    law, rate = chain.law, motion.rate[i]
    # Touching contacts, and contacts with preload that push, see above.
    if motion.mode[i] == TOUCHING or law[i, 0] > 0.0:
        return True
    if has_segments(chain.graph, i) and (motion.overlap[i] < 0.0 or (motion.overlap[i] == 0.0 and rate < 0.0)):
        return True  # the contact pulls
    # Velocity changes and energies now, then with the overlap at the end of the step.
    weight, push = chain.inverse_mass[i] + chain.inverse_mass[i + 1], max(motion.force[i], 0.0)
    if rate > inactive or weight * push * h > inactive:
        return True
    reach = motion.overlap[i] + max(rate, 0.0) * h
    if reach <= 0.0:
        return False
    push = weight * max(push, curve_force(law, chain.graph, i, reach))
    return push * h > inactive or push * reach > inactive * inactive


@inlined
def next_range(after, h, inactive, chain, motion):
    """Return the next range [first, last) of active contacts from contact `after` on, with a margin; (n, n) if none is
    left.

    The margin ends at the first open contact, because an open contact passes nothing on.
    """
    n = motion.mode.size
    # External forces and strings move all beads.
    if chain.external.size or chain.strings.rest.size:
        return after, n
    # Find the first active contact.
    first = after
    while first < n and not is_active(first, h, inactive, chain, motion):
        first += 1
    if first == n:
        return n, n
    # Join active contacts that are closer than two margins.
    last = first + 1
    for i in range(first + 1, n):
        if i >= last + 2 * MARGIN:
            break
        if is_active(i, h, inactive, chain, motion):
            last = i + 1
    # Add a margin on both sides, up to the first open contact.
    start, end = max(first - MARGIN, after), min(last + MARGIN, n)
    while first > start and motion.mode[first] != OPEN:
        first -= 1
    while last < end and motion.mode[last - 1] != OPEN:
        last += 1
    return first, last


@inlined
def accelerate(first, last, passed, chain, mode, carried, overlap, force, acceleration, upper):
    """Compute forces (n,) and overlap accelerations (n,) in a range from the overlaps of a stage, `passed` [s] after
    now.

    A frozen contact keeps the force that it has `carried` (n,). The last contact in a series of touching contacts from
    wall to wall does the same, because a force through all of them does not move anything. Each array is an argument,
    because stages, output nodes and the end of a step use different ones.
    """
    law, inverse_mass = chain.law, chain.inverse_mass
    # Forces of contacts that follow their law.
    touching = False
    for i in range(first, last):
        force[i] = carried[i] if mode[i] == FROZEN else 0.0
        if mode[i] == LOADED and overlap[i] > 0.0 and not has_segments(chain.graph, i):
            force[i] = pressed_force(law, chain.graph, i, overlap[i])
        elif mode[i] == LOADED:
            force[i] = curve_force(law, chain.graph, i, overlap[i])
        touching |= mode[i] == TOUCHING
    # The contact at the edge of a range inside the chain is inactive, and the bead outside would not receive its force.
    if first > 0:
        force[first] = 0.0
    if last < mode.size:
        force[last - 1] = 0.0
    # Multipliers of touching contacts: their relative acceleration is 0, (L f)_i = e_i. Thomas algorithm over each
    # series of touching contacts, with the forces of the neighbours as loads.
    if touching:
        for i in range(first, last):
            upper[i] = 0.0
            if mode[i] == TOUCHING:
                # Forward sweep: a neighbour that follows its law is a load, a touching one is eliminated.
                pivot = inverse_mass[i] + inverse_mass[i + 1]
                load = drive_at(chain, i, passed)
                if chain.strings.rest.size:
                    load += string_pull(chain, i, overlap[i])
                if i > 0:
                    load += inverse_mass[i] * force[i - 1]
                    if mode[i - 1] == TOUCHING:
                        pivot -= inverse_mass[i] * upper[i - 1]
                if i < mode.size - 1:
                    if mode[i + 1] != TOUCHING:
                        load += inverse_mass[i + 1] * force[i + 1]
                    elif inverse_mass[i + 1] > 0.0:  # A wall takes every force; between two walls the pivot would be 0.
                        upper[i] = inverse_mass[i + 1] / pivot
                free = pivot <= ROUND_OFF * (inverse_mass[i] + inverse_mass[i + 1])
                force[i] = carried[i] if free else load / pivot
        # Backward sweep.
        for i in range(last - 2, first - 1, -1):
            if mode[i] == TOUCHING and mode[i + 1] == TOUCHING:
                force[i] += upper[i] * force[i + 1]
    # Accelerations of the overlaps. Those of touching contacts are exactly 0.
    left = ((force[first - 1] if first > 0 else 0.0) - force[first]) * inverse_mass[first]
    for i in range(first, last):  # From the accelerations of the two beads, w' = a_i - a_(i+1)
        right = (force[i] - (force[i + 1] if i + 1 < force.size else 0.0)) * inverse_mass[i + 1]
        acceleration[i] = left - right
        left = right
    if chain.external.size:
        for i in range(first, last):
            acceleration[i] += drive_at(chain, i, passed)
    if chain.strings.rest.size:
        for i in range(first, last):
            acceleration[i] += string_pull(chain, i, overlap[i])
    if touching:
        for i in range(first, last):
            if mode[i] == TOUCHING:
                acceleration[i] = 0.0


@inlined
def dop853_step(h, inactive, firm, chain, motion, trial, scratch):
    """Take one step into `trial`: overlaps, rates and forces at its end, and at the nodes of `radau` for the event
    search.

    `inactive` [m/s] is the largest velocity change of contacts outside the active ranges. `firm` is true if beads may
    stick. Returns the error as a velocity [m/s], of order 8: err5² / sqrt(err5² + 0.01 err3²).
    """
    overlap, rate, mode, end_anchor = motion.overlap, motion.rate, motion.mode, trial.anchor
    force, of_anchor = scratch.correction[1], scratch.anchor_acceleration
    n = overlap.size
    touching, worst = False, 0.0
    # Start with free motion of all contacts; active ranges are replaced below.
    for i in range(n):
        force[i] = 0.0
        way = h * rate[i]
        # a slow contact stays at d = 0, see `open_passed`
        if rate[i] <= inactive and is_smooth(chain.law, chain.graph, i):
            way = min(way, max(-overlap[i], 0.0))
        trial.overlap[2, i], trial.rate[2, i] = overlap[i] + way, rate[i]
        for k in range(2):
            trial.overlap[k, i] = overlap[i] + OUTPUT_NODES[k] * way
        touching |= mode[i] == TOUCHING
    # The anchor bead is accelerated by external forces; the range that contains it replaces these values.
    for s in range(STAGES):
        of_anchor[s] = anchor_acceleration(chain, force, h * NODES[s])
    last = ZERO
    # Integrate one active range after the other.
    while last < n:
        first, last = next_range(last, h, inactive, chain, motion)
        if first == n:
            break
        worst = larger(worst, step_of_range(h, first, last, chain, motion, trial, scratch))
    # The anchor bead, by the same weights as the overlaps.
    end_anchor[0], end_anchor[1] = motion.anchor[0] + h * motion.anchor[1], motion.anchor[1]
    for k in range(STAGES):
        end_anchor[0] += h * h * WEIGHTS_SQUARE[k] * of_anchor[k]
        end_anchor[1] += h * WEIGHTS[k] * of_anchor[k]
    # Forces at the end of the step.
    for i in range(n):
        trial.force[2, i] = force[i]
        if force[i] == 0.0 and mode[i] == LOADED and trial.overlap[2, i] > 0.0:  # an inactive contact
            trial.force[2, i] = curve_force(chain.law, chain.graph, i, trial.overlap[2, i])
        if mode[i] == FROZEN:
            trial.force[2, i] = motion.force[i]
    # Held contacts and sticking beads have guards through the forces at the nodes, so these are needed as well.
    if touching or firm:
        stage, upper = scratch.correction[0], scratch.correction[2]
        for k in range(2):
            passed = h * OUTPUT_NODES[k]
            accelerate(ZERO, n, passed, chain, mode, motion.force, trial.overlap[k], trial.force[k], stage, upper)
    return worst


@inlined
def step_of_range(h, first, last, chain, motion, trial, scratch):
    """Take the step of contacts [first, last). Their forces at the end stay in scratch memory. Return the error as
    `dop853_step`.
    """
    overlap, rate, mode = motion.overlap, motion.rate, motion.mode
    stage, force, upper = scratch.correction[0], scratch.correction[1], scratch.correction[2]
    acceleration, square, moves_anchor = scratch.acceleration, h * h, first <= chain.anchor_bead <= last
    # The twelve stages: overlaps by A², then forces and accelerations.
    for s in range(STAGES):
        for i in range(first, last):
            stage[i] = overlap[i] + NODES[s] * h * rate[i]
        for k in range(s):
            add_scaled(square * SQUARE[s, k], acceleration[k], first, last, stage)
        accelerate(first, last, h * NODES[s], chain, mode, motion.force, stage, force, acceleration[s], upper)
        if moves_anchor:
            scratch.anchor_acceleration[s] = anchor_acceleration(chain, force, h * NODES[s])
            if chain.strings.rest.size:  # the pull at the position of the stage
                place = motion.anchor[0] + NODES[s] * h * motion.anchor[1]
                for k in range(s):
                    place += square * SQUARE[s, k] * scratch.anchor_acceleration[k]
                scratch.anchor_acceleration[s] += string_pull(chain, mode.size, place)
    # Overlap and rate at the end, and their embedded errors of orders 5 and 3.
    end_overlap, end_rate, errors = trial.overlap[2], trial.rate[2], scratch.work
    for i in range(first, last):
        d, w, d5, w5, d3, w3 = end_overlap[i], end_rate[i], 0.0, 0.0, 0.0, 0.0
        for k in range(STAGES):
            a = acceleration[k, i]
            d += square * WEIGHTS_SQUARE[k] * a
            w += h * WEIGHTS[k] * a
            d5 += square * FIFTH_SQUARE[k] * a
            w5 += h * FIFTH[k] * a
            d3 += square * THIRD_SQUARE[k] * a
            w3 += h * THIRD[k] * a
        end_overlap[i], end_rate[i] = d, w
        errors[FIFTH_OVERLAP, i], errors[FIFTH_RATE, i] = d5, w5
        errors[THIRD_OVERLAP, i], errors[THIRD_RATE, i] = d3, w3
    # Touching contacts do not move.
    for i in range(first, last):
        if mode[i] == TOUCHING:
            end_overlap[i], end_rate[i] = overlap[i], 0.0
    worst = error_of_range(h, first, last, chain, motion, trial, force, errors)
    # Forces at the end, then the overlaps at the nodes of `radau` by the quintic through both ends.
    accelerate(first, last, h, chain, mode, motion.force, end_overlap, force, stage, upper)
    for i in range(first, last):
        path = hermite_quintic(h, overlap[i], rate[i], acceleration[0, i], end_overlap[i], end_rate[i], stage[i])
        for k in range(2):
            trial.overlap[k, i] = halves(OUTPUT_NODES[k], path)[0][5]
    return worst


@inlined
def nearly_opens(h, overlap, rate, end_overlap, end_rate):
    """Return whether a contact unloads and loads again within a step and is nearly open in between. Its law is not
    smooth there.
    """
    # Only contacts that first unload and then load can nearly open.
    if not (overlap > 0.0 and end_overlap > 0.0 and rate < 0.0 < end_rate):
        return False
    # Smallest overlap of the parabola through both rates.
    least = overlap + 0.5 * h * rate * rate / (rate - end_rate)
    return least < GRAZE * max(overlap, end_overlap)


@inlined
def missed_impulse(h, first, last, chain, motion, trial, force):
    """Return (rough, error): if the law of a soft contact is not smooth in the step, and the error [m/s] that the
    embedded errors do not show. `force` (n,) are the forces at the last stage.

    The nodes of a step miss a part of the impulse of a force that begins or ends between them. For a > 1 this part is a
    known fraction (see `constants`). For a < 1 the embedded error of order 5 shows it, because the law is not smooth
    enough for order 8.
    """
    law, inverse_mass, overlap, mode = chain.law, chain.inverse_mass, motion.overlap, motion.mode
    end_overlap, rough, worst = trial.overlap[2], False, 0.0
    for i in range(first, last):
        if mode[i] == LOADED and law[i, 2] != 1.0:
            d0, d1, w0, w1 = overlap[i], end_overlap[i], motion.rate[i], trial.rate[2, i]
            opens, grazes = d1 < 0.0 < d0, nearly_opens(h, d0, w0, d1, w1)
            if opens or grazes or d0 <= 0.0 < force[i]:
                if law[i, 2] < 1.0:
                    rough = True
                else:
                    part = KINK if grazes else BEGINS
                    if opens:
                        # the sign of the cubic in the middle of the step tells in which half the force ends
                        part = ENDS[0] if 4.0 * (d0 + d1) < h * (w1 - w0) else ENDS[1]
                    push = curve_force(law, chain.graph, i, d0 if opens else d1)
                    worst = larger(worst, part * h * (inverse_mass[i] + inverse_mass[i + 1]) * push)
    # A kink of a tabulated law within the step.
    for i in range(first, last):
        if mode[i] == LOADED:
            push = breakpoint_force(chain.graph, i, overlap[i], end_overlap[i])
            worst = larger(worst, KINK * h * (inverse_mass[i] + inverse_mass[i + 1]) * push)
    return rough, worst


@inlined
def error_of_range(h, first, last, chain, motion, trial, force, work):
    """Return the error of a step as a velocity [m/s], from the embedded errors in rows of `work`.

    The error of a contact is that of its rate, and that of its overlap times its local frequency (its energy as a
    velocity). The error of order 5 alone is used if a soft contact begins or ceases to push within the step, or nearly
    does.
    """
    law, inverse_mass, overlap, mode = chain.law, chain.inverse_mass, motion.overlap, motion.mode
    rough, worst = missed_impulse(h, first, last, chain, motion, trial, force)
    error, square, slowest = work[CONTACT_ERROR], work[SQUARE_FREQUENCY], math.inf
    for i in range(first, last):
        fifth, third = work[FIFTH_RATE, i], work[THIRD_RATE, i]
        error[i] = abs(fifth) if rough else combined(fifth, third)
        square[i] = 0.0
        # If a smooth contact begins to push, take the slope at the end of the step: errors of rates alone vanish for
        # some step lengths.
        at = overlap[i] if overlap[i] > 0.0 or law[i, 2] < 1.0 else trial.overlap[2, i]
        if mode[i] == LOADED and (at > 0.0 or (has_segments(chain.graph, i) and law[i, 2] >= 1.0)):
            slope = curve_slope(law, chain.graph, i, at, curve_force(law, chain.graph, i, at))
            square[i] = (inverse_mass[i] + inverse_mass[i + 1]) * slope
            fifth, third = work[FIFTH_OVERLAP, i], work[THIRD_OVERLAP, i]
            error[i] = larger(error[i], math.sqrt(square[i]) * (abs(fifth) if rough else combined(fifth, third)))
            if law[i, 2] < 1.0:
                slowest = min(slowest, square[i])
    # The largest error counts, weighted for soft contacts that oscillate (see `care`).
    for i in range(first, last):
        faster = square[i] / slowest if math.isfinite(slowest) else 1.0
        worst = larger(worst, error[i] * care(law[i, 2], h * h * square[i], faster))
    return worst


@piece
def add_scaled(factor, source, first, last, target):
    """Compute ``target += factor * source`` in a range."""
    if factor != 0.0:
        for i in range(first, last):
            target[i] += factor * source[i]


@piece
def combined(fifth, third):
    """Return the error of order 8 from the errors of orders 5 and 3, as in the code of Hairer, Norsett & Wanner."""
    scale = fifth * fifth + 0.01 * third * third
    return fifth * fifth / math.sqrt(scale) if scale != 0.0 else 0.0
