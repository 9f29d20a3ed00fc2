"""The loop around a fixed-step method: steps, samples, contact switches, the end of a collision. One for all methods.

Samples between steps are one shorter step of the same method from the last grid state, so they carry its accuracy and
leave the path itself alone. While no contact is closed, whole steps of free flight are taken at once: drift is exact.
"""

from __future__ import annotations

import math

from physics.kernels.explicit import drift, euler_step, verlet_step, yoshida4_step
from physics.kernels.jit import jit

EULER, VERLET, YOSHIDA4, CONSERVING = 0, 1, 2, 3

# what `march` returns
DONE, SEPARATED, OUT_OF_STEPS, FAILED = 0, 1, 2, 3

# entries of the counter array
STEP, SAMPLE, SWITCH, EVALUATION = 0, 1, 2, 3
COUNTERS = 4

GRID_TOLERANCE = 1e-9  # of a step: a sample this near to the grid is taken from the grid


@jit
def step_once(method, h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead):
    """One step of `method`; returns how often it evaluated every contact."""
    if method == EULER:
        euler_step(h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead)
        return 1
    if method == VERLET:
        verlet_step(h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead)
        return 1
    yoshida4_step(h, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead)
    return 3


@jit
def note_switches(time, overlap, rate, closed, switch_contact, switch_time, counter):
    """Compare each contact with its `closed` flag; book (contact, time) of every change. Returns contacts still closed.

    The time is that of the straight line through the new overlap with the new rate: second order in the step.
    """
    still = 0
    for i in range(overlap.size):
        now = overlap[i] > 0.0
        if now:
            still += 1
        if now != (closed[i] != 0):
            closed[i] = 1 if now else 0
            k = counter[SWITCH]
            back = overlap[i] / rate[i] if rate[i] != 0.0 else 0.0
            if k < switch_contact.size:
                switch_contact[k] = i
                switch_time[k] = time - back
            counter[SWITCH] = k + 1
    return still


@jit
def flight_time(overlap, rate):
    """Time until the first contact closes if none pushes: inf when all move apart, 0 when one is closed already."""
    first = math.inf
    for i in range(overlap.size):
        if overlap[i] > 0.0:
            return 0.0
        if rate[i] > 0.0:
            first = min(first, -overlap[i] / rate[i])
    return first


@jit
def write_sample(k, overlap, rate, anchor, force, sample_overlap, sample_rate, sample_anchor, sample_force):
    """Copy a state into row k of the sample arrays."""
    for i in range(overlap.size):
        sample_overlap[k, i] = overlap[i]
        sample_rate[k, i] = rate[i]
        sample_force[k, i] = force[i]
    sample_anchor[k, 0] = anchor[0]
    sample_anchor[k, 1] = anchor[1]


@jit
def copy_state(overlap, rate, anchor, force, to_overlap, to_rate, to_anchor, to_force):
    """Copy a state into another, element by element."""
    for i in range(overlap.size):
        to_overlap[i] = overlap[i]
        to_rate[i] = rate[i]
        to_force[i] = force[i]
    to_anchor[0] = anchor[0]
    to_anchor[1] = anchor[1]


@jit
def march(
    method, h, start, end, stop, most_steps, law, inverse_mass, push, anchor_bead,
    overlap, rate, anchor, force, spare_overlap, spare_rate, spare_anchor, spare_force,
    closed, switch_contact, switch_time,
    sample_time, sample_overlap, sample_rate, sample_anchor, sample_force, counter,
):  # fmt: skip
    """Step from `start` to `end` (or, with `stop`, until no contact can close again); the state is moved in place.

    `closed` (n,) flags, `switch_*` the book of contact switches, `sample_*` the rows to fill, `counter` see above.
    Returns the status and the time reached.
    """
    still = note_switches(start, overlap, rate, closed, switch_contact, switch_time, counter)
    first_step = counter[STEP]
    origin = start - first_step * h
    while True:
        time = origin + counter[STEP] * h
        while counter[SAMPLE] < sample_time.size and sample_time[counter[SAMPLE]] < time + h * (1.0 - GRID_TOLERANCE):
            k = counter[SAMPLE]
            beyond = sample_time[k] - time
            copy_state(overlap, rate, anchor, force, spare_overlap, spare_rate, spare_anchor, spare_force)
            if beyond > h * GRID_TOLERANCE:
                counter[EVALUATION] += step_once(
                    method, beyond, law, inverse_mass, push, spare_overlap, spare_rate, spare_anchor, spare_force,
                    anchor_bead,
                )  # fmt: skip
            write_sample(
                k, spare_overlap, spare_rate, spare_anchor, spare_force,
                sample_overlap, sample_rate, sample_anchor, sample_force,
            )  # fmt: skip
            counter[SAMPLE] += 1
        if time > end - h * GRID_TOLERANCE:
            return DONE, end
        if counter[STEP] - first_step >= most_steps:
            return OUT_OF_STEPS, time
        if still == 0 and push.size == 0:
            flight = flight_time(overlap, rate)
            if stop and flight == math.inf:
                return SEPARATED, time
            until = end if counter[SAMPLE] == sample_time.size else min(end, sample_time[counter[SAMPLE]])
            whole = math.floor(min(flight, until - time) / h) - 1.0
            if whole >= 1.0:
                drift(whole * h, overlap, rate, anchor)
                counter[STEP] += int(whole)
                continue
        last = min(h, end - time)
        counter[EVALUATION] += step_once(
            method, last, law, inverse_mass, push, overlap, rate, anchor, force, anchor_bead
        )  # fmt: skip
        counter[STEP] += 1
        still = note_switches(time + last, overlap, rate, closed, switch_contact, switch_time, counter)
        if last < h * (1.0 - GRID_TOLERANCE):
            return DONE, end
