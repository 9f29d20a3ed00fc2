"""Event location: the first guard of all rows that turns negative within a step.

Each row has its own guard, a polynomial over the step that is positive while nothing switches:

    OPEN contact      -d          closes          quintic through both ends
    LOADED contact     d          opens           the same
    loss, LOADED       w or -w    turns from pressing in to coming out, or back; cubic through both ends
    sliding bead       v or -v    stops           the same
    TOUCHING contact   f - low    opens or eases;     high - f    yields; cubic through the stages
    sticking bead      mu m g - |q|   slips, q the friction it needs; the same
"""

from __future__ import annotations

import numpy as np
from softcradle.physics.adaptive.constants import ROUND_OFF, SAFETY
from softcradle.physics.adaptive.contact_modes import loss_of, multiplier_bounds
from softcradle.physics.adaptive.first_root import NONE, first_root, hermite_cubic, hermite_quintic, stage_cubic
from softcradle.physics.adaptive.stick_slip_friction import bead_bend, bead_push
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.knots import drive_at
from softcradle.physics.numerics.law_curve import NODES, curve_force, flow_into
from softcradle.physics.numerics.records import LOADED, NO_CONTACT, OPEN, TOUCHING

# kinds of event of a contact, then of a bead
NOTHING, CLOSES, OPENS, YIELDS, EASES, TURNS = (
    np.int64(0),
    np.int64(1),
    np.int64(2),
    np.int64(3),
    np.int64(4),
    np.int64(5),
)
STOPS, SLIPS = np.int64(6), np.int64(7)

BEFORE, AFTER = 5, 6  # rows (n+1,) of the work array: velocities of the beads at both ends of a step


@piece
def is_continued(law, i):
    """True where the force is continued to d < 0 within a step, so that a loaded contact opens by an event."""
    return law[i, 0] > 0.0 or law[i, 2] == 1.0


@piece
def closes_inactive(chain, i, inactive, rate, end_rate, end_overlap):
    """True where a contact closes so slowly, and has so little energy at the end, that its closing may be passed over.

    `inactive` [m/s] is the velocity that does not count.
    """
    if chain.law[i, 0] > 0.0 or max(rate, end_rate) > inactive or end_overlap <= 0.0:
        return False
    push = (chain.inverse_mass[i] + chain.inverse_mass[i + 1]) * curve_force(chain.law, chain.own, i, end_overlap)
    return push * end_overlap <= inactive * inactive


@inlined
def acceleration_of(i, chain, force, passed):
    """w' of contact i under the contact forces (n,), `passed` [s] after now."""
    return drive_at(chain, i, passed) - flow_into(i, chain.inverse_mass, force)


@inlined
def overlap_guard(h, sign, i, chain, motion, trial, slow):
    """The guard ``sign d`` of contact i; its mode tells which way it leaves d = 0 where it starts there from rest."""
    rate, bend = sign * motion.rate[i], sign * acceleration_of(i, chain, motion.force, 0.0)
    if motion.overlap[i] == 0.0 and rate <= slow:
        rate, bend = max(rate, 0.0), max(bend, 0.0)
    return hermite_quintic(
        h,
        sign * motion.overlap[i],
        rate,
        bend,
        sign * trial.overlap[2, i],
        sign * trial.rate[2, i],
        sign * acceleration_of(i, chain, trial.force[2], h),
    )


@inlined
def rate_guard(h, sign, i, chain, motion, trial, slow):
    """The guard ``sign w`` of contact i; a start no more than `slow` outside counts as inside."""
    lift = slow if sign * motion.rate[i] <= slow else 0.0
    return hermite_cubic(
        h,
        sign * motion.rate[i] + lift,
        sign * acceleration_of(i, chain, motion.force, 0.0),
        sign * trial.rate[2, i] + lift,
        sign * acceleration_of(i, chain, trial.force[2], h),
    )


@inlined
def friction_needed(j, chain, regime, force, passed):
    """The friction [N] that bead j needs to stay at rest under the contact forces (n,), `passed` [s] after now."""
    found = regime.push[j] if regime.push.size else 0.0
    if chain.knots.push_slope.size:
        found += passed * chain.knots.push_slope[j]
    if j > 0:
        found += force[j - 1]
    return found - force[j] if j < force.size else found


@inlined
def most_friction(j, chain, regime, passed):
    """The friction [N] that bead j can have, `passed` [s] after now."""
    found = regime.bed[j]
    if chain.knots.brake_slope.size:
        found += passed * chain.knots.brake_slope[j]
    return found / regime.inverse_mass[j]


@inlined
def bead_acceleration(j, chain, regime, force, passed):
    """Acceleration of bead j under the contact forces (n,), `passed` [s] after now."""
    before = force[j - 1] if j > 0 else 0.0
    after = force[j] if j < force.size else 0.0
    found = (before - after) * chain.inverse_mass[j] + bead_push(chain, regime, j)
    return found + passed * bead_bend(chain, regime, j)


@inlined
def velocity_guard(h, j, chain, regime, motion, trial, slow, before, after):
    """The guard of a sliding bead, from its velocities at both ends; a start no more than `slow` outside counts as inside."""
    sign = float(regime.slide[j])
    lift = slow if sign * before <= slow else 0.0
    return hermite_cubic(
        h,
        sign * before + lift,
        sign * bead_acceleration(j, chain, regime, motion.force, 0.0),
        sign * after + lift,
        sign * bead_acceleration(j, chain, regime, trial.force[2], h),
    )


@inlined
def flies_apart(i, chain, motion, trial):
    """True where open contact i is open at the end of the step too, and nothing pushes its beads at either end."""
    if trial.overlap[2, i] >= 0.0 or chain.external.size:
        return False
    before = motion.force[i - 1] == 0.0 == trial.force[2, i - 1] if i > 0 else True
    return before and (motion.force[i + 1] == 0.0 == trial.force[2, i + 1] if i < motion.force.size - 1 else True)


@piece
def find_event(h, chain, regime, motion, trial, skip, skipped, inactive, slow, work):
    """The earliest switch within the step: (row, kind, part of the step); row -1 where there is none.

    `skip` and `skipped` are row and kind of an event that is known; `inactive` [m/s] see `closes_inactive`; `slow` [m/s]: a
    rate or velocity this small that begins at 0 is round-off.
    """
    overlap, force, mode, f = motion.overlap, motion.force, motion.mode, trial.force
    row, kind, part = NO_CONTACT, NOTHING, 1.0
    for i in range(mode.size):
        if i == skip and skipped < STOPS:
            continue
        if mode[i] == OPEN:
            if flies_apart(i, chain, motion, trial):
                continue
            if closes_inactive(chain, i, inactive, motion.rate[i], trial.rate[2, i], trial.overlap[2, i]):
                continue
            x = first_root(overlap_guard(h, -1.0, i, chain, motion, trial, slow))
            if x < part:
                row, kind, part = i, CLOSES, x
        elif mode[i] == TOUCHING:
            low, high = multiplier_bounds(chain, regime, i, overlap[i])
            slack = ROUND_OFF * high
            if min(f[0, i], f[1, i], f[2, i]) < low - slack or max(f[0, i], f[1, i], f[2, i]) > SAFETY * high:
                x = first_root(stage_guard(1.0, slack - low, force[i], f[0, i], f[1, i], f[2, i]))
                if x < part:
                    row, kind, part = i, EASES if overlap[i] > 0.0 else OPENS, x
                x = first_root(stage_guard(-1.0, high + slack, force[i], f[0, i], f[1, i], f[2, i]))
                if x < part:
                    row, kind, part = i, YIELDS, x
        elif mode[i] == LOADED:
            if is_continued(chain.law, i):
                x = first_root(overlap_guard(h, 1.0, i, chain, motion, trial, slow))
                if x < part:
                    row, kind, part = i, OPENS, x
            if loss_of(regime, i) > 0.0 and (overlap[i] > 0.0 or motion.rate[i] > slow):
                sign = -1.0 if regime.easing[i] != 0 else 1.0
                x = first_root(rate_guard(h, sign, i, chain, motion, trial, slow))
                if x < part:
                    row, kind, part = i, TURNS, x
    if regime.bed.size:
        before, after = work[BEFORE], work[AFTER]
        bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], before)
        bead_velocities(trial.rate[2], chain.anchor_bead, trial.anchor[1], after)
        for j in range(regime.bed.size):
            if regime.bed[j] == 0.0 or (j == skip and skipped >= STOPS):
                continue
            if regime.slide[j] != 0:
                x = first_root(velocity_guard(h, j, chain, regime, motion, trial, slow, before[j], after[j]))
                if x < part:
                    row, kind, part = j, STOPS, x
            else:
                x = slip_of(h, j, chain, regime, motion, trial)
                if x < part:
                    row, kind, part = j, SLIPS, x
    return row, kind, part


@inlined
def slip_of(h, j, chain, regime, motion, trial):
    """The part of the step at which the static friction of bead j does not suffice any more."""
    first, last = most_friction(j, chain, regime, 0.0), most_friction(j, chain, regime, h)
    q0 = friction_needed(j, chain, regime, motion.force, 0.0)
    q1 = friction_needed(j, chain, regime, trial.force[0], h * NODES[0])
    q2 = friction_needed(j, chain, regime, trial.force[1], h * NODES[1])
    q3 = friction_needed(j, chain, regime, trial.force[2], h)
    if max(abs(q0), abs(q1), abs(q2), abs(q3)) < 0.5 * min(first, last):
        return NONE
    room, wider = first * (1.0 + ROUND_OFF), (last - first) * (1.0 + ROUND_OFF)
    r1, r2, r3 = room + NODES[0] * wider, room + NODES[1] * wider, room + wider
    up = first_root(stage_cubic(room - q0, r1 - q1, r2 - q2, r3 - q3))
    return min(up, first_root(stage_cubic(room + q0, r1 + q1, r2 + q2, r3 + q3)))


@inlined
def stage_guard(sign, offset, y0, y1, y2, y3):
    """Guard ``sign y + offset`` of a multiplier, from its values at the start and the stages of a step."""
    return stage_cubic(sign * y0 + offset, sign * y1 + offset, sign * y2 + offset, sign * y3 + offset)


@piece
def near_switch(h, chain, regime, motion, trial, slow):
    """The part of the step at which a guard comes near to zero without turning negative, so near that the polynomial may be
    wrong about it; 1 where none does. A step that ends there tells."""
    part = 1.0
    for i in range(motion.mode.size):
        if motion.mode[i] == TOUCHING:
            low, high = multiplier_bounds(chain, regime, i, motion.overlap[i])
            f1, f2, f3 = trial.force[0, i], trial.force[1, i], trial.force[2, i]
            if max(f1, f2) > 0.5 * (low + high):
                part = min(
                    part, lowest_of(stage_guard(-1.0, high, motion.force[i], f1, f2, f3), (1.0 - SAFETY) * (high - low))
                )
        elif motion.mode[i] == OPEN and motion.rate[i] > 0.0 > trial.rate[2, i]:
            guard = overlap_guard(h, -1.0, i, chain, motion, trial, slow)
            d0, d1, w0, w1 = motion.overlap[i], trial.overlap[2, i], motion.rate[i], trial.rate[2, i]
            middle = 0.5 * (d0 + d1) + 0.125 * h * (w0 - w1)  # of the cubic through both ends
            quintic = -(guard[0] + guard[5] + 5.0 * (guard[1] + guard[4]) + 10.0 * (guard[2] + guard[3])) / 32.0
            part = min(part, lowest_of(guard, abs(quintic - middle)))
    return part


@inlined
def lowest_of(b, margin):
    """Where in the step the guard is least, if it is less than `margin` there and not at an end; else 1."""
    if min(b[1], b[2], b[3], b[4]) >= margin or b[1] >= b[0] or b[4] >= b[5]:
        return 1.0
    low, high = 0.0, 1.0
    while high - low > ROUND_OFF:
        x = 0.5 * (low + high)
        y = 1.0 - x
        xx, xy, yy = x * x, x * y, y * y
        slope = (
            yy * yy * (b[1] - b[0]) + 4.0 * xy * yy * (b[2] - b[1]) + 6.0 * xy * xy * (b[3] - b[2])
            + 4.0 * xx * xy * (b[4] - b[3]) + xx * xx * (b[5] - b[4])
        )  # fmt: skip
        if slope < 0.0:
            low = x
        else:
            high = x
    x, y = low, 1.0 - low
    xx, xy, yy = x * x, x * y, y * y
    value = y * (yy * yy * b[0] + 5.0 * xy * yy * b[1] + 10.0 * xy * xy * b[2])
    value += x * (10.0 * xy * xy * b[3] + 5.0 * xx * xy * b[4] + xx * xx * b[5])
    return low if value < margin else 1.0


@inlined
def end_slope(y1, y2, y3):
    """Slope at the end of the parabola through the stages, times the length of the step."""
    c1, c2 = NODES[0], NODES[1]
    last, first = (y3 - y2) / (1.0 - c2), (y2 - y1) / (c2 - c1)
    return last + (1.0 - c2) * (last - first) / (1.0 - c1)


@inlined
def guard_at_end(h, row, kind, chain, regime, motion, trial, work):
    """(value, slope) of the guard of a row at the end of the step."""
    f = trial.force
    if kind == STOPS:
        bead_velocities(trial.rate[2], chain.anchor_bead, trial.anchor[1], work[AFTER])
        return regime.slide[row] * work[AFTER, row], regime.slide[row] * bead_acceleration(row, chain, regime, f[2], h)
    if kind == SLIPS:
        first, most = most_friction(row, chain, regime, 0.0), most_friction(row, chain, regime, h)
        q1 = friction_needed(row, chain, regime, f[0], h * NODES[0])
        q2 = friction_needed(row, chain, regime, f[1], h * NODES[1])
        q3 = friction_needed(row, chain, regime, f[2], h)
        slope, wider = end_slope(q1, q2, q3) / h, (most - first) / h
        return (most - q3, wider - slope) if q3 > 0.0 else (most + q3, wider + slope)
    if kind == TURNS:
        sign = -1.0 if regime.easing[row] != 0 else 1.0
        return sign * trial.rate[2, row], sign * acceleration_of(row, chain, f[2], h)
    if motion.mode[row] != TOUCHING:
        sign = -1.0 if kind == CLOSES else 1.0
        return sign * trial.overlap[2, row], sign * trial.rate[2, row]
    low, high = multiplier_bounds(chain, regime, row, motion.overlap[row])
    slope = end_slope(f[0, row], f[1, row], f[2, row]) / h
    return (high - f[2, row], -slope) if kind == YIELDS else (f[2, row] - low, slope)
