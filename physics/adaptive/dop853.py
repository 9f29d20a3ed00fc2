"""One step of DOP853, the explicit method of order 8 of Dormand and Prince, for the overlaps: for contacts that are not stiff.

    d_s = d0 + c_s h w0 + h² sum_k (A²)_sk a_k,   a_k = e - L f(d_k),   s = 1..12

Forces of touching contacts are multipliers: they solve (L f)_i = e_i at every stage, one tridiagonal system.
Only stretches of contacts take part; between them nothing pushes that matters, and overlaps go on at their rates.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.active_ranges import stretch
from softcradle.physics.adaptive.dop853_tableau import (
    FIFTH,
    FIFTH_SQUARE,
    NODES,
    SQUARE,
    STAGES,
    THIRD,
    THIRD_SQUARE,
    WEIGHTS,
    WEIGHTS_SQUARE,
)
from softcradle.physics.numerics.contact_law import power
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.law_curve import LOADED, TOUCHING, care, signed_force, slope_at
from softcradle.physics.numerics.law_curve import NODES as OUTPUT_NODES

KINK = 0.01  # of the impulse of a force that begins or ends in a step like (t - t_o)**a, a > 1: so much its nodes miss


@jit
def accelerate(first, last, law, inverse_mass, external, mode, overlap, force, acceleration, upper):
    """Forces (n,) and overlap accelerations (n,) in a stretch, from the overlaps of one stage."""
    touching = False
    for i in range(first, last):
        force[i] = 0.0
        if mode[i] == LOADED and overlap[i] > 0.0:
            force[i] = law[i, 0] + law[i, 1] * power(overlap[i], law[i, 2])
        elif mode[i] == LOADED:
            force[i] = signed_force(law[i, 0], law[i, 1], law[i, 2], overlap[i])
        touching |= mode[i] == TOUCHING
    if first > 0:  # an edge in the middle of the chain idles; what it pushed, the bead beyond would not feel
        force[first] = 0.0
    if last < mode.size:
        force[last - 1] = 0.0
    if touching:
        for i in range(first, last):
            upper[i] = 0.0
            if mode[i] == TOUCHING:
                pivot = inverse_mass[i] + inverse_mass[i + 1]
                load = external[i] if external.size else 0.0
                if i > 0:
                    load += inverse_mass[i] * force[i - 1]
                    if mode[i - 1] == TOUCHING:
                        pivot -= inverse_mass[i] * upper[i - 1]
                if i < mode.size - 1:
                    if mode[i + 1] == TOUCHING:
                        upper[i] = inverse_mass[i + 1] / pivot
                    else:
                        load += inverse_mass[i + 1] * force[i + 1]
                force[i] = load / pivot
        for i in range(last - 2, first - 1, -1):
            if mode[i] == TOUCHING and mode[i + 1] == TOUCHING:
                force[i] += upper[i] * force[i + 1]
    left = ((force[first - 1] if first > 0 else 0.0) - force[first]) * inverse_mass[first]
    for i in range(first, last):  # by the accelerations of the two beads, w' = a_i - a_(i+1)
        right = (force[i] - (force[i + 1] if i + 1 < force.size else 0.0)) * inverse_mass[i + 1]
        acceleration[i] = left - right
        left = right
    if external.size:
        for i in range(first, last):
            acceleration[i] += external[i]
    if touching:
        for i in range(first, last):
            if mode[i] == TOUCHING:
                acceleration[i] = 0.0


@jit
def anchor_acceleration(inverse_mass, external, anchor_bead, force):
    """Acceleration of the anchor bead by the contact forces (n,) and from outside."""
    net = force[anchor_bead - 1] if anchor_bead > 0 else 0.0
    if anchor_bead < force.size:
        net -= force[anchor_bead]
    return net * inverse_mass[anchor_bead] + (external[force.size] if external.size else 0.0)


@jit
def dop853_step(
    h, idle, law, inverse_mass, external, anchor_bead, mode, overlap, rate, anchor, held_force,
    stage_overlap, stage_rate, stage_force, acceleration, of_anchor, trial, force, upper, end_anchor,
):  # fmt: skip
    """One step: overlaps, rates and forces at its end, and for the event finder at the nodes of `radau`, into `stage_*`.

    `held_force` (n,) at the start; `idle` [m/s] is what contacts that wait may do; `acceleration` (12, n), `of_anchor` (12,),
    `trial`, `force`, `upper` (n,) scratch; `end_anchor` (2,). Returns the error as a velocity [m/s], of order 8:
    err5² / sqrt(err5² + 0.01 err3²).
    """
    n = overlap.size
    touching, worst = False, 0.0
    for i in range(n):
        force[i] = 0.0
        stage_overlap[2, i], stage_rate[2, i] = overlap[i] + h * rate[i], rate[i]
        for k in range(2):
            stage_overlap[k, i] = overlap[i] + OUTPUT_NODES[k] * h * rate[i]
        touching |= mode[i] == TOUCHING
    for s in range(STAGES):
        of_anchor[s] = anchor_acceleration(inverse_mass, external, anchor_bead, force)
    last = 0
    while last < n:
        first, last = stretch(last, h, idle, law, inverse_mass, external, mode, overlap, rate, held_force)
        if first == n:
            break
        worst = max(worst, step_of_stretch(
            h, first, last, law, inverse_mass, external, anchor_bead, mode, overlap, rate,
            stage_overlap, stage_rate, acceleration, of_anchor, trial, force, upper,
        ))  # fmt: skip
    end_anchor[0], end_anchor[1] = anchor[0] + h * anchor[1], anchor[1]
    for k in range(STAGES):
        end_anchor[0] += h * h * WEIGHTS_SQUARE[k] * of_anchor[k]
        end_anchor[1] += h * WEIGHTS[k] * of_anchor[k]
    for i in range(n):
        stage_force[2, i] = force[i]
        if force[i] == 0.0 and mode[i] == LOADED and stage_overlap[2, i] > 0.0:  # it waits
            stage_force[2, i] = force_at(law, i, stage_overlap[2, i])
    if touching:
        for k in range(2):
            for i in range(n):
                stage_force[k, i] = 0.0
            accelerate(0, n, law, inverse_mass, external, mode, stage_overlap[k], stage_force[k], trial, upper)
    return worst


@jit
def step_of_stretch(
    h, first, last, law, inverse_mass, external, anchor_bead, mode, overlap, rate,
    stage_overlap, stage_rate, acceleration, of_anchor, trial, force, upper,
):  # fmt: skip
    """The step of contacts [first, last): the forces of their end stay in `force`. Returns the error as `dop853_step`."""
    square, moves_anchor = h * h, first <= anchor_bead <= last
    for s in range(STAGES):
        for i in range(first, last):
            trial[i] = overlap[i] + NODES[s] * h * rate[i]
        for k in range(s):
            add_scaled(square * SQUARE[s, k], acceleration[k], first, last, trial)
        accelerate(first, last, law, inverse_mass, external, mode, trial, force, acceleration[s], upper)
        if moves_anchor:
            of_anchor[s] = anchor_acceleration(inverse_mass, external, anchor_bead, force)
    end_overlap, end_rate, fifth, third = stage_overlap[2], stage_rate[2], stage_overlap[0], stage_overlap[1]
    fifth_overlap, third_overlap = stage_rate[0], stage_rate[1]
    for i in range(first, last):
        fifth[i], third[i], fifth_overlap[i], third_overlap[i] = 0.0, 0.0, 0.0, 0.0
    for k in range(STAGES):
        add_scaled(square * WEIGHTS_SQUARE[k], acceleration[k], first, last, end_overlap)
        add_scaled(h * WEIGHTS[k], acceleration[k], first, last, end_rate)
        add_scaled(h * FIFTH[k], acceleration[k], first, last, fifth)
        add_scaled(h * THIRD[k], acceleration[k], first, last, third)
        add_scaled(square * FIFTH_SQUARE[k], acceleration[k], first, last, fifth_overlap)
        add_scaled(square * THIRD_SQUARE[k], acceleration[k], first, last, third_overlap)
    for i in range(first, last):
        if mode[i] == TOUCHING:
            end_overlap[i], end_rate[i] = 0.0, 0.0
    worst = error_of_stretch(
        h, first, last, law, inverse_mass, mode, overlap, force, end_overlap, fifth, third, fifth_overlap, third_overlap
    )
    accelerate(first, last, law, inverse_mass, external, mode, end_overlap, force, trial, upper)
    for k in range(2):
        for i in range(first, last):
            stage_overlap[k, i] = hermite(
                OUTPUT_NODES[k], h, overlap[i], rate[i], acceleration[0, i], end_overlap[i], end_rate[i], trial[i]
            )  # fmt: skip
    return worst


@jit
def error_of_stretch(
    h, first, last, law, inverse_mass, mode, overlap, force, end_overlap, fifth, third, fifth_overlap, third_overlap
):  # fmt: skip
    """Error of a step as a velocity [m/s]; of order 5 alone where a soft contact begins or ceases to push in it."""
    rough, worst = False, 0.0
    for i in range(first, last):
        if mode[i] == LOADED and law[i, 2] != 1.0:
            opens = end_overlap[i] < 0.0 < overlap[i]
            if opens or overlap[i] <= 0.0 < force[i]:
                if law[i, 2] < 1.0:
                    rough = True
                else:
                    push = force_at(law, i, overlap[i] if opens else end_overlap[i])
                    worst = max(worst, KINK * h * (inverse_mass[i] + inverse_mass[i + 1]) * push)
    slowest = math.inf
    error, frequency = fifth, third  # from here on: of each contact, before care; squared
    for i in range(first, last):
        error[i] = abs(fifth[i]) if rough else combined(fifth[i], third[i])
        frequency[i] = 0.0
        if mode[i] == LOADED and overlap[i] > 0.0:
            frequency[i] = frequency_of(law, inverse_mass, i, overlap[i])
            of_overlap = abs(fifth_overlap[i]) if rough else combined(fifth_overlap[i], third_overlap[i])
            error[i] = max(error[i], math.sqrt(frequency[i]) * of_overlap)
            if law[i, 2] < 1.0:
                slowest = min(slowest, frequency[i])
    for i in range(first, last):
        faster = frequency[i] / slowest if math.isfinite(slowest) else 1.0
        worst = max(worst, error[i] * care(law[i, 2], h * h * frequency[i], faster))
    return worst


@jit
def frequency_of(law, inverse_mass, i, overlap):
    """The local frequency, squared, of contact i at `overlap` > 0 [1/s²]."""
    slope = slope_at(law[i, 0], law[i, 1], law[i, 2], overlap, force_at(law, i, overlap))
    return (inverse_mass[i] + inverse_mass[i + 1]) * slope


@jit
def force_at(law, i, overlap):
    """Force of contact i, loaded, at `overlap`."""
    return signed_force(law[i, 0], law[i, 1], law[i, 2], overlap)


@jit
def add_scaled(factor, source, first, last, target):
    """``target += factor * source`` in a stretch."""
    if factor != 0.0:
        for i in range(first, last):
            target[i] += factor * source[i]


@jit
def combined(fifth, third):
    """The error of order 8 from those of orders 5 and 3, as in the authors' code."""
    scale = fifth * fifth + 0.01 * third * third
    return fifth * fifth / math.sqrt(scale) if scale > 0.0 else 0.0


@jit
def hermite(x, h, d0, w0, a0, d1, w1, a1):
    """The quintic with overlaps, rates and accelerations of both ends, at the part x of the step."""
    jump = d1 - d0 - h * w0 - 0.5 * h * h * a0
    turn = h * (w1 - w0 - h * a0)
    bend = h * h * (a1 - a0)
    c3, c4, c5 = (
        10.0 * jump - 4.0 * turn + 0.5 * bend,
        -15.0 * jump + 7.0 * turn - bend,
        6.0 * jump - 3.0 * turn + 0.5 * bend,
    )
    return d0 + x * (h * w0 + x * (0.5 * h * h * a0 + x * (c3 + x * (c4 + x * c5))))
