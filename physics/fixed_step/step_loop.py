"""Step loop of all fixed-step methods: steps, samples, contact switches and the end of a collision.

A sample between two steps is one shorter step of the same method from the last grid point. It has the accuracy of the
method and does not change the path. While all contacts are open and no bed brakes, whole steps of free flight are taken
at once, because the drift is exact. A run to the end on a bed stops when all beads rest, or when no contact pushes and
none can close before the beads have slid to rest.
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

# Fraction of the largest rate at the start. A smaller rate is round-off and does not close a contact.
STANDSTILL = 1e-14
RUNNING = -1  # In place of a status: there are steps to take.
FLOWN = -2  # In place of a status: a flight has been done, the loop looks ahead again.

GRID_TOLERANCE = 1e-9  # Fraction of a step. A time this near to a grid point counts as on the grid.
# Steps after which a run first tests if closed contacts still push. The interval then doubles each time.
FIRST_LOOK = 256
NEVER = 2**62  # More steps than any run takes, including steps of free flight. It fits into 64 bits with room for sums.
# Largest number of steps in one go, including free flight, so that step counts fit into 64 bits.
MOST_AT_ONCE = 2.0**61

# Entries of the plan of checkpoints.
COUNT = 0  # stored checkpoints
DUE = 1  # step count at which the next checkpoint is stored
SPACING = 2  # steps between two checkpoints

# Entries of ``Pause.counts``.
AT = 0  # step count at which the loop returns to Python; for samples, the number of steps before it returns
BEGUN = 1  # nonzero: the run was paused and resumes
LEFT = 2  # steps that were left of the current sequence of steps at the pause; 0: the pause was between two sequences
LOOK, FLOWN_STEPS, CLOSED, RESTS = 3, 4, 5, 6  # state of the loop at the pause
NEXT = 7  # for samples: the checkpoint from which to resume
# Entries of ``Pause.numbers``.
STILL, RATES, OVERLAPS = 0, 1, 3  # rates up to which nothing closes; exact sums at the start, two numbers each


class Pause(NamedTuple):
    """When a run returns to Python, and the data it needs to resume."""

    counts: NDArray[np.int64]  # (8,)
    numbers: Array  # (5,)


def no_pause() -> Pause:
    """Return memory for the pauses of a run, set so that it never pauses."""
    counts = np.zeros(8, dtype=np.int64)
    counts[AT] = NEVER
    return Pause(counts, np.zeros(5))


@inlined
def keep_checkpoint(time, motion, kept, plan, counter):
    """Store the motion at `time` in a row of `kept`. If all rows are full, first drop every second checkpoint."""
    # memory is full: keep every second checkpoint and double the spacing
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
    """Store the state of the loop, `left` steps before the end of the current sequence of steps."""
    counts, numbers = pause.counts, pause.numbers
    counts[BEGUN], counts[LEFT], counts[LOOK], counts[FLOWN_STEPS] = 1, left, look, flown
    counts[CLOSED], counts[RESTS] = closed, 1 if rests else 0
    numbers[STILL], numbers[RATES], numbers[RATES + 1] = still, rates[0], rates[1]
    numbers[OVERLAPS], numbers[OVERLAPS + 1] = overlaps[0], overlaps[1]


@inlined
def exact_sum(values):
    """Return the rounded sum of `values` and its rounding error (Neumaier's summation)."""
    total, rest = 0.0, 0.0
    for i in range(values.size):
        found = total + values[i]
        # the smaller term loses digits in the sum; add what it has lost
        larger = abs(total) >= abs(values[i])
        rest += (total - found) + values[i] if larger else (values[i] - found) + total
        total = found
    return total, rest


@inlined
def keep_wall_distance(elapsed, motion, rates, overlaps):
    """Correct the drift of the distance between two walls, `elapsed` [s] after the start, in the slowest open contact.

    `rates` and `overlaps` are the exact sums of both quantities at the start. Between two walls the sum of the rates is
    constant, and the sum of the overlaps changes linearly with time.
    """
    overlap, rate, slowest = motion.overlap, motion.rate, -1
    # find the slowest open contact: the correction is applied there
    for i in range(overlap.size):
        if overlap[i] < 0.0 and rate[i] != 0.0 and (slowest < 0 or abs(rate[i]) < abs(rate[slowest])):
            slowest = i
    if slowest >= 0:
        # the difference to the exact sums is the accumulated round-off
        total, rest = exact_sum(rate)
        rate[slowest] -= (total - rates[0]) + (rest - rates[1])
        total, rest = exact_sum(overlap)
        overlap[slowest] -= (total - overlaps[0]) + (rest - overlaps[1]) - elapsed * (rates[0] + rates[1])


@inlined
def is_before(sample, time, h):
    """Return True if `sample`, the time of a sample or of the end of a run, lies before the end of the step from `time` on."""
    return sample - time < h * (1.0 - GRID_TOLERANCE)


@inlined
def fly(steps, h, motion):
    """Take a number of whole steps of free flight in one go."""
    for i in range(motion.overlap.size):
        motion.overlap[i] += steps * h * motion.rate[i]
    motion.anchor[0] += steps * h * motion.anchor[1]


@inlined
def look_ahead(time, end, until, steady, h, most_steps, over, free, rests, still, chain, motion, counter):
    """Return how a run continues from `time`. A flight or rest in which no contact closes and no force changes is one step.

    `until` is the next sample or the end, `steady` the time until which forces and brakes do not change. `over` is True
    if the run ends now, `free` if no force acts, `rests` if all beads rest under the present forces.

    Return four values: a status, RUNNING or FLOWN; the number of steps to take at most, or of steps flown; their
    length; and True if they end at `end`, off the grid.
    """
    # the run is over: end time, end of the collision, or limit of steps
    if time > end - h * GRID_TOLERANCE:
        return DONE, ONE, h, True
    if over:
        return SEPARATED, ONE, h, True
    if counter[STEP] >= min(most_steps, NEVER):
        return OUT_OF_STEPS, ONE, h, True
    # a chain at rest or in free flight: take the whole steps before the next closing at once
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
        # A contact may close and open within one step without a change of its flag, so go at most one step beyond the
        # closing.
        ahead = min(ahead, flight + h)
    # the last step is shorter if the end is not on the grid
    if is_before(end, time, h):
        return RUNNING, ONE, end - time, True
    return RUNNING, np.int64(min(max(1.0, ahead / h), MOST_AT_ONCE, most_steps - counter[STEP])), h, False


@inlined
def log_switches(before, time, graph, motion, log):
    """Log every contact that has changed between open and closed since `before`. Return the number of closed contacts.

    A coupler couples when it closes. The time of a switch is the zero of the straight line through the new overlap with
    the new rate, which is second order in the step. A contact that closes without overlap touches from the start of the
    step, `before`, on.
    """
    overlap, rate, closed = motion.overlap, motion.rate, 0
    for i in range(overlap.size):
        now = is_closed(overlap[i], motion.force[i])
        if now:
            closed += 1
            # a coupler couples as soon as it closes
            if graph.coupled.size:
                graph.coupled[i] = 1
        if now != (log.closed[i] != 0):
            # extrapolate back along the straight line, but not beyond this step
            when = before if now and overlap[i] == 0.0 else time
            if overlap[i] != 0.0 and rate[i] != 0.0:
                past = overlap[i] - closing_overlap(graph, i, overlap[i], rate[i])
                when = min(max(before, time - past / rate[i]), time)
            log_switch(log, i, now, when)
    return closed


@inlined
def largest(values):
    """Return the largest absolute value."""
    found = 0.0
    for i in range(values.size):
        found = max(found, abs(values[i]))
    return found


@jit
def march(
    stepper, extent_fields, chain_fields, motion_fields, sample_fields, log_fields, checkpoints, pause_fields, memory
):
    """Take steps over an Extent and update the motion in place. Return the status and the time reached.

    The status is PAUSED when the step budget in `pause` is used up; call again with the same arguments to resume.

    Records come as plain tuples of their fields. `stepper` holds the drifts and kicks of `explicit_steps`, empty for a
    discrete gradient, and the step size [s]. `checkpoints` holds Samples and the plan, which gives the number of stored
    rows and when the next one is due. `memory` is scratch memory of the steps: (BEAD_ROWS, n+1) and (WORK_ROWS, n).
    """
    (drifts, kicks, h), (beads, work), (kept_fields, plan) = stepper, memory, checkpoints
    start, end, stop, most_steps = Extent(*extent_fields)
    chain, samples, log = ChainData(*chain_fields), Samples(*sample_fields), SwitchLog(*log_fields)
    motion, kept, pause = Motion(*motion_fields), Samples(*kept_fields), Pause(*pause_fields)
    counter, wanted = log.counter, samples.time
    brakes = chain.dissipation.bed
    bed = brakes.size > 0
    between_walls = kicks.size == 0 and chain.inverse_mass[0] == 0.0 and chain.inverse_mass[-1] == 0.0
    # Resume the run after a pause, or start it.
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
    # time until which the forces of the previous step are constant; unknown at first
    calm = -1.0 if knots.time.size else math.inf
    while True:
        # forces over time: mean over the next step, and how long all forces stay constant
        pushed, steady, waits = chain.push.size > 0, math.inf, False
        if knots.time.size:
            put_mean(time, h, knots, chain.push, brakes)
            steady, waits = steady_until(time, knots), time < knots.time[-1]
            pushed = steady < time + h or largest(chain.push) > 0.0
        changing = steady < time + h  # a force changes in the next step
        rests = rests and not changing and steady == calm  # a changed force may end the rest
        calm = steady
        # the step budget is used up between two sequences of steps
        if left == 0 and counter[STEP] >= pause.counts[AT]:
            keep_pause(pause, ZERO, look, flown, closed, rests, still, rates, overlaps)
            return PAUSED, time
        sampling = left == 0 and counter[SAMPLE] < wanted.size and is_before(wanted[counter[SAMPLE]], time, h)
        # next: a sample, the rest of a paused sequence, or a new sequence of steps
        moved, most, length, last = motion, ONE, 0.0, False
        if sampling:  # A row of the samples is a motion: the same steps move it.
            moved = row_of(samples, counter[SAMPLE], motion)
            copy_motion(moved, motion)
            length = wanted[counter[SAMPLE]] - time
        elif left > 0:
            most, length = left, h
        else:
            # plan the next sequence of steps: checkpoint, end of the collision, length
            if kept.time.size > 0 and time <= end - h * GRID_TOLERANCE and counter[STEP] >= plan[DUE]:
                keep_checkpoint(time, motion, kept, plan, counter)
            until = end if counter[SAMPLE] == wanted.size else min(end, wanted[counter[SAMPLE]])
            # without closed contacts and forces the beads are in free flight
            over = free = closed == 0 and not pushed
            # from time to time test if the closed contacts still push noticeably
            if stop and not bed and not pushed and counter[STEP] >= look:
                over, look = pushes_no_more(chain, motion, still), 2 * counter[STEP]
            over = stop and not waits and (rests or (over and not meets_again(chain, brakes, motion, still, beads[0])))
            status, most, length, last = look_ahead(
                time, end, until, steady, h, most_steps + flown, over, free, rests, still, chain, motion, counter
            )
            # free flight over whole steps: plan again from its end
            if status == FLOWN:
                flown += most
                time = start + counter[STEP] * h
                continue
            if status != RUNNING:
                return status, end if status == DONE else time
            # a sequence of steps ends at the next checkpoint
            if not last:
                most = min(most, plan[DUE] - counter[STEP])
            rests = bed and not changing and at_rest(motion)
        # limit the sequence to the steps that are left before the pause
        whole, left, taken = most, ZERO, ZERO
        if not (sampling or last):
            most = min(most, max(pause.counts[AT] - counter[STEP], ONE))
        # take the steps; on the grid they end early at the first switch
        if not sampling or length > h * GRID_TOLERANCE:
            if kicks.size == 0:
                taken = gradient_steps(most, time, length, chain, moved, log.closed, beads, work, counter)
            else:
                taken = split_steps(most, time, length, drifts, kicks, chain, moved, log.closed, beads)
                counter[EVALUATION] += taken * kicks.size
        # a sample does not change the run itself
        if sampling:
            take_no_pull(moved)
            counter[SAMPLE] += 1
            continue
        counter[STEP] += taken
        # the step budget is used up within a sequence of steps
        if taken == most and most < whole and not has_stopped(chain, motion, log.closed):
            keep_pause(pause, whole - taken, look, flown, closed, rests, still, rates, overlaps)
            return PAUSED, start + counter[STEP] * h
        # end of a sequence: log switches, and correct the sum of overlaps between walls
        rests = rests and at_rest(motion)
        before, now = start + (counter[STEP] - 1) * h, min(end, start + counter[STEP] * h)
        if between_walls:
            keep_wall_distance(now - start, motion, rates, overlaps)
        closed = log_switches(before, now, chain.graph, motion, log)  # a sequence of steps ends with the first switch
        if last:
            return DONE, end
        time = start + counter[STEP] * h


@jit
def sample_between(
    stepper, most_steps, chain_fields, motion_fields, sample_fields, log_fields, checkpoints, pause_fields, memory
):
    """Compute the samples of a run, each from the last checkpoint before it. Return True if all samples are complete.

    After a pause between two checkpoints, call again with the same arguments to resume.
    """
    (kept_fields, plan), h = checkpoints, stepper[2]
    kept, motion, counter = Samples(*kept_fields), Motion(*motion_fields), SwitchLog(*log_fields).counter
    wanted, count, pause, made = Samples(*sample_fields).time, plan[COUNT], Pause(*pause_fields), ZERO
    budget, pause.counts[AT], plan[DUE] = pause.counts[AT], NEVER, NEVER
    for k in range(pause.counts[NEXT], count):
        begun, until = kept.time[k], kept.time[k + 1] if k + 1 < count else math.inf
        # samples between this checkpoint and the next
        last = counter[SAMPLE]
        while last < wanted.size and wanted[last] < until:
            last += 1
        if last == counter[SAMPLE]:
            continue
        # repeat the steps from the checkpoint to the last of these samples
        copy_motion(motion, row_of(kept, k, motion))
        counter[STEP] = 0
        end = begun + h * math.floor((wanted[last - 1] - begun) / h + GRID_TOLERANCE)
        # At such a large time the round-off exceeds the tolerance: one more step makes sure that the sample is passed.
        if EPSILON * end > GRID_TOLERANCE * h:
            end += h
        march(
            stepper, (begun, end, NO, most_steps), chain_fields, motion_fields, sample_fields, log_fields, checkpoints,
            pause_fields, memory,
        )  # fmt: skip
        made += counter[STEP]
        # step budget used up
        if made >= budget:
            pause.counts[AT], pause.counts[NEXT] = budget, k + 1
            return k + 1 == count
    return True
