"""Step size controller of `radau` and `dop853`, the choice between the two, and the search for an accepted step.

Near a singular time the errors determine the step lengths: the steps shrink like the time left until an opening, and
grow like the time since an onset. So the next step is predicted from the last two (controller of Gustafsson; Hairer &
Wanner, Solving ODEs II, IV.8) and from the time of the next opening.
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
    Target,
)
from softcradle.physics.numerics.elementary import log, power
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.knots import drive_at
from softcradle.physics.numerics.law_curve import acceleration_of, curve_slope, is_continued, is_smooth, larger
from softcradle.physics.numerics.records import EVALUATION, LOADED, NO_CONTACT, OPEN, REJECTED, STEP, ZERO


@inlined
def restart_control(control, h):
    """Forget the previous steps. The next step is at most `h` (inf: not known)."""
    control[NEXT], control[RADAU_NEXT], control[LAST] = h, h, 0.0
    control[LEFT] = math.inf


@piece
def onset_step(chain, i, speed, wanted):
    """Return the length of the first step after contact i closes at `speed`; inf if its law is linear.

    The error of the step is the impulse L K (v h)**a h / (1+a). For a > 1 it is only the part of the impulse that
    dop853 misses, and at most half of the speed.
    """
    exponent, stiffness = chain.law[i, 2], chain.law[i, 1]
    if exponent == 1.0 or stiffness == 0.0 or speed <= 0.0:
        return math.inf
    # Solve error(h) = `wanted` for h.
    weight = (chain.inverse_mass[i] + chain.inverse_mass[i + 1]) * stiffness * power(speed, exponent)
    impulse = (1.0 + exponent) * wanted
    if exponent > 1.0:
        impulse = max(impulse, min(0.5 / BEGINS * wanted, 0.5 * (1.0 + exponent) * speed))
    return power(impulse / weight, 1.0 / (1.0 + exponent))


@piece
def first_step(chain, motion, scale):
    """Return a first step if no onset gives one: a hundredth of the fastest local period or crossing time."""
    fastest = 0.0
    for i in range(motion.mode.size):
        weight = chain.inverse_mass[i] + chain.inverse_mass[i + 1]
        preload, stiffness = chain.law[i, 0], chain.law[i, 1]
        # Local period of a loaded contact.
        if motion.mode[i] == LOADED and motion.overlap[i] != 0.0:
            slope = curve_slope(chain.law, chain.graph, i, motion.overlap[i], motion.force[i])
            fastest = max(fastest, math.sqrt(weight * slope))
        # Time in which the force of a closed contact changes the velocities by the scale.
        if motion.mode[i] != OPEN:
            push = max(abs(motion.force[i]), abs(preload))
            fastest = max(fastest, weight * push / scale, 1e-3 * math.sqrt(weight * stiffness))
        if chain.external.size:
            fastest = max(fastest, abs(chain.external[i]) / scale)
    fastest = max(fastest, math.sqrt(chain.strings.square))  # strings swing more slowly than contacts
    return FIRST_PART / fastest if fastest > 0.0 else 1.0


@inlined
def soft_contacts(chain, motion, wanted):
    """Return (reach, left, push) of the soft contacts.

    `reach` is the longest step of dop853, beyond which a soft contact is stiff. `left` is the time to the next opening
    of a soft contact at its present rate, inf if none is near. `push` is the velocity change by this contact until then
    [m/s].
    """
    stiffest, left, push = 0.0, math.inf, 0.0
    for i in range(motion.mode.size):
        if motion.mode[i] != LOADED or chain.law[i, 2] >= 1.0:
            continue
        overlap, rate = motion.overlap[i], motion.rate[i]
        # At d = 0 the law of a soft contact is vertical: infinitely stiff.
        if overlap <= 0.0:
            stiffest = math.inf
            continue
        weight = chain.inverse_mass[i] + chain.inverse_mass[i + 1]
        stiff = weight * curve_slope(chain.law, chain.graph, i, overlap, motion.force[i])
        stiffest = max(stiffest, stiff)
        # An opening is predicted if the contact cannot oscillate before it (time² times frequency² < 4) and its push
        # matters.
        if rate < 0.0:
            time = -overlap / rate
            pushes = weight * motion.force[i] * time
            if time < left and time * time * stiff < 4.0 and pushes > TOLERANCE_PART * wanted:
                left, push = time, pushes
    reach = math.sqrt(STIFF / stiffest) if stiffest > 0.0 else math.inf
    return reach, left, push


@inlined
def before_opening(left, push, wanted):
    """Return the length of a step that ends just before an opening. Its error is that of a force (t_o - t)**a.

    The smaller the remaining push is, the closer to the opening the step may end.
    """
    return left * (0.9 if push > 1e3 * wanted else 0.99 if push > 10.0 * wanted else 0.999)


@piece
def limited_by_end(left, push, h, wanted):
    """Return the longest allowed step, at most `h`, if a force like (t_o - t)**a with a > 1 ends after the time `left`.

    The step goes past the end of the force if the missed part of the force is a tolerable error. Otherwise it ends as
    close to the end as the error allows.
    """
    # The force ends in the first half, in the second half, or after the step: the missed fraction differs (see
    # `constants`).
    missed = ENDS[0] if 2.0 * left < h else ENDS[1] if left < h else NEARS
    if SAFETY * left >= h or missed * push * h <= wanted:
        return h
    # Put the end of the force into the second half of a longer step if that error is tolerable; otherwise stop before
    # it.
    if 2.0 * ENDS[1] * push * left <= PAST * wanted:
        return left / PAST
    return left * min(SAFETY, power(wanted / (NEARS * push * left), 1.0 / 15.0))


@inlined
def limited_by_ends(h, chain, motion, wanted):
    """Return the longest step of dop853, at most `h`, that the next openings of contacts with a > 1 allow."""
    for i in range(motion.mode.size):
        overlap, rate = motion.overlap[i], motion.rate[i]
        if motion.mode[i] == LOADED and is_smooth(chain.law, chain.graph, i) and rate < 0.0 < overlap:
            # Time of the opening, by the parabola through overlap, rate and acceleration.
            square = rate * rate - 2.0 * overlap * acceleration_of(i, chain, overlap, motion.force, 0.0)
            left = 2.0 * overlap / (math.sqrt(square) - rate) if square > 0.0 else math.inf
            push = (chain.inverse_mass[i] + chain.inverse_mass[i + 1]) * motion.force[i]
            h = limited_by_end(left, push, h, wanted)
    return h


@inlined
def propose_step(control, rest, allowed, chain, motion, wanted):
    """Return (kind, h, near): the kind of the next step, its length (at most `rest`), and whether a near opening limits
    it.

    `allowed` is the only kind that the method takes, or EITHER. dop853 as the only method lets soft contacts oscillate,
    so their openings predict nothing.
    """
    reach, left, push = soft_contacts(chain, motion, wanted)
    if allowed != EITHER:
        reach = math.inf if allowed == DOP853 else 0.0
    alone = allowed == DOP853
    # Steps shrink in proportion to the time left until an opening.
    if left < control[LEFT] < math.inf and not alone:
        control[NEXT] = min(control[NEXT], control[UNLIMITED] * left / control[LEFT])
    control[LEFT], control[REACH] = left, reach
    # dop853 takes the step unless the step of radau would be much longer, see COST_RATIO.
    longest = min(control[RADAU_NEXT], control[NEXT])
    kind, h = RADAU, min(longest, rest)
    if min(reach, control[NEXT]) >= COST_RATIO * longest:
        kind, h = DOP853, min(reach, control[NEXT], rest)
    # A soft contact opens within the step: end just before it.
    if left < h:
        return kind, SAFETY * left if alone else before_opening(left, push, wanted), not alone
    if kind == DOP853:
        limited = limited_by_ends(h, chain, motion, wanted)
        if limited < h:
            return kind, limited, True
        # Only stiffness limits dop853, so the step of radau may grow meanwhile.
        if h == reach:
            control[RADAU_NEXT] *= FURTHER_GROWTH
    return kind, h, False


@inlined
def update_control(control, h, kind, error, near, landing, rejected, wanted):
    """Set the next step from the error of this step of length `h`. A step that an opening or an event cut short
    predicts little.

    `rejected` is the length of the last attempt that was rejected for its error just before this step (inf: none). The
    next step stays well below it.
    """
    # Standard controller: the error varies with a power of the step length.
    exponent, error = ERROR_EXPONENT[kind], max(error, 1e-300)
    grow = min(MOST_GROWTH, SAFETY * power(wanted / error, exponent))
    control[UNLIMITED] = h * grow
    # A step cut short by an event never makes the next one shorter.
    if landing >= 0 or near:
        control[LAST] = 0.0
        control[NEXT] = max(control[NEXT], h * grow) if math.isfinite(control[NEXT]) else h * grow
        return
    # Controller of Gustafsson: if the error changed faster than the step length, the next error will do the same.
    if control[LAST] > 0.0:
        predicted = (h / control[LAST]) * power(control[ERROR] / error, exponent)
        if h < control[LAST]:
            grow = min(grow, SAFETY * predicted * power(wanted / error, exponent))
        elif math.isfinite(control[REACH]):
            grow = min(MOST_GROWTH, grow * min(max(predicted, 1.0), FURTHER_GROWTH))
    control[LAST], control[ERROR], control[NEXT] = h, max(error, NEWTON_PART * wanted), h * grow
    if kind == RADAU:
        control[RADAU_NEXT] = h * grow
    # Do not repeat a rejected length at once.
    elif rejected < math.inf:
        control[NEXT] = min(control[NEXT], max(h, SAFETY * SAFETY * rejected))


@piece
def take_step(h, kind, ctx, trial):
    """Take one step into `trial`, that of the context or memory for probe steps.

    Return -1 if its stages do not converge, else the error of dop853.
    """
    chain, motion, bounds, counter = ctx.chain, ctx.motion, ctx.bounds, ctx.log.counter
    counter[EVALUATION] += TRY_EVALUATIONS[kind]
    if kind == DOP853:
        may_stick = ctx.regime.bed.size > 0
        return dop853_step(h, bounds.inactive, may_stick, chain, motion, trial, ctx.scratch)
    used, tried = radau_step(h, chain, motion, bounds.slow, trial, ctx.scratch)
    counter[EVALUATION] += 3 * tried
    return 0.0 if used > 0 else -1.0


@inlined
def opened_early(h, chain, motion, trial, wanted):
    """Return the fraction of the step at which a contact opens that still pushes enough to matter; 1 without such a
    contact.

    No error estimate shows a force that ends between the nodes of a step.
    """
    part, d = 1.0, trial.overlap
    for i in range(motion.mode.size):
        if (
            motion.mode[i] == LOADED
            and motion.overlap[i] > 0.0 > d[2, i]
            and not is_continued(chain.law, chain.graph, i)
        ):
            soft = chain.law[i, 2] < 1.0
            # Opening time by the cubic through the stages, and the velocity change by the force at the start of the
            # step.
            x = first_root(stage_cubic(motion.overlap[i], d[0, i], d[1, i], d[2, i]))
            push = (chain.inverse_mass[i] + chain.inverse_mass[i + 1]) * motion.force[i] * h
            if x < part and ((soft and x < SAFETY and x * push > wanted) or (not soft and KINK * push > wanted)):
                part = x
    return part


@inlined
def measured_exponent(exponent, h, error, length_before, error_before):
    """Return 1 / order of the error as two rejected attempts show it. At a soft onset the order is only 1 + a."""
    if error < error_before and h < length_before:
        return max(exponent, min(1.0, log(length_before / h) / log(error_before / error)))
    return exponent


# Outcomes of the event location for an attempted step
STANDS = 0  # the step ends at its event, or does not contain an event: error control decides on it
RETRY = 1  # attempt a step of another length, which ends nearer at the event
AT_START = 2  # the event is now: no step is possible before its transition
LOST = 3  # no attempt ended at the event, and the step passes over it


@inlined
def swing_error(h, kind, chain, motion):
    """Return the error [m/s] of the common swing of all beads on strings in a step, which no contact shows.

    For a harmonic oscillator with x = omega h, Radau IIA with three stages has the error x**6 / 7200 of its largest velocity, and
    an explicit method of order 8 about x**9 / 9!.
    """
    n, square = motion.mode.size, chain.strings.square
    y = motion.anchor[0] - chain.strings.rest[n] - drive_at(chain, n, 0.0) / square
    x2 = h * h * square
    part = x2 * x2 * x2 / 7200.0 if kind == RADAU else x2 * x2 * x2 * x2 * math.sqrt(x2) / 362880.0
    return part * math.sqrt(motion.anchor[1] * motion.anchor[1] + square * y * y)


@inlined
def attempt_step(h, kind, ctx):
    """Attempt a step and return its error [m/s]; -1 if it does not converge or is not finite."""
    error = take_step(h, kind, ctx, ctx.trial)
    if kind == RADAU and error == 0.0:
        error = embedded_error(h, ctx.chain, ctx.motion, ctx.trial, ctx.scratch.work)
    if ctx.chain.strings.rest.size and error >= 0.0:
        error = larger(error, swing_error(h, kind, ctx.chain, ctx.motion))
    return error if math.isfinite(error) else -1.0


@inlined
def locate_event(time, h, least, error, event, target, ctx):
    """Decide if an attempted step of length `h` ends correctly: at the first event in it, if it contains events.

    `event` is the first Event in the step and `target` the Target of the step. A step below `least` [s] has a length of
    the order of round-off. Return the outcome, the length of the next attempt, and its Target. The end time is found by
    Newton's iteration on the guard; no step may pass over an event.
    """
    wanted, motion = ctx.bounds.wanted, ctx.motion
    row, side, tries, ceiling, miss = target.row, target.side, target.tries, target.ceiling, event.miss
    # The step does not have a target, or the event that a longer step showed has gone.
    if math.isnan(miss):
        row, tries, miss = NO_CONTACT, tries + (1 if row >= 0 else 0), 0.0
    at = event.part * h
    # An event now: its time is not distinguishable from the start.
    if event.row >= 0 and row < 0 and time + at <= time and (error <= wanted or h <= least):
        return AT_START, 0.0, Target(event.row, event.side, tries, ceiling)
    # The step has a target: shorten it to an earlier event, or move its end by Newton's iteration until the miss is
    # round-off. A slowly closing contact gets only a few tries, because it hardly matters.
    if row >= 0:
        closes = row < motion.mode.size and motion.mode[row] == OPEN
        is_inactive = closes and abs(ctx.trial.rate[2, row]) <= ctx.bounds.inactive
        if tries < (FEW_TRIES if is_inactive else MOST_TRIES):
            if event.row >= 0 and at < h + min(miss, 0.0):
                return RETRY, at, Target(event.row, event.side, tries + 1, ceiling)
            if abs(miss) > ROUND_OFF * h and time + miss != time and h > least:
                return RETRY, min(max(h + miss, LEAST_PART * h), ceiling), Target(row, side, tries + 1, ceiling)
    # The first attempt with an event in it: let the next one end there. The polynomial of a long step is inaccurate
    # near its start, so an event there first needs a shorter step.
    elif event.row >= 0 and tries < MOST_TRIES:
        if event.part < LEAST_PART and h > least and time + LEAST_PART * h > time:
            return RETRY, LEAST_PART * h, Target(row, side, tries + 1, h)
        return RETRY, at, Target(event.row, event.side, tries + 1, h)
    # The tries are used up, and an event still lies inside the step.
    if ((event.row >= 0 and at < h + min(miss, 0.0)) or miss < -FIRST_PART * h) and h > least:
        return LOST, SHRINK * h, Target(NO_CONTACT, side, ZERO, ceiling)
    # All tries are used up, and the step ends before the event.
    if miss > FIRST_PART * h:
        row = NO_CONTACT
    return STANDS, h, Target(row, side, tries, ceiling)


@inlined
def find_step(time, h, kind, alone, most_steps, ctx):
    """Find a step whose error is small enough and that ends at the first event in it, if there is any.

    Error control: a step whose error is too large is repeated with a shorter length; see `locate_event` for events.
    `alone` is true if dop853 takes every step. Return the step length, the error, row and side of the event, and the
    length of the last attempt that was rejected for its error (inf: none). Length 0 with an event: the event is now.
    Length 0 without an event: the stages do not converge, or the step budget is used up.
    """
    wanted, counter = ctx.bounds.wanted, ctx.log.counter
    # `rejected`, `length_before` and `error_before` are the last attempts that were rejected for their error. `probes`
    # counts the probe steps at guards that nearly vanish, and `least` is a length of the order of round-off.
    rejected, length_before, error_before, probes, least = math.inf, h, 0.0, 0, ROUND_OFF * h
    target = Target(NO_CONTACT, ZERO, ZERO, h)
    while counter[STEP] + counter[REJECTED] < most_steps:
        error = attempt_step(h, kind, ctx)
        # 1. It does not converge: try a much shorter step.
        if error < 0.0:
            counter[REJECTED] += 1
            target, h = Target(NO_CONTACT, target.side, target.tries, target.ceiling), SHRINK * h
            if time + h <= time:
                return 0.0, 0.0, NO_CONTACT, ZERO, rejected
            continue
        # 2. Event location: the step must end at the first event in it.
        event = first_corner(h, target.row, target.side, ctx)
        outcome, end, target = locate_event(time, h, least, error, event, target, ctx)
        if outcome == AT_START:
            return 0.0, 0.0, target.row, target.side, rejected
        if outcome != STANDS:
            counter[REJECTED] += 1 if outcome == LOST else 0
            h = end
            continue
        # 3. Accept the step if its error is small enough. A force that ends within the step is an error that the
        # estimate does not show.
        early = 1.0 if alone else opened_early(h, ctx.chain, ctx.motion, ctx.trial, wanted)
        if (error <= wanted and early == 1.0) or time + h <= time:
            # A guard comes close to 0: end a probe step there, because the end of a step is exact.
            if event.near < 1.0 and probes < FEW_TRIES and time + event.near * h > time:
                probes, h = probes + 1, event.near * h
                target = Target(NO_CONTACT, target.side, ZERO, target.ceiling)
                continue
            return h, error, target.row, target.side, rejected
        # 4. The error is too large: shorten the step. A shorter step has other events.
        counter[REJECTED] += 1
        target = Target(NO_CONTACT, target.side, ZERO, target.ceiling)
        # End just before the early opening if that is the only reason.
        if early < 1.0 and error <= 10.0 * wanted:
            h *= SAFETY * early
            continue
        rejected = h if early == 1.0 else rejected
        # The error can have a lower order than the method, see `measured_exponent`.
        exponent = measured_exponent(ERROR_EXPONENT[kind], h, error, length_before, error_before)
        length_before, error_before = h, error
        h *= max(LEAST_PART, SAFETY * power(wanted / error, exponent))
    return 0.0, 0.0, NO_CONTACT, ZERO, rejected
