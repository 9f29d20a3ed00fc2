"""The time axis that all plots share: how much time it spans, and where it begins."""

from __future__ import annotations

from dataclasses import dataclass

from softcradle.sandbox.draw.number_format import ticks, time_unit

SECONDS = 8.0  # of wall time that a plot spans
LATEST = 0.92  # rightmost place of the cursor, as a share of the width
EARLIEST = 0.08  # leftmost place of the cursor, as a share of the width, but at the start of the scene


@dataclass
class TimeSpan:
    """The time axis.

    Attributes:
        seconds: model time that it spans [s].
        width: pixels, one a column.
        left: the column at the left edge; column 0 is t = 0.
    """

    seconds: float
    width: int
    left: int = 0

    @property
    def column(self) -> float:
        """Model time of one column [s]."""
        return self.seconds / self.width

    def follow(self, time: float) -> None:
        """Scroll by whole columns until `time` is visible; the start of the scene stays as long as it can."""
        place = time / self.column - self.left
        if place > LATEST * self.width:
            self.left += round(place - LATEST * self.width)
        elif place < EARLIEST * self.width:
            self.left = max(round(time / self.column - EARLIEST * self.width), min(0, round(time / self.column)))

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
        """(time [s], label) of the round times that are visible."""
        size, _ = self.unit()
        low, high = self.left * self.column / size, (self.left + self.width) * self.column / size
        return [(value * size, text) for value, text in ticks(low, high, 5)]
