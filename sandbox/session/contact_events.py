"""Contact events: closings and openings of contacts, as the engine located them in each frame of the history."""

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
    """Closings and openings of contacts in order of time, (K,) each.

    Attributes:
        time: [s], as located by the engine; for a contact that an edit has closed or opened, the time of the frame.
        frame: the first frame after the event.
        lane, contact: indices.
        closed: True for a closing, False for an opening.
        speed: closing speed of its two beads at the frame before it closed; if it was closed or its beads separated
            then, their speed at the frame after [m/s]. It is 0 for an opening, and for a closing by an edit.
        approach: speed at which its two beads approached each other at the frame before [m/s], negative if they
            separated; 0 for an event caused by an edit.
    """

    time: Array
    frame: Integers
    lane: Integers
    contact: Integers
    closed: Mask
    speed: Array
    approach: Array

    def select(self, rows: Mask | Integers) -> ContactEvents:
        """Return some of them, selected by mask or index."""
        return ContactEvents._make(array[rows] for array in self)


class Impact(NamedTuple):
    """A contact that closed, for a click sound. Closing speed in m/s."""

    time: float
    lane: int
    contact: int
    speed: float


def contact_events(history: History, after: int = -1) -> ContactEvents:
    """Return the contact events of a history later than frame `after`."""
    events = _joined([_of(block, before) for before, block in history.pairs() if block.first + block.used - 1 > after])
    return events if after < history.first else events.select(events.frame > after)


def _of(block: Block, before: Block | None) -> ContactEvents:
    lanes = range(len(block.lanes))
    return block.found(
        ("events", before is None),
        lambda: _joined([*block.replaced, *(_lane_events(block, before, lane) for lane in lanes)]),
    )


def _lane_events(block: Block, before: Block | None, lane: int) -> ContactEvents:
    """Return the events of one lane in the rows of a block, including its first row if the previous block has the same
    beads.
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
    """Return the events of frames `first` ... at `time` (R,) from their `logs` by row.

    `closed` and `rate` (R+1, n) start at the previous frame. A contact whose state does not follow from its log was
    switched by an edit, or after the log was full.
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
    """Return (S,) how many entries with the same key precede each entry."""
    order = np.argsort(key, kind="stable")
    run_start = np.concatenate(([True], np.diff(key[order]) != 0))[: key.size]
    place = np.arange(key.size)
    rank = np.empty(key.size, dtype=np.int64)
    rank[order] = place - np.maximum.accumulate(np.where(run_start, place, 0))
    return rank


def _joined(parts: list[ContactEvents]) -> ContactEvents:
    """Return all `parts` in order of time."""
    if not parts:
        empty, integers = np.empty(0), np.empty(0, dtype=np.int64)
        return ContactEvents(empty, integers, integers, integers, empty.astype(bool), empty, empty)
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    order = np.argsort(columns[0], kind="stable")
    return ContactEvents._make(column[order] for column in columns)
