"""One step tried, and the search for one that holds the error and ends at the first event in it."""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import (
    FEW_TRIES,
    KINK,
    LEAST_PART,
    MOST_TRIES,
    NEWTON_PART,
    ROUND_OFF,
    SAFETY,
    SHRINK,
    TOLERANCE_PART,
)
from softcradle.physics.adaptive.corners import first_corner, first_root, is_continued, stage_cubic
from softcradle.physics.adaptive.dop853 import dop853_step
from softcradle.physics.adaptive.radau import radau_step
from softcradle.physics.adaptive.radau_error import embedded_error
from softcradle.physics.adaptive.radau_guess import AFTER
from softcradle.physics.adaptive.step_records import DOP853, ERROR_EXPONENT, TRY_EVALUATIONS
from softcradle.physics.numerics.elementary import log, power
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.records import EVALUATION, LOADED, NO_CONTACT, OPEN, REJECTED, STEP, ZERO


@piece
def take_step(h, kind, firm, chain, motion, wanted, past_step, origin, trial, scratch, log):
    """One step into `trial`; returns -1 where its stages do not converge, else the error of dop853. `firm`: beads may stick."""
    log.counter[EVALUATION] += TRY_EVALUATIONS[kind]
    if kind == DOP853:
        return dop853_step(h, TOLERANCE_PART * wanted, firm, chain, motion, trial, scratch)
    precision = NEWTON_PART * wanted
    used, tried = radau_step(h, chain, motion, precision, past_step, origin, trial, scratch)
    log.counter[EVALUATION] += 3 * tried
    return 0.0 if used > 0 else -1.0


@inlined
def try_step(h, kind, firm, chain, motion, wanted, past_step, trial, scratch, log):
    """One step that may be taken; returns its error as a velocity [m/s], negative where its stages do not converge."""
    error = take_step(h, kind, firm, chain, motion, wanted, past_step, AFTER, trial, scratch, log)
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
            if x < part and ((soft and x < SAFETY and x * push > wanted) or (not soft and KINK * push > wanted)):
                part = x
    return part


@inlined
def measured_exponent(exponent, h, error, length_before, error_before):
    """One over the order of the error as two rejected tries of a step show it: at a soft onset it is 1 + a, no more."""
    if error < error_before and h < length_before:
        return max(exponent, min(1.0, log(length_before / h) / log(error_before / error)))
    return exponent


@piece
def find_step(time, h, kind, alone, chain, regime, motion, wanted, slow, past_step, trial, scratch, log, most_steps):
    """Find the step that holds the error and ends at the first event in it, if any; `alone`: dop853 takes every step.

    Returns its length (0 with a corner: it is now; 0 without: its stages do not converge, or out of steps), error, the row and
    side of the corner, and the length of the last step rejected for its error (inf: none).
    """
    rejected, inactive, counter, length_before, error_before = math.inf, TOLERANCE_PART * wanted, log.counter, h, 0.0
    row, side, tries, ceiling, looked, least = NO_CONTACT, ZERO, 0, h, 0, ROUND_OFF * h
    firm = regime.bed.size > 0
    while counter[STEP] + counter[REJECTED] < most_steps:
        error = try_step(h, kind, firm, chain, motion, wanted, past_step, trial, scratch, log)
        if error < 0.0 or not math.isfinite(error):
            counter[REJECTED] += 1
            row, h = NO_CONTACT, SHRINK * h
            if time + h <= time:
                return 0.0, 0.0, NO_CONTACT, ZERO, rejected
            continue
        found, its_side, part, miss, near = first_corner(
            h, chain, regime, motion, trial, row, side, inactive, slow, scratch.work
        )
        if math.isnan(miss):  # none is landed on, or what looked like one from further off
            row, tries, miss = NO_CONTACT, tries + (1 if row >= 0 else 0), 0.0
        if found >= 0 and row < 0 and time + part * h <= time and (error <= wanted or h <= least):
            return 0.0, 0.0, found, its_side, rejected
        if row >= 0:
            closes = row < motion.mode.size and motion.mode[row] == OPEN
            is_inactive = closes and abs(trial.rate[2, row]) <= inactive
            most_tries = FEW_TRIES if is_inactive else MOST_TRIES
            if tries < most_tries and found >= 0 and part * h < h + min(miss, 0.0):
                row, side, h = found, its_side, part * h
                tries += 1
                continue
            if tries < most_tries and abs(miss) > ROUND_OFF * h and time + miss != time and h > least:
                h = min(max(h + miss, LEAST_PART * h), ceiling)
                tries += 1
                continue
        elif found >= 0 and tries < MOST_TRIES:
            ceiling, tries = h, tries + 1
            if part < LEAST_PART and h > least and time + LEAST_PART * h > time:
                h *= LEAST_PART  # the polynomial of a long step is coarse near its start
            else:
                row, side, h = found, its_side, part * h
            continue
        if found >= 0 and part * h < h + min(miss, 0.0) and h > least:
            # an event that was not met in so many tries: no step passes over it
            counter[REJECTED] += 1
            row, tries, h = NO_CONTACT, 0, SHRINK * h
            continue
        early = 1.0 if alone else opened_early(h, chain, motion, trial, wanted)
        if (error <= wanted and early == 1.0) or time + h <= time:
            if near < 1.0 and looked < FEW_TRIES and time + near * h > time:  # what is at the end of a step is exact
                looked, row, tries, h = looked + 1, NO_CONTACT, 0, near * h
                continue
            return h, error, row, side, rejected
        counter[REJECTED] += 1
        row, tries = NO_CONTACT, 0  # a shorter step has events of its own
        if early < 1.0 and error <= 10.0 * wanted:
            h *= SAFETY * early
            continue
        rejected = h if early == 1.0 else rejected
        exponent = measured_exponent(ERROR_EXPONENT[kind], h, error, length_before, error_before)
        length_before, error_before = h, error
        h *= max(LEAST_PART, SAFETY * power(wanted / error, exponent))
    return 0.0, 0.0, NO_CONTACT, ZERO, rejected
