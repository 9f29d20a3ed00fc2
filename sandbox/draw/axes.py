"""Axes of curves: the vertical axis with its places and ticks, and the painter of title, labels and names that charts share."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame
from softcradle.sandbox.draw.number_format import axis_prefix, decades, spread, ticks, with_prefix
from softcradle.sandbox.draw.palette import Colour, tones
from softcradle.sandbox.draw.supersampling import draw_marker
from softcradle.sandbox.draw.text import shortened, width, write
from softcradle.sandbox.motion import Array

TEXT = 13.0  # design pixels of what is written
LINE = 14.0  # design pixels between labels, and between names
MARKER_RADIUS = 3.6  # design pixels
LEADER = 9.0  # design pixels, the width of the line from a curve to its name
OVERHANG = 40.0  # design pixels by which a title may be longer than the axes: the next axis has its numbers there


@dataclass(frozen=True)
class VerticalAxis:
    """A vertical axis.

    Attributes:
        title: above it.
        low, high: its ends; exponents of ten where it is logarithmic.
        ticks: (place, label) of each tick.
        logarithmic: whether it shows the logarithm of values.
        size, prefix: of the unit in which its numbers are written: 1e3, "k" for kN.
    """

    title: str
    low: float
    high: float
    ticks: tuple[tuple[float, str], ...]
    logarithmic: bool = False
    size: float = 1.0
    prefix: str = ""

    def on(self, values: Array) -> Array:
        """Places of `values` on the axis. On a logarithmic axis, values too small for it are one decade below its lower end."""
        if not self.logarithmic:
            return values
        logarithms: Array = np.log10(np.maximum(values, 10.0 ** (self.low - 1.0)))
        return logarithms


def ticks_apart(ticks: Sequence[tuple[float, str]], scale: float, gap: float) -> list[tuple[float, str]]:
    """Every so many of evenly spaced ticks that they are `gap` pixels apart at `scale` pixels a unit; 0 stays among them.

    The scale of an axis that runs down is negative.
    """
    if len(ticks) < 2:
        return list(ticks)
    every = math.ceil(gap / max(abs(scale * (ticks[1][0] - ticks[0][0])), 1e-9))
    kept = next((k for k, (value, _) in enumerate(ticks) if value == 0.0), 0) % every
    return list(ticks[kept::every])


def linear_axis(title: str, low: float, high: float) -> VerticalAxis:
    """Return an axis from `low` to `high` with round ticks. Large numbers are written in a larger unit, which the title names."""
    size, prefix = axis_prefix(max(abs(low), abs(high)))
    marks = tuple((value * size, text) for value, text in ticks(low / size, high / size, 5))
    return VerticalAxis(with_prefix(title, prefix), low, high, marks, size=size, prefix=prefix)


def decade_axis(title: str, low: int, high: int) -> VerticalAxis:
    """An axis of powers of ten."""
    return VerticalAxis(title, float(low), float(high), tuple(decades(low, high, 5)), True)


class Axes:
    """The axes of one chart.

    Arguments:
        rect: of the whole chart; pixels.
        unit: pixels that a pixel of the design is.
        axis: the vertical axis.
        margins: left, right, top and bottom of the axes [design pixels].

    Attributes:
        area: the rectangle inside the axes.
    """

    def __init__(
        self, rect: pygame.Rect, unit: float, axis: VerticalAxis, margins: tuple[float, float, float, float]
    ) -> None:
        self.rect, self.unit, self.axis = rect, unit, axis
        left, right, top, bottom = (round(margin * unit) for margin in margins)
        size = max(8, rect.width - left - right), max(8, rect.height - top - bottom)
        self.area = pygame.Rect((rect.left + left, rect.top + top), size)

    def y(self, place: Array) -> Array:
        """Pixel of a place on the axis, from the top of the axes; places beyond its ends are put just outside."""
        share = np.clip((place - self.axis.low) / (self.axis.high - self.axis.low), -0.1, 1.1)
        return (self.area.height - 1) * (1.0 - share)

    def levels(self) -> list[tuple[int, Colour]]:
        """Pixel and colour of the line at each tick of the vertical axis."""
        zero = tones.grid if self.axis.logarithmic else tones.faint
        return [
            (round(float(self.y(np.array(place)))), zero if place == 0.0 else tones.grid)
            for place, _text in self.axis.ticks
        ]

    def title_room(self) -> float:
        """How wide a title may be; pixels."""
        return self.area.width + OVERHANG * self.unit

    def write_title(self, surface: pygame.Surface, title: str) -> None:
        """Write what is shown above the axes."""
        size, place = TEXT * self.unit, (self.area.left, self.area.top - 4 * self.unit)
        write(surface, shortened(title, size, self.title_room()), place, size, tones.foreground, align=(0, 1))

    def write_down(self, surface: pygame.Surface) -> list[float]:
        """Write the labels of the vertical axis; returns their pixels."""
        unit, area = self.unit, self.area
        apart = ticks_apart(self.axis.ticks, area.height / (self.axis.high - self.axis.low), LINE * unit)
        places = [(area.top + float(self.y(np.array(value))), text) for value, text in apart]
        shown = [(y, text) for y, text in places if area.top - 1 <= y <= area.bottom + 1]
        for y, text in shown:
            write(surface, text, (area.left - 6 * unit, y), TEXT * unit, tones.muted, align=(1, 0.5))
        return [y for y, _text in shown]

    def write_across(self, surface: pygame.Surface, labels: Sequence[tuple[float, str]], name: str, end: int) -> None:
        """Write the labels of the horizontal axis at their pixels, and its name, which ends at the pixel `end`."""
        unit, area, size = self.unit, self.area, TEXT * self.unit
        room = end - width(name, size) - 8 * unit
        for x, text in labels:
            half = 0.5 * width(text, size)
            if area.left - 12 * unit <= x - half and x + half < room:
                write(surface, text, (x, area.bottom + 3 * unit), size, tones.muted, align=(0.5, 0))
        write(surface, name, (end, area.bottom + 3 * unit), size, tones.muted, align=(1, 0))

    def write_names(
        self,
        surface: pygame.Surface,
        x: float,
        heights: Sequence[float],
        names: Sequence[str],
        colours: Sequence[Colour],
    ) -> None:
        """Write a name and a marker at pixel `x` for each of `heights`, moved apart; names without room are left out.

        A line leads from a curve to a name that was moved away from it.
        """
        unit, written = self.unit, -math.inf
        places = spread(list(heights), LINE * unit, 2.0 * unit, self.area.height - 4.0 * unit)
        for k, y in sorted(enumerate(places), key=lambda pair: pair[1]):
            if y >= written + LINE * unit - 1e-6:
                written, place = y, (x + 7 * unit, self.area.top + y)
                if abs(y - heights[k]) > 0.5 * LINE * unit:
                    curve = x - LEADER * unit, self.area.top + min(max(heights[k], 0.0), self.area.height)
                    pygame.draw.aaline(surface, colours[k], curve, (x, place[1]))
                draw_marker(surface, k, (x, place[1]), MARKER_RADIUS * unit, colours[k])
                write(surface, names[k], place, TEXT * unit, tones.foreground, align=(0, 0.5))

    def mark(self, surface: pygame.Surface, x: float, heights: Sequence[float], colours: Sequence[Colour]) -> None:
        """A marker at each of the `heights` on the axes, the first on top."""
        for k in range(len(heights) - 1, -1, -1):
            if 0.0 <= heights[k] <= self.area.height:
                centre = (x + 0.5, self.area.top + heights[k] + 0.5)
                draw_marker(surface, k, centre, MARKER_RADIUS * self.unit, colours[k])
