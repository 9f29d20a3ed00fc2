"""The time axis that all plots share: how long a stretch is seen, and where it begins."""

from __future__ import annotations

from dataclasses import dataclass

from softcradle.sandbox.draw.number_format import ticks, time_unit

SECONDS = 8.0  # of wall time that a plot spans: what was seen is what is plotted
AHEAD, BEHIND = 0.92, 0.08  # where the cursor may be, as shares of the width


@dataclass
class TimeSpan:
    """Model time [s] of a pixel column, and the column at the left edge; `width` is in pixels."""

    seconds: float
    width: int
    left: int = 0

    @property
    def column(self) -> float:
        """Model time of one column [s]."""
        return self.seconds / self.width

    def follow(self, time: float) -> None:
        """Move on, by whole columns, so that `time` is in sight; the beginning of the scene stays until it must go."""
        place = time / self.column - self.left
        if place > AHEAD * self.width:
            self.left += round(place - AHEAD * self.width)
        elif place < BEHIND * self.width:
            self.left = max(round(time / self.column - BEHIND * self.width), min(0, round(time / self.column)))

    def x(self, time: float) -> float:
        """Pixel of `time` from the left edge."""
        return time / self.column - self.left

    def time(self, x: float) -> float:
        """The time [s] at pixel `x` from the left edge."""
        return (x + self.left) * self.column

    def unit(self) -> tuple[float, str]:
        """(seconds in the unit of the labels, its name)."""
        return time_unit(self.seconds)

    def ticks(self) -> list[tuple[float, str]]:
        """(time [s], label) of round times in sight."""
        size, _ = self.unit()
        low, high = self.left * self.column / size, (self.left + self.width) * self.column / size
        return [(value * size, text) for value, text in ticks(low, high, 5)]
