"""The loop around a fixed-step method where something rubs: as softcradle.physics.fixed_step.step_loop, with the ledger of what is absorbed.

On a bed that rubs no flight is free, and a run to the end stops when no contact pushes and none can close any more before
the beads have slid to rest, or when everything rests.
"""

from __future__ import annotations

import math

from softcradle.physics.fixed_step.dissipative_gradient import bead_velocities, dry_steps
from softcradle.physics.fixed_step.dissipative_splitting import dry_split_steps
from softcradle.physics.fixed_step.step_loop import (
    DONE,
    EVALUATION,
    GRID_TOLERANCE,
    MOST_AT_ONCE,
    OUT_OF_STEPS,
    SAMPLE,
    SEPARATED,
    STANDSTILL,
    STEP,
    flight_time,
    note_switches,
)
from softcradle.physics.numerics.copying import copy_into
from softcradle.physics.numerics.jit import jit


@jit
def steps(
    most, h, drifts, kicks, law, loss, inverse_mass, push, bed, anchor_bead, overlap, rate, anchor, force, closed, absorbed,
    work, beads, counter,
):  # fmt: skip
    """Up to `most` steps, until a contact switches or all rest; conserving where there are no kicks."""
    if kicks.size == 0:
        return dry_steps(
            most, h, law, loss, inverse_mass, push, bed, anchor_bead, overlap, rate, anchor, force, closed, absorbed, work,
            beads, counter,
        )  # fmt: skip
    taken = dry_split_steps(
        most, h, drifts, kicks, law, loss, inverse_mass, push, bed, anchor_bead, overlap, rate, anchor, force, closed,
        absorbed, beads,
    )  # fmt: skip
    counter[EVALUATION] += taken * kicks.size
    return taken


@jit
def closes_again(bed, anchor_bead, overlap, rate, anchor, slow, velocity):
    """Whether two beads that are apart will meet if nothing pushes: each slides on and comes to rest v²/(2 mu g) away."""
    if bed.size == 0:
        return flight_time(overlap, rate, slow) < math.inf
    bead_velocities(rate, anchor_bead, anchor[1], velocity)
    for i in range(overlap.size):
        if rate[i] > slow:
            left, right = velocity[i], velocity[i + 1]
            ahead = math.inf if bed[i] == 0.0 and left > 0.0 else 0.0
            behind = -math.inf if bed[i + 1] == 0.0 and right < 0.0 else 0.0
            if bed[i] > 0.0:
                ahead = 0.5 * left * abs(left) / bed[i]
            if bed[i + 1] > 0.0:
                behind = 0.5 * right * abs(right) / bed[i + 1]
            if overlap[i] + ahead - behind > 0.0:
                return True
    return False


@jit
def at_rest(rate, anchor):
    """Whether no bead moves."""
    resting = anchor[1] == 0.0
    for i in range(rate.size):
        resting &= rate[i] == 0.0
    return resting


@jit
def dry_march(
    drifts, kicks, h, start, end, stop, most_steps, law, loss, inverse_mass, push, bed, anchor_bead,
    overlap, rate, anchor, force, absorbed, spare_overlap, spare_rate, spare_anchor, spare_force, spare_absorbed,
    closed, work, beads, switch_contact, switch_time,
    sample_time, sample_overlap, sample_rate, sample_anchor, sample_force, sample_absorbed, counter,
):  # fmt: skip
    """Step from `start` to `end`, or, with `stop`, until no contact can close again or all beads rest; see `march`.

    `absorbed` (2,) and `sample_absorbed` (T, 2): energy taken by the contacts and by the bed.
    """
    n = overlap.size
    slow = 0.0
    for i in range(n):
        slow = max(slow, STANDSTILL * abs(rate[i]))
    still = note_switches(start, start, overlap, rate, force, closed, switch_contact, switch_time, counter)
    rested = False
    while True:
        time = start + counter[STEP] * h
        while counter[SAMPLE] < sample_time.size and sample_time[counter[SAMPLE]] < time + h * (1.0 - GRID_TOLERANCE):
            k = counter[SAMPLE]
            counter[SAMPLE] += 1
            copy_into(spare_overlap, overlap)
            copy_into(spare_rate, rate)
            copy_into(spare_force, force)
            copy_into(spare_anchor, anchor)
            copy_into(spare_absorbed, absorbed)
            if sample_time[k] - time > h * GRID_TOLERANCE:
                steps(
                    1, sample_time[k] - time, drifts, kicks, law, loss, inverse_mass, push, bed, anchor_bead, spare_overlap,
                    spare_rate, spare_anchor, spare_force, closed, spare_absorbed, work, beads, counter,
                )  # fmt: skip
            copy_into(sample_overlap[k], spare_overlap)
            copy_into(sample_rate[k], spare_rate)
            copy_into(sample_force[k], spare_force)
            copy_into(sample_anchor[k], spare_anchor)
            copy_into(sample_absorbed[k], spare_absorbed)
        if time > end - h * GRID_TOLERANCE:
            return DONE, end
        free = still == 0 and push.size == 0
        if stop and (rested or (free and not closes_again(bed, anchor_bead, overlap, rate, anchor, slow, beads[0]))):
            return SEPARATED, time
        if counter[STEP] >= most_steps:
            return OUT_OF_STEPS, time
        until = end if counter[SAMPLE] == sample_time.size else min(end, sample_time[counter[SAMPLE]])
        if rested or (free and bed.size == 0):
            flight = math.inf if rested else flight_time(overlap, rate, slow)
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
        rested = at_rest(rate, anchor)
        counter[STEP] += steps(
            most, length, drifts, kicks, law, loss, inverse_mass, push, bed, anchor_bead, overlap, rate, anchor, force,
            closed, absorbed, work, beads, counter,
        )  # fmt: skip
        rested &= at_rest(rate, anchor) and bed.size > 0
        time = min(end, start + counter[STEP] * h)
        before = time - length  # the switch is in the last step
        still = note_switches(before, time, overlap, rate, force, closed, switch_contact, switch_time, counter)
        if not whole_step:
            return DONE, end
