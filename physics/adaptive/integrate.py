"""The loop around `radau` and `dop853`: step sizes, contact switches, free flight, the end of a collision.

Steps grade themselves into the singular times of soft contacts (onset, loss) by factors of up to 8. A sample inside a
step is one shorter step of the method from the start of that step, so it has the step's own accuracy, forces included.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.events import CLOSES, OPENS, YIELDS, is_continued, set_modes
from softcradle.physics.adaptive.fallback_step import fallback_step
from softcradle.physics.adaptive.sampling import flown, sample_flight, sample_inside
from softcradle.physics.adaptive.step import NEWTON_PART, find_step
from softcradle.physics.adaptive.step_control import (
    first_step,
    onset_step,
    propose_step,
    restart_control,
    update_control,
)
from softcradle.physics.adaptive.step_records import DOP853, LAST, NEXT, RADAU, Scratch, Trial
from softcradle.physics.adaptive.switch_log import find_openings, log_switches
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_curve import flow_into
from softcradle.physics.numerics.records import (
    DONE,
    LOADED,
    NO_CONTACT,
    OPEN,
    OUT_OF_STEPS,
    REJECTED,
    SAMPLE,
    SEPARATED,
    STEP,
    TOUCHING,
    ChainData,
    Motion,
    Samples,
    SwitchLog,
)

TOLERANCE_PART = 0.1  # of the tolerance: the error bound of each step
SLOW_PART = 1e-2  # of a step's error bound: a contact that arrives at d = 0 slower than this rests there
STILL_PART = 0.1  # of a step's error bound: a gap that closes slower than this counts as not closing
ROUND_OFF = 1e-15  # of the velocity scale: the least rate at which a gap closes
LAST_FORCE = 1e-11  # of the preload: a touching contact that carries less pushes no more
FALLBACK_PART = 0.25  # of a step that does not converge: the longest fallback step in its place
AFTER_FALLBACK = 4.0  # of the fallback step: the longest next step


@inlined
def nothing_pushes(chain, motion, negligible):
    """True where no contact pushes, or only with what gives less than `negligible` [m/s]."""
    for i in range(motion.mode.size):
        if motion.mode[i] == LOADED:
            weight = chain.inverse_mass[i] + chain.inverse_mass[i + 1]
            left = weight * max(motion.force[i], 0.0) * max(motion.overlap[i], 0.0)
            if left > negligible * negligible or motion.rate[i] > negligible:
                return False
        if motion.mode[i] == TOUCHING and motion.force[i] > LAST_FORCE * chain.law[i, 0]:
            return False
    return chain.external.size == 0


@inlined
def accept_step(kind, motion, trial, past):
    """Make the end of the trial the motion; its stages become the guess for the next step of radau."""
    if kind == RADAU:
        for i in range(motion.mode.size):
            past[0, i], past[4, i] = motion.force[i], motion.overlap[i]
            for k in range(3):
                past[1 + k, i], past[5 + k, i] = trial.force[k, i], trial.overlap[k, i]
    for i in range(motion.mode.size):
        motion.overlap[i], motion.rate[i], motion.force[i] = trial.overlap[2, i], trial.rate[2, i], trial.force[2, i]
        motion.held[i] = 0
        if motion.mode[i] == TOUCHING:
            motion.rate[i] = 0.0
    motion.anchor[0], motion.anchor[1] = trial.anchor[0], trial.anchor[1]


@jit
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
def open_passed(landing, chain, motion, slow):
    """Open the contacts that the step has carried past d = 0; returns True where there are any."""
    any_passed = False
    for i in range(motion.mode.size):
        if i == landing or (is_continued(chain.law, i) and motion.mode[i] == LOADED):
            continue
        if motion.mode[i] == OPEN and motion.overlap[i] > 0.0:  # its event could not be met
            motion.mode[i] = LOADED
        elif motion.mode[i] == LOADED and motion.overlap[i] < 0.0:
            any_passed = True
            motion.force[i] = 0.0
            drive = chain.external[i] if chain.external.size else 0.0
            if abs(motion.rate[i]) > slow or flow_into(i, chain.inverse_mass, motion.force) > drive:
                motion.mode[i] = OPEN
            else:  # pushed from both sides, or not at all, and too slow to count: it stays at 0
                motion.overlap[i] = 0.0
                stop_rate(i, chain, motion)
    return any_passed


@jit
def switch(landing, event, time, chain, motion, wanted, slow, scratch, log):
    """Carry out the event of contact `landing`; the forces of all touching contacts are solved anew."""
    control = scratch.control
    if event == CLOSES:
        restart_control(control, min(control[NEXT], onset_step(chain, landing, motion.rate[landing], wanted)))
    if motion.mode[landing] != TOUCHING:
        motion.overlap[landing] = 0.0
    elif event == YIELDS:
        motion.mode[landing], motion.held[landing] = LOADED, 1
    elif event == OPENS:
        motion.mode[landing], motion.held[landing] = OPEN, 1
    set_modes(chain, motion, slow, scratch.work)
    log_switches(time, time, motion, scratch.opening, log)


@jit
def fly(time, end, motion, negligible, samples, log):
    """Free flight to the first closing or to `end`. Returns the time and the contact that closes (-1: none, ever)."""
    flight, closing = math.inf, NO_CONTACT
    for i in range(motion.mode.size):
        if motion.rate[i] > negligible and -motion.overlap[i] / motion.rate[i] < flight:
            flight, closing = max(-motion.overlap[i] / motion.rate[i], 0.0), i
    until = min(time + flight, end)
    if until == math.inf:
        return time, NO_CONTACT
    sample_flight(time, until, motion, samples, log)
    for i in range(motion.mode.size):
        motion.overlap[i] = flown(motion.overlap[i], motion.rate[i], until - time)
        motion.held[i] = 0
    motion.anchor[0] += (until - time) * motion.anchor[1]
    return until, closing


@jit
def fly_to_closing(time, end, stop, chain, motion, wanted, slow, negligible, scratch, samples, log):
    """Open all loaded contacts, fly, and begin the contact that closes. Returns as :func:`fly`."""
    for i in range(motion.mode.size):
        if motion.mode[i] == LOADED:
            motion.mode[i], motion.force[i] = OPEN, 0.0
    log_switches(time, time, motion, scratch.opening, log)
    time, closing = fly(time, math.inf if stop else end, motion, negligible, samples, log)
    if closing >= 0 and time < end:
        motion.overlap[closing] = 0.0
        set_modes(chain, motion, slow, scratch.work)
        restart_control(scratch.control, onset_step(chain, closing, motion.rate[closing], wanted))
    return time, closing


@jit
def begin(time, chain, motion, wanted, slow, scratch, log):
    """Modes, first step and log at the start of a run."""
    first = math.inf
    for i in range(motion.mode.size):
        motion.held[i] = 0
    set_modes(chain, motion, slow, scratch.work)
    for i in range(motion.mode.size):
        if motion.mode[i] == LOADED and motion.overlap[i] == 0.0:
            first = min(first, onset_step(chain, i, max(motion.rate[i], 0.0), wanted))
    restart_control(scratch.control, first)
    log_switches(time, time, motion, scratch.opening, log)


@jit
def integrate(
    allowed, start, end, stop, most_steps, scale, tolerance, chain_fields, motion_fields, trial_fields, look_fields,
    scratch_fields, sample_fields, log_fields,
):  # fmt: skip
    """Integrate from `start` to `end` (or, with `stop`, until no contact can close again); the motion is moved in place.

    `allowed` is a kind of step or EITHER, `scale` the velocity [m/s] that `tolerance` is relative to. Records come as plain
    tuples of their fields; `look` is a second Trial, for what happens inside a step. Returns the status and the time reached.
    """
    chain, motion, samples = ChainData(*chain_fields), Motion(*motion_fields), Samples(*sample_fields)
    trial, look, scratch, log = (
        Trial(*trial_fields),
        Trial(*look_fields),
        Scratch(*scratch_fields),
        SwitchLog(*log_fields),
    )
    wanted = TOLERANCE_PART * tolerance * scale
    slow, negligible = SLOW_PART * wanted, max(STILL_PART * wanted, ROUND_OFF * scale)
    time, past_step, control, counter = start, 0.0, scratch.control, log.counter
    begin(time, chain, motion, wanted, slow, scratch, log)
    while True:
        sample_flight(time, time, motion, samples, log)
        if time >= end:
            return DONE, end
        if counter[STEP] + counter[REJECTED] >= most_steps:
            return OUT_OF_STEPS, time
        if nothing_pushes(chain, motion, negligible):
            time, closing = fly_to_closing(
                time, end, stop, chain, motion, wanted, slow, negligible, scratch, samples, log
            )  # fmt: skip
            if closing < 0 and stop:
                return SEPARATED, time
            if closing < 0 or time >= end:
                continue
            past_step = 0.0
        if not math.isfinite(control[NEXT]):
            restart_control(control, first_step(chain, motion, scale))
        kind, proposed, near = propose_step(control, end - time, allowed, chain, motion, wanted)
        h, error, landing, event, rejected = find_step(
            time, proposed, kind, allowed == DOP853, chain, motion, wanted, past_step, trial, scratch, log, most_steps
        )
        if h == 0.0:
            if counter[STEP] + counter[REJECTED] >= most_steps:
                return OUT_OF_STEPS, time
            h = fallback_step(FALLBACK_PART * proposed, chain, motion, wanted, trial, scratch, log)
            set_modes(chain, motion, slow, scratch.work)
            log_switches(time, time + h, motion, scratch.opening, log)
            restart_control(control, AFTER_FALLBACK * h)
            time, past_step = time + h, 0.0
            continue
        update_control(control, h, kind, error, near and h == proposed, landing, rejected, wanted)
        find_openings(h, kind, chain, motion, wanted, past_step, trial, look, scratch, log)
        if counter[SAMPLE] < samples.time.size and samples.time[counter[SAMPLE]] < time + h:
            precision = NEWTON_PART * wanted
            sample_inside(time, h, kind, chain, motion, precision, past_step, look, scratch, samples, log)
        accept_step(kind, motion, trial, scratch.past)
        before, time = time, time + h if h < end - time else end
        past_step = h if kind == RADAU else 0.0
        counter[STEP] += 1
        if open_passed(landing, chain, motion, slow):
            control[LAST] = 0.0
        log_switches(before, time, motion, scratch.opening, log)
        if landing >= 0:
            past_step = 0.0
            switch(landing, event, time, chain, motion, wanted, slow, scratch, log)
