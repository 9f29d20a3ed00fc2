"""The camera: which part of the line is shown. All lanes have the same one; it widens by itself until somebody moves it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.session.live_lane import LiveLane

ZOOM = 1.25  # factor of one step
MARGIN = 0.04  # of the width beyond the outermost beads, after it has framed them
SPARE = 1.4  # of the width that would do, so that beads that go on do not leave again at once
NARROWEST = 1e-4  # m
WIDEST = 1e9  # m


@dataclass
class Camera:
    """Centre [m] and width [m] of what is shown; an `automatic` one keeps all beads in sight."""

    centre: float
    width: float
    automatic: bool = True

    @classmethod
    def of(cls, scales: Scales) -> Camera:
        """The camera that shows the window of the scales."""
        low, high = scales.window
        return cls(0.5 * (low + high), high - low)

    def zoom(self, steps: float) -> None:
        """Zoom in by `steps`, out if negative."""
        self.width = min(max(self.width * ZOOM**-steps, NARROWEST), WIDEST)
        self.automatic = False

    def pan(self, distance: float) -> None:
        """Move by `distance` [m] to the right."""
        self.centre += distance
        self.automatic = False

    def fit(self, lanes: Sequence[LiveLane], length: float, spare: float = 1.0) -> None:
        """Show all beads, which are `length` [m] long, in a window `spare` times as wide as they need."""
        low, high = extent(lanes, length)
        self.centre, self.width = 0.5 * (low + high), (1.0 + 2.0 * MARGIN) * spare * (high - low)
        self.automatic = True

    def keep_in_sight(self, lanes: Sequence[LiveLane], length: float, visible: float) -> bool:
        """Widen where it is automatic and a bead has left the `visible` metres; whether it did."""
        if not self.automatic:
            return False
        low, high = extent(lanes, length)
        if low >= self.centre - 0.5 * visible and high <= self.centre + 0.5 * visible:
            return False
        self.fit(lanes, length, SPARE)
        return True

    def window(self, scales: Scales) -> Scales:
        """The scales with this camera's window."""
        return replace(scales, window=(self.centre - 0.5 * self.width, self.centre + 0.5 * self.width))


def extent(lanes: Sequence[LiveLane], length: float) -> tuple[float, float]:
    """Left and right end of all beads [m]."""
    positions = [lane.position for lane in lanes]
    return min(float(p.min()) for p in positions), max(float(p.max()) + length * len(p) for p in positions)
