"""Modes of contacts (open, touching, loaded), and the location of events: the changes of mode within a step."""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.numerics.contact_solve import solve_contacts
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_curve import NODES, cubic, flow_into, signed_force
from softcradle.physics.numerics.records import LOADED, NO_CONTACT, OPEN, TOUCHING

# kinds of event; a touching contact yields where its force reaches its preload
NOTHING, CLOSES, OPENS, YIELDS = np.int64(0), np.int64(1), np.int64(2), np.int64(3)
FORCE_SLACK = 1e-12  # of the preload: how far a multiplier may leave its range before the contact switches
ROUND_OFF = 1e-13  # of the acceleration by the preload: a smaller one is none, and its contact stays touching
POSSIBLE_YIELD = 0.5  # of the preload: a force at a node from which on a peak between the nodes is sought
NEAR_YIELD = 0.9  # of the preload: a peak from which on the step is made to end there
PEAK_PARTS = 32  # parts of a step in which a peak is sought; one in the first or last part counts as at the end
CROSSING_PARTS = 8  # parts of a step in which a change of sign is sought
BISECTIONS = 60  # of such a part: to the last digit
UNIT_STEP = math.sqrt(2.0)  # the step whose h²/2 is 1


@jit
def is_continued(law, i):
    """True where the force is continued to d < 0 within a step, so that a loaded contact opens by an event."""
    return law[i, 0] > 0.0 or law[i, 2] == 1.0


@jit
def set_modes(chain, motion, slow, work):
    """Modes and forces from overlaps and rates; contacts with preload at rest at d = 0 (rates below `slow`) share a
    complementarity problem, w' = -L f + e with 0 <= f <= preload: the contact solver with rigid contacts.

    A contact that has just switched keeps its mode (``motion.held`` nonzero). `work` (WORK_ROWS, n+1).
    """
    law, inverse_mass, external = chain.law, chain.inverse_mass, chain.external
    overlap, rate, force, mode, held = motion.overlap, motion.rate, motion.force, motion.mode, motion.held
    n = mode.size
    rows, target, start, moved = work[0:6], work[6], work[7, :n], work[8]
    load, diagonal, coupling = work[9, :n], work[10], work[11]
    resting = 0
    for i in range(n):
        load[i] = 0.0
        if held[i] == 0:
            at_rest = overlap[i] == 0.0 and abs(rate[i]) <= slow
            if overlap[i] < 0.0 or (overlap[i] == 0.0 and rate[i] < 0.0 and not at_rest):
                mode[i] = OPEN
            elif at_rest and law[i, 0] > 0.0:
                mode[i] = TOUCHING
                rate[i] = 0.0
                resting += 1
            else:
                mode[i] = LOADED
        force[i] = 0.0
        if mode[i] == LOADED:
            force[i] = signed_force(law[i, 0], law[i, 1], law[i, 2], overlap[i])
    if resting == 0:
        return
    rigid = work[12:15].reshape(3 * (n + 1))[: 3 * n].reshape((n, 3))
    coupling[n] = 0.0
    for i in range(n):
        start[i] = 0.0
        rigid[i, 0], rigid[i, 1], rigid[i, 2] = law[i, 0], 0.0, 1.0
        coupling[i] = inverse_mass[i] if i > 0 and mode[i] == TOUCHING and mode[i - 1] == TOUCHING else 0.0
        diagonal[i] = inverse_mass[i] + inverse_mass[i + 1] if mode[i] == TOUCHING else 1.0
        target[i] = -1.0
        if mode[i] == TOUCHING:
            target[i] = (external[i] if external.size else 0.0) - flow_into(i, inverse_mass, force)
        moved[i] = target[i]
    solve_contacts(
        UNIT_STEP, rigid, None, diagonal, coupling, external, target, start, rate, moved, load, work, rows
    )  # fmt: skip
    for i in range(n):
        if mode[i] == TOUCHING:
            force[i] = load[i]
            none = ROUND_OFF * (inverse_mass[i] + inverse_mass[i + 1]) * law[i, 0]
            if moved[i] > none:
                mode[i], force[i] = LOADED, law[i, 0]
            elif moved[i] < -none:
                mode[i], force[i] = OPEN, 0.0


@jit
def first_crossing(y0, y1, y2, y3, upwards, most):
    """The first x in (0, most) at which the cubic turns positive (`upwards`) or negative; 2 where it does not."""
    sign = 1.0 if upwards else -1.0
    left = 0.0
    for p in range(1, CROSSING_PARTS + 1):
        right = most * p / CROSSING_PARTS
        if sign * cubic(right, y0, y1, y2, y3) > 0.0:
            for _ in range(BISECTIONS):
                middle = 0.5 * (left + right)
                if sign * cubic(middle, y0, y1, y2, y3) > 0.0:
                    right = middle
                else:
                    left = middle
            return right
        left = right
    return 2.0


@jit
def closes_inactive(chain, i, inactive, rate, end_rate, end_overlap):
    """True where a contact closes so slowly, and has so little energy at the end, that its closing may be passed over.

    `inactive` [m/s] is the velocity that does not count.
    """
    law, inverse_mass = chain.law, chain.inverse_mass
    if law[i, 0] > 0.0 or max(rate, end_rate) > inactive or end_overlap <= 0.0:
        return False
    push = (inverse_mass[i] + inverse_mass[i + 1]) * signed_force(law[i, 0], law[i, 1], law[i, 2], end_overlap)
    return push * end_overlap <= inactive * inactive


@jit
def find_event(chain, motion, trial, skip, inactive):
    """The earliest change of mode within the step: (contact, kind, part of the step); contact -1 where there is none.

    `skip` is a contact whose event is known; `inactive` [m/s] see `closes_inactive`.
    """
    law, overlap, rate, force, mode = chain.law, motion.overlap, motion.rate, motion.force, motion.mode
    d, f = trial.overlap, trial.force
    contact, kind, part = NO_CONTACT, NOTHING, 1.0
    for i in range(mode.size):
        if i == skip:
            continue
        if mode[i] == OPEN:
            if max(d[0, i], d[1, i], d[2, i]) <= 0.0 and not rate[i] > 0.0 > trial.rate[2, i]:
                continue  # no crossing, nor one and back
            if closes_inactive(chain, i, inactive, rate[i], trial.rate[2, i], d[2, i]):
                continue
            x = first_crossing(overlap[i], d[0, i], d[1, i], d[2, i], True, part)
            if x < part:
                contact, kind, part = i, CLOSES, x
        elif mode[i] == LOADED and is_continued(law, i):
            if min(d[0, i], d[1, i], d[2, i]) < 0.0:
                x = first_crossing(overlap[i], d[0, i], d[1, i], d[2, i], False, part)
                if x < part:
                    contact, kind, part = i, OPENS, x
        elif mode[i] == TOUCHING:
            slack = FORCE_SLACK * law[i, 0]
            low, high = force[i] + slack, force[i] - law[i, 0] - slack
            if min(f[0, i], f[1, i], f[2, i]) < -slack:
                x = first_crossing(low, f[0, i] + slack, f[1, i] + slack, f[2, i] + slack, False, part)
                if x < part:
                    contact, kind, part = i, OPENS, x
            top = law[i, 0] + slack
            if max(f[0, i], f[1, i], f[2, i]) > top:
                x = first_crossing(high, f[0, i] - top, f[1, i] - top, f[2, i] - top, True, part)
                if x < part:
                    contact, kind, part = i, YIELDS, x
    return contact, kind, part


@jit
def passing_yield(chain, motion, trial):
    """The part of the step at which a touching contact comes near to its preload, perhaps beyond it, and goes back again; 1
    where none does. The nodes of a long step may lie on either side of the peak, and the cubic is not fine enough to tell."""
    part = 1.0
    for i in range(motion.mode.size):
        if motion.mode[i] != TOUCHING:
            continue
        preload = chain.law[i, 0]
        y0, y1, y2, y3 = motion.force[i], trial.force[0, i], trial.force[1, i], trial.force[2, i]
        if max(y0, y1, y2, y3) < POSSIBLE_YIELD * preload:
            continue
        best, at = y0, 0
        for p in range(1, PEAK_PARTS + 1):
            y = cubic(p / PEAK_PARTS, y0, y1, y2, y3)
            if y > best:
                best, at = y, p
        if 0 < at < PEAK_PARTS and best > NEAR_YIELD * preload:
            before, after = cubic((at - 1) / PEAK_PARTS, y0, y1, y2, y3), cubic((at + 1) / PEAK_PARTS, y0, y1, y2, y3)
            bend = before - 2.0 * best + after
            shift = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
            part = min(part, (at + shift) / PEAK_PARTS)
    return part


@inlined
def miss_of(chain, motion, trial, i, kind, h):
    """By how much time the end of the step misses the event of contact i: one Newton step on its overlap or its force."""
    if motion.mode[i] != TOUCHING:
        speed = trial.rate[2, i]
        return -trial.overlap[2, i] / speed if speed != 0.0 else 0.0
    wanted = chain.law[i, 0] if kind == YIELDS else 0.0
    f1, f2, f3 = trial.force[0, i], trial.force[1, i], trial.force[2, i]
    c1, c2 = NODES[0], NODES[1]
    f23 = (f3 - f2) / (1.0 - c2)
    f12 = (f2 - f1) / (c2 - c1)
    speed = f23 + (1.0 - c2) * (f23 - f12) / (1.0 - c1)
    return h * (wanted - f3) / speed if speed != 0.0 else 0.0
