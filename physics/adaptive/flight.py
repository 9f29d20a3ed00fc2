"""Free flight: no contact pushes and the external forces are steady. Overlaps are parabolas, or sines on strings, and the
next event is a closed form.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.constants import ROUND_OFF
from softcradle.physics.adaptive.row_graphs import bead_push, side_of, slack_of
from softcradle.physics.adaptive.step_records import VELOCITY
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.knots import drive_at
from softcradle.physics.numerics.records import FROZEN, LOADED, NO_CONTACT, OPEN, TOUCHING, ZERO
from softcradle.physics.numerics.swing import string_pull, swing, swing_time


@piece
def nothing_pushes(chain, regime, motion, negligible):
    """Return True if no contact pushes a bead that can move, or if all pushes change velocities by less than
    `negligible` [m/s].
    """
    driven = chain.external.size > 0
    for i in range(motion.mode.size):
        # A loaded contact is negligible if its stored energy and its closing rate are. Under external forces it must
        # also move apart, because such a force could press it for any time.
        if motion.mode[i] == LOADED:
            weight, side = chain.inverse_mass[i] + chain.inverse_mass[i + 1], side_of(regime, i)
            x, w, f = side * motion.overlap[i], side * motion.rate[i], side * motion.force[i]
            if weight * max(f, 0.0) * max(x, 0.0) > negligible * negligible or w > negligible:
                return False
            if driven and (x > 0.0 or w > 0.0 or f > 0.0 or side * chain.external[i] > 0.0):
                return False
            # Strings whose beads rest apart, or just in touch, pull a loaded contact apart.
            if chain.strings.rest.size and chain.strings.rest[i] > 0.0:
                return False
        # A touching contact pushes if its force is more than the round-off of its preload, or if external forces press
        # its beads together.
        pressed = driven and side_of(regime, i) * chain.external[i] > 0.0
        if motion.mode[i] == TOUCHING and chain.strings.rest.size:
            steady = drive_at(chain, i, 0.0) + string_pull(chain, i, motion.overlap[i])
            pressed = steady > 0.0
        if motion.mode[i] == TOUCHING and (pressed or abs(motion.force[i]) > ROUND_OFF * abs(chain.law[i, 0])):
            return False
    return True


@piece
def flown(overlap, rate, bend, time):
    """Return the overlap after `time` of free flight. A contact that closes too slowly to count stops at overlap 0,
    however long the flight is.
    """
    if bend == 0.0:
        return min(overlap + time * rate, max(overlap, 0.0)) if rate > 0.0 else overlap + time * rate
    return overlap + time * (rate + 0.5 * time * bend)


@piece
def closing_time(overlap, rate, bend):
    """Return the time at which ``overlap + rate t + bend t²/2`` becomes positive, starting from overlap <= 0; inf if it
    never does.
    """
    if overlap >= 0.0 and (rate > 0.0 or (rate == 0.0 and bend > 0.0)):
        return 0.0
    if bend == 0.0:
        return -overlap / rate if rate > 0.0 else math.inf
    # The first root of the parabola. Of the two equivalent formulas take the one without cancellation of rate and root.
    square = rate * rate - 2.0 * bend * overlap
    if square < 0.0 or (bend < 0.0 and rate <= 0.0):
        return math.inf
    root = math.sqrt(square)
    if rate > 0.0:
        return -2.0 * overlap / (rate + root)
    return (root - rate) / bend


@piece
def next_event(time, end, chain, regime, motion, negligible, velocity):
    """Return the end time of the free flight, and the row and side of the event there (row -1: none before `end`).

    A flight ends if a contact closes, a coupler begins to pull, or a sliding bead stops. `velocity` (n+1,) is scratch
    memory.
    """
    flight, row, at = math.inf, NO_CONTACT, ZERO
    # Contacts: side 0 closes at overlap 0, side 1 comes to the end of the slack of a coupler.
    root, square = math.sqrt(chain.strings.square), chain.strings.square
    for i in range(motion.mode.size):
        if motion.mode[i] == OPEN and square > 0.0:
            rest = chain.strings.rest[i] + drive_at(chain, i, 0.0) / square
            passed = swing_time(motion.overlap[i], motion.rate[i], rest, root, negligible)
            if passed < flight:
                flight, row, at = passed, ZERO + i, ZERO
        elif motion.mode[i] == OPEN and (chain.external.size or motion.rate[i] > negligible):
            passed = closing_time(motion.overlap[i], motion.rate[i], drive_at(chain, i, 0.0))
            if passed < flight:
                flight, row, at = max(passed, 0.0), ZERO + i, ZERO
        slack = slack_of(regime, i)
        if motion.mode[i] == OPEN and slack < math.inf:
            passed = max(closing_time(-motion.overlap[i] - slack, -motion.rate[i], -drive_at(chain, i, 0.0)), 0.0)
            if passed < flight:
                flight, row, at = passed, ZERO + i, ZERO + 1
    # Beads on a bed: friction stops a sliding bead if its acceleration is against its velocity.
    if regime.bed.size:
        bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
        for j in range(regime.bed.size):
            if regime.bed[j] > 0.0 and regime.slide[j] != 0:
                a = bead_push(chain, regime, j)
                if a * regime.slide[j] < 0.0:
                    passed = max(-velocity[j] / a, 0.0)
                    if passed < flight:
                        flight, row, at = passed, ZERO + motion.mode.size + j, ZERO
    if time + flight > end or time + flight == math.inf:
        return end, NO_CONTACT, ZERO
    return time + flight, row, at


@piece
def drift(passed, chain, regime, motion, velocity):
    """Move all overlaps and the anchor bead forward by `passed` [s] of free flight (backward if it is negative)."""
    if chain.strings.rest.size:
        for i in range(motion.mode.size):
            motion.held[i] = 0
        swing(passed, chain, motion)
        return
    if regime.bed.size:
        motion.taken[1] += flight_work(passed, chain, regime, motion, velocity)
    for i in range(motion.mode.size):
        if motion.mode[i] != FROZEN:
            motion.overlap[i] = flown(motion.overlap[i], motion.rate[i], drive_at(chain, i, 0.0), passed)
            motion.rate[i] += passed * drive_at(chain, i, 0.0)
        motion.held[i] = 0
    bend = drive_at(chain, motion.mode.size, 0.0)
    motion.anchor[0] += passed * (motion.anchor[1] + 0.5 * passed * bend)
    motion.anchor[1] += passed * bend


@piece
def back_to_opening(time, chain, regime, motion, scratch):
    """Move the motion back from the end of the step to the time at which the last contact opened, and return this time.

    Needed on a bed only: the motion ends at this opening, but friction still changes the velocities.
    """
    last = -math.inf
    for i in range(motion.mode.size):
        if scratch.opening[i] >= 0.0:
            last = max(last, scratch.bounced[i])
    if -math.inf < last < time:
        drift(last - time, chain, regime, motion, scratch.work[VELOCITY])
        return last
    return time


@inlined
def flight_work(passed, chain, regime, motion, velocity):
    """Return the energy [J] that bed friction dissipates in `passed` [s] of free flight."""
    found = 0.0
    bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
    for j in range(regime.bed.size):
        if regime.bed[j] > 0.0 and regime.slide[j] != 0:
            a = bead_push(chain, regime, j)
            path = passed * (velocity[j] + 0.5 * passed * a)
            found += regime.slide[j] * regime.bed[j] / regime.inverse_mass[j] * path
    return found
