"""A row of one's own: a contact that yields no more than a largest force, as a crush zone does, and gives all of it back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from softcradle.physics.coupler import Segment, gear_segment

from softcradle import Chain, Coupler, draft_gear, simulate


@dataclass(frozen=True)
class LargestForce(Coupler):
    """A linear gear ``push`` whose force stays at `most` [N] from there on: one more segment, whose stop takes its stiffness."""

    most: float = 0.0

    @property
    def yields_at(self) -> float:
        """The overlap [m] at which it has its largest force."""
        return (self.most - self.push.preload) / self.push.stiffness

    @property
    def segments(self) -> list[Segment]:
        """The gear, and beyond it a force that does not grow."""
        law, way = self.push, self.yields_at
        return [gear_segment(law, 1.0, 0.0, length=way), gear_segment(law, 1.0, way, way, -law.stiffness)]

    def energy(self, overlap: ArrayLike) -> np.ndarray:
        """Energy stored [J]."""
        way = np.minimum(overlap, self.yields_at)
        return self.push.energy(way) + self.most * (np.maximum(overlap, self.yields_at) - self.yields_at)


if __name__ == "__main__":
    crush = LargestForce(draft_gear(2.0, 0.1), most=1.0)
    found = simulate(Chain([1.0, 1.0], crush), [2.0, 0.0], 4.0, "accurate", samples=401)
    print(
        f"largest force {found.force.max():.12g} N, deepest {found.overlap.max():.12g} m, after it {found.final_velocity}"
    )
