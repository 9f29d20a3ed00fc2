"""The camera: which part of the line is on screen. All lanes look through the same one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.session.live_lane import LiveLane

ZOOM = 1.25
PATIENCE = 6.0  # 1/s: how fast a following camera catches up


@dataclass
class Camera:
    """Centre [m] and width [m] of what is seen; `following`: it keeps the beads in the middle."""

    centre: float
    width: float
    following: bool = False

    @classmethod
    def of(cls, scales: Scales) -> Camera:
        """What the scales' window shows."""
        low, high = scales.window
        return cls(0.5 * (low + high), high - low)

    def zoom(self, steps: int) -> None:
        """Nearer by `steps`, farther if negative."""
        self.width = min(max(self.width * ZOOM**-steps, 1e-4), 1e6)

    def follow(self, lanes: Sequence[LiveLane], length: float, seconds: float) -> None:
        """Move towards the middle of the beads of finite mass."""
        if self.following:
            middle = self.middle(lanes, length)
            self.centre += min(1.0, PATIENCE * seconds) * (middle - self.centre)

    def middle(self, lanes: Sequence[LiveLane], length: float) -> float:
        """Middle of all beads [m]."""
        lows = [float(lane.position.min()) for lane in lanes]
        highs = [float(lane.position.max()) + length * len(lane.position) for lane in lanes]
        return 0.5 * (min(lows) + max(highs))

    def window(self, scales: Scales) -> Scales:
        """The scales with this camera's window."""
        return replace(scales, window=(self.centre - 0.5 * self.width, self.centre + 0.5 * self.width))
