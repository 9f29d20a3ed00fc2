"""A rubber buffer of two stages: a soft one, and from some displacement on a hard one; both dissipate a part of their energy."""

from __future__ import annotations

from dataclasses import dataclass

from softcradle.physics.segments import PiecewiseContact, Segment

from softcradle import Chain, simulate


@dataclass(frozen=True)
class TwoStageBuffer(PiecewiseContact):
    """A contact of stiffness `soft` [N/m] up to the displacement `change` [m], and of stiffness `hard` beyond it."""

    soft: float
    hard: float
    change: float
    hysteresis: float

    @property
    def segments(self) -> list[Segment]:
        """One segment for each stage. The second one begins with the force at which the first one ends."""
        force = self.soft * self.change
        return [
            Segment(1.0, 0.0, preload=0.0, stiffness=self.soft, exponent=1.0, loss=self.hysteresis, length=self.change),
            Segment(1.0, self.change, preload=force, stiffness=self.hard, exponent=1.0, loss=self.hysteresis),
        ]


if __name__ == "__main__":
    buffer = TwoStageBuffer(soft=1e6, hard=1e7, change=0.05, hysteresis=0.5)
    found = simulate(Chain([2e4, 2e4], buffer), [1.0, 0.0], 1.0, samples=401)
    print(f"largest force {found.force.max():.6g} N, dissipated {found.absorbed_by_contacts[-1]:.6g} J")
