"""Slices of the history. A slice contains frames of one lane with one setup, as arrays for plots and exports."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.session.frame_history import Block, History, LaneRows
from softcradle.sandbox.session.lane_setup import LaneSetup
from softcradle.sandbox.session.ledger import BY_BED, BY_CONTACTS

ROWS = 512  # Number of rows of the history that are searched at a time.


def approach_of(history: History, lane: int, frame: int) -> tuple[Array, Array] | None:
    """Return the overlaps (n,) and velocities (n+1,) of a lane before a collision.

    They are the values of the latest frame up to `frame` in which no contact of the lane carries a force. Return None
    if there is no such frame with the present number of beads.
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


@dataclass(frozen=True, eq=False, kw_only=True)
class HistorySlice(Motion):
    """Motion of one lane from frame `first` on, with one setup. Frames may be left out at regular intervals.

    Attributes:
        first: frame of row 0.
        setup: the LaneSetup; its chain is `chain`.
        step: longest step [s] that was taken; 0 for an adaptive method.
        ledger: (T, 13) energy and momentum balance, see :mod:`softcradle.sandbox.session.ledger`.
    """

    first: int
    setup: LaneSetup
    step: float
    ledger: Array


def history_slices(history: History, lane: int, first: int, last: int, most: int = 0) -> Iterator[HistorySlice]:
    """Yield the stored frames from `first` to `last` of a lane, as one slice for each block and setup.

    If `most` > 0, yield between `most` and twice as many frames. Only every second, fourth, eighth ... frame, counted
    from frame 0, is then included. The frames of a longer part are therefore a subset of the frames of a shorter part.
    A curve that is drawn in pieces equals the curve drawn at once.
    """
    first, last = max(first, history.first), min(last, history.last)
    stride = 1 << max(0, ((last - first) // most).bit_length() - 1) if most else 1
    for block in history.blocks:
        low, high = max(first - block.first, 0), min(last - block.first + 1, block.used)
        if low < high:
            yield from _of_block(block, lane, low, high, stride)


def slice_at(history: History, lane: int, frame: int) -> HistorySlice:
    """Return a slice that contains a single frame of a lane."""
    return next(history_slices(history, lane, frame, frame))


def last_slice(history: History, lane: int, last: int) -> HistorySlice:
    """Return the frames of a lane up to `last`, as one slice. The slice begins where the chain or the method last
    changed.

    Its setup is the setup of the frame `last`.
    """
    setup, every = slice_at(history, lane, last).setup, list(history_slices(history, lane, history.first, last))
    alike = [part.chain is setup.chain and part.setup.method == setup.method for part in every]
    slices = every[len(every) - [*reversed(alike), False].index(False) :]
    step = max(part.step for part in [part for part in slices if part.first < last] or slices)
    names = ("time", *LaneRows._fields)
    time, *arrays = (np.concatenate([getattr(part, name) for part in slices]) for name in names)
    return _slice(slices[0].first, setup, step, time, LaneRows(*arrays))


def _of_block(block: Block, lane: int, low: int, high: int, stride: int) -> Iterator[HistorySlice]:
    """Yield a slice for each setup in the rows `low` to `high` (exclusive) of a block. Only every `stride`-th row is
    included.
    """
    ends = [*(row for row, _ in block.setups[1:]), block.used]
    for (begin, setup), end in zip(block.setups, ends, strict=True):
        start, stop = max(low, begin), min(high, end)
        start += -(block.first + start) % stride
        if start < stop:
            rows = slice(start, stop, stride)
            arrays = LaneRows(*(array[rows] for array in block.lanes[lane]))
            own = setup.lanes[lane]
            step = own.step_for(setup.frame_time) or 0.0
            yield _slice(block.first + start, own, step, block.time[rows], arrays)


def _slice(first: int, setup: LaneSetup, step: float, time: Array, rows: LaneRows) -> HistorySlice:
    absorbed = rows.ledger[:, BY_CONTACTS] + rows.ledger[:, BY_BED] if setup.chain.dissipative else np.zeros(0)
    frames = rows._asdict()
    return HistorySlice(chain=setup.chain, time=time, absorbed=absorbed, first=first, setup=setup, step=step, **frames)
