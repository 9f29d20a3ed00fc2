"""History: every frame of every lane, stored in blocks of rows. Memory is limited, and the oldest block is dropped
first.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.state import NO_SWITCHES, State, Switches
from softcradle.sandbox.session.lane_setup import Setup
from softcradle.sandbox.session.ledger import LEDGER_COLUMNS
from softcradle.sandbox.session.snapshots import STATE_ARRAYS, HeldBead, Snapshot

Array = NDArray[np.float64]
Flags = NDArray[np.int8]
Found = TypeVar("Found")

BLOCK_ROWS = 512
MEMORY = 32 * 2**20  # Default memory limit of a history in bytes.
SETUP_MEMORY = 2048  # Number of bytes counted for each setup in a block.
SWITCHES_MEMORY = 400  # Number of bytes counted for the event arrays of one lane in a frame, in addition to their data.


class LaneRows(NamedTuple):
    """Frames of one lane, one per row: overlap, rate, force (R, n), anchor (R, 2), ledger (R, 13)."""

    overlap: Array
    rate: Array
    force: Array
    anchor: Array
    ledger: Array

    @classmethod
    def empty(cls, rows: int, contacts: int) -> LaneRows:
        """Return empty arrays for `rows` frames of a lane with `contacts` contacts."""
        return cls(*(np.empty((rows, width)) for width in (contacts, contacts, contacts, 2, LEDGER_COLUMNS)))

    def cut(self, rows: int) -> LaneRows:
        """Return a copy of the first `rows` rows. The copy has no spare capacity."""
        return LaneRows(*(array[:rows].copy() for array in self))


@dataclass(eq=False)
class Block:
    """A block of up to BLOCK_ROWS frames, in which the numbers of contacts do not change.

    Attributes:
        first: frame of row 0.
        widths: number of contacts of each lane.
        time, held: (R,) time [s], and (R, 3) the bead held by the pointer.
        lanes: the rows of each lane.
        used: number of rows that contain frames.
        revision: number that increases when rows are removed. Derived data are then recomputed.
        setups: (first row, Setup) in ascending order.
        switches: for each lane, the contacts that opened or closed, by row. Rows without such events are omitted.
        replaced: contact events of the first frame before an edit changed the number of beads.
        coupled: (first row, flags of coupled contacts of each lane) in ascending order.
    """

    first: int
    widths: tuple[int, ...]
    time: Array
    held: Array
    lanes: list[LaneRows]
    used: int = 0
    revision: int = 0
    setups: list[tuple[int, Setup]] = field(default_factory=list)
    switches: dict[int, tuple[Switches, ...]] = field(default_factory=dict)
    replaced: tuple[Any, ...] = ()
    coupled: list[tuple[int, tuple[Flags, ...]]] = field(default_factory=list)
    _found: dict[Hashable, tuple[tuple[int, int], Any]] = field(default_factory=dict, repr=False)

    def found(self, what: Hashable, find: Callable[[], Found]) -> Found:
        """Return the result of `find` for the rows of this block. It is computed again only if rows have changed.

        `what` is the key of the stored result.
        """
        version = self.revision, self.used
        known = self._found.get(what)
        if known is None or known[0] != version:
            known = self._found[what] = version, find()
        found: Found = known[1]
        return found

    @classmethod
    def empty(cls, first: int, widths: tuple[int, ...]) -> Block:
        """Return an empty block whose first row is frame `first`."""
        lanes = [LaneRows.empty(BLOCK_ROWS, width) for width in widths]
        return cls(first, widths, np.empty(BLOCK_ROWS), np.empty((BLOCK_ROWS, 3)), lanes)

    @property
    def memory(self) -> int:
        """Size of the block in bytes."""
        rows = sum(array.nbytes for lane in self.lanes for array in lane)
        switches = sum(SWITCHES_MEMORY + 2 * own.time.nbytes for lanes in self.switches.values() for own in lanes)
        return rows + switches + self.time.nbytes + self.held.nbytes + SETUP_MEMORY * len(self.setups)

    def add(self, snapshot: Snapshot) -> None:
        """Write `snapshot` to the next free row."""
        row = self.used
        if not self.setups or self.setups[-1][1] is not snapshot.setup:
            self.setups.append((row, snapshot.setup))
        self.time[row], self.held[row] = snapshot.time, snapshot.held
        for lane, state, ledger in zip(self.lanes, snapshot.states, snapshot.ledgers, strict=True):
            for name in STATE_ARRAYS:
                getattr(lane, name)[row] = getattr(state, name)
            lane.ledger[row] = ledger
        coupled = tuple(state.coupled.copy() for state in snapshot.states)
        if not self.coupled or not all(map(np.array_equal, self.coupled[-1][1], coupled)):
            self.coupled.append((row, coupled))
        switched = tuple(state.switched for state in snapshot.states)
        if any(own.time.size for own in switched):
            self.switches[row] = switched
        self.used += 1

    def setup(self, row: int) -> Setup:
        """Return the setup of the frame in `row`."""
        return _at_row(self.setups, row)

    def snapshot(self, row: int) -> Snapshot:
        """Return the frame in `row` as a snapshot with its own arrays."""
        time = float(self.time[row])
        switches = self.switches.get(row, (NO_SWITCHES,) * len(self.lanes))
        states = tuple(
            State(
                time,
                **{name: getattr(lane, name)[row].copy() for name in STATE_ARRAYS},
                switched=own,
                coupled=coupled.copy(),
            )
            for lane, own, coupled in zip(self.lanes, switches, _at_row(self.coupled, row), strict=True)
        )
        ledgers = tuple(lane.ledger[row].copy() for lane in self.lanes)
        return Snapshot(time, self.setup(row), HeldBead(*self.held[row].tolist()), states, ledgers)

    def drop_last(self) -> None:
        """Remove the newest frame of the block."""
        self.used -= 1
        self.revision += 1
        self.switches.pop(self.used, None)
        for items in (self.setups, self.coupled):
            if items[-1][0] == self.used:
                items.pop()

    def cut(self, rows: int) -> Block:
        """Return a copy of the block with the first `rows` rows. The copy has no spare capacity."""
        lanes, setups = [lane.cut(rows) for lane in self.lanes], [item for item in self.setups if item[0] < rows]
        switches = {row: lanes for row, lanes in self.switches.items() if row < rows}
        columns = self.time[:rows].copy(), self.held[:rows].copy()
        coupled = [item for item in self.coupled if item[0] < rows]
        return Block(self.first, self.widths, *columns, lanes, rows, 0, setups, switches, self.replaced, coupled)


def _at_row(items: Sequence[tuple[int, Found]], row: int) -> Found:
    """Return the value that is valid at `row`. The `items` (first row, value) are in ascending order."""
    return items[bisect_right(items, row, key=lambda item: item[0]) - 1][1]


class History:
    """The stored frames `first` to `last` of a session, in blocks. If they need more than `memory` bytes, the oldest
    frames are dropped.

    Attributes:
        cuts: number of times that frames at the end were dropped or restored. A start, a new branch, an undo and a redo
            do
            this.
        edits: number of times that the newest frame was replaced.
    """

    def __init__(self, memory: int = MEMORY) -> None:
        self.bound, self.cuts, self.edits = memory, 0, 0
        self.blocks: deque[Block] = deque()

    @property
    def first(self) -> int:
        """Number of the oldest frame."""
        return self.blocks[0].first

    @property
    def last(self) -> int:
        """Number of the newest frame."""
        return self.blocks[-1].first + self.blocks[-1].used - 1

    @property
    def newest_setup(self) -> Setup:
        """Setup of the newest frame. It includes all edits."""
        return self.blocks[-1].setups[-1][1]

    @property
    def branch(self) -> tuple[int, int]:
        """A key that changes if frames are dropped or replaced. Derived data are recomputed when it changes."""
        return self.cuts, self.edits

    @property
    def version(self) -> tuple[int, ...]:
        """A key that changes whenever a frame is added, dropped or replaced. Views of all frames are redrawn when it
        changes.
        """
        return *self.branch, self.first, self.last

    def pairs(self) -> list[tuple[Block | None, Block]]:
        """Return every block together with the previous block, or with None for the first block."""
        blocks = list(self.blocks)
        return list(zip([None, *blocks[:-1]], blocks, strict=True))

    @property
    def first_time(self) -> float:
        """Time of the oldest frame [s]."""
        return self._time_of(self.first)

    @property
    def last_time(self) -> float:
        """Time of the newest frame [s]."""
        return self._time_of(self.last)

    @property
    def memory(self) -> int:
        """Memory in use [bytes]."""
        return sum(block.memory for block in self.blocks)

    def start(self, snapshot: Snapshot, frame: int = 0) -> None:
        """Drop all frames and make `snapshot` the first frame, with the number `frame`."""
        self.cuts += 1
        self.blocks.clear()
        self.blocks.append(Block.empty(frame, _widths(snapshot)))
        self.blocks[-1].add(snapshot)

    def append(self, snapshot: Snapshot) -> None:
        """Add a frame at the end."""
        block = self.blocks[-1]
        if block.used == len(block.time) or block.widths != _widths(snapshot):
            self._seal()
            self._add_block(self.last + 1, snapshot)
        self.blocks[-1].add(snapshot)

    def replace_last(self, snapshot: Snapshot, events: Callable[[], Any]) -> None:
        """Replace the newest frame by `snapshot` after an edit. `events` returns its contact events, which refer to the
        previous beads.
        """
        self.edits += 1
        frame, block = self.last, self.blocks[-1]
        replaced = () if block.widths == _widths(snapshot) else (events(),)
        block.drop_last()
        if replaced:
            if block.used:
                self._seal()
            else:
                self.blocks.pop()
            self._add_block(frame, snapshot)
            self.blocks[-1].replaced = replaced
        self.blocks[-1].add(snapshot)

    def _seal(self) -> None:
        """Release the spare capacity of the newest block."""
        self.blocks[-1] = self.blocks[-1].cut(self.blocks[-1].used)

    def _add_block(self, first: int, snapshot: Snapshot) -> None:
        """Start a block at frame `first`. Drop the oldest blocks if the history exceeds its memory limit."""
        self.blocks.append(Block.empty(first, _widths(snapshot)))
        while len(self.blocks) > 2 and self.memory > self.bound:
            self.blocks.popleft()

    def drop_after(self, frame: int) -> None:
        """Drop every frame later than `frame`."""
        if frame >= self.last:
            return
        self.cuts += 1
        while self.blocks[-1].first > frame:
            self.blocks.pop()
        self.blocks[-1] = self.blocks[-1].cut(frame - self.blocks[-1].first + 1)

    def copy_blocks(self) -> tuple[Block, ...]:
        """Return all blocks for a later :meth:`restore`. Full blocks are not copied, because they never change again."""
        *full, newest = self.blocks
        return *full, newest.cut(newest.used)

    def restore(self, blocks: tuple[Block, ...]) -> None:
        """Restore the `blocks` returned by :meth:`copy_blocks`. The same blocks can be restored several times."""
        self.cuts += 1
        *full, newest = blocks
        self.blocks = deque((*full, newest.cut(newest.used)))

    def snapshot(self, frame: int) -> Snapshot:
        """Return a frame as a snapshot. Raise IndexError if the history does not contain it."""
        block = self.block_of(frame)
        return block.snapshot(frame - block.first)

    def block_of(self, frame: int) -> Block:
        """Return the block that contains `frame`. Raise IndexError if the history does not contain the frame."""
        if not self.first <= frame <= self.last:
            raise IndexError(f"frame {frame} is not in the history, which has frames {self.first} to {self.last}")
        return self.blocks[bisect_right(self.blocks, frame, key=lambda block: block.first) - 1]

    def frame_at(self, time: float) -> int:
        """Return the frame nearest to `time` [s]."""
        starts = [float(block.time[0]) for block in self.blocks]
        block = self.blocks[max(0, bisect_right(starts, time) - 1)]
        after = block.first + int(np.searchsorted(block.time[: block.used], time))
        near = range(max(after - 1, self.first), min(after, self.last) + 1)
        return min(reversed(near), key=lambda frame: abs(self._time_of(frame) - time))

    def _time_of(self, frame: int) -> float:
        block = self.block_of(frame)
        return float(block.time[frame - block.first])


def _widths(snapshot: Snapshot) -> tuple[int, ...]:
    return tuple(state.overlap.size for state in snapshot.states)
