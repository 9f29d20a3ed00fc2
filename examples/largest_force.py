"""A user-defined force graph: the force grows up to a largest value, as in a crush zone, and no energy is lost."""

from __future__ import annotations

from dataclasses import dataclass

from softcradle.physics.coupler import gear_segment
from softcradle.physics.segments import Segment

from softcradle import Chain, Coupler, draft_gear, simulate


@dataclass(frozen=True)
class LargestForce(Coupler):
    """A linear gear ``push`` whose force is limited to `most` [N]: a second segment cancels the stiffness."""

    most: float = 0.0

    @property
    def yields_at(self) -> float:
        """The overlap [m] at which the force reaches `most`."""
        return (self.most - self.push.preload) / self.push.stiffness

    @property
    def segments(self) -> list[Segment]:
        """The segment of the gear, followed by a segment of constant force."""
        law, way = self.push, self.yields_at
        return [gear_segment(law, 1.0, 0.0, length=way), gear_segment(law, 1.0, way, way, -law.stiffness)]


if __name__ == "__main__":
    crush = LargestForce(draft_gear(2.0, 0.1), most=1.0)
    found = simulate(Chain([1.0, 1.0], crush), [2.0, 0.0], 4.0, "accurate", samples=401)
    print(
        f"largest force {found.force.max():.12g} N, deepest {found.overlap.max():.12g} m, after it {found.final_velocity}"
    )
