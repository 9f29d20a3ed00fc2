"""The loop around a fixed-step method: steps, samples, contact switches, the end of a collision. One for all methods.

Samples between steps are one shorter step of the same method from the last grid state, so they carry its accuracy and
leave the path itself alone. While no contact is closed and no bed brakes, whole steps of free flight are taken at once: drift
is exact. On a bed a run to the end stops when no contact pushes and none can close any more before the beads have slid to
rest, or when all beads rest.
"""

from __future__ import annotations

import math

from softcradle.physics.fixed_step.checkpoints import (
    AT,
    BEGUN,
    CLOSED,
    COUNT,
    DUE,
    FLOWN_STEPS,
    LEFT,
    LOOK,
    NEVER,
    NEXT,
    OVERLAPS,
    RATES,
    RESTS,
    STILL,
    Checkpoints,
    Pause,
    keep_checkpoint,
    keep_pause,
)
from softcradle.physics.fixed_step.discrete_gradient import gradient_steps
from softcradle.physics.fixed_step.explicit_steps import split_steps
from softcradle.physics.fixed_step.next_steps import FIRST_LOOK, FLOWN, GRID_TOLERANCE, RUNNING, look_ahead, seems_over
from softcradle.physics.fixed_step.wall_distance import exact_sum, keep_wall_distance
from softcradle.physics.numerics.bead_velocities import at_rest
from softcradle.physics.numerics.coupler_kernels import crossed_overlap, settle_joint_forces
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.knots import put_mean
from softcradle.physics.numerics.records import (
    DONE,
    EVALUATION,
    NO,
    ONE,
    PAUSED,
    SAMPLE,
    STEP,
    ZERO,
    ChainData,
    Motion,
    Samples,
    SwitchLog,
)
from softcradle.physics.numerics.switches import (
    any_switched,
    copy_motion,
    is_closed,
    log_switch,
    take_row,
    take_sample,
)

# kinds of step
SPLITTING, DISCRETE_GRADIENT = 0, 1

STANDSTILL = 1e-14  # of the fastest rate at the start: a slower one is round-off and closes nothing


@inlined
def log_switches(before, time, joints, motion, log):
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
                past = overlap[i] - crossed_overlap(joints, i, overlap[i], rate[i])
                when = min(max(before, time - past / rate[i]), time)
            log_switch(log, i, now, when)
    return closed


@inlined
def largest(values):
    """The largest absolute value."""
    found = 0.0
    for i in range(values.size):
        found = max(found, abs(values[i]))
    return found


@jit
def march(
    kind, drifts, kicks, h, start, end, stop, most_steps, chain_fields, dissipation, motion_fields, spare_fields,
    sample_fields, log_fields, checkpoint_fields, pause_fields, beads, work,
):  # fmt: skip
    """Step from `start` to `end` (or, with `stop`, until no contact can close again); the motion is moved in place.
    Steps of free flight that are taken at once do not count among `most_steps`. Where the pause wants it, the status is PAUSED,
    and a call with the same arguments goes on.

    Records come as plain tuples of their fields, `dissipation` as a Dissipation or None; `spare` is a second Motion for
    samples, `beads` (BEAD_ROWS, n+1) and `work` (WORK_ROWS, n) are scratch memory. Returns the status and the time reached.
    """
    chain, samples, log = ChainData(*chain_fields), Samples(*sample_fields), SwitchLog(*log_fields)
    motion, spare, kept = Motion(*motion_fields), Motion(*spare_fields), Checkpoints(*checkpoint_fields)
    pause = Pause(*pause_fields)
    counter, wanted = log.counter, samples.time
    bed = dissipation is not None and dissipation.bed.size > 0
    brakes = chain.inverse_mass[:0] if dissipation is None else dissipation.bed
    between_walls = kind == DISCRETE_GRADIENT and chain.inverse_mass[0] == 0.0 and chain.inverse_mass[-1] == 0.0
    if pause.counts[BEGUN] != 0:
        counts, numbers = pause.counts, pause.numbers
        still, left, rests = numbers[STILL], counts[LEFT], counts[RESTS] != 0
        rates = numbers[RATES], numbers[RATES + 1]
        overlaps = numbers[OVERLAPS], numbers[OVERLAPS + 1]
        closed, flown, look = counts[CLOSED], counts[FLOWN_STEPS], counts[LOOK]
    else:
        still, left, rests = STANDSTILL * largest(motion.rate), ZERO, False
        rates, overlaps = exact_sum(motion.rate), exact_sum(motion.overlap)
        settle_joint_forces(chain.joints, motion)
        closed, flown, look = log_switches(start, start, chain.joints, motion, log), ZERO, ONE * FIRST_LOOK
    time, knots = start + counter[STEP] * h, chain.knots
    while True:
        pushed, changing = chain.push.size > 0, False
        if knots.time.size:
            put_mean(time, h, knots, chain.push, brakes if bed else chain.push)
            changing = time < knots.time[-1]
            pushed = changing or largest(chain.push) > 0.0
        if left == 0 and counter[STEP] >= pause.counts[AT]:
            keep_pause(pause, ZERO, look, flown, closed, rests, still, rates, overlaps)
            return PAUSED, time
        sampling = (
            left == 0 and counter[SAMPLE] < wanted.size and wanted[counter[SAMPLE]] < time + h * (1.0 - GRID_TOLERANCE)
        )
        most, length, last = ONE, 0.0, False
        if sampling:
            copy_motion(spare, motion)
            length = wanted[counter[SAMPLE]] - time
        elif left > 0:
            most, length = left, h
        else:
            if kept.time.size > 0 and time <= end - h * GRID_TOLERANCE and counter[STEP] >= kept.plan[DUE]:
                keep_checkpoint(time, motion, kept, counter)
            until = end if counter[SAMPLE] == wanted.size else min(end, wanted[counter[SAMPLE]])
            over, look = seems_over(stop and not bed, closed, look, still, pushed, chain, motion, counter)
            rests = rests and not changing
            status, most, length, last = look_ahead(
                time, end, until, stop and not changing, h, most_steps + flown, closed, over, rests, still, pushed, chain,
                brakes, motion, counter, beads[0],
            )  # fmt: skip
            if status == FLOWN:
                flown += most
                time = start + counter[STEP] * h
                continue
            if status != RUNNING:
                return status, end if status == DONE else time
            if not last:
                most = min(most, kept.plan[DUE] - counter[STEP])
            rests = bed and at_rest(motion)
        whole, left, taken = most, ZERO, ZERO
        if not (sampling or last):
            most = min(most, max(pause.counts[AT] - counter[STEP], ONE))
        if not sampling or length > h * GRID_TOLERANCE:
            moved = spare if sampling else motion
            if kind == DISCRETE_GRADIENT:
                taken = gradient_steps(most, time, length, chain, dissipation, moved, log.closed, beads, work, counter)
            else:
                taken = split_steps(most, time, length, drifts, kicks, chain, dissipation, moved, log.closed, beads)
                counter[EVALUATION] += taken * kicks.size
        if sampling:
            take_sample(samples, log, spare)
            continue
        counter[STEP] += taken
        stopped = any_switched(motion, log.closed) or (dissipation is not None and at_rest(motion))
        if taken == most and most < whole and not stopped:
            keep_pause(pause, whole - taken, look, flown, closed, rests, still, rates, overlaps)
            return PAUSED, start + counter[STEP] * h
        rests = rests and at_rest(motion)
        before, now = start + (counter[STEP] - 1) * h, min(end, start + counter[STEP] * h)
        if between_walls:
            keep_wall_distance(now - start, motion, rates, overlaps)
        closed = log_switches(before, now, chain.joints, motion, log)  # a run of steps ends with the first switch
        if last:
            return DONE, end
        time = start + counter[STEP] * h


@jit
def sample_between(
    kind, drifts, kicks, h, most_steps, chain_fields, dissipation, motion_fields, spare_fields, sample_fields, log_fields,
    checkpoint_fields, no_checkpoints, pause_fields, beads, work,
):  # fmt: skip
    """Fill the samples of a run by going on from the last of its checkpoints before each.

    Returns whether all are filled; a call with the same arguments goes on after a pause between two checkpoints.
    """
    kept, motion, counter = Checkpoints(*checkpoint_fields), Motion(*motion_fields), SwitchLog(*log_fields).counter
    wanted, count = Samples(*sample_fields).time, kept.plan[COUNT]
    pause, made = Pause(*pause_fields), ZERO
    budget, pause.counts[AT] = pause.counts[AT], NEVER
    for k in range(pause.counts[NEXT], count):
        begun, until = kept.time[k], kept.time[k + 1] if k + 1 < count else math.inf
        last = counter[SAMPLE]
        while last < wanted.size and wanted[last] < until:
            last += 1
        if last == counter[SAMPLE]:
            continue
        take_row(motion, kept, k)
        counter[STEP] = 0
        end = begun + h * math.floor((wanted[last - 1] - begun) / h + GRID_TOLERANCE)
        march(
            kind, drifts, kicks, h, begun, end, NO, most_steps, chain_fields, dissipation, motion_fields, spare_fields,
            sample_fields, log_fields, no_checkpoints, pause_fields, beads, work,
        )  # fmt: skip
        made += counter[STEP]
        if made >= budget:
            pause.counts[AT], pause.counts[NEXT] = budget, k + 1
            return k + 1 == count
    return True
