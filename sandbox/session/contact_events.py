"""Contact events: when contacts close and open, found in the rows of the history without a loop over frames."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.contact import is_closed
from softcradle.sandbox.session.frame_history import Block, History

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class ContactEvents:
    """Closings and openings of contacts in order of time, (K,) each.

    Attributes:
        time: [s], on the straight line between two frames.
        frame: the first frame after the event.
        lane, contact: which contact of which lane.
        closed: True: it closed; False: it opened.
        speed: closing speed of its two beads before it closed [m/s]; 0 for an opening.
    """

    time: Array
    frame: Integers
    lane: Integers
    contact: Integers
    closed: Mask
    speed: Array

    def select(self, rows: Mask | Integers) -> ContactEvents:
        """Some of them, by mask or index."""
        return ContactEvents(*(array[rows] for array in self.columns()))

    def columns(self) -> tuple[NDArray[Any], ...]:
        """All six arrays, in the order of the fields."""
        return self.time, self.frame, self.lane, self.contact, self.closed, self.speed


class Impact(NamedTuple):
    """A contact that closed, for a click. Closing speed in m/s."""

    time: float
    lane: int
    contact: int
    speed: float


class ContactEventIndex:
    """The contact events of a history; those of full blocks are found once."""

    def __init__(self, history: History) -> None:
        self.history = history
        self._by_block: dict[int, tuple[Block, int, ContactEvents]] = {}
        self._joined: tuple[tuple[tuple[int, int], ...] | None, ContactEvents] = (None, _joined([]))

    def all(self) -> ContactEvents:
        """Every event in the history."""
        *full, (before, newest) = self._pairs()
        key = tuple((id(block), block.revision) for _, block in full)
        if key != self._joined[0]:
            present = {id(block) for _, block in full}
            self._by_block = {place: item for place, item in self._by_block.items() if place in present}
            self._joined = key, _joined([self._of(block, earlier) for earlier, block in full])
        return _joined([self._joined[1], self._of(newest, before)])

    def after(self, frame: int) -> ContactEvents:
        """Events later than `frame`."""
        found = [self._of(block, before) for before, block in self._pairs() if block.first + block.used - 1 > frame]
        events = _joined(found)
        return events.select(events.frame > frame)

    def _pairs(self) -> list[tuple[Block | None, Block]]:
        """Every block with the one before it."""
        blocks = list(self.history.blocks)
        return list(zip([None, *blocks[:-1]], blocks, strict=True))

    def _of(self, block: Block, before: Block | None) -> ContactEvents:
        known = self._by_block.get(id(block))
        if known and known[0] is block and known[1] == block.revision and block is not self.history.blocks[-1]:
            return known[2]
        events = _joined([_lane_events(_lane_rows(block, before, lane)) for lane in range(len(block.lanes))])
        self._by_block[id(block)] = (block, block.revision, events)
        return events


class _LaneRows(NamedTuple):
    """One lane of a block, after the last row of the block before it where there is one; row 0 is frame `first`."""

    first: int
    lane: int
    time: Array
    overlap: Array
    rate: Array
    closed: Mask


def _lane_rows(block: Block, before: Block | None, lane: int) -> _LaneRows:
    rows = block.lanes[lane]
    columns = [array[: block.used] for array in (block.time, rows.overlap, rows.rate, rows.force)]
    first = block.first
    if before is not None and before.widths == block.widths:
        earlier, k = before.lanes[lane], before.used - 1
        last_row = [array[k : k + 1] for array in (before.time, earlier.overlap, earlier.rate, earlier.force)]
        columns = [np.concatenate(pair) for pair in zip(last_row, columns, strict=True)]
        first -= 1
    time, overlap, rate, force = columns
    return _LaneRows(first, lane, time, overlap, rate, is_closed(overlap, force))


def _lane_events(rows: _LaneRows) -> ContactEvents:
    """Events of one lane, between every row and the next."""
    closed, bounced = rows.closed, _bounced(rows)
    closing = ~closed[:-1] & (closed[1:] | bounced)
    opening = (closed[:-1] | bounced) & ~closed[1:]
    return _joined([_closings(rows, *np.nonzero(closing)), _openings(rows, *np.nonzero(opening))])


def _bounced(rows: _LaneRows) -> Mask:
    """(R-1, n) contacts that closed and opened between two frames: open at both, about to close, then parting."""
    reached = rows.overlap[:-1] + rows.rate[:-1] * np.diff(rows.time)[:, None] > 0.0
    bounced: Mask = ~rows.closed[:-1] & ~rows.closed[1:] & reached & (rows.rate[1:] < 0.0)
    return bounced


def _closing_time(rows: _LaneRows, row: Integers, contact: Integers) -> Array:
    """When the beads of an open contact meet at the rate of `row`; at the latest at the next row."""
    speed = np.maximum(rows.rate[row, contact], 0.0)
    flight = np.divide(-rows.overlap[row, contact], speed, out=np.zeros(len(row)), where=speed > 0.0)
    return np.minimum(rows.time[row] + np.maximum(flight, 0.0), rows.time[row + 1])


def _closings(rows: _LaneRows, row: Integers, contact: Integers) -> ContactEvents:
    speed = np.maximum(rows.rate[row, contact], 0.0)
    lane, closed = np.full(len(row), rows.lane), np.ones(len(row), dtype=bool)
    return ContactEvents(_closing_time(rows, row, contact), rows.first + row + 1, lane, contact, closed, speed)


def _openings(rows: _LaneRows, row: Integers, contact: Integers) -> ContactEvents:
    parting = np.minimum(rows.rate[row + 1, contact], 0.0)
    since = np.divide(rows.overlap[row + 1, contact], parting, out=np.zeros(len(row)), where=parting < 0.0)
    earliest = np.where(rows.closed[row, contact], rows.time[row], _closing_time(rows, row, contact))
    time = np.maximum(rows.time[row + 1] - np.maximum(since, 0.0), earliest)
    lane, zeros = np.full(len(row), rows.lane), np.zeros(len(row))
    return ContactEvents(time, rows.first + row + 1, lane, contact, zeros.astype(bool), zeros)


def _joined(parts: list[ContactEvents]) -> ContactEvents:
    """All `parts` in order of time."""
    if not parts:
        empty, integers = np.empty(0), np.empty(0, dtype=np.int64)
        return ContactEvents(empty, integers, integers, integers, empty.astype(bool), empty)
    columns = [np.concatenate(column) for column in zip(*(part.columns() for part in parts), strict=True)]
    order = np.argsort(columns[0], kind="stable")
    return ContactEvents(*(column[order] for column in columns))
