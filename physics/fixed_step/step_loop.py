"""The loop around a fixed-step method: steps, samples, contact switches, the end of a collision. One for all methods.

Samples between steps are one shorter step of the same method from the last grid state, so they carry its accuracy and
leave the path itself alone. While no contact is closed, whole steps of free flight are taken at once: drift is exact.
"""

from __future__ import annotations

import math

from softcradle.physics.fixed_step.discrete_gradient import conserving_steps
from softcradle.physics.fixed_step.splitting import split_steps
from softcradle.physics.fixed_step.splitting_simd import LONG, long_steps
from softcradle.physics.numerics.jit import jit

# what `march` returns
DONE, SEPARATED, OUT_OF_STEPS, FAILED = 0, 1, 2, 3

# entries of the counter array: evaluations of all contacts, steps that did not converge, steps, sample rows, switches
EVALUATION, FAILURE, STEP, SAMPLE, SWITCH = 0, 1, 2, 3, 4
COUNTERS = 5

GRID_TOLERANCE = 1e-9  # of a step: a sample this near to the grid is taken from the grid
STANDSTILL = 1e-14  # of the fastest rate at the start: what is slower is round-off and closes nothing
MOST_AT_ONCE = 2**40  # steps; keeps the count an integer where the end is infinitely far


@jit
def steps(
    most, h, drifts, kicks, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, closed, work, counter
):  # fmt: skip
    """Up to `most` steps, until a contact switches: explicit by its drifts and kicks; conserving where there are none."""
    if kicks.size == 0:
        return conserving_steps(
            most, h, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, closed, work, counter
        )  # fmt: skip
    if overlap.size < LONG:
        taken = split_steps(
            most, h, drifts, kicks, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, closed
        )  # fmt: skip
    else:
        taken = long_steps(
            most, h, drifts, kicks, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, closed
        )  # fmt: skip
    counter[EVALUATION] += taken * kicks.size
    return taken


@jit
def note_switches(before, time, overlap, rate, force, closed, switch_contact, switch_time, counter):
    """Compare each contact with its `closed` flag; book (contact, time) of every change. Returns contacts still closed.

    The time is that of the straight line through the new overlap with the new rate, second order in the step; a contact
    that closes without overlap touches from the start of the step, at time `before`, on.
    """
    still = 0
    for i in range(overlap.size):
        now = overlap[i] > 0.0 or (overlap[i] == 0.0 and force[i] > 0.0)
        if now:
            still += 1
        if now != (closed[i] != 0):
            closed[i] = 1 if now else 0
            k = counter[SWITCH]
            if k < switch_contact.size:
                switch_contact[k] = i
                switch_time[k] = before if now and overlap[i] == 0.0 else time
                if overlap[i] != 0.0 and rate[i] != 0.0:
                    switch_time[k] = min(max(before, time - overlap[i] / rate[i]), time)
            counter[SWITCH] = k + 1
    return still


@jit
def flight_time(overlap, rate, still):
    """Time until the first contact closes if none pushes; inf when none closes faster than `still`."""
    first = math.inf
    for i in range(overlap.size):
        if rate[i] > still:
            first = min(first, -overlap[i] / rate[i])
    return first


@jit
def march(
    drifts, kicks, h, start, end, stop, most_steps, law, inverse_mass, push, anchor_bead,
    overlap, rate, anchor, force, spare_overlap, spare_rate, spare_anchor, spare_force,
    closed, work, switch_contact, switch_time,
    sample_time, sample_overlap, sample_rate, sample_anchor, sample_force, counter,
):  # fmt: skip
    """Step from `start` to `end` (or, with `stop`, until no contact can close again); the state is moved in place.

    `closed` (n,) flags, `switch_*` the book of contact switches, `sample_*` the rows to fill, `counter` see above.
    Returns the status and the time reached.
    """
    n = overlap.size
    slow = 0.0
    for i in range(n):
        slow = max(slow, STANDSTILL * abs(rate[i]))
    still = note_switches(start, start, overlap, rate, force, closed, switch_contact, switch_time, counter)
    while True:
        time = start + counter[STEP] * h
        while counter[SAMPLE] < sample_time.size and sample_time[counter[SAMPLE]] < time + h * (1.0 - GRID_TOLERANCE):
            k = counter[SAMPLE]
            counter[SAMPLE] += 1
            for i in range(n):
                spare_overlap[i], spare_rate[i], spare_force[i] = overlap[i], rate[i], force[i]
            spare_anchor[0], spare_anchor[1] = anchor[0], anchor[1]
            if sample_time[k] - time > h * GRID_TOLERANCE:
                steps(
                    1, sample_time[k] - time, drifts, kicks, law, inverse_mass, push, anchor_bead,
                    spare_overlap, spare_rate, spare_anchor, spare_force, closed, work, counter,
                )  # fmt: skip
            for i in range(n):
                sample_overlap[k, i], sample_rate[k, i] = spare_overlap[i], spare_rate[i]
                sample_force[k, i] = spare_force[i]
            sample_anchor[k, 0], sample_anchor[k, 1] = spare_anchor[0], spare_anchor[1]
        if time > end - h * GRID_TOLERANCE:
            return DONE, end
        if counter[STEP] >= most_steps:
            return OUT_OF_STEPS, time
        until = end if counter[SAMPLE] == sample_time.size else min(end, sample_time[counter[SAMPLE]])
        if still == 0 and push.size == 0:
            flight = flight_time(overlap, rate, slow)
            if stop and flight == math.inf:
                return SEPARATED, time
            whole = math.floor(min(flight, until - time) / h) - 1.0
            if whole >= 1.0:
                for i in range(n):
                    overlap[i] += whole * h * rate[i]
                anchor[0] += whole * h * anchor[1]
                counter[STEP] += int(whole)
                continue
        whole_step = end - time >= h * (1.0 - GRID_TOLERANCE)
        length = h if whole_step else end - time
        most = 1 if not whole_step else int(min(max(1.0, (until - time) / h), MOST_AT_ONCE, most_steps - counter[STEP]))
        counter[STEP] += steps(
            most, length, drifts, kicks, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, closed,
            work, counter,
        )  # fmt: skip
        before, time = time, min(end, start + counter[STEP] * h)
        still = note_switches(before, time, overlap, rate, force, closed, switch_contact, switch_time, counter)
        if not whole_step:
            return DONE, end
