"""Contact events: times at which contacts close and open. The engine locates them within each frame of the history."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.contact import is_closed
from softcradle.physics.state import NO_SWITCHES, Switches
from softcradle.sandbox.session.frame_history import Block, History

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


class ContactEvents(NamedTuple):
    """Contact events in order of time. Each field is an array of shape (K,).

    Attributes:
        time: time located by the engine [s]. If an edit has closed or opened the contact, the time of the frame.
        frame: the first frame after the event.
        lane, contact: indices.
        closed: True if the contact closed, False if it opened.
        speed: closing speed of the two beads [m/s] in the frame before the contact closed. If the beads did not
            approach each other in that frame, their speed in the next frame. It is 0 if the contact opened, or if an
                edit closed it.
        approach: speed at which the two beads approached each other in the frame before the event [m/s]. It is negative
            if
            they separated, and 0 for an event caused by an edit.
    """

    time: Array
    frame: Integers
    lane: Integers
    contact: Integers
    closed: Mask
    speed: Array
    approach: Array

    def select(self, rows: Mask | Integers) -> ContactEvents:
        """Return the events selected by `rows`, a mask or an array of indices."""
        return ContactEvents._make(array[rows] for array in self)


class Impact(NamedTuple):
    """A contact that closed and makes a click sound. The closing speed is in m/s."""

    time: float
    lane: int
    contact: int
    speed: float


def contact_events(history: History, after: int = -1) -> ContactEvents:
    """Return the contact events of `history` later than frame `after`."""
    events = _joined([_of(block, before) for before, block in history.pairs() if block.first + block.used - 1 > after])
    return events if after < history.first else events.select(events.frame > after)


def _of(block: Block, before: Block | None) -> ContactEvents:
    lanes = range(len(block.lanes))
    return block.found(
        ("events", before is None),
        lambda: _joined([*block.replaced, *(_lane_events(block, before, lane) for lane in lanes)]),
    )


def _lane_events(block: Block, before: Block | None, lane: int) -> ContactEvents:
    """Return the events of one lane in the rows of a block.

    Events of the first row are included only if the previous block has the same beads.
    """
    rows, first = block.lanes[lane], 1
    columns = [array[: block.used] for array in (rows.overlap, rows.force, rows.rate)]
    if before is not None and before.widths[lane] == block.widths[lane] and not block.replaced:
        earlier, k, first = before.lanes[lane], before.used - 1, 0
        last_row = [array[k : k + 1] for array in (earlier.overlap, earlier.force, earlier.rate)]
        columns = [np.concatenate(pair) for pair in zip(last_row, columns, strict=True)]
    overlap, force, rate = columns
    logs = {row - first: lanes[lane] for row, lanes in block.switches.items() if row >= first}
    time = block.time[first : block.used]
    return _events(lane, block.first + first, time, is_closed(overlap, force), rate, logs)


def _events(lane: int, first: int, time: Array, closed: Mask, rate: Array, logs: dict[int, Switches]) -> ContactEvents:
    """Return the events of consecutive frames from their `logs` by row. The frames begin at `first`, at the times
    `time` (R,).

    `closed` and `rate` (R+1, n) start at the previous frame. If the log does not explain the state of a contact, an
    edit has switched the contact, or the log was full.
    """
    row = np.repeat(np.array([*logs], dtype=np.int64), [own.time.size for own in logs.values()])
    contact, when = (np.concatenate(column) for column in zip(NO_SWITCHES, *logs.values(), strict=True))
    count = np.zeros((time.size, closed.shape[1]), dtype=np.int64)
    np.add.at(count, (row, contact), 1)
    now = closed[row, contact] ^ (_rank(row * closed.shape[1] + contact) % 2 == 0)
    approach, after = rate[row, contact], np.abs(rate[row + 1, contact])
    speed = np.where(now, np.where(approach > 0.0, approach, after), 0.0)
    edited, changed = np.nonzero(closed[:-1] ^ closed[1:] ^ (count % 2 == 1))
    lanes = np.full(row.size, lane), np.full(edited.size, lane)
    none = np.zeros(edited.size)
    by_edit = time[edited], first + edited, lanes[1], changed, closed[edited + 1, changed], none, none
    own = ContactEvents(when, first + row, lanes[0], contact, now, speed, approach)
    return _joined([own, ContactEvents(*by_edit)])


def _rank(key: Integers) -> Integers:
    """Return (S,) the number of preceding entries with the same key, for each entry."""
    order = np.argsort(key, kind="stable")
    run_start = np.concatenate(([True], np.diff(key[order]) != 0))[: key.size]
    place = np.arange(key.size)
    rank = np.empty(key.size, dtype=np.int64)
    rank[order] = place - np.maximum.accumulate(np.where(run_start, place, 0))
    return rank


def _joined(parts: list[ContactEvents]) -> ContactEvents:
    """Return the events of all `parts` in order of time."""
    if not parts:
        empty, integers = np.empty(0), np.empty(0, dtype=np.int64)
        return ContactEvents(empty, integers, integers, integers, empty.astype(bool), empty, empty)
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    order = np.argsort(columns[0], kind="stable")
    return ContactEvents._make(column[order] for column in columns)
