"""Reading the history for plots: stretches of frames as arrays, thinned evenly where there are more than pixels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from softcradle.physics import Chain
from softcradle.physics.state import from_anchor
from softcradle.sandbox.motion import Array, stored_energy
from softcradle.sandbox.session.history import Block, History


@dataclass(frozen=True, eq=False)
class Rows:
    """Some frames of one lane under one chain: time (T,), overlap, rate, force (T, n), anchor (T, 2)."""

    chain: Chain
    time: Array
    overlap: Array
    rate: Array
    force: Array
    anchor: Array

    @cached_property
    def velocity(self) -> Array:
        """(T, n+1) [m/s]."""
        return from_anchor(self.rate, self.anchor[:, 1], self.chain.anchor)

    @cached_property
    def position(self) -> Array:
        """(T, n+1) [m], bead lengths taken out."""
        return from_anchor(self.overlap, self.anchor[:, 0], self.chain.anchor)

    @cached_property
    def energies(self) -> Array:
        """(T, n+2) [J]: kinetic energy of each bead, 0 for a wall, then what all contacts store."""
        mass = np.where(np.isfinite(self.chain.mass), self.chain.mass, 0.0)
        stored = stored_energy(self.chain.parameters.law, self.overlap).sum(axis=1)
        return np.column_stack((0.5 * mass * self.velocity**2, stored))


def stretches(history: History, lane: int, first: int, last: int, most: int) -> Iterator[Rows]:
    """Frames `first` to `last` of `lane`, about `most` of them, a Rows for every chain they were made with."""
    first, last = max(first, history.first), min(last, history.last)
    if last < first:
        return
    stride = max(1, (last - first) // max(most, 1))
    for block in history.blocks:
        low, high = max(first - block.first, 0), min(last - block.first + 1, block.used)
        if low < high:
            yield from _of_block(block, lane, low, high, stride)


def _of_block(block: Block, lane: int, low: int, high: int, stride: int) -> Iterator[Rows]:
    starts = [*(row for row, _ in block.setups), block.used]
    for (begin, setup), end in zip(block.setups, starts[1:], strict=True):
        a, b = max(low, begin), min(high, end)
        a += -(block.first + a) % stride  # the same frames whatever stretch is asked for: re-inking changes nothing
        if a >= b:
            continue
        pick, rows = slice(a, b, stride), block.lanes[lane]
        yield Rows(
            setup.lanes[lane].chain,
            block.time[pick], rows.overlap[pick], rows.rate[pick], rows.force[pick], rows.anchor[pick],
        )  # fmt: skip


def at_frame(history: History, lane: int, frame: int) -> Rows:
    """One frame."""
    return next(stretches(history, lane, frame, frame, 1))
