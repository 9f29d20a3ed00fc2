"""Times between two knots of forces and brakes over time, in each of which they are lines: the reference stops at every knot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.timed_force import summed

Array = NDArray[np.float64]

BESIDE = 1e-13  # of a span: so far inside values at its start are taken, so that what begins there at 0 has its sign


@dataclass(frozen=True)
class Span:
    """Forces and brakes from `start` on until `end` [s], on n+1 beads.

    Attributes:
        push, push_slope: (n+1,) forces over time [N] at the start, and by how much they grow [N/s].
        brake, brake_slope: (n+1,) the same of brakes.
    """

    start: float
    end: float
    push: Array
    push_slope: Array
    brake: Array
    brake_slope: Array

    @classmethod
    def at(cls, chain: Chain, time: float) -> Span:
        """The span that begins or goes on at `time`."""
        end = next((knot for knot in chain.knots if knot > time), math.inf)
        middle, beads = 0.5 * (time + end) if math.isfinite(end) else time + 1.0, chain.contacts + 1
        lines = []
        for items in (chain.forces, chain.brakes):
            first = summed(items, time, beads)
            lines += [first, (summed(items, middle, beads) - first) / (middle - time)]
        return cls(time, end, *lines)

    @property
    def changes(self) -> bool:
        """Whether it ends, or something in it changes."""
        return math.isfinite(self.end)

    def push_at(self, time: Any) -> Any:
        """(..., n+1) forces over time [N] at `time` (...)."""
        return self.push + self._passed(time) * self.push_slope

    def brake_at(self, time: Any) -> Any:
        """(..., n+1) brakes [N] at `time` (...)."""
        return np.maximum(self.brake + self._passed(time) * self.brake_slope, 0.0)

    def _passed(self, time: Any) -> Any:
        least = BESIDE * (self.end - self.start) if self.changes else 0.0
        return np.maximum(np.asarray(time) - self.start, least)[..., None]
