"""What a run of fixed steps does next: it ends, flies, or takes so many steps before it looks up again. One for all loops."""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.numerics.jit import inlined
from softcradle.physics.numerics.meeting import flight_time, meets_again, pushes_no_more
from softcradle.physics.numerics.records import DONE, ONE, OUT_OF_STEPS, SEPARATED, STEP

RUNNING = -1  # in place of a status: there are steps to take
FLOWN = -2  # in place of a status: it looks ahead once more

GRID_TOLERANCE = 1e-9  # of a step: what is this near to the grid is on it
FIRST_LOOK = 256  # steps after which a run looks if closed contacts still push; then twice as many, and so on
MOST_COUNTED = 2**62  # steps of a run, those of flights included: their number stays one of 64 bits
MOST_FLOWN = 2.0**61  # steps of a flight, for the same reason
MOST_AT_ONCE = 2**40  # steps; keeps the count an integer where the end is infinitely far


@inlined
def fly(steps, h, motion):
    """Take whole steps of free flight at once."""
    for i in range(motion.overlap.size):
        motion.overlap[i] += steps * h * motion.rate[i]
    motion.anchor[0] += steps * h * motion.anchor[1]


@inlined
def seems_over(looks, closed, look, still, pushed, chain, motion, counter):
    """Whether no contact pushes beads apart any more, and the step at which to look closer next, if it `looks`."""
    over = closed == 0 and not pushed
    if looks and not pushed and counter[STEP] >= look:
        return pushes_no_more(chain, motion, still), 2 * counter[STEP]
    return over, look


@inlined
def look_ahead(
    time, end, until, stop, h, most_steps, closed, over, rests, still, pushed, chain, brakes, motion, counter, velocity
):
    """How a run goes on from `time`; a flight in which no contact closes is flown at once. `until` is the next sample or the end.

    `closed` is the number of closed contacts, `over` as of `seems_over`, `rests` whether all beads rest whatever acts on them,
    `pushed` whether a force from outside acts on any, `brakes` (n+1,) or (0,) as of `meets_again`, `velocity` (n+1,) scratch
    memory. Returns a status, or RUNNING or FLOWN; how many steps to take at the most, or have been flown; their length; and
    whether they end at `end`, off the grid.
    """
    bed = brakes.size > 0
    if time > end - h * GRID_TOLERANCE:
        return DONE, ONE, h, True
    free = closed == 0 and not pushed
    if stop and (rests or (over and not meets_again(chain, brakes, motion, still, velocity))):
        return SEPARATED, ONE, h, True
    if counter[STEP] >= min(most_steps, MOST_COUNTED):
        return OUT_OF_STEPS, ONE, h, True
    ahead = until - time
    if rests or free:
        flight = math.inf if rests else flight_time(chain.joints, motion.overlap, motion.rate, still)
        whole = 0.0 if bed and not rests else math.floor(min(flight, ahead, MOST_FLOWN * h) / h) - 1.0
        if whole >= 1.0:
            fly(whole, h, motion)
            counter[STEP] += int(whole)
            return FLOWN, np.int64(whole), h, False
        # A contact may close and open within one step, where no flag tells of it.
        ahead = min(ahead, flight + h)
    if end - time < h * (1.0 - GRID_TOLERANCE):
        return RUNNING, ONE, end - time, True
    return RUNNING, np.int64(min(max(1.0, ahead / h), MOST_AT_ONCE, most_steps - counter[STEP])), h, False
