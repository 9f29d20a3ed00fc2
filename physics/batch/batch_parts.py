"""A batch on its way: the arrays that kernels take, and its chains in parts that have in common what kernels are told once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.batch.batch_scales import BatchStart
from softcradle.physics.batch.chain_batch import ChainBatch
from softcradle.physics.batch.lockstep_loop import BatchData, BatchMotion
from softcradle.physics.numerics.records import COUNTERS

Array = NDArray[np.float64]

PARTS_A_THREAD = 8  # at the least: chains differ in cost, so the last thread to finish should not have much left
MOST_AT_ONCE = 1024  # chains in a part, so that progress is told often, and a run that is stopped ends soon
LEAST_AT_ONCE = 16  # chains in a part


@dataclass(frozen=True)
class BatchRun:
    """The arrays of a run, and whether chains stop when they are apart."""

    data: BatchData
    moving: BatchMotion
    stop: bool

    @classmethod
    def of(cls, batch: ChainBatch, start: BatchStart, steps: Array, ends: Array, stop: bool) -> BatchRun:
        """Of a batch from its start, with `steps` and `ends` (C,) [s]."""
        count, contacts = start.overlap.shape
        push = batch.drive.copy()
        data = BatchData(batch.law_rows, batch.loss.copy(), batch.inverse_mass, push, batch.bed, steps, ends)
        motion = start.overlap, start.rate, start.anchor, start.force
        closed, counter = np.zeros((count, contacts), dtype=np.int8), np.zeros((count, COUNTERS), dtype=np.int64)
        status, time = np.zeros(count, dtype=np.int64), np.zeros(count)
        return cls(data, BatchMotion(*motion, closed, counter, status, time), stop)


@dataclass(frozen=True)
class Part:
    """Chains of a batch that are alike in what takes energy, what gives it, and their anchor bead."""

    chains: NDArray[np.int64]
    driven: bool
    dissipates: bool
    lossy: bool
    braked: bool
    bead: int


def parts_of(batch: ChainBatch, threads: int, least: int = LEAST_AT_ONCE) -> Iterator[Part]:
    """All chains of a batch in parts of `least` or more, for that many threads."""
    size = max(least, min(MOST_AT_ONCE, batch.chains // (threads * PARTS_A_THREAD)))
    kinds = np.stack([batch.driven, batch.lossy, batch.on_bed, batch.anchor], axis=1)
    found, number = np.unique(kinds, axis=0, return_inverse=True)
    for k, (driven, keeps, braked, bead) in enumerate(found.tolist()):
        alike = np.flatnonzero(number.reshape(-1) == k)
        for first in range(0, alike.size, size):
            chains = alike[first : first + size]
            yield Part(chains, bool(driven), bool(keeps or braked), bool(keeps), bool(braked), int(bead))
