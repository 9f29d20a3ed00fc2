"""The loop around a fixed-step method: steps, samples, contact switches, the end of a collision. One for all methods.

Samples between steps are one shorter step of the same method from the last grid state, so they carry its accuracy and
leave the path itself alone. While no contact is closed and no bed brakes, whole steps of free flight are taken at once: drift
is exact. On a bed a run to the end stops when no contact pushes and none can close any more before the beads have slid to
rest, or when all beads rest.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.fixed_step.discrete_gradient import gradient_steps
from softcradle.physics.fixed_step.explicit_steps import split_steps
from softcradle.physics.numerics.bead_velocities import at_rest
from softcradle.physics.numerics.graph_kernels import closing_overlap, settle_graph_forces
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.knots import put_mean, steady_until
from softcradle.physics.numerics.law_kernels import EPSILON
from softcradle.physics.numerics.meeting import flight_time, meets_again, pushes_no_more
from softcradle.physics.numerics.records import (
    DONE,
    EVALUATION,
    NO,
    ONE,
    OUT_OF_STEPS,
    PAUSED,
    SAMPLE,
    SEPARATED,
    STEP,
    ZERO,
    ChainData,
    Extent,
    Motion,
    Samples,
    SwitchLog,
)
from softcradle.physics.numerics.switches import copy_motion, has_stopped, is_closed, log_switch, row_of, take_no_pull

Array = NDArray[np.float64]

STANDSTILL = 1e-14  # of the fastest rate at the start: a slower one is round-off and closes nothing
RUNNING = -1  # in place of a status: there are steps to take
FLOWN = -2  # in place of a status: it looks ahead once more

GRID_TOLERANCE = 1e-9  # of a step: what is this near to the grid is on it
FIRST_LOOK = 256  # steps after which a run looks if closed contacts still push; then twice as many, and so on
NEVER = 2**62  # steps: more than any run takes, those of flights included, so that their number stays one of 64 bits
MOST_AT_ONCE = 2.0**61  # steps, those of a flight too, for the same reason

# entries of the plan
COUNT = 0  # checkpoints kept
DUE = 1  # steps after which the next one is kept
SPACING = 2  # steps between two

# entries of the counts of a pause
AT = 0  # steps at which the loop hands back; for samples, steps that are made before it does
BEGUN = 1  # nonzero: the run has paused and goes on
LEFT = 2  # steps that were left when it paused, before it looks up again; 0: it paused where it looks up
LOOK, FLOWN_STEPS, CLOSED, RESTS = 3, 4, 5, 6  # what the loop knew then
NEXT = 7  # for samples: the checkpoint to go on from
# entries of its numbers
STILL, RATES, OVERLAPS = 0, 1, 3  # rates up to which nothing closes; exact sums at the start, two numbers each


class Pause(NamedTuple):
    """When a run hands back, and what it needs to go on."""

    counts: NDArray[np.int64]  # (8,)
    numbers: Array  # (5,)


def no_pause() -> Pause:
    """Memory for the pauses of a run; as it is there are none."""
    counts = np.zeros(8, dtype=np.int64)
    counts[AT] = NEVER
    return Pause(counts, np.zeros(5))


@inlined
def keep_checkpoint(time, motion, kept, plan, counter):
    """Keep the motion at `time` in a row of `kept`; where there is none left, first leave every second one out."""
    if plan[COUNT] == kept.time.size:
        left = (kept.time.size + 1) // 2
        for k in range(1, left):
            kept.time[k] = kept.time[2 * k]
            copy_motion(row_of(kept, k, motion), row_of(kept, 2 * k, motion))
        plan[COUNT], plan[SPACING] = left, 2 * plan[SPACING]
    k = plan[COUNT]
    kept.time[k] = time
    copy_motion(row_of(kept, k, motion), motion)
    plan[COUNT], plan[DUE] = k + 1, counter[STEP] + plan[SPACING]


@inlined
def keep_pause(pause, left, look, flown, closed, rests, still, rates, overlaps):
    """Keep what the loop knows, `left` steps before it looks up again."""
    counts, numbers = pause.counts, pause.numbers
    counts[BEGUN], counts[LEFT], counts[LOOK], counts[FLOWN_STEPS] = 1, left, look, flown
    counts[CLOSED], counts[RESTS] = closed, 1 if rests else 0
    numbers[STILL], numbers[RATES], numbers[RATES + 1] = still, rates[0], rates[1]
    numbers[OVERLAPS], numbers[OVERLAPS + 1] = overlaps[0], overlaps[1]


@inlined
def exact_sum(values):
    """The sum as a number and what it lacks of being exact (Neumaier)."""
    total, rest = 0.0, 0.0
    for i in range(values.size):
        found = total + values[i]
        larger = abs(total) >= abs(values[i])
        rest += (total - found) + values[i] if larger else (values[i] - found) + total
        total = found
    return total, rest


@inlined
def keep_wall_distance(elapsed, motion, rates, overlaps):
    """Take what sums of rates and overlaps are off after `elapsed` [s] from the open contact that is slowest.

    `rates` and `overlaps` are their exact sums at the start.
    """
    overlap, rate, slowest = motion.overlap, motion.rate, -1
    for i in range(overlap.size):
        if overlap[i] < 0.0 and rate[i] != 0.0 and (slowest < 0 or abs(rate[i]) < abs(rate[slowest])):
            slowest = i
    if slowest >= 0:
        total, rest = exact_sum(rate)
        rate[slowest] -= (total - rates[0]) + (rest - rates[1])
        total, rest = exact_sum(overlap)
        overlap[slowest] -= (total - overlaps[0]) + (rest - overlaps[1]) - elapsed * (rates[0] + rates[1])


@inlined
def is_before(sample, time, h):
    """Whether the time of a sample, or of the end of a run, is before the end of the step from `time` on."""
    return sample - time < h * (1.0 - GRID_TOLERANCE)


@inlined
def fly(steps, h, motion):
    """Take whole steps of free flight at once."""
    for i in range(motion.overlap.size):
        motion.overlap[i] += steps * h * motion.rate[i]
    motion.anchor[0] += steps * h * motion.anchor[1]


@inlined
def look_ahead(time, end, until, steady, h, most_steps, over, free, rests, still, chain, motion, counter):
    """Return how a run continues from `time`. A flight or rest in which no contact closes and no force changes is one step.

    `until` is the next sample or the end, `steady` the time until which forces and brakes do not change. `over` is True if the
    run ends now, `free` if no force acts, `rests` if all beads rest under the present forces.
    Returns a status, or RUNNING or FLOWN; how many steps to take at the most, or have been flown; their length; and whether they
    end at `end`, off the grid.
    """
    if time > end - h * GRID_TOLERANCE:
        return DONE, ONE, h, True
    if over:
        return SEPARATED, ONE, h, True
    if counter[STEP] >= min(most_steps, NEVER):
        return OUT_OF_STEPS, ONE, h, True
    ahead = until - time
    if rests or free:
        ahead = min(ahead, steady - time)
        flight = math.inf if rests else flight_time(chain.graph, motion.overlap, motion.rate, still)
        whole = (
            0.0
            if chain.dissipation.bed.size > 0 and not rests
            else math.floor(min(flight, ahead, MOST_AT_ONCE * h) / h) - 1.0
        )
        if whole >= 1.0:
            fly(whole, h, motion)
            counter[STEP] += int(whole)
            return FLOWN, np.int64(whole), h, False
        # A contact may close and open within one step, where no flag tells of it.
        ahead = min(ahead, flight + h)
    if is_before(end, time, h):
        return RUNNING, ONE, end - time, True
    return RUNNING, np.int64(min(max(1.0, ahead / h), MOST_AT_ONCE, most_steps - counter[STEP])), h, False


@inlined
def log_switches(before, time, graph, motion, log):
    """Log every contact that has left the state of its flag since `before`. Return the number of closed contacts.

    A coupler that closes couples.

    Its time is that of the straight line through the new overlap with the new rate, second order in the step; a contact
    that closes without overlap touches from the start of the step, at time `before`, on.
    """
    overlap, rate, closed = motion.overlap, motion.rate, 0
    for i in range(overlap.size):
        now = is_closed(overlap[i], motion.force[i])
        if now:
            closed += 1
            if graph.kind.size:
                graph.coupled[i] = 1
        if now != (log.closed[i] != 0):
            when = before if now and overlap[i] == 0.0 else time
            if overlap[i] != 0.0 and rate[i] != 0.0:
                past = overlap[i] - closing_overlap(graph, i, overlap[i], rate[i])
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
    stepper, extent_fields, chain_fields, motion_fields, sample_fields, log_fields, checkpoints, pause_fields, memory
):
    """Step over an Extent; the motion is moved in place. Where the pause wants it, the status is PAUSED, and a call with the same
    arguments goes on.

    Records come as plain tuples of their fields. `stepper` is what a step is: its drifts and kicks as of `explicit_steps`, none
    of a discrete gradient, and its length [s]. `checkpoints` are Samples and the plan, which tells how many of these rows are
    kept and when the next is due; `memory` scratch memory of the steps: (BEAD_ROWS, n+1) and (WORK_ROWS, n). Returns the status
    and the time reached.
    """
    (drifts, kicks, h), (beads, work), (kept_fields, plan) = stepper, memory, checkpoints
    start, end, stop, most_steps = Extent(*extent_fields)
    chain, samples, log = ChainData(*chain_fields), Samples(*sample_fields), SwitchLog(*log_fields)
    motion, kept, pause = Motion(*motion_fields), Samples(*kept_fields), Pause(*pause_fields)
    counter, wanted = log.counter, samples.time
    brakes = chain.dissipation.bed
    bed = brakes.size > 0
    between_walls = kicks.size == 0 and chain.inverse_mass[0] == 0.0 and chain.inverse_mass[-1] == 0.0
    if pause.counts[BEGUN] != 0:
        counts, numbers = pause.counts, pause.numbers
        still, left, rests = numbers[STILL], counts[LEFT], counts[RESTS] != 0
        rates = numbers[RATES], numbers[RATES + 1]
        overlaps = numbers[OVERLAPS], numbers[OVERLAPS + 1]
        closed, flown, look = counts[CLOSED], counts[FLOWN_STEPS], counts[LOOK]
    else:
        still, left, rests = STANDSTILL * largest(motion.rate), ZERO, False
        rates, overlaps = exact_sum(motion.rate), exact_sum(motion.overlap)
        settle_graph_forces(chain.graph, motion)
        closed, flown, look = log_switches(start, start, chain.graph, motion, log), ZERO, ONE * FIRST_LOOK
    time, knots = start + counter[STEP] * h, chain.knots
    calm = (
        -1.0 if knots.time.size else math.inf
    )  # until when forces kept their values in the step before; unknown at first
    while True:
        pushed, steady, waits = chain.push.size > 0, math.inf, False
        if knots.time.size:
            put_mean(time, h, knots, chain.push, brakes)
            steady, waits = steady_until(time, knots), time < knots.time[-1]
            pushed = steady < time + h or largest(chain.push) > 0.0
        changing = steady < time + h  # in the next step
        rests = rests and not changing and steady == calm  # other forces may end a rest
        calm = steady
        if left == 0 and counter[STEP] >= pause.counts[AT]:
            keep_pause(pause, ZERO, look, flown, closed, rests, still, rates, overlaps)
            return PAUSED, time
        sampling = left == 0 and counter[SAMPLE] < wanted.size and is_before(wanted[counter[SAMPLE]], time, h)
        moved, most, length, last = motion, ONE, 0.0, False
        if sampling:  # a row of samples is a motion: it is moved by what moves that of the run
            moved = row_of(samples, counter[SAMPLE], motion)
            copy_motion(moved, motion)
            length = wanted[counter[SAMPLE]] - time
        elif left > 0:
            most, length = left, h
        else:
            if kept.time.size > 0 and time <= end - h * GRID_TOLERANCE and counter[STEP] >= plan[DUE]:
                keep_checkpoint(time, motion, kept, plan, counter)
            until = end if counter[SAMPLE] == wanted.size else min(end, wanted[counter[SAMPLE]])
            over = free = closed == 0 and not pushed
            if stop and not bed and not pushed and counter[STEP] >= look:
                over, look = pushes_no_more(chain, motion, still), 2 * counter[STEP]
            over = stop and not waits and (rests or (over and not meets_again(chain, brakes, motion, still, beads[0])))
            status, most, length, last = look_ahead(
                time, end, until, steady, h, most_steps + flown, over, free, rests, still, chain, motion, counter
            )
            if status == FLOWN:
                flown += most
                time = start + counter[STEP] * h
                continue
            if status != RUNNING:
                return status, end if status == DONE else time
            if not last:
                most = min(most, plan[DUE] - counter[STEP])
            rests = bed and not changing and at_rest(motion)
        whole, left, taken = most, ZERO, ZERO
        if not (sampling or last):
            most = min(most, max(pause.counts[AT] - counter[STEP], ONE))
        if not sampling or length > h * GRID_TOLERANCE:
            if kicks.size == 0:
                taken = gradient_steps(most, time, length, chain, moved, log.closed, beads, work, counter)
            else:
                taken = split_steps(most, time, length, drifts, kicks, chain, moved, log.closed, beads)
                counter[EVALUATION] += taken * kicks.size
        if sampling:
            take_no_pull(moved)
            counter[SAMPLE] += 1
            continue
        counter[STEP] += taken
        if taken == most and most < whole and not has_stopped(chain, motion, log.closed):
            keep_pause(pause, whole - taken, look, flown, closed, rests, still, rates, overlaps)
            return PAUSED, start + counter[STEP] * h
        rests = rests and at_rest(motion)
        before, now = start + (counter[STEP] - 1) * h, min(end, start + counter[STEP] * h)
        if between_walls:
            keep_wall_distance(now - start, motion, rates, overlaps)
        closed = log_switches(before, now, chain.graph, motion, log)  # a run of steps ends with the first switch
        if last:
            return DONE, end
        time = start + counter[STEP] * h


@jit
def sample_between(
    stepper, most_steps, chain_fields, motion_fields, sample_fields, log_fields, checkpoints, pause_fields, memory
):
    """Fill the samples of a run by going on from the last of its checkpoints before each.

    Returns whether all are filled; a call with the same arguments goes on after a pause between two checkpoints.
    """
    (kept_fields, plan), h = checkpoints, stepper[2]
    kept, motion, counter = Samples(*kept_fields), Motion(*motion_fields), SwitchLog(*log_fields).counter
    wanted, count, pause, made = Samples(*sample_fields).time, plan[COUNT], Pause(*pause_fields), ZERO
    budget, pause.counts[AT], plan[DUE] = pause.counts[AT], NEVER, NEVER
    for k in range(pause.counts[NEXT], count):
        begun, until = kept.time[k], kept.time[k + 1] if k + 1 < count else math.inf
        last = counter[SAMPLE]
        while last < wanted.size and wanted[last] < until:
            last += 1
        if last == counter[SAMPLE]:
            continue
        copy_motion(motion, row_of(kept, k, motion))
        counter[STEP] = 0
        end = begun + h * math.floor((wanted[last - 1] - begun) / h + GRID_TOLERANCE)
        if EPSILON * end > GRID_TOLERANCE * h:  # no time is known as well as that: one more step passes the sample
            end += h
        march(
            stepper, (begun, end, NO, most_steps), chain_fields, motion_fields, sample_fields, log_fields, checkpoints,
            pause_fields, memory,
        )  # fmt: skip
        made += counter[STEP]
        if made >= budget:
            pause.counts[AT], pause.counts[NEXT] = budget, k + 1
            return k + 1 == count
    return True
