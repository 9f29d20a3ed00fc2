"""The loop around a fixed-step method: steps, samples, contact switches, the end of a collision. One for all methods.

Samples between steps are one shorter step of the same method from the last grid state, so they carry its accuracy and
leave the path itself alone. While no contact is closed and no bed brakes, whole steps of free flight are taken at once: drift
is exact. On a bed a run to the end stops when no contact pushes and none can close any more before the beads have slid to
rest, or when all beads rest.
"""

from __future__ import annotations

import math

from softcradle.physics.fixed_step.discrete_gradient import gradient_steps
from softcradle.physics.fixed_step.splitting import split_steps
from softcradle.physics.fixed_step.splitting_simd import simd_split_steps
from softcradle.physics.numerics.bead_velocities import at_rest, bead_velocities
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.records import (
    DONE,
    EVALUATION,
    OUT_OF_STEPS,
    SAMPLE,
    SEPARATED,
    STEP,
    ChainData,
    Dissipation,
    Motion,
    Samples,
    SwitchLog,
)
from softcradle.physics.numerics.switches import copy_motion, is_closed, log_switch, take_sample

# kinds of step
SPLITTING, SPLITTING_SIMD, DISCRETE_GRADIENT = 0, 1, 2

GRID_TOLERANCE = 1e-9  # of a step: a sample this near to the grid is taken from the grid
STANDSTILL = 1e-14  # of the fastest rate at the start: a slower one is round-off and closes nothing
MOST_AT_ONCE = 2**40  # steps; keeps the count an integer where the end is infinitely far


@inlined
def take_steps(most, h, kind, drifts, kicks, chain, dissipation, motion, log, beads, work):
    """Up to `most` steps of this kind, until a contact switches or all beads rest on a bed. Returns the steps taken."""
    if kind == DISCRETE_GRADIENT:
        return gradient_steps(most, h, chain, dissipation, motion, log.closed, beads, work, log.counter)
    taken = 0
    if kind == SPLITTING:
        taken = split_steps(most, h, drifts, kicks, chain, dissipation, motion, log.closed, beads)
    elif dissipation is None:
        taken = simd_split_steps(most, h, drifts, kicks, chain, motion, log.closed)
    log.counter[EVALUATION] += taken * kicks.size
    return taken


@inlined
def log_switches(before, time, motion, log):
    """Log every contact that has left the state of its flag since `before`. Returns the number of closed contacts.

    Its time is that of the straight line through the new overlap with the new rate, second order in the step; a contact
    that closes without overlap touches from the start of the step, at time `before`, on.
    """
    overlap, rate, closed = motion.overlap, motion.rate, 0
    for i in range(overlap.size):
        now = is_closed(overlap[i], motion.force[i])
        if now:
            closed += 1
        if now != (log.closed[i] != 0):
            when = before if now and overlap[i] == 0.0 else time
            if overlap[i] != 0.0 and rate[i] != 0.0:
                when = min(max(before, time - overlap[i] / rate[i]), time)
            log_switch(log, i, now, when)
    return closed


@inlined
def flight_time(overlap, rate, still):
    """Time until the first contact closes if none pushes; inf when none closes faster than `still`."""
    first = math.inf
    for i in range(overlap.size):
        if rate[i] > still:
            first = min(first, -overlap[i] / rate[i])
    return first


@jit
def sliding_path(velocity, deceleration):
    """How far a bead slides until it rests, v²/(2 mu g) with the sign of v; a wall goes on for ever."""
    if deceleration > 0.0:
        return 0.5 * velocity * abs(velocity) / deceleration
    return math.copysign(math.inf, velocity) if velocity != 0.0 else 0.0


@inlined
def closes_again(chain, dissipation, motion, still, velocity):
    """Whether two beads that are apart will meet if no contact pushes; rates up to `still` are round-off.

    `velocity` (n+1,) is scratch memory.
    """
    if dissipation is None or dissipation.bed.size == 0:
        return flight_time(motion.overlap, motion.rate, still) < math.inf
    bed = dissipation.bed
    bead_velocities(motion.rate, chain.anchor_bead, motion.anchor[1], velocity)
    for i in range(motion.overlap.size):
        if motion.rate[i] > still:
            ahead, behind = sliding_path(velocity[i], bed[i]), sliding_path(velocity[i + 1], bed[i + 1])
            if motion.overlap[i] + ahead - behind > 0.0:
                return True
    return False


@jit
def take_samples(time, h, kind, drifts, kicks, chain, dissipation, motion, spare, samples, log, beads, work):
    """Fill the sample rows up to the next step, between steps by one shorter step of `spare`."""
    wanted, counter = samples.time, log.counter
    while counter[SAMPLE] < wanted.size and wanted[counter[SAMPLE]] < time + h * (1.0 - GRID_TOLERANCE):
        copy_motion(spare, motion)
        length = wanted[counter[SAMPLE]] - time
        if length > h * GRID_TOLERANCE:
            take_steps(1, length, kind, drifts, kicks, chain, dissipation, spare, log, beads, work)
        take_sample(samples, log, spare)


@inlined
def fly(steps, h, motion):
    """Take whole steps of free flight at once."""
    for i in range(motion.overlap.size):
        motion.overlap[i] += steps * h * motion.rate[i]
    motion.anchor[0] += steps * h * motion.anchor[1]


@jit
def march(
    kind, drifts, kicks, h, start, end, stop, most_steps, chain, dissipation, motion, spare, samples, log, beads, work
):  # fmt: skip
    """Step from `start` to `end` (or, with `stop`, until no contact can close again); the motion is moved in place.

    `spare` is a second Motion for samples, `beads` (BEAD_ROWS, n+1) and `work` (WORK_ROWS, n) scratch memory.
    Returns the status and the time reached.
    """
    counter, wanted = log.counter, samples.time
    bed = dissipation is not None and dissipation.bed.size > 0
    still = 0.0
    for i in range(motion.rate.size):
        still = max(still, STANDSTILL * abs(motion.rate[i]))
    closed, rests = log_switches(start, start, motion, log), False
    while True:
        time = start + counter[STEP] * h
        take_samples(time, h, kind, drifts, kicks, chain, dissipation, motion, spare, samples, log, beads, work)
        if time > end - h * GRID_TOLERANCE:
            return DONE, end
        free = closed == 0 and chain.push.size == 0
        if stop and (rests or (free and not closes_again(chain, dissipation, motion, still, beads[0]))):
            return SEPARATED, time
        if counter[STEP] >= most_steps:
            return OUT_OF_STEPS, time
        until = end if counter[SAMPLE] == wanted.size else min(end, wanted[counter[SAMPLE]])
        if rests or (free and not bed):
            flight = math.inf if rests else flight_time(motion.overlap, motion.rate, still)
            whole = math.floor(min(flight, until - time) / h) - 1.0
            if whole >= 1.0:
                fly(whole, h, motion)
                counter[STEP] += int(whole)
                continue
        whole_step = end - time >= h * (1.0 - GRID_TOLERANCE)
        length = h if whole_step else end - time
        most = 1 if not whole_step else int(min(max(1.0, (until - time) / h), MOST_AT_ONCE, most_steps - counter[STEP]))
        rests = bed and at_rest(motion)
        counter[STEP] += take_steps(most, length, kind, drifts, kicks, chain, dissipation, motion, log, beads, work)
        rests = rests and at_rest(motion)
        time = min(end, start + counter[STEP] * h)
        before = start + (counter[STEP] - 1) * h  # the switch is in the last step: with it a run of steps ends
        closed = log_switches(before, time, motion, log)
        if not whole_step:
            return DONE, end


@jit
def march_records(
    kind, drifts, kicks, h, start, end, stop, most_steps, chain, dissipation, motion, spare, samples, log, beads, work
):  # fmt: skip
    """`march` for Python: the records come as plain tuples."""
    return march(
        kind, drifts, kicks, h, start, end, stop, most_steps, ChainData(*chain), Dissipation(*dissipation), Motion(*motion),
        Motion(*spare), Samples(*samples), SwitchLog(*log), beads, work,
    )  # fmt: skip


@jit
def march_frictionless(
    kind, drifts, kicks, h, start, end, stop, most_steps, chain, motion, spare, samples, log, beads, work
):  # fmt: skip
    """`march_records` for a chain that nothing dissipates."""
    return march(
        kind, drifts, kicks, h, start, end, stop, most_steps, ChainData(*chain), None, Motion(*motion), Motion(*spare),
        Samples(*samples), SwitchLog(*log), beads, work,
    )  # fmt: skip
