"""The error of a `radau` step, from two embedded quadratures filtered by the stiff part of the motion."""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import KINK, RATIO, ROUND_OFF
from softcradle.physics.adaptive.radau import COARSE, EMBEDDED, GAMMA
from softcradle.physics.numerics.jit import inlined
from softcradle.physics.numerics.knots import drive_at
from softcradle.physics.numerics.law_curve import care, curve_slope, flow_into, larger
from softcradle.physics.numerics.own_contacts import bend_passed
from softcradle.physics.numerics.records import FROZEN, LOADED, OPEN, TOUCHING


@inlined
def compliance(chain, mode, i, overlap, force):
    """dd/df of contact i: 0 while it touches, -1 for a contact that carries no force at all."""
    if mode[i] == OPEN or mode[i] == FROZEN:
        return -1.0
    if mode[i] == TOUCHING:
        return 0.0
    slope = curve_slope(chain.law, chain.own, i, overlap, force)
    return 1.0 / slope if slope > 0.0 else -1.0


@inlined
def embedded_error(h, chain, motion, trial, work):
    """Error of the step as a velocity [m/s] from two embedded quadratures, of orders h**4 and h**3; `work` (3 or more, n+1).

    Each is filtered through (I - h gamma J)^-1. With the compliance C = dd/df and the force error phi:
    (C + (h gamma)² L) phi = e_d + h gamma e_w; then the errors are e_w - h gamma L phi in the rate and C phi in the
    overlap, which counts by its energy, sqrt(L C) phi. Of each contact counts its own ratio of the two.
    """
    law, inverse_mass = chain.law, chain.inverse_mass
    overlap, rate, force, mode = motion.overlap, motion.rate, motion.force, motion.mode
    stage_overlap, stage_rate, stage_force = trial.overlap, trial.rate, trial.force
    n = overlap.size
    fine, coarse, upper = work[0, :n], work[1, :n], work[2, :n]
    reach = h * GAMMA
    fine_rate, coarse_rate = stage_rate[0], stage_rate[1]  # free by now: the end of the step is the third row
    for i in range(n):
        fine_w = reach * (drive_at(chain, i, 0.0) - flow_into(i, inverse_mass, force))
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
        upper[i], fine[i], coarse[i] = 0.0, 0.0, 0.0
        if give >= 0.0:
            lower = -reach * reach * inverse_mass[i] if i > 0 else 0.0
            pivot = reach * reach * (inverse_mass[i] + inverse_mass[i + 1]) + give
            fine[i], coarse[i] = fine_d + reach * fine_w, coarse_d + reach * coarse_w
            if i > 0:
                pivot -= lower * upper[i - 1]
                fine[i] -= lower * fine[i - 1]
                coarse[i] -= lower * coarse[i - 1]
            if pivot > ROUND_OFF * reach * reach * (inverse_mass[i] + inverse_mass[i + 1]):
                fine[i] /= pivot
                coarse[i] /= pivot
                upper[i] = -reach * reach * inverse_mass[i + 1] / pivot
            else:  # a force through all beads from wall to wall moves nothing, and is not determined
                fine[i], coarse[i] = 0.0, 0.0
    for i in range(n - 2, -1, -1):
        fine[i] -= upper[i] * fine[i + 1]
        coarse[i] -= upper[i] * coarse[i + 1]
    worst, slowest = 0.0, math.inf
    for i in range(n):
        upper[i] = compliance(chain, mode, i, stage_overlap[2, i], stage_force[2, i])
        if upper[i] > 0.0:
            slowest = min(slowest, (inverse_mass[i] + inverse_mass[i + 1]) / upper[i])
    for i in range(n):
        by_fine = abs(fine_rate[i] - reach * flow_into(i, inverse_mass, fine))
        by_coarse = abs(coarse_rate[i] - reach * flow_into(i, inverse_mass, coarse))
        times = 1.0
        if mode[i] == LOADED:
            push = bend_passed(chain.own, i, overlap[i], stage_overlap[2, i])
            worst = larger(worst, KINK * h * (inverse_mass[i] + inverse_mass[i + 1]) * push)
        if upper[i] > 0.0:
            weight = inverse_mass[i] + inverse_mass[i + 1]
            by_fine = larger(by_fine, math.sqrt(weight * upper[i]) * abs(fine[i]))
            by_coarse = larger(by_coarse, math.sqrt(weight * upper[i]) * abs(coarse[i]))
            times = care(law[i, 2], h * h * weight / upper[i], weight / upper[i] / slowest)
        worst = larger(worst, times * by_fine * min(1.0, RATIO * by_fine / max(by_coarse, 1e-300)))
    return worst
