"""Log of contact switches of the adaptive methods, openings within a step, and error amplification by bounces.

Contacts with preload and linear contacts open at an event that ends a step. A step passes over the opening of other
contacts, whose force vanishes smoothly or at the smallest overlaps; their opening time is computed afterwards.

Error amplification: a velocity error before a bounce changes the time of the bounce, and the forces that act meanwhile
turn this delay into another velocity error. To first order the factor is that of the saltation matrix of the event. The
factors of all bounces of a run are added up in `GROWTH`.
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
    PRESSED,
    START,
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
from softcradle.physics.numerics.swing import spread_time, string_pull
from softcradle.physics.numerics.switches import log_switch

# Least acceleration by other forces at which a return to d = 0 counts as a bounce, as a fraction of the acceleration by
# the contact at the turning point of its oscillation. If less pushes the beads back, the wave has passed on.
STEADY = 0.3
# Entries of the row PRESSED of the work array: the contact pushes, or touches and is pressed by a pushing neighbour
PUSHES, IS_PUSHED = 1.0, 2.0
AT_REST = -math.inf  # Value in place of a time: the contact touches, and nothing has pushed it


@inlined
def log_switches(before, time, landed, ctx):
    """Log the contacts that have begun or ceased to push in the step from `before` to `time`.

    A contact closes at the start of a step, because steps end at closings. A contact that touched at rest closes when a
    neighbour begins to push it (see `find_pressed`), however long its overlap stays below the smallest float. A contact
    opens at `opening` (n,) after the start of the step, or at its end if that entry is negative. If the step ended at
    the event of contact `landed`, its opening is logged after the mode transition. A contact that closes and opens
    within one step has nearly no force and is not logged. Flights between bounces, on contacts and on each segment of
    couplers, enter the error amplification, see `grow_errors`.
    """
    chain, regime, motion, scratch, log = ctx.chain, ctx.regime, ctx.motion, ctx.scratch, ctx.log
    pressed, since = scratch.work[PRESSED], scratch.pressed
    find_pressed(chain, regime, motion, ctx.bounds.slow, since, pressed)
    for i in range(motion.mode.size):
        closed = log.closed[i] != 0
        # `since`: time since which the contact pushes or is pressed; AT_REST if it touches and nothing has pushed it
        # yet.
        if pressed[i] == 0.0:
            since[i] = AT_REST if rests(i, chain, regime, motion, since) else math.inf
            if not closed:
                continue
        elif since[i] == AT_REST or since[i] == math.inf:
            since[i] = before
        if (i == landed) if closed else (pressed[i] != PUSHES):
            continue
        w = side_of(regime, i) * motion.rate[i]
        # A coupler without slack can change from pulling to pushing without opening.
        now = not closed or pressed[i] != 0.0 or (motion.mode[i] == LOADED and w > 0.0)
        if now != closed:
            when = since[i] if now else time
            if not now and time > before and scratch.opening[i] >= 0.0:
                when = before + scratch.opening[i]
            log_switch(log, i, now, when)
            if now and regime.segment.size:
                regime.graph.coupled[i] = 1
            put_bounce(i, now, w, when, ctx)
        # The contact stays closed but has reached another segment: a bounce on this segment begins.
        elif now and regime.segment.size and regime.segment[i] != scratch.segment[i]:
            put_bounce(i, now, w, time, ctx)


@inlined
def pushes(i, regime, motion):
    """Return whether contact i pushes or pulls. A touching contact carries nothing if its force is round-off of its
    preload.
    """
    if motion.mode[i] == OPEN:
        return False
    if side_of(regime, i) * motion.overlap[i] > 0.0:
        return True
    least = ROUND_OFF * abs(regime.law[i, 0]) if motion.mode[i] == TOUCHING else 0.0
    return abs(motion.force[i]) > least


@inlined
def find_pressed(chain, regime, motion, slow, since, pressed):
    """Put into `pressed` (n,) which contacts push, and which contacts touch and are pressed by a pushing neighbour; 0
    for the others.

    A push that a neighbour passes on begins when the neighbour begins to push, even if it grows with a high power of
    time. It may be too small for a float, or smaller than the precision of the stages, which leave round-off of either
    sign without any push. Rates up to `slow` [m/s] at d = 0 count as zero.
    """
    back, before = False, 0.0
    # Sweep to the right: a push is passed on to touching right neighbours.
    for i in range(motion.mode.size):
        now = PUSHES if pushes(i, regime, motion) else IS_PUSHED
        found = now if now == PUSHES and since[i] != AT_REST else 0.0
        if found == 0.0 != before and takes_on(i, i - 1, chain, regime, motion, slow, since):
            found = now
        back |= found != 0.0 == before and i > 0 and motion.mode[i - 1] != OPEN
        pressed[i] = before = found
    if not back:
        return
    # Sweep to the left, only if a push can be passed on to a left neighbour.
    for i in range(motion.mode.size - 2, -1, -1):
        if pressed[i] == 0.0 != pressed[i + 1] and takes_on(i, i + 1, chain, regime, motion, slow, since):
            pressed[i] = PUSHES if pushes(i, regime, motion) else IS_PUSHED


@inlined
def steady_pull(i, chain):
    """Return the acceleration [m/s²] of contact i at overlap 0 by external forces and strings."""
    found = drive_at(chain, i, 0.0)
    return found + string_pull(chain, i, 0.0) if chain.strings.rest.size else found


@inlined
def takes_on(i, neighbour, chain, regime, motion, slow, since):
    """Return whether contact i touches and the pushing `neighbour` presses the bead between them into it."""
    if side_of(regime, neighbour) < 0.0 or side_of(regime, i) < 0.0:
        return False
    touches = since[i] == AT_REST or (motion.overlap[i] == 0.0 and motion.rate[i] >= -slow)
    if not touches or (motion.mode[i] != LOADED and motion.mode[i] != TOUCHING):
        return False
    return not is_firm(regime, max(i, neighbour)) and steady_pull(i, chain) >= 0.0


@inlined
def rests(i, chain, regime, motion, since):
    """Return whether contact i touches at rest and nothing pushes it, so that any overlap that it gets is round-off."""
    at_zero = since[i] == AT_REST or (motion.overlap[i] == 0.0 == motion.rate[i])
    if not at_zero or motion.mode[i] != LOADED or has_segments(chain.graph, i) or steady_pull(i, chain) != 0.0:
        return False
    return chain.knots.bend.size == 0 or chain.knots.bend[i] == 0.0


@inlined
def put_bounce(i, now, speed, when, ctx):
    """Start a bounce of contact i on a segment at the time `when`, or end it if `now` is false.

    Velocity errors delay a bounce after a flight. For a coupler without slack that changes from pulling to pushing, the
    preloads act with this delay.
    """
    regime, bounds, scratch = ctx.regime, ctx.bounds, ctx.scratch
    # End the previous bounce or flight: add its error amplification to the sum of the run.
    flight, before = when - scratch.bounced[i], int(scratch.segment[i])
    scratch.control[GROWTH] += scratch.grown[i]
    scratch.bounced[i], scratch.grown[i], scratch.segment[i] = when, 0.0, -1.0
    # Delay of this closing per velocity error: flight time over closing speed. `most_grown` is the change of velocity
    # by a bounce that does not happen at all, 2 u, per error.
    scratch.lateness[i] = 0.0
    if now and 0.0 < flight < math.inf and speed > 0.0:
        scratch.lateness[i] = spread_time(flight, ctx.chain) / speed
    scratch.most_grown[i] = 2.0 * speed / bounds.wanted
    if now and speed > bounds.full:
        scratch.control[IMPACTS] += 1.0
    # A coupler without slack changes from pulling to pushing: the force jumps by both preloads, so the error is the
    # delay times this jump.
    if now and regime.segment.size:
        scratch.segment[i] = regime.segment[i]
        if before >= 0 and is_innermost(regime, i) and scratch.lateness[i] > 0.0:
            jump = abs(regime.law[i, 0]) + abs(regime.graph.segment[regime.graph.first[i] + before, PRELOAD])
            jump *= regime.inverse_mass[i] + regime.inverse_mass[i + 1]
            scratch.grown[i] = min(scratch.lateness[i] * jump, scratch.most_grown[i])


@inlined
def grow_errors(row, side, before, ctx):
    """Update the error amplification by the bounces in progress and by returns to d = 0, and count the turns of loaded
    contacts.

    A velocity error e before a flight of duration T delays the closing by T e / u, where u is the closing speed. If
    other forces accelerate the beads of the contact by a, the delay becomes a velocity error a T e / u. The step began
    at `before` and ended at the event of `row` on that `side`.
    """
    chain, regime, motion, scratch = ctx.chain, ctx.regime, ctx.motion, ctx.scratch
    course, slowest = scratch.course, ctx.bounds.wanted / TOLERANCE_PART
    for i in range(motion.mode.size):
        inward = side_of(regime, i)
        loaded, rate, overlap = motion.mode[i] == LOADED, inward * motion.rate[i], inward * motion.overlap[i]
        # A contact that was put to rest is pushed again, or has opened.
        if scratch.parting[i] > 0.0 and (not loaded or overlap > 0.0):
            count_parting(i, before, ctx)
        fastest = course[i]
        # Skip slow contacts without a bounce in progress.
        quiet = abs(rate) <= slowest if loaded else fastest == 0.0
        if quiet and i != row and scratch.lateness[i] == 0.0:
            continue
        # Follow the oscillation of a loaded contact: its fastest rate since its last turning point.
        turned = abs(rate) > slowest and fastest * rate < 0.0
        if not loaded:
            course[i] = 0.0
        elif abs(rate) > slowest:
            # Count only turns back inward. The phase of a single bounce, after which the contact opens, does not
            # matter.
            scratch.turns[i] += 1.0 if turned and rate > 0.0 else 0.0
            if turned or abs(rate) > abs(fastest):
                course[i] = rate
        # The contact returns to d = 0, or turns before it.
        returns = (loaded and i == row and side == 0) or (motion.mode[i] == OPEN and fastest < 0.0)
        turns_back = loaded and turned and rate > 0.0 and not returns
        if not (returns or turns_back or scratch.lateness[i] > 0.0):
            continue
        # `others` is the acceleration by all forces but that of the contact itself.
        weight = chain.inverse_mass[i] + chain.inverse_mass[i + 1]
        own, bend = (
            inward * weight * motion.force[i],
            inward * acceleration_of(i, chain, motion.overlap[i], motion.force, 0.0),
        )
        others = own + bend
        if returns:
            return_to_touch(i, fastest, rate, 0.0, others, chain, scratch.control)
        elif turns_back:
            least = overlap - (0.5 * rate * rate / bend if bend > 0.0 else 0.0)
            return_to_touch(i, fastest, 0.0, least, others, chain, scratch.control)
        # Bounce in progress: the largest acceleration by other forces so far, times the delay.
        if scratch.lateness[i] > 0.0:
            # the draft gear pushes in parallel with the stop on which the contact bounces
            if not is_innermost(regime, i):
                others -= own - weight * regime.law[i, LAW_STOP] * overlap
            grown = min(scratch.lateness[i] * abs(others), scratch.most_grown[i])
            scratch.grown[i] = max(scratch.grown[i], grown)


@inlined
def count_parting(i, before, ctx):
    """Add the error of contact i, which was put to rest at d = 0 and is pushed again in the step from `before`, to the
    local errors.

    At the neglected rate e it would have opened by e T in the time T since then. The acceleration a of its beads closes
    this gap at the speed sqrt(2 a e T), and a bounce changes velocities by twice as much.
    """
    chain, motion, scratch, pushed = ctx.chain, ctx.motion, ctx.scratch, 0.0
    if motion.mode[i] == LOADED:
        own = (chain.inverse_mass[i] + chain.inverse_mass[i + 1]) * motion.force[i]
        pushed = side_of(ctx.regime, i) * (own + acceleration_of(i, chain, motion.overlap[i], motion.force, 0.0))
        if pushed <= 0.0:
            return
    square = 8.0 * pushed * scratch.parting[i] * spread_time(before - scratch.parted[i], chain)
    scratch.control[LOCAL_SQUARE] += square
    scratch.parting[i] = 0.0


@inlined
def end_within_bounces(passed, chain, motion, wanted, scratch):
    """Sum up the error amplification by contacts that are closed when a run ends, `passed` [s] after its start.

    The sum e of all velocity errors delayed a contact that closed at speed u by at most T e / u, with the time T since
    the start. Its rate is wrong by its acceleration times this delay.
    """
    # on strings the sum delays it by at most e / (omega u)
    late = min(passed, 1.0 / math.sqrt(chain.strings.square)) if chain.strings.rest.size else passed
    scratch.control[ENDING] = 0.0
    for i in range(motion.mode.size):
        if scratch.lateness[i] > 0.0:
            # The closing speed u, from the stored limit 2 u / wanted.
            speed = 0.5 * wanted * scratch.most_grown[i]
            grown = late / speed * abs(acceleration_of(i, chain, motion.overlap[i], motion.force, 0.0))
            scratch.control[ENDING] += max(min(grown, scratch.most_grown[i]) - scratch.grown[i], 0.0)


@inlined
def begin_estimate(time, motion, scratch):
    """Begin the error estimate of a run. In a frame of live use, the estimate of the previous frame may continue."""
    control = scratch.control
    control[ENDING] = 0.0
    if control[CONTINUES] != 0.0:
        return
    control[LOCAL_SQUARE], control[GROWTH] = control[CARRIED_SQUARE], 0.0
    control[IMPACTS], control[START] = 0.0, time
    for i in range(motion.mode.size):
        scratch.bounced[i], scratch.segment[i] = time if motion.overlap[i] < 0.0 else math.inf, -1.0
        scratch.lateness[i] = scratch.grown[i] = scratch.most_grown[i] = 0.0
        scratch.course[i] = scratch.turns[i] = scratch.parting[i] = 0.0


@inlined
def swing_push(i, weight, fastest, chain):
    """Return the acceleration by contact i at the overlap at which it stores the energy of the rate `fastest`."""
    depth = curve_depth(chain.law, chain.graph, i, 0.5 * fastest * fastest / weight)
    return weight * pressed_force(chain.law, chain.graph, i, depth)


@piece
def return_to_touch(i, fastest, rate, least, others, chain, control):
    """Add the error amplification of contact i that returns to d = 0 at `rate`, or turns before it at the overlap
    `least`.

    A velocity error e in an oscillation whose largest rate was u is an error u e of half the squared rate. So it is an
    error u e / w of the rate w here, or sqrt(2 u e) if this rate is 0. It changes the time spent beyond d = 0, and
    there the force of the contact is missing among the `others`.
    """
    # Without a steady force a contact returns only by bounces, which are counted elsewhere.
    if chain.external.size == 0:
        return
    weight, fastest = chain.inverse_mass[i] + chain.inverse_mass[i + 1], abs(fastest)
    # The contact must be pressed by steady forces that are not small compared with its own oscillation.
    bend = others - weight * abs(chain.law[i, 0])
    if bend <= 0.0 or fastest == 0.0 or others < STEADY * swing_push(i, weight, fastest, chain):
        return
    # Velocity error of the oscillation so far. If the smallest overlap is much larger than its error, the contact does
    # not reach d = 0.
    error = max(math.sqrt(control[LOCAL_SQUARE]), ROUND_OFF * fastest)
    square = fastest * error
    if bend * least > FEW_TRIES * square:
        return
    # Missing force at the largest wrong depth, and amplification of the rate.
    missing = weight * pressed_force(chain.law, chain.graph, i, square / bend)
    grown = fastest / math.sqrt(max(rate * rate, 2.0 * square)) - 1.0
    if grown > 0.0:
        control[GROWTH] += 2.0 * missing / (bend + missing) * grown
        control[LOCAL_SQUARE] = max(control[LOCAL_SQUARE], error * error)


@inlined
def in_the_middle(i, h, chain, motion, trial):
    """Return overlap [m] and its second derivative in the middle of the step, by the quintic of contact i through both
    ends.
    """
    d0, d1, turned = motion.overlap[i], trial.overlap[2, i], trial.rate[2, i] - motion.rate[i]
    bends = acceleration_of(i, chain, d0, motion.force, 0.0) + acceleration_of(i, chain, d1, trial.force[2], h)
    return 0.5 * (d0 + d1) + h * (h * bends / 64.0 - 5.0 / 32.0 * turned), 1.5 * turned / h - 0.25 * bends


@inlined
def quintic_lacks(i, part, h, chain, motion, trial, look):
    """Return the error [m] of the quintic of contact i at the fraction `part` of the step.

    The acceleration in the middle of the quintic differs from that by the forces there. An error c x³ (1-x)³ has -24
    times its value as second derivative in the middle. `look` is scratch memory.
    """
    # Forces in the middle of the step, of the contact and its neighbours.
    for k in range(max(i - 1, 0), min(i + 2, motion.mode.size)):
        overlap, _ = in_the_middle(k, h, chain, motion, trial)
        if motion.mode[k] == LOADED:
            look.force[0, k] = curve_force(chain.law, chain.graph, k, overlap)
        else:
            look.force[0, k] = 0.5 * (motion.force[k] + trial.force[2, k])
    middle, bend = in_the_middle(i, h, chain, motion, trial)
    missed = acceleration_of(i, chain, middle, look.force[0], 0.5 * h) - bend
    x = 4.0 * part * (1.0 - part)
    return -h * h / 24.0 * missed * x * x * x


@inlined
def find_openings(h, kind, ctx):
    """Put into `scratch.opening` the time within the step at which contacts open without an event.

    The time comes from the quintic through both ends and its estimated error. If that error is large, it comes from
    shorter steps of the method, taken into `look`.
    """
    chain, motion, trial, look, opening = ctx.chain, ctx.motion, ctx.trial, ctx.look, ctx.scratch.opening
    wanted, doubtful, allowed = ctx.bounds.wanted, False, ctx.bounds.inactive * h
    for i in range(motion.mode.size):
        opening[i] = -1.0
        opens = motion.mode[i] == LOADED and motion.overlap[i] > 0.0 > trial.overlap[2, i]
        if opens and not is_continued(chain.law, chain.graph, i):
            # Root of the quintic, corrected by one Newton step with the error of the quintic there.
            d0, d1 = motion.overlap[i], trial.overlap[2, i]
            a0, a1 = acceleration_of(i, chain, d0, motion.force, 0.0), acceleration_of(i, chain, d1, trial.force[2], h)
            guard = hermite_quintic(h, d0, motion.rate[i], a0, d1, trial.rate[2, i], a1)
            part = min(first_root(guard), 1.0)
            lacks = quintic_lacks(i, part, h, chain, motion, trial, look)
            doubtful |= abs(lacks) > wanted * h
            _, _, _, _, before, at = halves(part, guard)[0]
            if at < before:
                part = min(max(part + 0.2 * part * lacks / (before - at), 0.5 * part), 1.0)
            opening[i] = part * h
    # Only if that error matters: Newton's iteration on the opening time, with a step of the method for each function
    # value.
    if not doubtful:
        return
    for i in range(motion.mode.size):
        for _ in range(FEW_TRIES):  # Newton's iteration for the time at which contact i opens
            part = opening[i]
            if part <= 0.0:
                break
            if take_step(part, kind, ctx, look) < 0.0:
                break
            miss, speed = look.overlap[2, i], look.rate[2, i]
            if speed >= 0.0:
                break
            opening[i] = min(max(part - miss / speed, 0.5 * part), h)
            if abs(miss) <= allowed:
                break
