"""The log of contact switches of the adaptive methods, and when within a step contacts open without an event.

Contacts with preload and linear ones open by an event that ends a step; a step passes over the opening of others, whose
force vanishes smoothly or with the smallest of overlaps, and it is located afterwards.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import FEW_TRIES, ROUND_OFF, TOLERANCE_PART
from softcradle.physics.adaptive.corner_search import first_root, halves, hermite_quintic
from softcradle.physics.adaptive.row_graphs import is_firm, is_innermost, side_of
from softcradle.physics.adaptive.step_control import take_step
from softcradle.physics.adaptive.step_records import (
    CARRIED_SQUARE,
    CONTINUES,
    ENDING,
    GROWTH,
    IMPACTS,
    LOCAL_SQUARE,
    START,
    UNSEEN_SQUARE,
)
from softcradle.physics.numerics.graph_kernels import has_segments
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.knots import drive_at
from softcradle.physics.numerics.law_curve import (
    LAW_STOP,
    acceleration_of,
    curve_depth,
    curve_force,
    is_continued,
    pressed_force,
)
from softcradle.physics.numerics.records import LOADED, OPEN, PRELOAD, TOUCHING
from softcradle.physics.numerics.switches import log_switch

# of the push against which a contact would swing as fast as it has: where less pushes it back, the wave has gone on
STEADY = 0.3
PRESSED = 5  # row (n+1,) of the work array: which contacts push, or are pressed by one that does, as
PUSHES, IS_PUSHED = 1.0, 2.0
AT_REST = -math.inf  # in place of a time: the contact touches, and nothing has pushed it


@inlined
def log_switches(before, time, landed, chain, regime, motion, bounds, scratch, log):
    """Log the contacts that have begun or ceased to push in the step from `before` to `time`.

    One that has begun does so at the start: steps end where contacts close. One that touched at rest has begun when a neighbour
    did, see `find_pressed`, however late its overlap is a number. One that has opened did so at `opening` (n,) after the start,
    or at the end where that is negative. What opens where it has `landed` on a corner is told of when it is over it.
    One that closes and opens within one step has next to no force, and is not told.
    Flights between bounces, on contacts and on each segment of couplers, count in how errors grow, see `grow_errors`.
    """
    pressed, since = scratch.work[PRESSED], scratch.pressed
    find_pressed(chain, regime, motion, bounds.slow, since, pressed)
    for i in range(motion.mode.size):
        closed = log.closed[i] != 0
        if pressed[i] == 0.0:
            since[i] = AT_REST if rests(i, chain, regime, motion, since) else math.inf
            if not closed:
                continue
        elif since[i] == AT_REST or since[i] == math.inf:
            since[i] = before
        if (i == landed) if closed else (pressed[i] != PUSHES):
            continue
        w = side_of(regime, i) * motion.rate[i]
        # a coupler without slack may go over from pulling to pushing
        now = not closed or pressed[i] != 0.0 or (motion.mode[i] == LOADED and w > 0.0)
        if now != closed:
            when = min(before, since[i]) if now else time
            if not now and time > before and scratch.opening[i] >= 0.0:
                when = before + scratch.opening[i]
            log_switch(log, i, now, when)
            if now and regime.segment.size:
                regime.graph.coupled[i] = 1
            put_bounce(i, now, w, when, regime, bounds, scratch)
        elif now and regime.segment.size and regime.segment[i] != scratch.segment[i]:
            put_bounce(i, now, w, time, regime, bounds, scratch)


@inlined
def pushes(i, regime, motion):
    """Whether contact i pushes or pulls; one that touches carries nothing where its force is the round-off of its preload."""
    if motion.mode[i] == OPEN:
        return False
    if side_of(regime, i) * motion.overlap[i] > 0.0:
        return True
    least = ROUND_OFF * abs(regime.law[i, 0]) if motion.mode[i] == TOUCHING else 0.0
    return abs(motion.force[i]) > least


@inlined
def find_pressed(chain, regime, motion, slow, since, pressed):
    """Which contacts push, and which touch and are pressed by a neighbour that does, into `pressed` (n,): 0 for others.

    What a neighbour hands on begins with it, however high the power of time is with which it grows: it may be far too small for
    a number, or for the precision of the stages, which leave round-off of either sign where nothing pushes. A rate up to `slow`
    [m/s] at d = 0 is none.
    """
    back, before = False, 0.0
    for i in range(motion.mode.size):
        now = PUSHES if pushes(i, regime, motion) else IS_PUSHED
        found = now if now == PUSHES and since[i] != AT_REST else 0.0
        if found == 0.0 != before and takes_on(i, i - 1, chain, regime, motion, slow, since):
            found = now
        back |= found != 0.0 == before and i > 0 and motion.mode[i - 1] != OPEN
        pressed[i] = before = found
    if not back:
        return
    for i in range(motion.mode.size - 2, -1, -1):
        if pressed[i] == 0.0 != pressed[i + 1] and takes_on(i, i + 1, chain, regime, motion, slow, since):
            pressed[i] = PUSHES if pushes(i, regime, motion) else IS_PUSHED


@inlined
def takes_on(i, neighbour, chain, regime, motion, slow, since):
    """Whether contact i touches and the `neighbour`, which pushes, pushes the bead between them into it."""
    if side_of(regime, neighbour) < 0.0 or side_of(regime, i) < 0.0:
        return False
    touches = since[i] == AT_REST or (motion.overlap[i] == 0.0 and motion.rate[i] >= -slow)
    if not touches or (motion.mode[i] != LOADED and motion.mode[i] != TOUCHING):
        return False
    return not is_firm(regime, max(i, neighbour)) and drive_at(chain, i, 0.0) >= 0.0


@inlined
def rests(i, chain, regime, motion, since):
    """Whether contact i, which nothing pushes, touches at rest: what overlap it gets so is round-off."""
    at_zero = since[i] == AT_REST or (motion.overlap[i] == 0.0 == motion.rate[i])
    if not at_zero or motion.mode[i] != LOADED or has_segments(chain.graph, i) or drive_at(chain, i, 0.0) != 0.0:
        return False
    return chain.knots.bend.size == 0 or chain.knots.bend[i] == 0.0


@inlined
def put_bounce(i, now, speed, when, regime, bounds, scratch):
    """A bounce of contact i on a segment begins, or ends where that is not `now` entered at that `speed`.

    Errors of velocity make one late that comes after another. A coupler without slack that goes over from pulling to pushing gets
    its preloads late.
    """
    flight, before = when - scratch.bounced[i], int(scratch.segment[i])
    scratch.control[GROWTH] += scratch.grown[i]
    scratch.bounced[i], scratch.grown[i], scratch.segment[i] = when, 0.0, -1.0
    scratch.lateness[i] = flight / speed if now and flight > 0.0 and speed > 0.0 else 0.0
    scratch.most_grown[i] = 2.0 * speed / bounds.wanted
    if now and speed > bounds.full:
        scratch.control[IMPACTS] += 1.0
    if now and regime.segment.size:
        scratch.segment[i] = regime.segment[i]
        if before >= 0 and is_innermost(regime, i) and scratch.lateness[i] > 0.0:
            jump = abs(regime.law[i, 0]) + abs(regime.graph.segment[regime.graph.first[i] + before, PRELOAD])
            jump *= regime.inverse_mass[i] + regime.inverse_mass[i + 1]
            scratch.grown[i] = min(scratch.lateness[i] * jump, scratch.most_grown[i])


@inlined
def grow_errors(row, side, before, chain, regime, motion, wanted, scale, scratch):
    """How the bounces that now go on, and returns to d = 0, make errors grow, and how often loaded contacts have turned.

    A velocity error e before a flight of duration T closes the contact T e / u later, at closing speed u. What else pushes its
    beads meanwhile, at acceleration a, makes that a velocity error of a T e / u. The step, which began at `before`, has ended at
    the corner of `row` on that `side`.
    """
    course, slowest = scratch.course, wanted / TOLERANCE_PART
    for i in range(motion.mode.size):
        inward = side_of(regime, i)
        loaded, rate, overlap = motion.mode[i] == LOADED, inward * motion.rate[i], inward * motion.overlap[i]
        if scratch.parting[i] > 0.0 and (not loaded or overlap > 0.0):
            count_parting(i, before, chain, regime, motion, ROUND_OFF * scale, scratch)
        fastest = course[i]
        quiet = abs(rate) <= slowest if loaded else fastest == 0.0
        if quiet and i != row and scratch.lateness[i] == 0.0:
            continue
        turned = abs(rate) > slowest and fastest * rate < 0.0
        if not loaded:
            course[i] = 0.0
        elif abs(rate) > slowest:
            # only a turn back inwards: the phase of a single bounce, after which the contact opens, moves nothing
            scratch.turns[i] += 1.0 if turned and rate > 0.0 else 0.0
            if turned or abs(rate) > abs(fastest):
                course[i] = rate
        returns = (loaded and i == row and side == 0) or (motion.mode[i] == OPEN and fastest < 0.0)
        turns_back = loaded and turned and rate > 0.0 and not returns
        if not (returns or turns_back or scratch.lateness[i] > 0.0):
            continue
        weight = chain.inverse_mass[i] + chain.inverse_mass[i + 1]
        own, bend = inward * weight * motion.force[i], inward * acceleration_of(i, chain, motion.force, 0.0)
        others = own + bend
        if returns:
            return_to_touch(i, fastest, rate, 0.0, others, chain, scratch.control)
        elif turns_back:
            least = overlap - (0.5 * rate * rate / bend if bend > 0.0 else 0.0)
            return_to_touch(i, fastest, 0.0, least, others, chain, scratch.control)
        if scratch.lateness[i] > 0.0:
            if not is_innermost(regime, i):  # the gear pushes beside the stop on which it bounces
                others -= own - weight * regime.law[i, LAW_STOP] * overlap
            grown = min(scratch.lateness[i] * abs(others), scratch.most_grown[i])
            scratch.grown[i] = max(scratch.grown[i], grown)


@inlined
def count_parting(i, before, chain, regime, motion, least, scratch):
    """Count as an error what contact i would bounce at, which was put to rest and is pushed again in the step from `before`.

    At the rate e it would have parted by e T in the time T since. The acceleration a of its beads closes that at sqrt(2 a e T); a
    bounce changes velocities by twice as much. What parts at `least` [m/s] at the most rests in finer runs, too: no difference
    between them tells of it.
    """
    pushed = 0.0
    if motion.mode[i] == LOADED:
        own = (chain.inverse_mass[i] + chain.inverse_mass[i + 1]) * motion.force[i]
        pushed = side_of(regime, i) * (own + acceleration_of(i, chain, motion.force, 0.0))
        if pushed <= 0.0:
            return
    square = 8.0 * pushed * scratch.parting[i] * (before - scratch.parted[i])
    scratch.control[LOCAL_SQUARE] += square
    scratch.control[UNSEEN_SQUARE] += square if scratch.parting[i] <= least else 0.0
    scratch.parting[i] = 0.0


@inlined
def end_within_bounces(passed, chain, motion, wanted, scratch):
    """Add up how errors have grown by contacts that are closed when a run ends, `passed` [s] after its start.

    All velocity errors e made a contact that closed at speed u late by T e / u. Its rate is off by its acceleration times that.
    """
    scratch.control[ENDING] = 0.0
    for i in range(motion.mode.size):
        if scratch.lateness[i] > 0.0:
            speed = 0.5 * wanted * scratch.most_grown[i]
            grown = passed / speed * abs(acceleration_of(i, chain, motion.force, 0.0))
            scratch.control[ENDING] += max(min(grown, scratch.most_grown[i]) - scratch.grown[i], 0.0)


@inlined
def begin_estimate(time, motion, scratch):
    """Begin the estimate of the error that the run makes; in a frame of live use that of the frame before may go on."""
    control = scratch.control
    control[ENDING] = 0.0
    if control[CONTINUES] != 0.0:
        return
    control[LOCAL_SQUARE], control[GROWTH], control[UNSEEN_SQUARE] = control[CARRIED_SQUARE], 0.0, 0.0
    control[IMPACTS], control[START] = 0.0, time
    for i in range(motion.mode.size):
        scratch.bounced[i], scratch.segment[i] = time if motion.overlap[i] < 0.0 else math.inf, -1.0
        scratch.lateness[i] = scratch.grown[i] = scratch.most_grown[i] = 0.0
        scratch.course[i] = scratch.turns[i] = scratch.parting[i] = 0.0


@inlined
def swing_push(i, weight, fastest, chain):
    """Acceleration by contact i where it holds the energy of the rate `fastest`: about that of the push it swings against."""
    depth = curve_depth(chain.law, chain.graph, i, 0.5 * fastest * fastest / weight)
    return weight * pressed_force(chain.law, chain.graph, i, depth)


@piece
def return_to_touch(i, fastest, rate, least, others, chain, control):
    """Growth of errors where contact i comes back to d = 0 at `rate`, or turns at the overlap `least` before it.

    A velocity error e in a swing whose largest rate was u is one u e of half the rate squared, so one u e / w of the rate w here,
    and sqrt(2 u e) of none. That moves the time spent beyond d = 0, where the force of the contact is missing among the `others`.
    """
    if chain.external.size == 0:  # nothing pushes steadily: what comes back does so by bounces, which are counted
        return
    weight, fastest = chain.inverse_mass[i] + chain.inverse_mass[i + 1], abs(fastest)
    bend = others - weight * abs(chain.law[i, 0])
    if bend <= 0.0 or fastest == 0.0 or others < STEADY * swing_push(i, weight, fastest, chain):
        return
    error = max(math.sqrt(control[LOCAL_SQUARE]), ROUND_OFF * fastest)
    square = fastest * error
    if bend * least > FEW_TRIES * square:
        return
    missing = weight * pressed_force(chain.law, chain.graph, i, square / bend)
    grown = fastest / math.sqrt(max(rate * rate, 2.0 * square)) - 1.0
    if grown > 0.0:
        control[GROWTH] += 2.0 * missing / (bend + missing) * grown
        control[LOCAL_SQUARE] = max(control[LOCAL_SQUARE], error * error)


@inlined
def in_the_middle(i, h, chain, motion, trial):
    """Overlap [m] and its second derivative in the middle of the step, by the quintic of contact i through both ends."""
    d0, d1, turned = motion.overlap[i], trial.overlap[2, i], trial.rate[2, i] - motion.rate[i]
    bends = acceleration_of(i, chain, motion.force, 0.0) + acceleration_of(i, chain, trial.force[2], h)
    return 0.5 * (d0 + d1) + h * (h * bends / 64.0 - 5.0 / 32.0 * turned), 1.5 * turned / h - 0.25 * bends


@inlined
def quintic_lacks(i, part, h, chain, motion, trial, look):
    """What the quintic of contact i lacks [m] at a part of the step: by the acceleration in its middle, which is not that of the
    forces there. An error c x³ (1-x)³ has -24 times its value as second derivative in the middle. `look` is scratch."""
    for k in range(max(i - 1, 0), min(i + 2, motion.mode.size)):
        overlap, _ = in_the_middle(k, h, chain, motion, trial)
        if motion.mode[k] == LOADED:
            look.force[0, k] = curve_force(chain.law, chain.graph, k, overlap)
        else:
            look.force[0, k] = 0.5 * (motion.force[k] + trial.force[2, k])
    _, bend = in_the_middle(i, h, chain, motion, trial)
    missed = acceleration_of(i, chain, look.force[0], 0.5 * h) - bend
    x = 4.0 * part * (1.0 - part)
    return -h * h / 24.0 * missed * x * x * x


@inlined
def find_openings(h, kind, firm, chain, motion, wanted, trial, look, scratch, log):
    """When within the step contacts open without an event, into `scratch.opening`: by the quintic of both ends and what it lacks,
    then, where that is much, by shorter steps of the method, tried in `look`."""
    doubtful, allowed = False, TOLERANCE_PART * wanted * h
    opening = scratch.opening
    for i in range(motion.mode.size):
        opening[i] = -1.0
        opens = motion.mode[i] == LOADED and motion.overlap[i] > 0.0 > trial.overlap[2, i]
        if opens and not is_continued(chain.law, chain.graph, i):
            a0, a1 = acceleration_of(i, chain, motion.force, 0.0), acceleration_of(i, chain, trial.force[2], h)
            d0, d1 = motion.overlap[i], trial.overlap[2, i]
            guard = hermite_quintic(h, d0, motion.rate[i], a0, d1, trial.rate[2, i], a1)
            part = min(first_root(guard), 1.0)
            lacks = quintic_lacks(i, part, h, chain, motion, trial, look)
            doubtful |= abs(lacks) > wanted * h
            _, _, _, _, before, at = halves(part, guard)[0]
            if at < before:
                part = min(max(part + 0.2 * part * lacks / (before - at), 0.5 * part), 1.0)
            opening[i] = part * h
    if not doubtful:
        return
    for i in range(motion.mode.size):
        for _ in range(FEW_TRIES):  # Newton on the time at which contact i opens
            part = opening[i]
            if part <= 0.0:
                break
            if take_step(part, kind, firm, chain, motion, wanted, look, scratch, log) < 0.0:
                break
            miss, speed = look.overlap[2, i], look.rate[2, i]
            if speed >= 0.0:
                break
            opening[i] = min(max(part - miss / speed, 0.5 * part), h)
            if abs(miss) <= allowed:
                break
