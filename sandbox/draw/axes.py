"""Axes of charts. The module contains the vertical axis with its ticks. The module also writes titles, tick labels and
the names of curves.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame
from softcradle.sandbox.draw.palette import Colour, tones
from softcradle.sandbox.draw.supersampling import draw_marker
from softcradle.sandbox.draw.text import shortened, width, write
from softcradle.sandbox.motion import Array
from softcradle.sandbox.story.numbers import axis_prefix, decades, spread, ticks, with_prefix

TEXT = 13.0  # Size of all text of a chart [design pixels].
LINE = 14.0  # Smallest vertical distance between two tick labels or two names of curves [design pixels].
MARKER_RADIUS = 3.6  # Radius of a marker [design pixels].
LEADER = 9.0  # Width of the line that connects a curve with its name [design pixels].
# Length by which a title may be wider than the axes [design pixels]. Beyond this length, it would reach the tick labels
# of the next chart.
OVERHANG = 40.0


@dataclass(frozen=True)
class VerticalAxis:
    """Vertical axis of a chart.

    Attributes:
        title: text above the axis.
        low, high: values at the ends of the axis; exponents of ten if the axis is logarithmic.
        ticks: (value, label) of each tick.
        logarithmic: True if the axis shows the decimal logarithm of values.
        size, prefix: size and prefix of the unit of the tick labels. For the unit kN, the size is 1e3 and the prefix is
            "k".
    """

    title: str
    low: float
    high: float
    ticks: tuple[tuple[float, str], ...]
    logarithmic: bool = False
    size: float = 1.0
    prefix: str = ""

    def on(self, values: Array) -> Array:
        """Return the coordinates of `values` on the axis.

        On a logarithmic axis the coordinates are decimal logarithms. Values below the lower end of the axis, including
        0, are put one decade below this end.
        """
        if not self.logarithmic:
            return values
        logarithms: Array = np.log10(np.maximum(values, 10.0 ** (self.low - 1.0)))
        return logarithms


def ticks_apart(ticks: Sequence[tuple[float, str]], scale: float, gap: float) -> list[tuple[float, str]]:
    """Return every k-th of the evenly spaced `ticks`. k is the smallest number that keeps the ticks `gap` pixels apart.

    `scale` is the number of pixels per unit. The scale is negative for an axis that points down. The tick at 0 is
    always kept.
    """
    if len(ticks) < 2:
        return list(ticks)
    every = math.ceil(gap / max(abs(scale * (ticks[1][0] - ticks[0][0])), 1e-9))
    kept = next((k for k, (value, _) in enumerate(ticks) if value == 0.0), 0) % every
    return list(ticks[kept::every])


def linear_axis(title: str, low: float, high: float) -> VerticalAxis:
    """Return an axis from `low` to `high` with round tick values. Large numbers are written in a larger unit, and the
    title of the axis contains this unit.
    """
    size, prefix = axis_prefix(max(abs(low), abs(high)))
    marks = tuple((value * size, text) for value, text in ticks(low / size, high / size, 5))
    return VerticalAxis(with_prefix(title, prefix), low, high, marks, size=size, prefix=prefix)


def decade_axis(title: str, low: int, high: int) -> VerticalAxis:
    """Return a logarithmic axis from 10**`low` to 10**`high`."""
    return VerticalAxis(title, float(low), float(high), tuple(decades(low, high, 5)), True)


class Axes:
    """Axes of one chart.

    Arguments:
        rect: rectangle of the whole chart [pixels].
        unit: pixels per design pixel.
        axis: the vertical axis.
        margins: distances of the axes from the left, right, top and bottom edge of `rect` [design pixels].

    Attributes:
        area: the rectangle inside the axes [pixels].
    """

    def __init__(
        self, rect: pygame.Rect, unit: float, axis: VerticalAxis, margins: tuple[float, float, float, float]
    ) -> None:
        self.rect, self.unit, self.axis = rect, unit, axis
        left, right, top, bottom = (round(margin * unit) for margin in margins)
        size = max(8, rect.width - left - right), max(8, rect.height - top - bottom)
        self.area = pygame.Rect((rect.left + left, rect.top + top), size)

    def y(self, place: Array) -> Array:
        """Return the distance [pixels] between a coordinate and the top of the axes. Coordinates beyond the ends of the
        axis are put just outside it.
        """
        share = np.clip((place - self.axis.low) / (self.axis.high - self.axis.low), -0.1, 1.1)
        return (self.area.height - 1) * (1.0 - share)

    def levels(self) -> list[tuple[int, Colour]]:
        """Return the vertical position [pixels] and the colour of each horizontal grid line. Each tick of the vertical
        axis has one grid line.
        """
        zero = tones.grid if self.axis.logarithmic else tones.faint
        return [
            (round(float(self.y(np.array(place)))), zero if place == 0.0 else tones.grid)
            for place, _text in self.axis.ticks
        ]

    def title_room(self) -> float:
        """Return the largest width [pixels] of a title."""
        return self.area.width + OVERHANG * self.unit

    def write_title(self, surface: pygame.Surface, title: str) -> None:
        """Write the title of the chart above the axes."""
        size, place = TEXT * self.unit, (self.area.left, self.area.top - 4 * self.unit)
        write(surface, shortened(title, size, self.title_room()), place, size, tones.foreground, align=(0, 1))

    def write_down(self, surface: pygame.Surface) -> list[float]:
        """Write the labels of the vertical axis and return their vertical positions [pixels]."""
        unit, area = self.unit, self.area
        apart = ticks_apart(self.axis.ticks, area.height / (self.axis.high - self.axis.low), LINE * unit)
        places = [(area.top + float(self.y(np.array(value))), text) for value, text in apart]
        shown = [(y, text) for y, text in places if area.top - 1 <= y <= area.bottom + 1]
        for y, text in shown:
            write(surface, text, (area.left - 6 * unit, y), TEXT * unit, tones.muted, align=(1, 0.5))
        return [y for y, _text in shown]

    def write_across(self, surface: pygame.Surface, labels: Sequence[tuple[float, str]], name: str, end: int) -> None:
        """Write the labels of the horizontal axis at their pixels. Write the name of the axis so that it ends at the
        pixel `end`.
        """
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
        """Write the name and the marker of each curve at pixel `x`. `heights` are the vertical positions of the curves.

        Names that would overlap are moved apart. A line connects a moved name with its curve. Names without enough
        space are omitted.
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
        """Draw a marker at pixel `x` for each of the `heights`, in pixels below the top of the axes. The first marker
        covers the others.
        """
        for k in range(len(heights) - 1, -1, -1):
            if 0.0 <= heights[k] <= self.area.height:
                centre = (x + 0.5, self.area.top + heights[k] + 0.5)
                draw_marker(surface, k, centre, MARKER_RADIUS * self.unit, colours[k])
