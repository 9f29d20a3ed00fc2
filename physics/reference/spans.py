"""Time spans between two breakpoints of the forces and brakes. In a span, all forces are linear in time.

The reference solution stops at each breakpoint.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.timed_force import summed

Array = NDArray[np.float64]

# Smallest time after the start at which values are taken, as a fraction of the span. At this time, a force that starts
# from 0 already has its sign.
BESIDE = 1e-13


@dataclass(frozen=True)
class Span:
    """External forces and brakes on n+1 beads from `start` to `end` [s].

    Attributes:
        push, push_slope: (n+1,) forces over time [N] at the start of the span, and their slopes [N/s].
        brake, brake_slope: (n+1,) the same for brakes.
    """

    start: float
    end: float
    push: Array
    push_slope: Array
    brake: Array
    brake_slope: Array

    @classmethod
    def at(cls, chain: Chain, time: float) -> Span:
        """Return the span that starts at `time`. If `time` lies inside a span, return the rest of this span."""
        end = next((knot for knot in chain.knots if knot > time), math.inf)
        middle, beads = 0.5 * (time + end) if math.isfinite(end) else time + 1.0, chain.contacts + 1
        lines = []
        for items in (chain.forces, chain.brakes):
            first = summed(items, time, beads)
            lines += [first, (summed(items, middle, beads) - first) / (middle - time)]
        return cls(time, end, *lines)

    @property
    def changes(self) -> bool:
        """True if the span has an end. The last span, with constant forces, has none."""
        return math.isfinite(self.end)

    def push_at(self, time: Any) -> Any:
        """Return the (..., n+1) forces over time [N] at `time` (...)."""
        return self.push + self._passed(time) * self.push_slope

    def brake_at(self, time: Any) -> Any:
        """Return the (..., n+1) brakes [N] at `time` (...)."""
        return np.maximum(self.brake + self._passed(time) * self.brake_slope, 0.0)

    def _passed(self, time: Any) -> Any:
        least = BESIDE * (self.end - self.start) if self.changes else 0.0
        return np.maximum(np.asarray(time) - self.start, least)[..., None]
