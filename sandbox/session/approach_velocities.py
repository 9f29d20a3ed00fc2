"""The approach: how beads went into the collision that is under way, or that comes next."""

from __future__ import annotations

import numpy as np
from softcradle.sandbox.motion import Array
from softcradle.sandbox.session.frame_history import History
from softcradle.sandbox.session.history_slices import history_slices

ROWS = 512  # of the history that are searched at a time


def approach_of(history: History, lane: int, frame: int) -> tuple[Array, Array] | None:
    """(n,) overlaps and (n+1,) velocities at the latest frame up to `frame` at which no contact of the lane carried a force.

    None where there is no such frame since the number of beads changed last: no collision began there.
    """
    last = frame
    while last >= history.first:
        first = max(history.first, last - ROWS + 1)
        for part in reversed(list(history_slices(history, lane, first, last))):
            if last == frame and part.first + len(part.time) > frame:
                contacts = part.chain.contacts
            if part.chain.contacts != contacts:
                return None
            free = np.flatnonzero(~(part.force > 0.0).any(axis=1))
            if free.size:
                return part.overlap[free[-1]], part.velocity[free[-1]]
        last = first - 1
    return None
