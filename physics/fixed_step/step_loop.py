"""Step loop of all fixed-step methods: steps, samples, contact switches and the end of a collision.

A sample between two steps is one shorter step of the same method from the last grid point. It has the accuracy of the
method and does not change the path. While all contacts are open and no bed brakes, whole steps of free flight are taken
at once, because the drift is exact; on strings it is a sine. A run to the end on a bed stops when all beads rest, or when
no contact pushes and none can close before the beads have slid to rest.
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
from softcradle.physics.numerics.swing import flight_on_strings, swing
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
LEFT = 2  # steps that were left of the current stretch at the pause; 0: the pause was between two stretches
LOOK, FLOWN_STEPS, CLOSED, RESTS = 3, 4, 5, 6  # state of the loop at the pause
NEXT = 7  # for samples: the checkpoint from which to resume
# Entries of ``Pause.numbers``.
STILL, RATES, OVERLAPS = 0, 1, 3  # rates up to which nothing closes; exact sums at the start, two numbers each


class Pause(NamedTuple):
    """When a run returns to Python, and the data it needs to resume."""

    counts: NDArray[np.int64]  # (8,)
    numbers: Array  # (5,)


class Run(NamedTuple):
    """All records of a run of fixed steps."""

    h: float  # step [s]
    extent: Extent
    chain: ChainData
    motion: Motion
    samples: Samples
    log: SwitchLog
    kept: Samples  # checkpoints
    plan: NDArray[np.int64]  # (3,) plan of the checkpoints
    beads: Array  # (BEAD_ROWS, n+1) scratch memory


class Progress(NamedTuple):
    """State of a run between two stretches, which a pause stores."""

    left: int  # steps that are left of the stretch in which the run paused; 0: it paused between two stretches
    look: int  # step count from which on closed contacts are tested again if they still push
    flown: int  # steps of free flight so far
    closed: int  # number of closed contacts
    rests: bool  # all beads rest under the present forces
    still: float  # rates up to which no contact closes [m/s]
    rates: tuple[float, float]  # exact sum of the rates at the start
    overlaps: tuple[float, float]  # exact sum of the overlaps at the start
    calm: float  # time [s] until which the forces of the last stretch were constant; -1: unknown


class Forces(NamedTuple):
    """External forces from the present time on."""

    pushed: bool  # a force acts in the next step
    steady: float  # time [s] until which all forces are constant
    waits: bool  # a breakpoint is still to come
    changing: bool  # a force changes in the next step


class Stretch(NamedTuple):
    """Next part of a run: a sample, a number of steps, a flight, or its end."""

    sampling: bool  # one shorter step to the next sample, which does not change the run
    status: int  # RUNNING, FLOWN, or the status with which the run ends
    most: int | np.int64  # largest number of steps
    length: float  # length of each step [s]
    last: bool  # the step ends at the end of the run, off the grid


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
def keep_pause(pause, left, progress):
    """Store the progress of a run, `left` steps before the end of the current stretch."""
    counts, numbers = pause.counts, pause.numbers
    counts[BEGUN], counts[LEFT], counts[LOOK], counts[FLOWN_STEPS] = 1, left, progress.look, progress.flown
    counts[CLOSED], counts[RESTS] = progress.closed, 1 if progress.rests else 0
    numbers[STILL], numbers[RATES], numbers[RATES + 1] = progress.still, progress.rates[0], progress.rates[1]
    numbers[OVERLAPS], numbers[OVERLAPS + 1] = progress.overlaps[0], progress.overlaps[1]


@inlined
def begin_or_resume(pause, run):
    """Return the Progress of a run that starts now, or that resumes after a pause."""
    counts, numbers = pause.counts, pause.numbers
    calm = -1.0 if run.chain.knots.time.size else math.inf
    if counts[BEGUN] != 0:
        rates, overlaps = (numbers[RATES], numbers[RATES + 1]), (numbers[OVERLAPS], numbers[OVERLAPS + 1])
        left, look, flown, closed = counts[LEFT], counts[LOOK], counts[FLOWN_STEPS], counts[CLOSED]
        return Progress(left, look, flown, closed, counts[RESTS] != 0, numbers[STILL], rates, overlaps, calm)
    motion, start = run.motion, run.extent.start
    still, rates, overlaps = STANDSTILL * largest(motion.rate), exact_sum(motion.rate), exact_sum(motion.overlap)
    settle_graph_forces(run.chain.graph, motion)
    closed = log_switches(start, start, run.chain.graph, motion, run.log)
    return Progress(ZERO, ONE * FIRST_LOOK, ZERO, closed, False, still, rates, overlaps, calm)


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
def fly(steps, h, chain, motion):
    """Take a number of whole steps of free flight in one go."""
    if chain.strings.rest.size:
        swing(steps * h, chain, motion)
        return
    for i in range(motion.overlap.size):
        motion.overlap[i] += steps * h * motion.rate[i]
    motion.anchor[0] += steps * h * motion.anchor[1]


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


@inlined
def forces_ahead(time, run):
    """Put the mean forces over the next step into the chain, and return how long all forces stay constant."""
    chain, knots, h = run.chain, run.chain.knots, run.h
    pushed, steady, waits = chain.push.size > 0, math.inf, False
    if knots.time.size:
        put_mean(time, h, knots, chain.push, chain.dissipation.bed)
        steady, waits = steady_until(time, knots), time < knots.time[-1]
        pushed = steady < time + h or largest(chain.push) > 0.0
    return Forces(pushed, steady, waits, steady < time + h)


@inlined
def ending(time, over, flown, run):
    """Return the status with which a run ends at `time`, or RUNNING. `over` is True if nothing more can happen."""
    if time > run.extent.end - run.h * GRID_TOLERANCE:
        return DONE
    if over:
        return SEPARATED
    return OUT_OF_STEPS if run.log.counter[STEP] >= min(run.extent.most_steps + flown, NEVER) else RUNNING


@inlined
def steps_ahead(time, steady, free, rests, still, flown, run):
    """Return the Stretch of steps from `time` on. Take a flight or rest in which nothing changes at once.

    `steady` is the time until which forces and brakes do not change. `free` is True if no force acts, `rests` if all
    beads rest under the present forces.
    """
    chain, motion, counter, h, end = run.chain, run.motion, run.log.counter, run.h, run.extent.end
    until = end if counter[SAMPLE] == run.samples.time.size else min(end, run.samples.time[counter[SAMPLE]])
    ahead = until - time
    # a chain at rest or in free flight: take the whole steps before the next closing at once
    if rests or free:
        ahead = min(ahead, steady - time)
        if rests:
            flight = math.inf
        elif chain.strings.rest.size:
            flight = flight_on_strings(chain, motion, still)
        else:
            flight = flight_time(chain.graph, motion.overlap, motion.rate, still)
        whole = (
            0.0
            if chain.dissipation.bed.size > 0 and not rests
            else math.floor(min(flight, ahead, MOST_AT_ONCE * h) / h) - 1.0
        )
        if whole >= 1.0:
            fly(whole, h, chain, motion)
            counter[STEP] += int(whole)
            return Stretch(False, FLOWN, np.int64(whole), h, False)
        # A contact may close and open within one step without a change of its flag, so go at most one step beyond the
        # closing.
        ahead = min(ahead, flight + h)
    # the last step is shorter if the end is not on the grid
    if is_before(end, time, h):
        return Stretch(False, RUNNING, ONE, end - time, True)
    most = np.int64(min(max(1.0, ahead / h), MOST_AT_ONCE, run.extent.most_steps + flown - counter[STEP]))
    # a stretch ends at the next checkpoint
    return Stretch(False, RUNNING, min(most, run.plan[DUE] - counter[STEP]), h, False)


@inlined
def next_stretch(time, forces, progress, run):
    """Decide what a run does from `time` on. Return the Stretch, and the Progress at its end if nothing is logged.

    In this order: a sample before the next grid point, the rest of the stretch in which the run paused, the end of the
    run, a flight, or steps on the grid.
    """
    left, look, flown, closed, rests, still, rates, overlaps, calm = progress
    chain, motion, counter, wanted = run.chain, run.motion, run.log.counter, run.samples.time
    brakes, h, stop = chain.dissipation.bed, run.h, run.extent.stop
    bed = brakes.size > 0
    # a changed force may end the rest
    rests = rests and not forces.changing and forces.steady == calm
    if left == 0 and counter[SAMPLE] < wanted.size and is_before(wanted[counter[SAMPLE]], time, h):
        stretch = Stretch(True, RUNNING, ONE, wanted[counter[SAMPLE]] - time, False)
    elif left > 0:
        stretch = Stretch(False, RUNNING, left, h, False)
    else:
        if run.kept.time.size > 0 and time <= run.extent.end - h * GRID_TOLERANCE and counter[STEP] >= run.plan[DUE]:
            keep_checkpoint(time, motion, run.kept, run.plan, counter)
        # without closed contacts and forces the beads are in free flight
        over = free = closed == 0 and not forces.pushed
        # from time to time test if the closed contacts still push noticeably
        if stop and not bed and not forces.pushed and counter[STEP] >= look:
            over, look = pushes_no_more(chain, motion, still), 2 * counter[STEP]
        may_end = stop and not forces.waits
        over = may_end and (rests or (over and not meets_again(chain, brakes, motion, still, run.beads[0])))
        status = ending(time, over, flown, run)
        stretch = Stretch(False, status, ONE, h, True)
        if status == RUNNING:
            stretch = steps_ahead(time, forces.steady, free, rests, still, flown, run)
        if stretch.status == FLOWN:
            flown += stretch.most
        elif stretch.status == RUNNING:
            rests = bed and not forces.changing and at_rest(motion)
    return stretch, Progress(ZERO, look, flown, closed, rests, still, rates, overlaps, forces.steady)


@jit
def march(
    stepper, extent_fields, chain_fields, motion_fields, sample_fields, log_fields, checkpoints, pause_fields, memory
):
    """Take steps over an Extent and update the motion in place. Return the status and the time reached.

    The status is PAUSED when the step budget in `pause` is used up; call again with the same arguments to resume.

    Records come as plain tuples of their fields, which are cheap to pass from Python. `stepper` holds the drifts and
    kicks of `explicit_steps`, empty for a discrete gradient, and the step size [s]. `checkpoints` holds Samples and the
    plan, which gives the number of stored rows and when the next one is due. `memory` is scratch memory of the steps:
    (BEAD_ROWS, n+1) and (WORK_ROWS, n).
    """
    (drifts, kicks, h), (beads, work), (kept_fields, plan) = stepper, memory, checkpoints
    extent, chain, motion = Extent(*extent_fields), ChainData(*chain_fields), Motion(*motion_fields)
    samples, log, pause = Samples(*sample_fields), SwitchLog(*log_fields), Pause(*pause_fields)
    run = Run(h, extent, chain, motion, samples, log, Samples(*kept_fields), plan, beads)
    counter, start, end = log.counter, extent.start, extent.end
    between_walls = kicks.size == 0 and chain.inverse_mass[0] == 0.0 and chain.inverse_mass[-1] == 0.0
    between_walls = between_walls and chain.strings.rest.size == 0  # strings keep the round-off from growing
    progress = begin_or_resume(pause, run)
    time = start + counter[STEP] * h
    while True:
        # 1. Decide: the step budget may be used up between two stretches, or the run may end.
        forces = forces_ahead(time, run)
        if progress.left == 0 and counter[STEP] >= pause.counts[AT]:
            keep_pause(pause, ZERO, progress)
            return PAUSED, time
        stretch, progress = next_stretch(time, forces, progress, run)
        # free flight over whole steps: decide again at its end
        if stretch.status == FLOWN:
            time = start + counter[STEP] * h
            continue
        if stretch.status != RUNNING:
            return stretch.status, end if stretch.status == DONE else time
        # 2. Advance. A row of the samples is a motion: the same steps move it.
        moved, most, taken = motion, stretch.most, ZERO
        if stretch.sampling:
            moved = row_of(samples, counter[SAMPLE], motion)
            copy_motion(moved, motion)
        elif not stretch.last:
            # limit the stretch to the steps that are left before the pause
            most = min(most, max(pause.counts[AT] - counter[STEP], ONE))
        # steps on the grid end early at the first switch
        if not stretch.sampling or stretch.length > h * GRID_TOLERANCE:
            if kicks.size == 0:
                taken = gradient_steps(most, time, stretch.length, chain, moved, log.closed, beads, work, counter)
            else:
                taken = split_steps(most, time, stretch.length, drifts, kicks, chain, moved, log.closed, beads)
                counter[EVALUATION] += taken * kicks.size
        # a sample does not change the run itself
        if stretch.sampling:
            take_no_pull(moved)
            counter[SAMPLE] += 1
            continue
        counter[STEP] += taken
        # the step budget is used up within a stretch
        if taken == most and most < stretch.most and not has_stopped(chain, motion, log.closed):
            keep_pause(pause, stretch.most - taken, progress)
            return PAUSED, start + counter[STEP] * h
        # 3. End of a stretch: log switches, and correct the sum of overlaps between walls. A stretch ends with the
        # first switch.
        _, look, flown, _, rests, still, rates, overlaps, calm = progress
        before, now = start + (counter[STEP] - 1) * h, min(end, start + counter[STEP] * h)
        rests = rests and at_rest(motion)
        if between_walls:
            keep_wall_distance(now - start, motion, rates, overlaps)
        closed = log_switches(before, now, chain.graph, motion, log)
        if stretch.last:
            return DONE, end
        progress = Progress(ZERO, look, flown, closed, rests, still, rates, overlaps, calm)
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
