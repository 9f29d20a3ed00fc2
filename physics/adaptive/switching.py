"""What is carried out at a switch: the row's event, contacts that a step has carried past their opening, the start of a run."""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import ROUND_OFF, SHRINK
from softcradle.physics.adaptive.contact_modes import resolve_modes
from softcradle.physics.adaptive.event_location import (
    CLOSES,
    EASES,
    SLIPS,
    STOPS,
    TURNS,
    YIELDS,
    friction_needed,
    is_continued,
    most_friction,
)
from softcradle.physics.adaptive.fallback_step import fallback_step
from softcradle.physics.adaptive.flight import drift, next_event
from softcradle.physics.adaptive.sampling import keep_step
from softcradle.physics.adaptive.step_control import onset_step, restart_control
from softcradle.physics.adaptive.step_records import AT_ONCE, FLOWN, GROWTH, LAST, LOCAL_SQUARE, NEXT, PAST_STEP
from softcradle.physics.adaptive.stick_slip_friction import find_slides, put_drive, stop_bead, stop_beside
from softcradle.physics.adaptive.switch_log import log_switches
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.knots import drive_at
from softcradle.physics.numerics.law_curve import flow_into
from softcradle.physics.numerics.records import LOADED, OPEN, TOUCHING


@piece
def stop_rate(i, chain, motion):
    """Give the two beads of contact i the velocity of their centre of mass: this takes its rate and leaves momentum alone.

    Beside soft contacts, which are stiff where they are deep, and touching ones only the rate itself is set to 0.
    """
    inverse_mass, rate = chain.inverse_mass, motion.rate
    for k in range(max(i - 1, 0), min(i + 2, motion.mode.size)):
        if chain.law[k, 2] < 1.0 or motion.mode[k] == TOUCHING:
            rate[i] = 0.0
            return
    weight = inverse_mass[i] + inverse_mass[i + 1]
    impulse = rate[i] / weight if weight > 0.0 else 0.0
    if i > 0:
        rate[i - 1] += impulse * inverse_mass[i]
    if i + 1 < motion.mode.size:
        rate[i + 1] += impulse * inverse_mass[i + 1]
    if chain.anchor_bead == i:
        motion.anchor[1] -= impulse * inverse_mass[i]
    elif chain.anchor_bead == i + 1:
        motion.anchor[1] += impulse * inverse_mass[i + 1]
    rate[i] = 0.0


@inlined
def open_passed(row, event, chain, regime, motion, slow):
    """Open the contacts that the step has carried past d = 0; returns True where there are any."""
    any_passed = False
    for i in range(motion.mode.size):
        if (i == row and event < STOPS) or (is_continued(chain.law, i) and motion.mode[i] == LOADED):
            continue
        if motion.mode[i] == OPEN and motion.overlap[i] > 0.0:  # its event could not be met
            motion.mode[i] = LOADED
        elif motion.mode[i] == LOADED and motion.overlap[i] < 0.0:
            any_passed = True
            motion.force[i] = 0.0
            if abs(motion.rate[i]) > slow or flow_into(i, chain.inverse_mass, motion.force) > drive_at(chain, i, 0.0):
                motion.mode[i] = OPEN
            else:  # pushed from both sides, or not at all, and too slow to count: it stays at 0
                motion.overlap[i] = 0.0
                stop_rate(i, chain, motion)
            if regime.easing.size and regime.easing[i] != 0:
                regime.easing[i] = 0
                chain.law[i, 0], chain.law[i, 1] = regime.law[i, 0], regime.law[i, 1]
    return any_passed


@inlined
def slip(j, chain, regime, motion, slow, scratch):
    """Let bead j slip, unless contacts that are held can take up what its friction lacks."""
    resolve_modes(chain, regime, motion, slow, scratch)
    needed = friction_needed(j, chain, regime, motion.force, 0.0)
    if regime.slide[j] == 0 and abs(needed) >= (1.0 - ROUND_OFF) * regime.bed[j] / regime.inverse_mass[j]:
        regime.slide[j] = 1 if needed > 0.0 else -1


@piece
def slip_by(j, h, force, chain, regime, motion, slow, scratch):
    """Let bead j slip at once under contact forces (n,) that a step of length `h` has shown: at its start they are smaller."""
    needed = friction_needed(j, chain, regime, force, h)
    if abs(needed) > most_friction(j, chain, regime, h):
        regime.slide[j] = 1 if needed > 0.0 else -1
        resolve_modes(chain, regime, motion, slow, scratch)


@piece
def switch(row, event, time, chain, regime, motion, wanted, slow, scratch, log):
    """Carry out the event of a row; what is held is resolved anew in the whole chain."""
    control = scratch.control
    if event == STOPS:
        stop_bead(row, chain, regime, motion, slow, scratch.work[0])
    elif event == SLIPS:
        slip(row, chain, regime, motion, slow, scratch)
    elif event == TURNS:
        motion.rate[row] = 0.0
        stop_beside(row, chain, regime, motion, slow, scratch.work[0])
    elif event in (YIELDS, EASES):
        motion.mode[row], motion.held[row] = LOADED, 1
        if regime.easing.size:
            regime.easing[row] = 1 if event == EASES else 0
    elif motion.mode[row] == TOUCHING:
        motion.mode[row], motion.held[row] = OPEN, 1
    else:
        motion.overlap[row] = 0.0
    if event == CLOSES:
        restart_control(control, min(control[NEXT], onset_step(chain, row, motion.rate[row], wanted)))
    resolve_modes(chain, regime, motion, slow, scratch)
    control[PAST_STEP] = 0.0
    log_switches(time, time, motion, wanted, scratch, log)


@piece
def fly_to_event(time, end, chain, regime, motion, wanted, slow, negligible, trial, scratch, steps, log):
    """Open all loaded contacts, fly to the first event, and carry it out. Returns the time and the row (-1: none)."""
    for i in range(motion.mode.size):
        if motion.mode[i] == LOADED:
            motion.mode[i], motion.force[i] = OPEN, 0.0
    log_switches(time, time, motion, wanted, scratch, log)
    scratch.control[NEXT] = math.inf
    until, row, kind = next_event(time, end, chain, regime, motion, negligible, scratch.work[0])
    if until < math.inf:
        if steps.time.size:
            keep_step(time, until - time, FLOWN, chain, regime, motion, trial, steps, log.counter)
        drift(until - time, chain, regime, motion, scratch.work[0])
        time = until
    if row >= 0:
        switch(row, kind, time, chain, regime, motion, wanted, slow, scratch, log)
    return time, row


@piece
def begin(time, chain, regime, motion, wanted, slow, scratch, log):
    """Modes, first step and log at the start of a run."""
    first = math.inf
    for i in range(motion.mode.size):
        motion.held[i] = 0
    for j in range(regime.bed.size):
        scratch.work[1, j] = 0.0
    find_slides(chain, regime, motion, scratch.work[1], scratch.work[0])
    resolve_modes(chain, regime, motion, slow, scratch)
    for i in range(motion.mode.size):
        if motion.mode[i] == LOADED and motion.overlap[i] == 0.0:
            first = min(first, onset_step(chain, i, max(motion.rate[i], 0.0), wanted))
    restart_control(scratch.control, first)
    for k in (PAST_STEP, AT_ONCE, LOCAL_SQUARE, GROWTH):
        scratch.control[k] = 0.0
    for i in range(motion.mode.size):
        scratch.opened[i] = time if motion.overlap[i] < 0.0 else math.inf
        scratch.lateness[i] = scratch.grown[i] = scratch.most_grown[i] = 0.0
        scratch.course[i] = scratch.turns[i] = 0.0
    log_switches(time, time, motion, wanted, scratch, log)


@piece
def pass_knot(time, chain, regime, motion, wanted, slow, scratch, log):
    """Go on under the forces and brakes after a knot; what is held is resolved anew. Returns what `put_drive` does."""
    known = scratch.work[1]
    for j in range(regime.bed.size):
        known[j] = regime.bed[j]
    acts = put_drive(time, chain, regime)
    find_slides(chain, regime, motion, known, scratch.work[0])
    for i in range(motion.mode.size):
        motion.held[i] = 0
    resolve_modes(chain, regime, motion, slow, scratch)
    scratch.control[LAST], scratch.control[PAST_STEP] = 0.0, 0.0
    log_switches(time, time, motion, wanted, scratch, log)
    return acts


@piece
def fall_back(h, time, chain, regime, motion, wanted, slow, trial, scratch, log):
    """One step of the discrete gradient of length `h` at most; returns its length."""
    h = fallback_step(h, chain, motion, wanted, trial, scratch, log)
    if chain.knots.time.size:
        put_drive(time + h, chain, regime)
    resolve_modes(chain, regime, motion, slow, scratch)
    log_switches(time, time + h, motion, wanted, scratch, log)
    restart_control(scratch.control, h / SHRINK)
    scratch.control[PAST_STEP], scratch.control[AT_ONCE] = 0.0, 0.0
    return h
