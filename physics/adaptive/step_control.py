"""The controller of the step size of `radau` and `dop853`, and which of them takes the next step.

Errors near a singular time grade the steps: they shrink like the time that is left to an opening, and grow like the time
since an onset. So the next step is predicted from the last two (Gustafsson), and from when the next contact will open.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import (
    BEGINS,
    COST_RATIO,
    ENDS,
    FEW_TRIES,
    FIRST_PART,
    FURTHER_GROWTH,
    KINK,
    LEAST_PART,
    MOST_GROWTH,
    MOST_TRIES,
    NEARS,
    NEWTON_PART,
    PAST,
    ROUND_OFF,
    SAFETY,
    SHRINK,
    STIFF,
    TOLERANCE_PART,
)
from softcradle.physics.adaptive.corner_search import first_corner, first_root, stage_cubic
from softcradle.physics.adaptive.dop853 import dop853_step
from softcradle.physics.adaptive.radau import embedded_error, radau_step
from softcradle.physics.adaptive.step_records import (
    DOP853,
    EITHER,
    ERROR,
    ERROR_EXPONENT,
    LAST,
    LEFT,
    NEXT,
    RADAU,
    RADAU_NEXT,
    REACH,
    TRY_EVALUATIONS,
    UNLIMITED,
)
from softcradle.physics.numerics.elementary import log, power
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.law_curve import acceleration_of, curve_slope, is_continued, is_smooth
from softcradle.physics.numerics.records import EVALUATION, LOADED, NO_CONTACT, OPEN, REJECTED, STEP, ZERO


@inlined
def restart_control(control, h):
    """Forget the past; the next step is `h` at the most (inf: not known)."""
    control[NEXT], control[RADAU_NEXT], control[LAST] = h, h, 0.0
    control[LEFT] = math.inf


@piece
def onset_step(chain, i, speed, wanted):
    """First step after contact i closes at `speed`; inf if smooth.

    The error is its impulse L K (v h)**a h / (1+a); where a > 1 what dop853 misses of it, and half of the speed at the most.
    """
    exponent, stiffness = chain.law[i, 2], chain.law[i, 1]
    if exponent == 1.0 or stiffness == 0.0 or speed <= 0.0:
        return math.inf
    weight = (chain.inverse_mass[i] + chain.inverse_mass[i + 1]) * stiffness * power(speed, exponent)
    impulse = (1.0 + exponent) * wanted
    if exponent > 1.0:
        impulse = max(impulse, min(0.5 / BEGINS * wanted, 0.5 * (1.0 + exponent) * speed))
    return power(impulse / weight, 1.0 / (1.0 + exponent))


@piece
def first_step(chain, motion, scale):
    """A step to begin with where no onset gives one: a hundredth of the fastest local period or crossing."""
    fastest = 0.0
    for i in range(motion.mode.size):
        weight = chain.inverse_mass[i] + chain.inverse_mass[i + 1]
        preload, stiffness = chain.law[i, 0], chain.law[i, 1]
        if motion.mode[i] == LOADED and motion.overlap[i] != 0.0:
            slope = curve_slope(chain.law, chain.graph, i, motion.overlap[i], motion.force[i])
            fastest = max(fastest, math.sqrt(weight * slope))
        if motion.mode[i] != OPEN:
            push = max(abs(motion.force[i]), abs(preload))
            fastest = max(fastest, weight * push / scale, 1e-3 * math.sqrt(weight * stiffness))
        if chain.external.size:
            fastest = max(fastest, abs(chain.external[i]) / scale)
    return FIRST_PART / fastest if fastest > 0.0 else 1.0


@inlined
def soft_contacts(chain, motion, wanted):
    """(reach, left, push): longest step of dop853, beyond which a soft contact is stiff; time to the next opening of a soft
    contact if its rate stays, inf where none is near, and what this contact pushes until then [m/s]."""
    stiffest, left, push = 0.0, math.inf, 0.0
    for i in range(motion.mode.size):
        if motion.mode[i] != LOADED or chain.law[i, 2] >= 1.0:
            continue
        overlap, rate = motion.overlap[i], motion.rate[i]
        if overlap <= 0.0:
            stiffest = math.inf
            continue
        weight = chain.inverse_mass[i] + chain.inverse_mass[i + 1]
        stiff = weight * curve_slope(chain.law, chain.graph, i, overlap, motion.force[i])
        stiffest = max(stiffest, stiff)
        if rate < 0.0:
            time = -overlap / rate
            pushes = weight * motion.force[i] * time
            if time < left and time * time * stiff < 4.0 and pushes > TOLERANCE_PART * wanted:
                left, push = time, pushes
    reach = math.sqrt(STIFF / stiffest) if stiffest > 0.0 else math.inf
    return reach, left, push


@inlined
def before_opening(left, push, wanted):
    """A step that ends just before an opening, the closer the less it matters: its error is that of (t_o - t)**a."""
    return left * (0.9 if push > 1e3 * wanted else 0.99 if push > 10.0 * wanted else 0.999)


@piece
def limited_by_end(left, push, h, wanted):
    """The length of a step, `h` at the most, that a force like (t_o - t)**a, a > 1, allows which ends in the time `left`.

    It goes past the end where what is missed of the force is an error that holds, else as near to it as such errors allow.
    """
    missed = ENDS[0] if 2.0 * left < h else ENDS[1] if left < h else NEARS
    if SAFETY * left >= h or missed * push * h <= wanted:
        return h
    if 2.0 * ENDS[1] * push * left <= PAST * wanted:
        return left / PAST
    return left * min(SAFETY, power(wanted / (NEARS * push * left), 1.0 / 15.0))


@inlined
def limited_by_ends(h, chain, motion, wanted):
    """The length of a step of dop853, `h` at the most, that the next openings of contacts with a > 1 allow, by parabolas."""
    for i in range(motion.mode.size):
        overlap, rate = motion.overlap[i], motion.rate[i]
        if motion.mode[i] == LOADED and is_smooth(chain.law, chain.graph, i) and rate < 0.0 < overlap:
            square = rate * rate - 2.0 * overlap * acceleration_of(i, chain, motion.force, 0.0)
            left = 2.0 * overlap / (math.sqrt(square) - rate) if square > 0.0 else math.inf
            push = (chain.inverse_mass[i] + chain.inverse_mass[i + 1]) * motion.force[i]
            h = limited_by_end(left, push, h, wanted)
    return h


@inlined
def propose_step(control, rest, allowed, chain, motion, wanted):
    """(kind, h, near): the kind of the next step, its length, `rest` at the most, and whether a near opening limits it.

    `allowed` is the one kind that the method takes, or EITHER. dop853 alone lets soft contacts oscillate, so no opening of
    theirs predicts anything.
    """
    reach, left, push = soft_contacts(chain, motion, wanted)
    if allowed != EITHER:
        reach = math.inf if allowed == DOP853 else 0.0
    alone = allowed == DOP853
    if left < control[LEFT] < math.inf and not alone:
        control[NEXT] = min(control[NEXT], control[UNLIMITED] * left / control[LEFT])
    control[LEFT], control[REACH] = left, reach
    longest = min(control[RADAU_NEXT], control[NEXT])
    kind, h = RADAU, min(longest, rest)
    if min(reach, control[NEXT]) >= COST_RATIO * longest:
        kind, h = DOP853, min(reach, control[NEXT], rest)
    if left < h:
        return kind, SAFETY * left if alone else before_opening(left, push, wanted), not alone
    if kind == DOP853:
        limited = limited_by_ends(h, chain, motion, wanted)
        if limited < h:
            return kind, limited, True
        if h == reach:
            control[RADAU_NEXT] *= FURTHER_GROWTH
    return kind, h, False


@inlined
def update_control(control, h, kind, error, near, landing, rejected, wanted):
    """Set the next step from the error of this one, of length `h`. One that an opening or an event cut short predicts little.

    `rejected` is the length of the last step rejected for its error just before this one (inf: none): the next stays well below.
    """
    exponent, error = ERROR_EXPONENT[kind], max(error, 1e-300)
    grow = min(MOST_GROWTH, SAFETY * power(wanted / error, exponent))
    control[UNLIMITED] = h * grow
    if landing >= 0 or near:
        control[LAST] = 0.0
        control[NEXT] = max(control[NEXT], h * grow) if math.isfinite(control[NEXT]) else h * grow
        return
    if control[LAST] > 0.0:
        predicted = (h / control[LAST]) * power(control[ERROR] / error, exponent)
        if h < control[LAST]:
            grow = min(grow, SAFETY * predicted * power(wanted / error, exponent))
        elif math.isfinite(control[REACH]):
            grow = min(MOST_GROWTH, grow * min(max(predicted, 1.0), FURTHER_GROWTH))
    control[LAST], control[ERROR], control[NEXT] = h, max(error, NEWTON_PART * wanted), h * grow
    if kind == RADAU:
        control[RADAU_NEXT] = h * grow
    elif rejected < math.inf:
        control[NEXT] = min(control[NEXT], max(h, SAFETY * SAFETY * rejected))


@piece
def take_step(h, kind, firm, chain, motion, wanted, trial, scratch, log):
    """One step into `trial`; returns -1 where its stages do not converge, else the error of dop853. `firm`: beads may stick."""
    log.counter[EVALUATION] += TRY_EVALUATIONS[kind]
    if kind == DOP853:
        return dop853_step(h, TOLERANCE_PART * wanted, firm, chain, motion, trial, scratch)
    precision = NEWTON_PART * wanted
    used, tried = radau_step(h, chain, motion, precision, trial, scratch)
    log.counter[EVALUATION] += 3 * tried
    return 0.0 if used > 0 else -1.0


@inlined
def opened_early(h, chain, motion, trial, wanted):
    """The part of the step at which a contact opens that still pushes enough to matter; 1 where none does.

    No error estimate sees a force that ends between its nodes.
    """
    part, d = 1.0, trial.overlap
    for i in range(motion.mode.size):
        if (
            motion.mode[i] == LOADED
            and motion.overlap[i] > 0.0 > d[2, i]
            and not is_continued(chain.law, chain.graph, i)
        ):
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


@inlined
def find_step(time, h, kind, alone, most_steps, chain, regime, motion, bounds, trial, scratch, log):
    """Find the step that holds the error and ends at the first event in it, if any; `alone`: dop853 takes every step.

    Returns its length (0 with a corner: it is now; 0 without: its stages do not converge, or out of steps), error, the row and
    side of the corner, and the length of the last step rejected for its error (inf: none).
    """
    wanted, counter = bounds.wanted, log.counter
    rejected, inactive, length_before, error_before = math.inf, TOLERANCE_PART * wanted, h, 0.0
    row, side, tries, ceiling, looked, least = NO_CONTACT, ZERO, 0, h, 0, ROUND_OFF * h
    firm = regime.bed.size > 0
    while counter[STEP] + counter[REJECTED] < most_steps:
        error = take_step(h, kind, firm, chain, motion, wanted, trial, scratch, log)
        if kind == RADAU and error == 0.0:
            error = embedded_error(h, chain, motion, trial, scratch.work)
        if error < 0.0 or not math.isfinite(error):
            counter[REJECTED] += 1
            row, h = NO_CONTACT, SHRINK * h
            if time + h <= time:
                return 0.0, 0.0, NO_CONTACT, ZERO, rejected
            continue
        found, its_side, part, miss, near = first_corner(
            h, chain, regime, motion, trial, row, side, inactive, bounds.slow, scratch.work
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
        if ((found >= 0 and part * h < h + min(miss, 0.0)) or miss < -FIRST_PART * h) and h > least:
            # an event that was not met in so many tries, or that at which the step was to end: no step passes over it
            counter[REJECTED] += 1
            row, tries, h = NO_CONTACT, 0, SHRINK * h
            continue
        early = 1.0 if alone else opened_early(h, chain, motion, trial, wanted)
        if (error <= wanted and early == 1.0) or time + h <= time:
            if near < 1.0 and looked < FEW_TRIES and time + near * h > time:  # what is at the end of a step is exact
                looked, row, tries, h = looked + 1, NO_CONTACT, 0, near * h
                continue
            if miss > FIRST_PART * h:  # all tries are spent, and the step does not reach the corner
                row = NO_CONTACT
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
