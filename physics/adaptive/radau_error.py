"""What follows from the stages of a `radau` step: rates, the anchor bead, and the error."""

from __future__ import annotations

import math

from softcradle.physics.adaptive.radau_tableau import COARSE, EMBEDDED, GAMMA, INVERSE, TABLEAU
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.law_curve import OPEN, TOUCHING, care, flow_into, slope_at

RATIO = 3.0  # error taken of a contact = fine error times this times fine over coarse


@jit
def stage_rates(h, inverse_mass, external, overlap, rate, stage_overlap, stage_force, stage_rate):
    """Rates of all stages: w0 - h sum_j A_kj (L f_j - e), or (1/h) sum_j (A^-1)_kj (d_j - d0) where that is finer.

    It is where the overlaps are smaller than what the forces move in a step: deep inside a cluster.
    """
    for i in range(overlap.size):
        flow = (
            flow_into(i, inverse_mass, stage_force[0]),
            flow_into(i, inverse_mass, stage_force[1]),
            flow_into(i, inverse_mass, stage_force[2]),
        )
        drive = external[i] if external.size else 0.0
        moved = (stage_overlap[0, i] - overlap[i], stage_overlap[1, i] - overlap[i], stage_overlap[2, i] - overlap[i])
        largest = max(abs(overlap[i]), abs(stage_overlap[0, i]), abs(stage_overlap[1, i]), abs(stage_overlap[2, i]))
        pushed = h * h * (inverse_mass[i] + inverse_mass[i + 1])
        fine = largest < pushed * max(stage_force[0, i], stage_force[1, i], stage_force[2, i])
        for k in range(3):
            if fine:
                stage_rate[k, i] = (INVERSE[k, 0] * moved[0] + INVERSE[k, 1] * moved[1] + INVERSE[k, 2] * moved[2]) / h
            else:
                stage_rate[k, i] = rate[i] - h * (
                    TABLEAU[k, 0] * (flow[0] - drive)
                    + TABLEAU[k, 1] * (flow[1] - drive)
                    + TABLEAU[k, 2] * (flow[2] - drive)
                )


@jit
def move_anchor(h, inverse_mass, external, anchor_bead, stage_force, anchor, end_anchor):
    """Position and velocity of the anchor bead at the end of the step."""
    n = stage_force.shape[1]
    end_anchor[0], end_anchor[1] = anchor[0] + h * anchor[1], anchor[1]
    for j in range(3):
        net = stage_force[j, anchor_bead - 1] if anchor_bead > 0 else 0.0
        net -= stage_force[j, anchor_bead] if anchor_bead < n else 0.0
        acceleration = net * inverse_mass[anchor_bead]
        if external.size:
            acceleration += external[n]
        square = TABLEAU[2, 0] * TABLEAU[0, j] + TABLEAU[2, 1] * TABLEAU[1, j] + TABLEAU[2, 2] * TABLEAU[2, j]
        end_anchor[0] += h * h * square * acceleration
        end_anchor[1] += h * TABLEAU[2, j] * acceleration


@jit
def compliance(law, mode, i, overlap, force):
    """dd/df of contact i: 0 while it touches, -1 for a contact that carries no force at all."""
    if mode[i] == OPEN:
        return -1.0
    if mode[i] == TOUCHING:
        return 0.0
    slope = slope_at(law[i, 0], law[i, 1], law[i, 2], overlap, force)
    return 1.0 / slope if slope > 0.0 else -1.0


@jit
def embedded_error(
    h, law, inverse_mass, external, mode, overlap, rate, force, stage_overlap, stage_rate, stage_force, fine, coarse, upper
):  # fmt: skip
    """Error of the step as a velocity [m/s] from two embedded quadratures, of orders h**4 and h**3; (n,) scratch arrays.

    Each is filtered through (I - h gamma J)^-1. With the compliance C = dd/df and the force error phi:
    (C + (h gamma)² L) phi = e_d + h gamma e_w; then the errors are e_w - h gamma L phi in the rate and C phi in the
    overlap, which counts by its energy, sqrt(L C) phi. Of each contact counts its own ratio of the two.
    """
    n = overlap.size
    reach = h * GAMMA
    fine_rate, coarse_rate = stage_rate[0], stage_rate[1]  # free by now: the end of the step is the third row
    for i in range(n):
        drive = external[i] if external.size else 0.0
        fine_w, fine_d = reach * (drive - flow_into(i, inverse_mass, force)), reach * rate[i]
        coarse_w, coarse_d = 0.0, 0.0
        for k in range(3):
            by_rate, by_overlap = stage_rate[k, i] - rate[i], stage_overlap[k, i] - overlap[i]
            fine_w += EMBEDDED[k] * by_rate
            fine_d += EMBEDDED[k] * by_overlap
            coarse_w += COARSE[k] * by_rate
            coarse_d += COARSE[k] * by_overlap
        fine_rate[i], coarse_rate[i] = fine_w, coarse_w
        give = compliance(law, mode, i, stage_overlap[2, i], stage_force[2, i])
        upper[i], fine[i], coarse[i] = 0.0, 0.0, 0.0
        if give >= 0.0:
            lower = -reach * reach * inverse_mass[i] if i > 0 else 0.0
            pivot = reach * reach * (inverse_mass[i] + inverse_mass[i + 1]) + give
            fine[i], coarse[i] = fine_d + reach * fine_w, coarse_d + reach * coarse_w
            if i > 0:
                pivot -= lower * upper[i - 1]
                fine[i] -= lower * fine[i - 1]
                coarse[i] -= lower * coarse[i - 1]
            fine[i] /= pivot
            coarse[i] /= pivot
            upper[i] = -reach * reach * inverse_mass[i + 1] / pivot
    for i in range(n - 2, -1, -1):
        fine[i] -= upper[i] * fine[i + 1]
        coarse[i] -= upper[i] * coarse[i + 1]
    worst, slowest = 0.0, math.inf
    for i in range(n):
        upper[i] = compliance(law, mode, i, stage_overlap[2, i], stage_force[2, i])
        if upper[i] > 0.0:
            slowest = min(slowest, (inverse_mass[i] + inverse_mass[i + 1]) / upper[i])
    for i in range(n):
        by_fine = abs(fine_rate[i] - reach * flow_into(i, inverse_mass, fine))
        by_coarse = abs(coarse_rate[i] - reach * flow_into(i, inverse_mass, coarse))
        times = 1.0
        if upper[i] > 0.0:
            weight = inverse_mass[i] + inverse_mass[i + 1]
            by_fine = max(by_fine, math.sqrt(weight * upper[i]) * abs(fine[i]))
            by_coarse = max(by_coarse, math.sqrt(weight * upper[i]) * abs(coarse[i]))
            times = care(law[i, 2], h * h * weight / upper[i], weight / upper[i] / slowest)
        worst = max(worst, times * by_fine * min(1.0, RATIO * by_fine / max(by_coarse, 1e-300)))
    return worst
