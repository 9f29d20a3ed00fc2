"""The camera: which part of the line is shown. All lanes have the same one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.session.live_lane import LiveLane

ZOOM = 1.25  # factor of one step
CATCH_UP = 6.0  # 1/s: rate at which a following camera closes its distance to the beads
NARROWEST = 1e-4  # m
WIDEST = 1e6  # m


@dataclass
class Camera:
    """Centre [m] and width [m] of what is shown; `following`: it keeps the beads in the middle."""

    centre: float
    width: float
    following: bool = False

    @classmethod
    def of(cls, scales: Scales) -> Camera:
        """The camera that shows the window of the scales."""
        low, high = scales.window
        return cls(0.5 * (low + high), high - low)

    def zoom(self, steps: int) -> None:
        """Zoom in by `steps`, out if negative."""
        self.width = min(max(self.width * ZOOM**-steps, NARROWEST), WIDEST)

    def follow(self, lanes: Sequence[LiveLane], length: float, seconds: float) -> None:
        """Move towards the middle of the beads, if it is following; `length` is that of a bead [m]."""
        if self.following:
            middle = self.middle(lanes, length)
            self.centre += min(1.0, CATCH_UP * seconds) * (middle - self.centre)

    def middle(self, lanes: Sequence[LiveLane], length: float) -> float:
        """Middle of all beads [m]."""
        lows = [float(lane.position.min()) for lane in lanes]
        highs = [float(lane.position.max()) + length * len(lane.position) for lane in lanes]
        return 0.5 * (min(lows) + max(highs))

    def window(self, scales: Scales) -> Scales:
        """The scales with this camera's window."""
        return replace(scales, window=(self.centre - 0.5 * self.width, self.centre + 0.5 * self.width))
