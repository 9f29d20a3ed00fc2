"""The loop around `radau` and `dop853`: step sizes, contact switches, free flight, the end of a collision.

Steps grade themselves into the singular times of soft contacts (onset, loss) by factors of up to 8.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import FEW_TRIES, FULL_SPEED, NEWTON_PART, ROUND_OFF, TOLERANCE_PART
from softcradle.physics.adaptive.corner_action import begin, cross, fly_to_event, open_passed, pass_knot
from softcradle.physics.adaptive.flight import back_to_opening, nothing_pushes
from softcradle.physics.adaptive.row_graphs import friction_needed, most_friction, put_drive
from softcradle.physics.adaptive.sampling import absorb, accept_step, keep_step
from softcradle.physics.adaptive.step_control import (
    find_step,
    first_step,
    propose_step,
    restart_control,
    update_control,
)
from softcradle.physics.adaptive.step_records import (
    AT_ONCE,
    DOP853,
    LAST,
    LOCAL_SQUARE,
    NEXT,
    RESTED,
    START,
    Accuracy,
    Bounds,
    Regime,
    Scratch,
    Steps,
    Trial,
)
from softcradle.physics.adaptive.switch_log import end_within_bounces, find_openings, grow_errors, log_switches
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.jit import inlined, piece, whole
from softcradle.physics.numerics.knots import BESIDE, next_knot
from softcradle.physics.numerics.meeting import meets_again
from softcradle.physics.numerics.records import (
    DONE,
    FLIGHT,
    FROZEN,
    KEPT,
    OUT_OF_STEPS,
    PAUSED,
    REJECTED,
    SEPARATED,
    STEP,
    ChainData,
    Extent,
    Motion,
    SwitchLog,
)


@piece
def nothing_moves(least, chain, regime, motion, velocity):
    """True where no bead is faster than `least` [m/s], and friction holds each, or forces balance on it where no bed brakes it.

    A bead that creeps as a soft contact damps it would do so for ever, for it never turns; and one that sticks beside it has
    a velocity within the precision of the stages. `velocity` (n+1,) is scratch.
    """
    for i in range(motion.rate.size):
        if abs(motion.rate[i]) > 2.0 * least:
            return False
    bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
    for j in range(velocity.size):
        held = ROUND_OFF * largest_force(j, chain, motion)
        if regime.bed[j] > 0.0:
            held += most_friction(j, chain, regime, 0.0)
        pushed = regime.inverse_mass[j] > 0.0 and abs(friction_needed(j, chain, regime, motion.force, 0.0)) > held
        if pushed or abs(velocity[j]) > (least if regime.bed[j] > 0.0 else 0.0):
            return False
    return True


@inlined
def largest_force(j, chain, motion):
    """The largest of the forces on bead j."""
    found = abs(chain.push[j]) if chain.push.size else 0.0
    for i in range(max(j - 1, 0), min(j + 1, motion.force.size)):
        found = max(found, abs(motion.force[i]), abs(chain.law[i, 0]))
    return found


@inlined
def put_to_rest(regime, motion):
    """Take all velocities: friction holds all beads."""
    for i in range(motion.rate.size):
        motion.rate[i] = 0.0
    for j in range(regime.slide.size):
        regime.slide[j] = 0
    motion.anchor[1] = 0.0


@inlined
def any_frozen(motion):
    """Whether a contact is held closed between beads that do not move."""
    found = False
    for i in range(motion.mode.size):
        found |= motion.mode[i] == FROZEN and motion.overlap[i] > 0.0
    return found


@whole
def integrate(
    extent_fields, pause, accuracy_fields, chain_fields, regime_fields, motion_fields, trial_fields, look_fields,
    scratch_fields, steps_fields, log_fields,
):  # fmt: skip
    """Integrate over an Extent; the motion is moved in place.

    `pause` is whether the run is resumed, and the steps, rejected ones included, after which it hands back: the status then, or
    where no row for another step is left, is PAUSED, and a call that is resumed goes on from the time reached.
    Records come as plain tuples of their fields; `look` is a second Trial, for what happens inside a step. Returns the status
    and the time reached. Overlaps of couplers are left as they are counted here, from the origins of their segments.
    """
    (time, end, stop, most_steps), (resumed, budget) = Extent(*extent_fields), pause
    allowed, tolerance, scale = Accuracy(*accuracy_fields)
    chain, motion, steps = ChainData(*chain_fields), Motion(*motion_fields), Steps(*steps_fields)
    regime, trial, look = Regime(*regime_fields), Trial(*trial_fields), Trial(*look_fields)
    scratch, log = Scratch(*scratch_fields), SwitchLog(*log_fields)
    wanted = TOLERANCE_PART * tolerance * scale
    least = max(TOLERANCE_PART * wanted, ROUND_OFF * scale)
    bounds = Bounds(wanted, NEWTON_PART * wanted, least, FULL_SPEED * scale)
    control, counter, firm = scratch.control, log.counter, regime.bed.size > 0
    timed, acts, until = chain.knots.time.size > 0, False, next_knot(time, end, chain.knots)
    if timed:
        acts = put_drive(time, chain, regime)
    if not resumed:
        begin(time, chain, regime, motion, bounds, scratch, log)
    while True:
        if time >= end:
            end_within_bounces(end - control[START], chain, motion, wanted, scratch)
            return DONE, end
        if time >= until:
            acts = pass_knot(time, chain, regime, motion, bounds, scratch, log)
            until = next_knot(time, end, chain.knots)
        spent = counter[STEP] + counter[REJECTED]
        if spent >= most_steps:
            return OUT_OF_STEPS, time
        if spent >= budget or (steps.time.size > 0 and counter[KEPT] == steps.time.size):
            return PAUSED, time
        if firm and not acts and nothing_moves(bounds.negligible, chain, regime, motion, scratch.work[0]):
            put_to_rest(regime, motion)
            if until == end:
                return (SEPARATED, time) if stop else (DONE, end)
            keep_step(time, until - time, RESTED, chain, regime, motion, steps, counter)
            time = until
            continue
        if not acts and nothing_pushes(chain, regime, motion, bounds.negligible):
            apart = stop and firm and until == end and not any_frozen(motion)  # what stays closed may only come to rest
            if apart and not meets_again(chain, regime.bed, motion, bounds.negligible, scratch.work[0]):
                return SEPARATED, back_to_opening(time, chain, regime, motion, scratch)
            time, row = fly_to_event(time, until, chain, regime, motion, bounds, scratch, steps, log)
            if row < 0 and stop and until == end:
                return SEPARATED, time
            counter[FLIGHT] += 1
            if counter[FLIGHT] >= most_steps:
                return OUT_OF_STEPS, time
            continue
        if not math.isfinite(control[NEXT]):
            restart_control(control, first_step(chain, motion, scale))
        kind, proposed, near = propose_step(control, until - time, allowed, chain, motion, wanted)
        h, error, row, side, rejected = find_step(
            time, proposed, kind, allowed == DOP853, most_steps, chain, regime, motion, bounds, trial, scratch, log
        )
        if h == 0.0 and row >= 0 and control[AT_ONCE] < FEW_TRIES * (motion.mode.size + regime.bed.size):
            control[AT_ONCE] += 1.0
            cross(row, side, time, chain, regime, motion, bounds, scratch, log)
            continue
        if h == 0.0:
            return OUT_OF_STEPS, time
        update_control(control, h, kind, error, near and h == proposed, row, rejected, wanted)
        control[AT_ONCE] = 0.0
        control[LOCAL_SQUARE] += error * error
        find_openings(h, kind, firm, chain, motion, wanted, trial, look, scratch, log)
        keep_step(time, h, kind, chain, regime, motion, steps, counter)
        absorb(h, chain, regime, motion, trial, scratch.work, motion.taken)
        accept_step(motion, trial)
        before, time = time, time + h if h < until - time else until
        if timed:  # at a knot those just before it, even where the step to it is as short as the last digit of the time
            beside = time if time < until else before + (1.0 - BESIDE) * (time - before)
            acts = put_drive(beside if beside < until else before, chain, regime)
        counter[STEP] += 1
        if open_passed(row, h, time, chain, regime, motion, trial, bounds, scratch):
            control[LAST] = 0.0
        log_switches(before, time, row, chain, regime, motion, bounds, scratch, log)
        grow_errors(row, side, before, chain, regime, motion, wanted, scale, scratch)
        if row >= 0:
            cross(row, side, time, chain, regime, motion, bounds, scratch, log)
