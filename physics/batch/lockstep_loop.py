"""The loop around explicit steps side by side: lanes take chain after chain, each steps on until one of its contacts switches.

What a chain does between two runs of steps is `look_ahead`, as for a chain alone; here its numbers lie in rows of the batch.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.batch.lockstep_steps import ANY, HERTZ, HOOKE, LANES, Lanes, lane_steps
from softcradle.physics.fixed_step.next_steps import FIRST_LOOK, FLOWN, RUNNING, look_ahead, seems_over
from softcradle.physics.fixed_step.step_loop import STANDSTILL, largest, log_switches
from softcradle.physics.numerics.bead_velocities import at_rest
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.records import DONE, EVALUATION, ONE, STEP, ChainData, Motion, SwitchLog

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

FREE_LANE = -1  # in place of a chain
ENDLESS = 2**62  # steps: more than any run has


class BatchData(NamedTuple):
    """What does not move: a row a chain."""

    law: Array  # (C, n, 3)
    loss: Array  # (C, n)
    inverse_mass: Array  # (C, n+1)
    push: Array  # (C, n+1)
    bed: Array  # (C, n+1)
    step: Array  # (C,)
    end: Array  # (C,) inf: none


class BatchMotion(NamedTuple):
    """What moves, and what the end is: a row a chain."""

    overlap: Array  # (C, n)
    rate: Array  # (C, n)
    anchor: Array  # (C, 2)
    force: Array  # (C, n)
    closed: NDArray[np.int8]  # (C, n)
    counter: Whole  # (C, COUNTERS)
    status: Whole  # (C,)
    time: Array  # (C,) when the run ended


class LaneState(NamedTuple):
    """How far each lane is, and scratch memory of a chain."""

    chain: Whole  # (LANES,) which chain, or FREE_LANE
    left: Whole  # (LANES,) steps until it looks up
    last: Whole  # (LANES,) nonzero: these end its run
    flown: Whole  # (LANES,) steps of flights, which do not count against the limit of a run
    look: Whole  # (LANES,) the step at which it looks whether closed contacts still push
    rests: Whole  # (LANES,) nonzero: all its beads rest
    still: Array  # (LANES,) rates up to which nothing closes
    velocity: Array  # (n+1,)
    contact: Whole  # (0,) of a log of switches that only counts
    switch_time: Array  # (0,)
    absorbed: Array  # (2,)
    flags: NDArray[np.int8]  # (0,)


def empty_state(contacts: int) -> LaneState:
    """The state of lanes without chains."""

    def whole(count: int) -> Whole:
        return np.zeros(count, dtype=np.int64)

    scratch = np.zeros(contacts + 1), whole(0), np.zeros(0), np.zeros(2), np.zeros(0, dtype=np.int8)
    return LaneState(
        whole(LANES), whole(LANES), whole(LANES), whole(LANES), whole(LANES), whole(LANES), np.zeros(LANES), *scratch
    )  # fmt: skip


@inlined
def laws_alike(i, lanes):
    """What the laws of contact i have in common in all lanes; free lanes have the exponent 0."""
    hooke, hertz = True, True
    for k in range(LANES):
        hooke &= lanes.exponent[i, k] == 1.0 or lanes.exponent[i, k] == 0.0
        hertz &= lanes.exponent[i, k] == 1.5 or lanes.exponent[i, k] == 0.0
    return HOOKE if hooke else (HERTZ if hertz else ANY)


@inlined
def take_chain(k, c, batch, lanes):
    """Put what does not move of chain c into lane k."""
    n = batch.loss.shape[1]
    for i in range(n):
        lanes.preload[i, k], lanes.stiffness[i, k], lanes.exponent[i, k] = (
            batch.law[c, i, 0],
            batch.law[c, i, 1],
            batch.law[c, i, 2],
        )
        lanes.kept[i, k] = 1.0 - batch.loss[c, i]
        lanes.kind[i] = laws_alike(i, lanes)
    for j in range(n + 1):
        lanes.inverse_mass[j, k] = batch.inverse_mass[c, j]
        lanes.push[j, k] = batch.push[c, j]
        lanes.bed[j, k] = batch.bed[c, j]


@inlined
def read_lane(k, c, lanes, moving):
    """Bring the motion of lane k to the rows of its chain."""
    for i in range(moving.overlap.shape[1]):
        moving.overlap[c, i], moving.rate[c, i] = lanes.overlap[i, k], lanes.rate[i, k]
        moving.force[c, i] = lanes.force[i + 1, k]
    moving.anchor[c, 0], moving.anchor[c, 1] = lanes.anchor[0, k], lanes.anchor[1, k]


@inlined
def write_lane(k, c, lanes, moving):
    """Bring the motion of a chain to lane k."""
    for i in range(moving.overlap.shape[1]):
        lanes.overlap[i, k], lanes.rate[i, k] = moving.overlap[c, i], moving.rate[c, i]
        lanes.force[i + 1, k] = moving.force[c, i]
        lanes.closed[i, k] = moving.closed[c, i]
    lanes.anchor[0, k], lanes.anchor[1, k] = moving.anchor[c, 0], moving.anchor[c, 1]


@inlined
def clear_lane(k, lanes):
    """Make lane k one in which nothing moves and nothing is closed."""
    for i in range(lanes.rate.shape[0]):
        lanes.overlap[i, k], lanes.rate[i, k], lanes.force[i + 1, k], lanes.closed[i, k] = -1.0, 0.0, 0.0, 0
        lanes.exponent[i, k] = 0.0
    lanes.anchor[0, k], lanes.anchor[1, k], lanes.step[k] = 0.0, 1.0, 0.0  # a free lane does not rest
    for j in range(lanes.inverse_mass.shape[0]):
        lanes.push[j, k], lanes.bed[j, k] = 0.0, 0.0


@jit
def look_up(k, c, begins, stop, most_steps, driven, braked, bead, batch, moving, lanes, state):
    """Log what has switched in chain c of lane k, and say how it goes on. Returns whether it steps on in its lane."""
    push = batch.push[c] if driven else batch.push[c][:0]
    brakes = batch.bed[c] if braked else batch.bed[c][:0]
    chain = ChainData(batch.law[c], batch.inverse_mass[c], push, push, bead, None, None)
    motion = Motion(
        moving.overlap[c], moving.rate[c], moving.anchor[c], moving.force[c], state.absorbed, state.flags, state.flags
    )
    log = SwitchLog(state.contact, state.switch_time, moving.closed[c], moving.counter[c])
    counter, h, end = log.counter, batch.step[c], batch.end[c]
    if begins:
        state.still[k], state.rests[k] = STANDSTILL * largest(motion.rate), 0
        state.flown[k], state.look[k] = 0, FIRST_LOOK
    elif state.rests[k] != 0 and not at_rest(motion):
        state.rests[k] = 0
    before, now = (counter[STEP] - 1) * h, min(end, counter[STEP] * h)
    closed = log_switches(0.0 if begins else before, 0.0 if begins else now, None, motion, log)
    status, most, length, last = DONE, ONE, h, True
    if begins or state.last[k] == 0:
        status = FLOWN
    while status == FLOWN:
        over, state.look[k] = seems_over(
            stop and not braked, closed, state.look[k], state.still[k], chain, motion, counter
        )
        status, most, length, last = look_ahead(
            counter[STEP] * h, end, end, stop, h, most_steps + state.flown[k], closed, over, state.rests[k] != 0, state.still[k],
            chain, brakes, motion, counter, state.velocity,
        )  # fmt: skip
        state.flown[k] += most if status == FLOWN else 0
    state.left[k], lanes.step[k], state.last[k] = most, length, 1 if last else 0
    if status == RUNNING:
        state.rests[k] = 1 if braked and at_rest(motion) else 0
        write_lane(k, c, lanes, moving)
        return True
    moving.status[c], moving.time[c] = status, end if status == DONE else counter[STEP] * h
    return False


@inlined
def next_chain(k, taken, which, stop, most_steps, driven, braked, bead, batch, moving, lanes, state):
    """Give lane k the next of the chains `which` that takes a step, or leave it free. Returns how many have been taken."""
    while taken < which.size:
        c = which[taken]
        taken += 1
        if look_up(k, c, True, stop, most_steps, driven, braked, bead, batch, moving, lanes, state):
            take_chain(k, c, batch, lanes)
            state.chain[k] = c
            return taken
    state.chain[k], state.left[k] = FREE_LANE, ENDLESS
    clear_lane(k, lanes)
    return taken


@jit
def march_lanes(
    which, drifts, kicks, stop, most_steps, driven, dissipates, braked, bead, batch_fields, motion_fields, lane_fields,
    state_fields,
):  # fmt: skip
    """Move the chains `which` of a batch to their ends in place; all have the anchor bead `bead`.

    Either all or none are `driven`, dissipate, and have beads that are `braked`. Records come as plain tuples of their fields.
    """
    batch, moving = BatchData(*batch_fields), BatchMotion(*motion_fields)
    lanes, state = Lanes(*lane_fields), LaneState(*state_fields)
    taken, steps = 0, 0
    for k in range(LANES):
        taken = next_chain(k, taken, which, stop, most_steps, driven, braked, bead, batch, moving, lanes, state)
    while True:
        run = ENDLESS
        for k in range(LANES):
            run = min(run, state.left[k])
        if run == ENDLESS:
            return
        steps = lane_steps(run, drifts, kicks, driven, dissipates, braked, bead, lanes)
        for k in range(LANES):
            c = state.chain[k]
            if c == FREE_LANE:
                continue
            state.left[k] -= steps
            moving.counter[c, STEP] += steps
            moving.counter[c, EVALUATION] += steps * kicks.size
            if state.left[k] == 0 or lanes.switched[k] != 0:
                read_lane(k, c, lanes, moving)
                if not look_up(k, c, False, stop, most_steps, driven, braked, bead, batch, moving, lanes, state):
                    taken = next_chain(
                        k, taken, which, stop, most_steps, driven, braked, bead, batch, moving, lanes, state
                    )
