"""Series: a stretch of the history as arrays, for plots and pictures. Its names are those of `softcradle.sandbox.draw.Motion`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.state import from_anchor
from softcradle.sandbox.session import ledger
from softcradle.sandbox.session.history import KINETIC, STORED, Block, History
from softcradle.sandbox.session.lane_setup import LaneSetup

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Series:
    """What one lane did from frame `first` on, frame by frame; the number of beads is the same all along.

    Attributes:
        first: frame of row 0.
        setups: (first row, LaneSetup) of every stretch with one setup, ascending.
        time: (T,) [s].
        overlap, rate, force: (T, n) [m], [m/s], [N].
        anchor: (T, 2) position and velocity of the anchor bead.
        ledger: (T, 10) see :mod:`softcradle.sandbox.session.ledger`.
    """

    first: int
    setups: tuple[tuple[int, LaneSetup], ...]
    time: Array
    overlap: Array
    rate: Array
    force: Array
    anchor: Array
    ledger: Array

    @property
    def chain(self) -> Chain:
        """The chain of the last row."""
        return self.setups[-1][1].chain

    @property
    def method(self) -> str:
        """How the last row was made, for a label."""
        setup = self.setups[-1][1]
        return f"{setup.method}, step {setup.step:.2g} s" if setup.step else setup.method

    @cached_property
    def position(self) -> Array:
        """(T, n+1) positions [m], bead lengths taken out."""
        return self._beads(self.overlap, self.anchor[:, 0])

    @cached_property
    def velocity(self) -> Array:
        """(T, n+1) bead velocities [m/s]."""
        return self._beads(self.rate, self.anchor[:, 1])

    @cached_property
    def kinetic(self) -> Array:
        """(T, n+1) kinetic energy of each bead [J]; 0 for a wall."""
        return 0.5 * self._mass * self.velocity**2

    @cached_property
    def momentum(self) -> Array:
        """(T, n+1) momentum of each bead [N s]; 0 for a wall."""
        return self._mass * self.velocity

    @property
    def stored(self) -> Array:
        """(T,) energy in all contacts [J]."""
        return self.ledger[:, STORED]

    @property
    def energy(self) -> Array:
        """(T,) kinetic and stored energy of the lane [J]."""
        return self.ledger[:, KINETIC] + self.ledger[:, STORED]

    @cached_property
    def energy_error(self) -> Array:
        """(T,) energy that no start, hand, drive or edit explains, relative to the largest there has been."""
        return np.asarray(ledger.energy_error(self.ledger))

    @cached_property
    def momentum_error(self) -> Array:
        """(T,) the same of the momentum; 0 where a wall takes it up."""
        return np.asarray(ledger.momentum_error(self.ledger))

    @cached_property
    def closed(self) -> NDArray[np.bool_]:
        """(T, n) whether each contact pushes, or touches under force."""
        return is_closed(self.overlap, self.force)

    def from_row(self, row: int) -> Series:
        """The same series without the rows before `row`."""
        later = tuple((max(0, start - row), setup) for start, setup in self.setups if start > row)
        now = [setup for start, setup in self.setups if start <= row][-1]
        arrays = (self.time, self.overlap, self.rate, self.force, self.anchor, self.ledger)
        return Series(self.first + row, ((0, now), *later), *(array[row:] for array in arrays))

    def _beads(self, difference: Array, value: Array) -> Array:
        parts = [
            from_anchor(difference[start:end], value[start:end], chain.anchor) for start, end, chain in self._stretches
        ]
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    @cached_property
    def _mass(self) -> Array:
        """(1 or T, n+1) masses [kg], 0 for a wall."""
        parts = []
        for start, end, chain in self._stretches:
            mass = np.array(chain.mass)
            row = np.where(np.isfinite(mass), mass, 0.0)[None]
            parts.append(np.repeat(row, end - start, axis=0) if len(self.setups) > 1 else row)
        return np.concatenate(parts)

    @cached_property
    def _stretches(self) -> list[tuple[int, int, Chain]]:
        """First row, end and chain of every stretch with one chain."""
        starts: list[tuple[int, Chain]] = []
        for start, setup in self.setups:
            if not starts or starts[-1][1] is not setup.chain:
                starts.append((start, setup.chain))
        ends = [start for start, _ in starts[1:]] + [len(self.time)]
        return [(start, end, chain) for (start, chain), end in zip(starts, ends, strict=True)]


def is_closed(overlap: Array, force: Array) -> NDArray[np.bool_]:
    """Whether contacts push, or touch under force."""
    closed: NDArray[np.bool_] = (overlap > 0.0) | ((overlap == 0.0) & (force > 0.0))
    return closed


def series_of(history: History, lane: int, first: int, last: int) -> Series:
    """Frames `first` ... `last` of a lane, or the last of them from where the number of beads is that of `last`."""
    blocks = _blocks(history, lane, first, last)
    first = max(first, blocks[0].first)
    columns: list[Sequence[Array]] = []
    times: list[Array] = []
    setups: list[tuple[int, LaneSetup]] = []
    for block in blocks:
        low, high = max(0, first - block.first), min(block.used, last - block.first + 1)
        times.append(block.time[low:high])
        columns.append([array[low:high] for array in block.lanes[lane].arrays()])
        for start, setup in block.setups:
            if start < high:
                row = max(0, block.first + start - first)
                _note(setups, row, setup.lanes[lane])
    overlap, rate, force, anchor, books = (np.concatenate(parts) for parts in zip(*columns, strict=True))
    return Series(first, tuple(setups), np.concatenate(times), overlap, rate, force, anchor, books)


def _note(setups: list[tuple[int, LaneSetup]], row: int, setup: LaneSetup) -> None:
    """Let `setup` hold from `row` on."""
    if setups and setups[-1][0] == row:
        setups.pop()
    if not setups or setups[-1][1] is not setup:
        setups.append((row, setup))


def _blocks(history: History, lane: int, first: int, last: int) -> list[Block]:
    """The blocks that hold `first` ... `last`, from the last on backwards while the lane has as many contacts."""
    found = [history.block_of(last)]
    for block in reversed(history.blocks):
        if block.first >= found[-1].first:
            continue
        if found[-1].first <= first or block.widths[lane] != found[-1].widths[lane]:
            break
        found.append(block)
    return found[::-1]


@dataclass(frozen=True, eq=False)
class Difference:
    """The second lane minus the first, frame by frame: position, velocity (T, beads), overlap, force (T, contacts).

    Beads are compared from the left, as many as both lanes have.
    """

    time: Array
    position: Array
    velocity: Array
    overlap: Array
    force: Array


def difference_of(first: Series, second: Series) -> Difference:
    """`second` minus `first` at the frames that both cover."""
    start = max(first.first, second.first)
    pair = first.from_row(start - first.first), second.from_row(start - second.first)

    def less(name: str) -> Array:
        a, b = (getattr(series, name) for series in pair)
        width = min(a.shape[1], b.shape[1])
        apart: Array = b[:, :width] - a[:, :width]
        return apart

    return Difference(pair[0].time, less("position"), less("velocity"), less("overlap"), less("force"))
