"""Marks: when contacts close and open, found in the rows of the history without a loop over frames."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.session.history import Block, History
from softcradle.sandbox.session.history_slices import is_closed

Array = NDArray[np.float64]
Rows = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Marks:
    """Contact closings and openings in order of time, (K,) each.

    Attributes:
        time: [s], on the straight line between two frames.
        frame: the first frame after it.
        lane, contact: which.
        closed: True: it closed; False: it opened.
        speed: closing speed of its two beads before it closed [m/s]; 0 for an opening.
    """

    time: Array
    frame: Rows
    lane: Rows
    contact: Rows
    closed: NDArray[np.bool_]
    speed: Array

    def chosen(self, rows: NDArray[np.bool_] | Rows) -> Marks:
        """Some of them, by mask or index."""
        return Marks(*(array[rows] for array in self.columns()))

    def columns(self) -> tuple[NDArray[Any], ...]:
        """All six, in the order of the fields."""
        return self.time, self.frame, self.lane, self.contact, self.closed, self.speed


class Impact(NamedTuple):
    """A contact that closed: for a click. Closing speed in m/s."""

    time: float
    lane: int
    contact: int
    speed: float


class MarkBook:
    """The marks of a history; those of full blocks are found once."""

    def __init__(self, history: History) -> None:
        self.history = history
        self._full: dict[int, tuple[Block, int, Marks]] = {}
        self._known: tuple[tuple[tuple[int, int], ...] | None, Marks] = (None, _joined([]))

    def all(self) -> Marks:
        """Every mark in the history."""
        *full, (before, newest) = self._pairs()
        key = tuple((id(block), block.revision) for _, block in full)
        if key != self._known[0]:
            kept = {id(block) for _, block in full}
            self._full = {place: item for place, item in self._full.items() if place in kept}
            self._known = key, _joined([self._of(block, earlier) for earlier, block in full])
        return _joined([self._known[1], self._of(newest, before)])

    def since(self, frame: int) -> Marks:
        """Marks later than `frame`, which is before the newest."""
        found = [self._of(block, before) for before, block in self._pairs() if block.first + block.used - 1 > frame]
        marks = _joined(found)
        return marks.chosen(marks.frame > frame)

    def _pairs(self) -> list[tuple[Block | None, Block]]:
        blocks = list(self.history.blocks)
        return list(zip([None, *blocks[:-1]], blocks, strict=True))

    def _of(self, block: Block, before: Block | None) -> Marks:
        known = self._full.get(id(block))
        if known and known[0] is block and known[1] == block.revision and block is not self.history.blocks[-1]:
            return known[2]
        marks = _joined([_lane_marks(_rows(block, before, lane)) for lane in range(len(block.lanes))])
        self._full[id(block)] = (block, block.revision, marks)
        return marks


class _Rows(NamedTuple):
    """One lane of a block, with the last row before it where there is one; row 0 is frame `first`."""

    first: int
    lane: int
    time: Array
    overlap: Array
    rate: Array
    closed: NDArray[np.bool_]


def _rows(block: Block, before: Block | None, lane: int) -> _Rows:
    here = block.lanes[lane]
    columns = [array[: block.used] for array in (block.time, here.overlap, here.rate, here.force)]
    first = block.first
    if before is not None and before.widths == block.widths:
        last, k = before.lanes[lane], before.used - 1
        old = [array[k : k + 1] for array in (before.time, last.overlap, last.rate, last.force)]
        columns = [np.concatenate(pair) for pair in zip(old, columns, strict=True)]
        first -= 1
    time, overlap, rate, force = columns
    return _Rows(first, lane, time, overlap, rate, is_closed(overlap, force))


def _lane_marks(rows: _Rows) -> Marks:
    """Marks of one lane, between every row and the next."""
    closed, bounced = rows.closed, _bounced(rows)
    closing = ~closed[:-1] & (closed[1:] | bounced)
    opening = (closed[:-1] | bounced) & ~closed[1:]
    return _joined([_closings(rows, *np.nonzero(closing)), _openings(rows, *np.nonzero(opening))])


def _bounced(rows: _Rows) -> NDArray[np.bool_]:
    """(R-1, n) contacts that closed and opened again between two frames: they approached, would have met, and part."""
    reached = rows.overlap[:-1] + rows.rate[:-1] * np.diff(rows.time)[:, None] > 0.0
    bounced: NDArray[np.bool_] = ~rows.closed[:-1] & ~rows.closed[1:] & reached & (rows.rate[1:] < 0.0)
    return bounced


def _meeting(rows: _Rows, row: Rows, contact: Rows) -> Array:
    """When the beads of an open contact meet if they go on as at `row`, at the latest by the next row."""
    speed = np.maximum(rows.rate[row, contact], 0.0)
    wait = np.divide(-rows.overlap[row, contact], speed, out=np.zeros(len(row)), where=speed > 0.0)
    return np.minimum(rows.time[row] + np.maximum(wait, 0.0), rows.time[row + 1])


def _closings(rows: _Rows, row: Rows, contact: Rows) -> Marks:
    speed = np.maximum(rows.rate[row, contact], 0.0)
    lane, yes = np.full(len(row), rows.lane), np.ones(len(row), dtype=bool)
    return Marks(_meeting(rows, row, contact), rows.first + row + 1, lane, contact, yes, speed)


def _openings(rows: _Rows, row: Rows, contact: Rows) -> Marks:
    parting = np.minimum(rows.rate[row + 1, contact], 0.0)
    since = np.divide(rows.overlap[row + 1, contact], parting, out=np.zeros(len(row)), where=parting < 0.0)
    earliest = np.where(rows.closed[row, contact], rows.time[row], _meeting(rows, row, contact))
    when = np.maximum(rows.time[row + 1] - np.maximum(since, 0.0), earliest)
    lane, none = np.full(len(row), rows.lane), np.zeros(len(row))
    return Marks(when, rows.first + row + 1, lane, contact, none.astype(bool), none)


def _joined(parts: list[Marks]) -> Marks:
    """All `parts` in order of time."""
    if not parts:
        none, whole = np.empty(0), np.empty(0, dtype=np.int64)
        return Marks(none, whole, whole, whole, none.astype(bool), none)
    columns = [np.concatenate(column) for column in zip(*(part.columns() for part in parts), strict=True)]
    order = np.argsort(columns[0], kind="stable")
    return Marks(*(column[order] for column in columns))
