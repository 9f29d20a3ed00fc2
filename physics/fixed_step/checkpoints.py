"""Checkpoints: motions on the way of a run, from which its samples are taken when its end is known; and its pauses.

A run without a duration does not know the times of its samples before it is over. It keeps its motion every few steps; where
the rows are full, every second one goes and the steps between them double, so that any run fits and few steps are made again.

A long run hands back now and then, because Python hears no signal while a kernel runs. It goes on as if it had not paused.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.numerics.jit import inlined
from softcradle.physics.numerics.records import STEP
from softcradle.physics.numerics.switches import copy_into, put_row

Array = NDArray[np.float64]

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

MOST_ROWS, MOST_NUMBERS = 1024, 2**22  # checkpoints of a run, and numbers that they take: 32 MB
# steps between two at first; to leave the loop of steps after each one would cost a short chain half of a run
FIRST_SPACING = 4
NEVER = 2**62  # steps


class Checkpoints(NamedTuple):
    """Rows of a motion as of Samples, and the plan: how many there are and when the next is due."""

    time: Array  # (R,) [s]
    overlap: Array  # (R, n)
    rate: Array  # (R, n)
    anchor: Array  # (R, 2)
    force: Array  # (R, n)
    taken: Array  # (R, 4)
    plan: NDArray[np.int64]  # (3,)


class Pause(NamedTuple):
    """When a run hands back, and what it needs to go on."""

    counts: NDArray[np.int64]  # (8,)
    numbers: Array  # (5,)


def no_pause() -> Pause:
    """Memory for the pauses of a run; as it is there are none."""
    counts = np.zeros(8, dtype=np.int64)
    counts[AT] = NEVER
    return Pause(counts, np.zeros(5))


def empty_checkpoints(contacts: int, kept: bool) -> Checkpoints:
    """Rows for a chain with `contacts`; none where no checkpoints are `kept`."""
    rows = min(MOST_ROWS, max(2, MOST_NUMBERS // (3 * contacts))) if kept else 0
    wide, narrow = (rows, contacts), (rows, 2)
    plan = np.array([0, 0 if kept else NEVER, FIRST_SPACING])
    return Checkpoints(
        np.empty(rows), np.empty(wide), np.empty(wide), np.empty(narrow), np.empty(wide), np.empty((rows, 4)), plan
    )


@inlined
def keep_checkpoint(time, motion, kept, counter):
    """Keep the motion at `time`; where there is no row left, first leave every second one out."""
    plan, rows = kept.plan, kept.time.size
    if plan[COUNT] == rows:
        left = (rows + 1) // 2
        for k in range(1, left):
            kept.time[k] = kept.time[2 * k]
            copy_into(kept.overlap[k], kept.overlap[2 * k])
            copy_into(kept.rate[k], kept.rate[2 * k])
            copy_into(kept.anchor[k], kept.anchor[2 * k])
            copy_into(kept.force[k], kept.force[2 * k])
            copy_into(kept.taken[k], kept.taken[2 * k])
        plan[COUNT], plan[SPACING] = left, 2 * plan[SPACING]
    k = plan[COUNT]
    kept.time[k] = time
    put_row(kept, k, motion)
    plan[COUNT], plan[DUE] = k + 1, counter[STEP] + plan[SPACING]


@inlined
def keep_pause(pause, left, look, flown, closed, rests, still, rates, overlaps):
    """Keep what the loop knows, `left` steps before it looks up again."""
    counts, numbers = pause.counts, pause.numbers
    counts[BEGUN], counts[LEFT], counts[LOOK], counts[FLOWN_STEPS] = 1, left, look, flown
    counts[CLOSED], counts[RESTS] = closed, 1 if rests else 0
    numbers[STILL], numbers[RATES], numbers[RATES + 1] = still, rates[0], rates[1]
    numbers[OVERLAPS], numbers[OVERLAPS + 1] = overlaps[0], overlaps[1]
