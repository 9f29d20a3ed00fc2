"""Explicit steps of several short chains side by side: the drifts and kicks of `explicit_steps`, one chain in each vector lane.

Rows are contacts or beads, columns lanes. Each lane goes through the operations of `explicit_steps.split_steps` in their
order, so its numbers are those of a chain alone, to the last digit; that is why powers are taken one by one, by the C library.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.law_kernels import force as contact_force
from softcradle.physics.numerics.resolvent import EPSILON

Array = NDArray[np.float64]

# chains side by side: with fewer, calls and chains that look up take as long as the steps; more gain nothing
LANES = 64

ANY, HOOKE, HERTZ = 0, 1, 2  # what the laws of a row have in common: nothing, the exponent 1, the exponent 3/2


class Lanes(NamedTuple):
    """Chains side by side; forces have a row of zeros before the first contact and after the last."""

    overlap: Array  # (n, LANES)
    rate: Array  # (n, LANES)
    force: Array  # (n+2, LANES)
    anchor: Array  # (2, LANES)
    preload: Array  # (n, LANES)
    stiffness: Array  # (n, LANES)
    exponent: Array  # (n, LANES)
    kept: Array  # (n, LANES) part of its force that each contact has as it comes out
    inverse_mass: Array  # (n+1, LANES)
    push: Array  # (n+1, LANES)
    bed: Array  # (n+1, LANES)
    step: Array  # (LANES,) length of the next steps
    part: Array  # (LANES,) of them
    velocity: Array  # (n+1, LANES) scratch memory
    change: Array  # (n+1, LANES) scratch memory
    closed: NDArray[np.int64]  # (n, LANES) the state that each contact has to leave
    switched: NDArray[np.int64]  # (LANES,) whether one has
    kind: NDArray[np.int64]  # (n,) ANY, HOOKE or HERTZ


def empty_lanes(contacts: int) -> Lanes:
    """Lanes without chains."""

    def rows(count: int) -> Array:
        return np.zeros((count, LANES))

    n = contacts
    closed, switched, kind = (
        np.zeros((n, LANES), dtype=np.int64),
        np.zeros(LANES, dtype=np.int64),
        np.zeros(n, dtype=np.int64),
    )
    return Lanes(
        rows(n), rows(n), rows(n + 2), rows(2), rows(n), rows(n), rows(n), rows(n), rows(n + 1), rows(n + 1), rows(n + 1),
        np.zeros(LANES), np.zeros(LANES), rows(n + 1), rows(n + 1), closed, switched, kind,
    )  # fmt: skip


@jit
def scale_steps(step, part, result):
    """``result = step part``."""
    for k in range(result.size):
        result[k] = step[k] * part


@jit
def drift_row(part, overlap, rate):
    """``d += part w``."""
    for k in range(rate.size):
        overlap[k] += part[k] * rate[k]


@jit
def force_row(kind, preload, stiffness, exponent, overlap, force):
    """``F + K d**a`` where d > 0, else 0."""
    pressed = False
    for k in range(force.size):
        pressed |= not overlap[k] <= 0.0
    if not pressed:
        for k in range(force.size):
            force[k] = 0.0
    elif kind == HOOKE:
        for k in range(force.size):
            f = preload[k] if stiffness[k] == 0.0 else preload[k] + stiffness[k] * overlap[k]
            force[k] = 0.0 if overlap[k] <= 0.0 else f
    elif kind == HERTZ:
        for k in range(force.size):
            d = max(overlap[k], 0.0)
            f = preload[k] if stiffness[k] == 0.0 else preload[k] + stiffness[k] * (d * math.sqrt(d))
            force[k] = 0.0 if overlap[k] <= 0.0 else f
    else:
        for k in range(force.size):
            force[k] = contact_force(preload[k], stiffness[k], exponent[k], overlap[k])


@jit
def ease_row(kept, rate, force):
    """A contact with loss has a part of its force as it comes out."""
    for k in range(force.size):
        force[k] = force[k] * kept[k] if rate[k] < 0.0 else force[k]


@jit
def kick_row(part, before, own, after, inverse_left, inverse_right, rate):
    """``w += part (a_left - a_right)``."""
    for k in range(rate.size):
        left = (before[k] - own[k]) * inverse_left[k]
        right = (own[k] - after[k]) * inverse_right[k]
        rate[k] += part[k] * (left - right)


@jit
def push_row(part, left, right, inverse_left, inverse_right, rate):
    """``w += part (push_left/m_left - push_right/m_right)``."""
    for k in range(rate.size):
        rate[k] += part[k] * (left[k] * inverse_left[k] - right[k] * inverse_right[k])


@jit
def push_anchor(part, push, inverse_mass, velocity):
    """``v += part push/m`` of the anchor bead."""
    for k in range(velocity.size):
        velocity[k] += part[k] * push[k] * inverse_mass[k]


@jit
def kick_anchor(part, before, after, inverse_mass, velocity):
    """``v += part (f_before - f_after)/m`` of the anchor bead."""
    for k in range(velocity.size):
        velocity[k] += part[k] * (before[k] - after[k]) * inverse_mass[k]


@jit
def kick(driven, bead, lanes):
    """Change the rates by all forces, as `explicit_steps.kick` does."""
    n, part, push, inverse_mass, force = lanes.rate.shape[0], lanes.part, lanes.push, lanes.inverse_mass, lanes.force
    if driven:
        push_anchor(part, push[bead], inverse_mass[bead], lanes.anchor[1])
        for i in range(n):
            push_row(part, push[i], push[i + 1], inverse_mass[i], inverse_mass[i + 1], lanes.rate[i])
    kick_anchor(part, force[bead], force[bead + 1], inverse_mass[bead], lanes.anchor[1])
    for i in range(n):
        kick_row(part, force[i], force[i + 1], force[i + 2], inverse_mass[i], inverse_mass[i + 1], lanes.rate[i])


@jit
def find_velocities(bead, lanes):
    """The velocities of the beads, as `bead_velocities` gives them."""
    n, velocity, rate, terms = lanes.rate.shape[0], lanes.velocity, lanes.rate, lanes.change[0]
    for k in range(lanes.step.size):
        velocity[bead, k] = lanes.anchor[1, k]
        terms[k] = abs(lanes.anchor[1, k])
    for j in range(bead - 1, -1, -1):
        for k in range(lanes.step.size):
            velocity[j, k] = velocity[j + 1, k] + rate[j, k]
            terms[k] += abs(rate[j, k])
    for j in range(bead, n):
        for k in range(lanes.step.size):
            velocity[j + 1, k] = velocity[j, k] - rate[j, k]
            terms[k] += abs(rate[j, k])
    for j in range(n + 1):
        for k in range(lanes.step.size):
            velocity[j, k] = 0.0 if abs(velocity[j, k]) <= 2.0 * EPSILON * terms[k] else velocity[j, k]


@jit
def net_row(part, before, after, push, inverse_mass, change):
    """``change = part (f_before - f_after + push)/m``."""
    for k in range(change.size):
        change[k] = part[k] * ((before[k] - after[k]) + push[k]) * inverse_mass[k]


@jit
def brake_row(part, bed, velocity, change):
    """Take from the change of a bead what the bed does: it stops a bead, never turns it round."""
    for k in range(change.size):
        pushed, brake = velocity[k] + change[k], part[k] * bed[k]
        stops = abs(pushed) <= brake
        braked = -velocity[k] if stops else change[k] - math.copysign(brake, pushed)
        change[k] = braked if bed[k] > 0.0 else change[k]


@jit
def change_row(braked, left, right, velocity_left, velocity_right, rate):
    """``w += dv_left - dv_right``; 0 between two beads that stop."""
    for k in range(rate.size):
        rate[k] += left[k] - right[k]
        stop = braked and left[k] == -velocity_left[k] and right[k] == -velocity_right[k]
        rate[k] = 0.0 if stop else rate[k]


@jit
def kick_and_brake(braked, bead, lanes):
    """Change bead velocities by all forces, then brake them, as `explicit_steps.kick_and_brake` does."""
    n, part, change, force, velocity = lanes.rate.shape[0], lanes.part, lanes.change, lanes.force, lanes.velocity
    if braked:
        find_velocities(bead, lanes)
    for j in range(n + 1):
        net_row(part, force[j], force[j + 1], lanes.push[j], lanes.inverse_mass[j], change[j])
        if braked:
            brake_row(part, lanes.bed[j], velocity[j], change[j])
    for k in range(lanes.step.size):
        lanes.anchor[1, k] += change[bead, k]
    for i in range(n):
        change_row(braked, change[i], change[i + 1], velocity[i], velocity[i + 1], lanes.rate[i])


@jit
def switched_row(overlap, force, closed, switched):
    """Mark the lanes whose contact has left the state in `closed`."""
    for k in range(switched.size):
        now = (overlap[k] > 0.0) | ((overlap[k] == 0.0) & (force[k] > 0.0)) | (force[k] < 0.0)
        switched[k] |= (1 if now else 0) ^ closed[k]


@jit
def mark_resting(lanes):
    """Mark the lanes in which no bead moves."""
    n, switched = lanes.rate.shape[0], lanes.switched
    for k in range(lanes.step.size):
        resting = lanes.anchor[1, k] == 0.0
        for i in range(n):
            resting &= lanes.rate[i, k] == 0.0
        switched[k] |= 1 if resting else 0


@jit
def any_switched(dissipates, lanes):
    """Mark the lanes in which a contact has switched or, if it `dissipates`, all beads rest; whether there are any."""
    switched, found = lanes.switched, 0
    for k in range(lanes.step.size):
        switched[k] = 0
    for i in range(lanes.rate.shape[0]):
        switched_row(lanes.overlap[i], lanes.force[i + 1], lanes.closed[i], switched)
    if dissipates:
        mark_resting(lanes)
    for k in range(lanes.step.size):
        found |= switched[k]
    return found != 0


@jit
def lane_steps(most, drifts, kicks, driven, dissipates, braked, bead, lanes):
    """Up to `most` steps in all lanes, until a contact of one switches or, if it `dissipates`, all beads of one rest.

    `bead` is the anchor bead of all chains. Returns the steps taken; `lanes.switched` tells of the lanes.
    """
    n, stages, part = lanes.rate.shape[0], kicks.size, lanes.part
    overlap, rate, force = lanes.overlap, lanes.rate, lanes.force
    for step in range(most):
        for stage in range(stages):
            scale_steps(lanes.step, drifts[stage], part)
            drift_row(part, lanes.anchor[0], lanes.anchor[1])
            for i in range(n):
                drift_row(part, overlap[i], rate[i])
                force_row(
                    lanes.kind[i], lanes.preload[i], lanes.stiffness[i], lanes.exponent[i], overlap[i], force[i + 1],
                )  # fmt: skip
                if dissipates:
                    ease_row(lanes.kept[i], rate[i], force[i + 1])
            scale_steps(lanes.step, kicks[stage], part)
            if dissipates:
                kick_and_brake(braked, bead, lanes)
            else:
                kick(driven, bead, lanes)
        if drifts[stages] != 0.0:
            scale_steps(lanes.step, drifts[stages], part)
            drift_row(part, lanes.anchor[0], lanes.anchor[1])
            for i in range(n):
                drift_row(part, overlap[i], rate[i])
        if any_switched(dissipates, lanes):
            return step + 1
    return most
