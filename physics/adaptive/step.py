"""One step tried, and the search for one that holds the error and ends at the first event in it."""

from __future__ import annotations

import math

from softcradle.physics.adaptive.dop853 import KINK, dop853_step
from softcradle.physics.adaptive.events import (
    CLOSES,
    NOTHING,
    find_event,
    guard_at_end,
    is_continued,
    near_switch,
)
from softcradle.physics.adaptive.first_root import first_root, stage_cubic
from softcradle.physics.adaptive.radau import MOST_NEWTON, radau_step
from softcradle.physics.adaptive.radau_error import embedded_error
from softcradle.physics.adaptive.radau_guess import AFTER, NO_GUESS
from softcradle.physics.adaptive.step_records import DOP853, ERROR_EXPONENT, TRY_EVALUATIONS
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.records import EVALUATION, LOADED, NO_CONTACT, REJECTED, STEP

NEWTON_PART = 1e-2  # of a step's error bound: precision to which the stages are solved
INACTIVE_PART = 10.0  # of that precision: a velocity below which a contact is inactive
LEAST_SHRINK = 0.1  # of a rejected step: the next try is no shorter
SAFETY = 0.9  # of the step size that the error estimate allows
LANDING_TRIES = 20  # tries to end a step at an event
INACTIVE_TRIES = 3  # tries at an event of an inactive contact
EARLY = 0.1  # part of a step: an event before it is sought again in a step of this part
AT_ONCE = 1e-12  # part of the step tried first: an event before it is one of its start
LATE = 0.95  # part of a step: a contact that opens after it has pushed through the step
LANDED = 1e-13  # of a step: an event this near to its end is met
MOST_LOOKS = 2  # at a guard that comes near to zero within one step
MOST_FAILURES = 6  # tries of one step whose stages do not converge, before the fallback step


@jit
def take_step(h, kind, firm, chain, motion, precision, past_step, origin, trial, scratch, log):
    """One step into `trial`; returns -1 where its stages do not converge, else the error of dop853. `firm`: beads may stick."""
    log.counter[EVALUATION] += TRY_EVALUATIONS[kind]
    if kind == DOP853:
        return dop853_step(h, INACTIVE_PART * precision, firm, chain, motion, trial, scratch)
    used = radau_step(h, chain, motion, precision, past_step, origin, trial, scratch)
    log.counter[EVALUATION] += 3 * (used if used > 0 else MOST_NEWTON)
    if used == 0:
        used = radau_step(h, chain, motion, precision, NO_GUESS, AFTER, trial, scratch)
        log.counter[EVALUATION] += 3 * (used if used > 0 else MOST_NEWTON)
    return 0.0 if used > 0 else -1.0


@inlined
def try_step(h, kind, firm, chain, motion, precision, past_step, trial, scratch, log):
    """One step that may be taken; returns its error as a velocity [m/s], negative where its stages do not converge."""
    error = take_step(h, kind, firm, chain, motion, precision, past_step, AFTER, trial, scratch, log)
    return error if kind == DOP853 or error < 0.0 else embedded_error(h, chain, motion, trial, scratch.work)


@inlined
def opened_early(h, chain, motion, trial, wanted):
    """The part of the step at which a contact opens that still pushes enough to matter; 1 where none does.

    No error estimate sees a force that ends between its nodes.
    """
    part, d = 1.0, trial.overlap
    for i in range(motion.mode.size):
        if motion.mode[i] == LOADED and motion.overlap[i] > 0.0 > d[2, i] and not is_continued(chain.law, i):
            soft = chain.law[i, 2] < 1.0
            x = first_root(stage_cubic(motion.overlap[i], d[0, i], d[1, i], d[2, i]))
            push = (chain.inverse_mass[i] + chain.inverse_mass[i + 1]) * motion.force[i] * h
            if x < part and ((soft and x < LATE and x * push > wanted) or (not soft and KINK * push > wanted)):
                part = x
    return part


@jit
def find_step(time, h, kind, alone, chain, regime, motion, wanted, slow, past_step, trial, scratch, log, most_steps):
    """Find the step that holds the error and ends at the first event in it, if any; `alone`: dop853 takes every step.

    Returns its length (0 with an event: it is now; 0 without: its stages do not converge, or out of steps), error, the row and
    kind of the event, and the length of the last step rejected for its error (inf: none).
    """
    rejected, inactive, counter = math.inf, INACTIVE_PART * NEWTON_PART * wanted, log.counter
    row, event, tries, failures, ceiling, looked, least = NO_CONTACT, NOTHING, 0, 0, h, 0, AT_ONCE * h
    firm, work = regime.bed.size > 0, scratch.work
    while counter[STEP] + counter[REJECTED] < most_steps:
        error = try_step(h, kind, firm, chain, motion, NEWTON_PART * wanted, past_step, trial, scratch, log)
        if error < 0.0 or not math.isfinite(error):
            counter[REJECTED] += 1
            failures += 1
            row, h = NO_CONTACT, 0.25 * h
            if failures > MOST_FAILURES or time + h <= time:
                return 0.0, 0.0, NO_CONTACT, NOTHING, rejected
            continue
        miss = 0.0
        if row >= 0:
            value, slope = guard_at_end(h, row, event, chain, regime, motion, trial, work)
            if slope < 0.0:
                miss = -value / slope
            else:  # what looked, from further off, like an event
                row, tries = NO_CONTACT, tries + 1
        found, its_event, part = find_event(h, chain, regime, motion, trial, row, event, inactive, slow, work)
        if found >= 0 and row < 0 and time + part * h <= time and (error <= wanted or h <= least):
            return 0.0, 0.0, found, its_event, rejected
        if row >= 0:
            is_inactive = event == CLOSES and abs(trial.rate[2, row]) <= inactive
            most_tries = INACTIVE_TRIES if is_inactive else LANDING_TRIES
            if tries < most_tries and found >= 0 and part * h < h + min(miss, 0.0):
                row, event, h = found, its_event, part * h
                tries += 1
                continue
            if tries < most_tries and abs(miss) > LANDED * h and time + miss != time and h > least:
                h = min(max(h + miss, 0.1 * h), ceiling)
                tries += 1
                continue
        elif found >= 0 and tries < LANDING_TRIES:
            ceiling, tries = h, tries + 1
            if part < EARLY and h > least and time + EARLY * h > time:
                h *= EARLY  # the polynomial of a long step is coarse near its start
            else:
                row, event, h = found, its_event, part * h
            continue
        early = 1.0 if alone else opened_early(h, chain, motion, trial, wanted)
        if (error <= wanted and early == 1.0) or time + h <= time:
            near = 1.0 if looked == MOST_LOOKS else near_switch(h, chain, regime, motion, trial, slow)
            if near < 1.0 and time + near * h > time:  # what is at the end of a step is exact
                looked, row, tries, h = looked + 1, NO_CONTACT, 0, near * h
                continue
            return h, error, row, event, rejected
        counter[REJECTED] += 1
        if early < 1.0 and error <= 10.0 * wanted:
            h, row = 0.9 * early * h, NO_CONTACT
            continue
        rejected = h if early == 1.0 else rejected
        h *= max(LEAST_SHRINK, SAFETY * (wanted / error) ** ERROR_EXPONENT[kind])
        row = NO_CONTACT
    return 0.0, 0.0, NO_CONTACT, NOTHING, rejected
