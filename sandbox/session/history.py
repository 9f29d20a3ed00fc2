"""The history: every frame of every lane in blocks of rows, bounded in memory; the oldest block is dropped first."""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.state import State
from softcradle.sandbox.session.lane_setup import Setup

Array = NDArray[np.float64]

BLOCK_ROWS = 512
MEMORY = 32 * 2**20  # bytes of a history, unless told otherwise

# columns of the ledger of a lane, see softcradle.sandbox.session.ledger
KINETIC, STORED, MOMENTUM, ENERGY_BOOKED, MOMENTUM_BOOKED, ENERGY_SCALE, MOMENTUM_SCALE, SWITCHES = range(8)
BY_CONTACTS, BY_BED = 8, 9
LEDGER = 10
NO_HAND = (-1.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Moment:
    """One frame, all of it: time [s], setup, hand (lane, bead, position), and per lane State and ledger (10,)."""

    time: float
    setup: Setup
    hand: tuple[float, float, float]
    states: tuple[State, ...]
    ledgers: tuple[Array, ...]

    def copy(self) -> Moment:
        """The same moment in arrays of its own, without the scratch memory of the methods."""
        states = tuple(state.copy() for state in self.states)
        return replace(self, states=states, ledgers=tuple(ledger.copy() for ledger in self.ledgers))


@dataclass(eq=False)
class LaneRows:
    """Rows of one lane: overlap, rate, force (R, n), anchor (R, 2), ledger (R, 10)."""

    overlap: Array
    rate: Array
    force: Array
    anchor: Array
    ledger: Array

    @classmethod
    def empty(cls, rows: int, contacts: int) -> LaneRows:
        """Room for `rows` frames of a lane of that many contacts."""
        return cls(*(np.empty((rows, width)) for width in (contacts, contacts, contacts, 2, LEDGER)))

    def arrays(self) -> tuple[Array, ...]:
        """All five, in the order of the fields."""
        return self.overlap, self.rate, self.force, self.anchor, self.ledger

    def cut(self, rows: int) -> LaneRows:
        """A copy of the first `rows` rows, without the room for more."""
        return LaneRows(*(array[:rows].copy() for array in self.arrays()))


@dataclass(eq=False)
class Block:
    """Up to BLOCK_ROWS frames of lanes whose numbers of contacts do not change; `setups` holds (first row, Setup)."""

    first: int
    widths: tuple[int, ...]
    time: Array
    hand: Array
    lanes: list[LaneRows]
    used: int = 0
    revision: int = 0  # grows when rows are taken out: what was made from them is stale
    setups: list[tuple[int, Setup]] = field(default_factory=list)

    @classmethod
    def at(cls, first: int, widths: tuple[int, ...]) -> Block:
        """An empty block whose first row is frame `first`."""
        lanes = [LaneRows.empty(BLOCK_ROWS, width) for width in widths]
        return cls(first, widths, np.empty(BLOCK_ROWS), np.empty((BLOCK_ROWS, 3)), lanes)

    @property
    def memory(self) -> int:
        """Bytes."""
        rows = sum(array.nbytes for lane in self.lanes for array in lane.arrays())
        return rows + self.time.nbytes + self.hand.nbytes + 2048 * len(self.setups)

    def add(self, moment: Moment) -> None:
        """Write `moment` to the next row."""
        row = self.used
        if not self.setups or self.setups[-1][1] is not moment.setup:
            self.setups.append((row, moment.setup))
        self.time[row], self.hand[row] = moment.time, moment.hand
        for lane, state, ledger in zip(self.lanes, moment.states, moment.ledgers, strict=True):
            lane.overlap[row], lane.rate[row], lane.force[row] = state.overlap, state.rate, state.force
            lane.anchor[row], lane.ledger[row] = state.anchor, ledger
        self.used += 1

    def setup(self, row: int) -> Setup:
        """The setup that made `row`."""
        return self.setups[bisect_right(self.setups, row, key=lambda item: item[0]) - 1][1]

    def moment(self, row: int) -> Moment:
        """Read `row` back; arrays are copies."""
        time = float(self.time[row])
        states = tuple(
            State(time, *(array[row].copy() for array in (lane.overlap, lane.rate, lane.anchor, lane.force)))
            for lane in self.lanes
        )
        hand: tuple[float, float, float] = tuple(self.hand[row].tolist())
        return Moment(time, self.setup(row), hand, states, tuple(lane.ledger[row].copy() for lane in self.lanes))

    def forget_last(self) -> None:
        """Take the last row out again."""
        self.used -= 1
        self.revision += 1
        if self.setups[-1][0] == self.used:
            self.setups.pop()

    def cut(self, rows: int) -> None:
        """Keep the first `rows` rows and give back the room for more."""
        self.used = rows
        self.revision += 1
        self.time, self.hand = self.time[:rows].copy(), self.hand[:rows].copy()
        self.lanes = [lane.cut(rows) for lane in self.lanes]
        self.setups = [item for item in self.setups if item[0] < rows]


class History:
    """Frames `first` ... `last`, in blocks. `memory` bounds its bytes; what is dropped is the oldest."""

    def __init__(self, memory: int = MEMORY) -> None:
        self.bound = memory
        self.blocks: deque[Block] = deque()

    @property
    def first(self) -> int:
        """Oldest frame kept."""
        return self.blocks[0].first

    @property
    def last(self) -> int:
        """Newest frame."""
        return self.blocks[-1].first + self.blocks[-1].used - 1

    @property
    def first_time(self) -> float:
        """Time of the oldest frame [s]."""
        return float(self.blocks[0].time[0])

    @property
    def last_time(self) -> float:
        """Time of the newest frame [s]."""
        return float(self.blocks[-1].time[self.blocks[-1].used - 1])

    @property
    def memory(self) -> int:
        """Bytes in use."""
        return sum(block.memory for block in self.blocks)

    def start(self, moment: Moment, frame: int = 0) -> None:
        """Forget everything; `moment` is frame `frame`."""
        self.blocks.clear()
        self.blocks.append(Block.at(frame, _widths(moment)))
        self.blocks[-1].add(moment)

    def append(self, moment: Moment) -> None:
        """Add a frame at the end."""
        block = self.blocks[-1]
        if block.used == len(block.time) or block.widths != _widths(moment):
            block.cut(block.used)
            self._add_block(self.last + 1, moment)
        self.blocks[-1].add(moment)

    def replace_last(self, moment: Moment) -> None:
        """Put `moment` in place of the newest frame: an edit."""
        frame, block = self.last, self.blocks[-1]
        block.forget_last()
        if block.widths != _widths(moment):
            if block.used:
                block.cut(block.used)
            else:
                self.blocks.pop()
            self._add_block(frame, moment)
        self.blocks[-1].add(moment)

    def _add_block(self, first: int, moment: Moment) -> None:
        """Begin a block for frame `first`, and drop the oldest ones that are too much with it."""
        self.blocks.append(Block.at(first, _widths(moment)))
        while len(self.blocks) > 2 and self.memory > self.bound:
            self.blocks.popleft()

    def drop_after(self, frame: int) -> None:
        """Forget every frame later than `frame`."""
        if frame >= self.last:
            return
        while self.blocks[-1].first > frame:
            self.blocks.pop()
        self.blocks[-1].cut(frame - self.blocks[-1].first + 1)

    def moment(self, frame: int) -> Moment:
        """The frame `frame`, which must be kept."""
        block = self.block_of(frame)
        return block.moment(frame - block.first)

    def block_of(self, frame: int) -> Block:
        """The block in which `frame` is."""
        if not self.first <= frame <= self.last:
            raise IndexError(f"frame {frame} is not kept; frames {self.first} to {self.last} are")
        return self.blocks[bisect_right(self.blocks, frame, key=lambda block: block.first) - 1]

    def frame_at(self, time: float) -> int:
        """The frame nearest to `time` [s]."""
        starts = [float(block.time[0]) for block in self.blocks]
        block = self.blocks[max(0, bisect_right(starts, time) - 1)]
        times = block.time[: block.used]
        after = int(np.searchsorted(times, time))
        if after == block.used:
            return min(block.first + block.used - 1 + _nearer_next(block, self.blocks, time), self.last)
        if after > 0 and time - times[after - 1] < times[after] - time:
            after -= 1
        return block.first + after


def _nearer_next(block: Block, blocks: deque[Block], time: float) -> int:
    """1 when the first row of the next block is nearer to `time` than the last of `block`, else 0."""
    following = blocks.index(block) + 1
    if following == len(blocks):
        return 0
    return int(float(blocks[following].time[0]) - time < time - float(block.time[block.used - 1]))


def _widths(moment: Moment) -> tuple[int, ...]:
    return tuple(state.overlap.size for state in moment.states)
