"""One step of Radau IIA with three stages (order 5), solved for force and overlap together.

    d_k = d0 + h c_k w0 - h² sum_j (A²)_kj (L f_j)        w_k = w0 - h sum_j A_kj (L f_j),   k = 1..3

In the variables (d, f) on the curve of the law a step costs one block-tridiagonal solve an iteration, with 3x3 blocks
and diagonal couplings. A touching contact is the vertical part of the curve: its d stays 0 and its f is a multiplier.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.radau_tableau import SQUARE_INVERSE
from softcradle.physics.numerics.contact_law import power
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.law_curve import (
    LOADED,
    NODES,
    OPEN,
    SMALLEST,
    TOUCHING,
    cubic,
    flow_into,
    move_along,
    signed_force,
    slope_at,
)

MOST_NEWTON = 15
DIVERGED = 1e30  # [m] an overlap so large tells that Newton has lost its way
FORCE_PRECISION = 1e-3  # of the largest force: in the smallest of steps none counts, yet the next begins from it
FOLLOW = 3.0  # times the step before: a longer step does not begin from its cubics
SOFT_FOLLOW = 1.3  # nor of soft contacts,
SUDDEN = 0.2  # nor one of this part of the time since an onset, or until an opening: powers of that time then go on
LEAST_LEFT = 0.01  # of an overlap that shrinks, in a guess
MOST_GROWTH = math.log(3.0)  # of a guessed force


@jit
def first_guess(
    h, law, inverse_mass, external, mode, overlap, rate, force, past_step, past, stage_overlap, stage_force
):  # fmt: skip
    """Stages to begin Newton from: the cubics of the step before, where there was one of like size, go on.

    `past` (8, n): force at the start and stages of that step, then the overlaps. Else soft contacts go on as a power of the
    time since an onset, d (1 + t/T)**(w T/d), or keep their force where `past_step` is negative; others fly on.
    """
    follows = past_step > 0.0 and h < FOLLOW * past_step
    soft_follows = past_step > 0.0 and h < SOFT_FOLLOW * past_step
    since = time_since_onset(law, mode, overlap, rate, force)
    for i in range(overlap.size):
        preload, stiffness, exponent = law[i, 0], law[i, 1], law[i, 2]
        for k in range(3):
            flown = overlap[i] + h * NODES[k] * rate[i]
            x = 1.0 + NODES[k] * h / past_step if follows else 0.0
            if mode[i] == OPEN:
                stage_overlap[k, i], stage_force[k, i] = flown, 0.0
            elif mode[i] == TOUCHING:
                stage_overlap[k, i], stage_force[k, i] = 0.0, force[i]
                if follows:
                    stage_force[k, i] = cubic(x, past[0, i], past[1, i], past[2, i], past[3, i])
            elif exponent < 1.0 and force[i] > preload:
                stage_overlap[k, i], stage_force[k, i] = overlap[i], force[i]
                weight = inverse_mass[i] + inverse_mass[i + 1]
                stiff = weight * exponent * (force[i] - preload)  # times d: it keeps its rate until d = 0 where small
                own = rate[i] < 0.0 and overlap[i] > SMALLEST and overlap[i] * stiff < 4.0 * rate[i] * rate[i]
                time = overlap[i] / rate[i] if own else since
                if past_step >= 0.0 and (not soft_follows or h > SUDDEN * abs(time)) and overlap[i] > SMALLEST:
                    growth = math.log(max(1.0 + h * NODES[k] / time, LEAST_LEFT))
                    if own and flown <= 0.0 and preload == 0.0:
                        stage_overlap[k, i], stage_force[k, i] = flown, 0.0
                        continue
                    if not own:
                        growth *= rate[i] * time / overlap[i]
                    growth = min(max(growth, -MOST_GROWTH / exponent), MOST_GROWTH / exponent)
                    stage_overlap[k, i] = overlap[i] * math.exp(growth)
                    stage_force[k, i] = preload + (force[i] - preload) * math.exp(exponent * growth)
                elif soft_follows:
                    excess = cubic(x, past[0, i], past[1, i], past[2, i], past[3, i]) - preload
                    if 0.3 * (force[i] - preload) < excess < 3.0 * (force[i] - preload):
                        stage_overlap[k, i] = power(excess / stiffness, 1.0 / exponent)
                        stage_force[k, i] = preload + excess
            elif overlap[i] == 0.0 and rate[i] == 0.0:
                stage_overlap[k, i], stage_force[k, i] = 0.0, preload
                if i > 0 and preload == 0.0:
                    set_pushed(h, law, inverse_mass, i, k, i, stage_force[k, i - 1], stage_overlap, stage_force)
            else:
                if follows:
                    flown = cubic(x, past[4, i], past[5, i], past[6, i], past[7, i])
                stage_overlap[k, i] = flown
                stage_force[k, i] = signed_force(preload, stiffness, exponent, flown)
    for i in range(overlap.size - 2, -1, -1):
        for k in range(3):
            if mode[i] == LOADED and overlap[i] == 0.0 and rate[i] == 0.0 and stage_force[k, i] == 0.0:
                set_pushed(h, law, inverse_mass, i, k, i + 1, stage_force[k, i + 1], stage_overlap, stage_force)
                if external.size and external[i] > 0.0 and law[i, 0] == 0.0:  # of two halves the lighter bead's mass
                    push = external[i] / (inverse_mass[i] + inverse_mass[i + 1])
                    set_pushed(h, law, inverse_mass, i, k, i + 1, push, stage_overlap, stage_force)


@jit
def time_since_onset(law, mode, overlap, rate, force):
    """Time since the overlap of the soft contact that pushes most was zero, if its rate was what it is; negative until then."""
    largest, since = 0.0, 1e30
    for i in range(overlap.size):
        if mode[i] == LOADED and law[i, 2] < 1.0 and overlap[i] > 0.0 and force[i] > largest and rate[i] != 0.0:
            largest, since = force[i], overlap[i] / rate[i]
    return since


@jit
def set_pushed(h, law, inverse_mass, i, k, bead, push, stage_overlap, stage_force):
    """Guess for contact i at rest when its neighbour pushes `bead`: what the bead would fly, at most most of the push."""
    if push <= 0.0:
        return
    flown = 0.5 * (h * NODES[k]) ** 2 * inverse_mass[bead] * push
    stage_force[k, i] = min(0.8 * push, law[i, 1] * power(flown, law[i, 2]))
    stage_overlap[k, i] = power(stage_force[k, i] / law[i, 1], 1.0 / law[i, 2])


@jit
def directions(h, law, inverse_mass, mode, stage_overlap, stage_force, along, across):
    """Direction (dd, df) = (along, across) z of the curve at every stage, scaled so that both terms of a row are alike."""
    n = mode.size
    for i in range(n):
        weight = h * h * (inverse_mass[i] + inverse_mass[i + 1])
        for k in range(3):
            if mode[i] == OPEN:
                along[k, i], across[k, i] = 1.0, 0.0
                continue
            slope = math.inf
            if mode[i] == LOADED:
                slope = slope_at(law[i, 0], law[i, 1], law[i, 2], stage_overlap[k, i], stage_force[k, i])
            if slope > 1e200:
                along[k, i], across[k, i] = 0.0, 1.0 / weight
            else:
                along[k, i] = 1.0 / (1.0 + weight * slope)
                across[k, i] = slope * along[k, i]


@jit
def eliminate(h, law, inverse_mass, external, overlap, rate, stage_overlap, stage_force, along, across, block, z):
    """Newton correction z (3, n) of all stages: block Thomas with M = D'^-1 kept in `block` (n, 9).

    Row (k, i): sum_j (A^-2)_kj (d_j - b_j) + h² (L f_k - e) = 0 with b_j = d0 + h c_j w0 and external acceleration e.
    """
    n = overlap.size
    square = h * h
    for i in range(n):
        left, right = square * inverse_mass[i], square * inverse_mass[i + 1]
        e0 = stage_overlap[0, i] - overlap[i] - h * NODES[0] * rate[i]
        e1 = stage_overlap[1, i] - overlap[i] - h * NODES[1] * rate[i]
        e2 = stage_overlap[2, i] - overlap[i] - h * NODES[2] * rate[i]
        for k in range(3):
            flow = square * flow_into(i, inverse_mass, stage_force[k])
            if external.size:
                flow -= square * external[i]
            z[k, i] = -(SQUARE_INVERSE[k, 0] * e0 + SQUARE_INVERSE[k, 1] * e1 + SQUARE_INVERSE[k, 2] * e2 + flow)
        m00 = SQUARE_INVERSE[0, 0] * along[0, i] + (left + right) * across[0, i]
        m11 = SQUARE_INVERSE[1, 1] * along[1, i] + (left + right) * across[1, i]
        m22 = SQUARE_INVERSE[2, 2] * along[2, i] + (left + right) * across[2, i]
        m01, m02 = SQUARE_INVERSE[0, 1] * along[1, i], SQUARE_INVERSE[0, 2] * along[2, i]
        m10, m12 = SQUARE_INVERSE[1, 0] * along[0, i], SQUARE_INVERSE[1, 2] * along[2, i]
        m20, m21 = SQUARE_INVERSE[2, 0] * along[0, i], SQUARE_INVERSE[2, 1] * along[1, i]
        if i > 0 and left != 0.0:
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
        i00, i01, i02 = m11 * m22 - m12 * m21, m02 * m21 - m01 * m22, m01 * m12 - m02 * m11
        i10, i11, i12 = m12 * m20 - m10 * m22, m00 * m22 - m02 * m20, m02 * m10 - m00 * m12
        i20, i21, i22 = m10 * m21 - m11 * m20, m01 * m20 - m00 * m21, m00 * m11 - m01 * m10
        scale = 1.0 / (m00 * i00 + m01 * i10 + m02 * i20)
        m = block[i]
        m[0], m[1], m[2] = i00 * scale, i01 * scale, i02 * scale
        m[3], m[4], m[5] = i10 * scale, i11 * scale, i12 * scale
        m[6], m[7], m[8] = i20 * scale, i21 * scale, i22 * scale
        r = (z[0, i], z[1, i], z[2, i])
        z[0, i] = m[0] * r[0] + m[1] * r[1] + m[2] * r[2]
        z[1, i] = m[3] * r[0] + m[4] * r[1] + m[5] * r[2]
        z[2, i] = m[6] * r[0] + m[7] * r[1] + m[8] * r[2]
    for i in range(n - 2, -1, -1):
        right = square * inverse_mass[i + 1]
        m = block[i]
        r0, r1, r2 = across[0, i + 1] * z[0, i + 1], across[1, i + 1] * z[1, i + 1], across[2, i + 1] * z[2, i + 1]
        z[0, i] += right * (m[0] * r0 + m[1] * r1 + m[2] * r2)
        z[1, i] += right * (m[3] * r0 + m[4] * r1 + m[5] * r2)
        z[2, i] += right * (m[6] * r0 + m[7] * r1 + m[8] * r2)


@jit
def solve_stages(
    h, law, inverse_mass, external, mode, overlap, rate, force, precision, stage_overlap, stage_force, along, across,
    block, z,
):  # fmt: skip
    """Newton on all stages from the guess in `stage_*`; `precision` is the velocity [m/s] to converge to.

    A correction counts by the velocity it gives, h L df, and by that of its energy, sqrt(L dd df). Returns the
    iterations used, 0 where they did not converge.
    """
    n = overlap.size
    before, strongest = math.inf, 0.0
    for i in range(n):
        strongest = max(strongest, force[i])
    for iteration in range(MOST_NEWTON):
        directions(h, law, inverse_mass, mode, stage_overlap, stage_force, along, across)
        eliminate(h, law, inverse_mass, external, overlap, rate, stage_overlap, stage_force, along, across, block, z)
        size, changed, largest = 0.0, 0.0, strongest
        for i in range(n):
            weight = inverse_mass[i] + inverse_mass[i + 1]
            for k in range(3):
                by_overlap, by_force = along[k, i] * z[k, i], across[k, i] * z[k, i]
                if not math.isfinite(by_overlap) or not math.isfinite(by_force):
                    return 0
                if mode[i] == LOADED:
                    d, f = move_along(
                        law[i, 0], law[i, 1], law[i, 2], h * h * weight,
                        stage_overlap[k, i], stage_force[k, i], by_overlap, by_force,
                    )  # fmt: skip
                    by_overlap, by_force = d - stage_overlap[k, i], f - stage_force[k, i]
                    stage_overlap[k, i], stage_force[k, i] = d, f
                elif mode[i] == OPEN:
                    stage_overlap[k, i] += by_overlap
                else:
                    stage_force[k, i] += by_force
                if not abs(stage_overlap[k, i]) < DIVERGED:
                    return 0
                size = max(size, h * weight * abs(by_force), math.sqrt(weight * abs(by_overlap * by_force)))
                changed, largest = max(changed, abs(by_force)), max(largest, abs(stage_force[k, i]))
        if changed <= FORCE_PRECISION * largest and (
            size <= precision or (iteration > 0 and size <= 1e-2 * before and size * size <= precision * before)
        ):
            return iteration + 1
        before = size
    return 0
