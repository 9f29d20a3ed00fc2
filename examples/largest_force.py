"""A contact of two segments: the force grows to a largest value, as in a crush zone, and the contact dissipates no energy."""

from __future__ import annotations

from dataclasses import dataclass

from softcradle.physics.segments import PiecewiseContact, Segment

from softcradle import Chain, Contact, draft_gear, simulate


@dataclass(frozen=True)
class LargestForce(PiecewiseContact):
    """A linear gear whose force stays at `most` [N] from there on."""

    gear: Contact
    most: float

    @property
    def segments(self) -> list[Segment]:
        """The gear, and from its largest force on a constant one."""
        preload, stiffness = self.gear.preload, self.gear.stiffness
        yields_at = (self.most - preload) / stiffness
        return [
            Segment(side=1.0, origin=0.0, preload=preload, stiffness=stiffness, exponent=1.0, length=yields_at),
            Segment(side=1.0, origin=yields_at, preload=self.most, stiffness=0.0, exponent=1.0),
        ]


if __name__ == "__main__":
    crush = LargestForce(draft_gear(2.0, 0.1), most=1.0)
    found = simulate(Chain([1.0, 1.0], crush), [2.0, 0.0], 4.0, "accurate", samples=401)
    print(
        f"largest force {found.force.max():.12g} N, deepest {found.overlap.max():.12g} m, after it {found.final_velocity}"
    )
