"""Panels of curves against time: axes and curves are drawn once, and in each frame the curves up to the cursor appear."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame
from softcradle.sandbox.draw.number_format import decades, spread, ticks, time_unit
from softcradle.sandbox.draw.palette import Colour, mix, tones
from softcradle.sandbox.draw.supersampling import SUBPIXELS, draw_line, draw_marker
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.motion import Array

# Design pixels around the axes, for ticks, names and title.
LEFT = 46.0
RIGHT = 44.0
TOP = 24.0
BOTTOM = 22.0
LINE_WIDTH = 2.2  # of a curve [design pixels]
MARKER_RADIUS = 3.6  # design pixels
MOST_LABELS = 10  # more curves have neither names nor markers
LABEL_GAP = 14.0  # design pixels between names beside the axes


@dataclass(frozen=True)
class VerticalAxis:
    """A vertical axis.

    Attributes:
        title: above it.
        low, high: its ends; exponents of ten where it is logarithmic.
        ticks: (place, label) of each tick.
        logarithmic: whether it shows the logarithm of values.
    """

    title: str
    low: float
    high: float
    ticks: tuple[tuple[float, str], ...]
    logarithmic: bool = False

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
    """An axis from `low` to `high` with round ticks."""
    return VerticalAxis(title, low, high, tuple(ticks(low, high, 5)))


def decade_axis(title: str, low: int, high: int) -> VerticalAxis:
    """An axis of powers of ten."""
    return VerticalAxis(title, float(low), float(high), tuple(decades(low, high, 5)), True)


class Panel:
    """One plot: curves against time. The curves are drawn by :meth:`draw_curves` and shown up to the cursor by :meth:`paint`.

    Arguments:
        rect: where it is drawn.
        unit: pixels of a design pixel.
        time: ends of the time axis [s].
        axis: the vertical axis.
        colours, names: of the curves.
    """

    def __init__(
        self,
        rect: pygame.Rect,
        unit: float,
        time: tuple[float, float],
        axis: VerticalAxis,
        *,
        colours: Sequence[Colour],
        names: Sequence[str],
    ) -> None:
        self.rect, self.unit, self.time, self.axis, self.colours, self.names = rect, unit, time, axis, colours, names
        left, top = rect.left + round(LEFT * unit), rect.top + round(TOP * unit)
        right, bottom = rect.right - round(RIGHT * unit), rect.bottom - round(BOTTOM * unit)
        self.area = pygame.Rect(left, top, max(8, right - left), max(8, bottom - top))
        self.curves = pygame.Surface(self.area.size, 0, 32)
        self.labelled = len(names) <= MOST_LABELS and len(names) * 0.75 * LABEL_GAP * unit <= self.area.height

    def x(self, time: Array | float) -> Array:
        """Pixel of `time` [s], from the left end of the axes."""
        share = (np.asarray(time, dtype=np.float64) - self.time[0]) / (self.time[1] - self.time[0])
        return share * (self.area.width - 1)

    def y(self, place: Array) -> Array:
        """Pixel of a place on the axis, from the top of the axes; places beyond its ends are put just outside."""
        share = np.clip((place - self.axis.low) / (self.axis.high - self.axis.low), -0.1, 1.1)
        return (self.area.height - 1) * (1.0 - share)

    def draw_curves(self, time: Array, values: Array) -> None:
        """Draw the curves `values` (T, k) over `time` (T,), of which each frame then shows a part."""
        self.curves = self._drawn(time, values, self.colours)

    def backdrop(self, surface: pygame.Surface, time: Array, values: Array, peaks: Array, ahead: float) -> None:
        """Draw axes, title, names beside the values `peaks` (k,), and all curves as strong as `ahead` (0 to 1)."""
        pale = [mix(tones.background, colour, ahead) for colour in self.colours]
        surface.blit(self._drawn(time, values, pale if ahead > 0.0 else ()), self.area)
        self._annotate(surface)
        self._write_names(surface, self.y(self.axis.on(peaks)))

    def paint(self, surface: pygame.Surface, time: float, values: Array) -> None:
        """Show the curves up to the cursor at `time`, and a marker at each of the `values` (k,) there."""
        place = float(self.x(time))
        if not 0.0 <= place <= self.area.width:
            return
        end = round(place)
        surface.blit(self.curves, self.area, (0, 0, end, self.area.height))
        surface.fill(tones.muted, (self.area.left + end, self.area.top, max(1, round(self.unit)), self.area.height))
        if not self.labelled:
            return
        heights = self.y(self.axis.on(values))
        for k in range(len(values) - 1, -1, -1):
            if 0.0 <= heights[k] <= self.area.height:
                centre = (self.area.left + place + 0.5, self.area.top + float(heights[k]) + 0.5)
                draw_marker(surface, k, centre, MARKER_RADIUS * self.unit, self.colours[k])

    def _drawn(self, time: Array, values: Array, colours: Sequence[Colour]) -> pygame.Surface:
        """Grid and curves; the first curve is drawn last and lies above the others."""
        wide, high = self.area.size
        fine = pygame.Surface((wide * SUBPIXELS, high * SUBPIXELS), 0, 32)
        fine.fill(tones.background)
        self._grid(fine)
        across = (self.x(time) + 0.5) * SUBPIXELS
        for k in range(len(colours) - 1, -1, -1):
            down = (self.y(self.axis.on(values[:, k])) + 0.5) * SUBPIXELS
            draw_line(fine, colours[k], _thinned(across, down), LINE_WIDTH * self.unit * SUBPIXELS)
        return pygame.transform.smoothscale(fine, (wide, high))

    def _grid(self, fine: pygame.Surface) -> None:
        for place, _ in self.axis.ticks:
            y = round(float(self.y(np.array(place))))
            tint = tones.faint if place == 0.0 and not self.axis.logarithmic else tones.grid
            fine.fill(tint, (0, y * SUBPIXELS, fine.get_width(), SUBPIXELS))
        for time, _ in self._time_ticks():
            fine.fill(tones.grid, (round(float(self.x(time))) * SUBPIXELS, 0, SUBPIXELS, fine.get_height()))

    def _time_ticks(self) -> list[tuple[float, str]]:
        size, _ = time_unit(self.time[1] - self.time[0])
        return [(v * size, text) for v, text in ticks(self.time[0] / size, self.time[1] / size, 6)]

    def _annotate(self, surface: pygame.Surface) -> None:
        """Write the title and the ticks of both axes."""
        unit, area = self.unit, self.area
        write(surface, self.axis.title, (area.left, area.top - 5 * unit), 13.5 * unit, tones.foreground, align=(0, 1))
        for place, text in self.axis.ticks:
            y = area.top + float(self.y(np.array(place)))
            write(surface, text, (area.left - 6 * unit, y), 12 * unit, tones.muted, align=(1, 0.5))
        for time, text in self._time_ticks():
            x, y = area.left + float(self.x(time)), area.bottom + 3 * unit
            write(surface, text, (x, y), 12 * unit, tones.muted, align=(0.5, 0))
        name = f"t ({time_unit(self.time[1] - self.time[0])[1]})"
        write(surface, name, (self.rect.right, area.bottom + 3 * unit), 12 * unit, tones.muted, align=(1, 0))

    def _write_names(self, surface: pygame.Surface, heights: Array) -> None:
        """A marker and a name beside the axes for each of `heights`, moved apart so that they do not overlap."""
        if not self.labelled:
            return
        unit, area = self.unit, self.area
        for k, y in enumerate(spread(heights.tolist(), LABEL_GAP * unit, 0.0, area.height - 5.0 * unit)):
            x, middle = area.right + 9 * unit, area.top + y
            draw_marker(surface, k, (x, middle), MARKER_RADIUS * unit, self.colours[k])
            write(surface, self.names[k], (x + 7 * unit, middle), 13 * unit, tones.foreground, align=(0, 0.5))


def _thinned(across: Array, down: Array) -> list[tuple[float, float]]:
    """Points of a curve, without those on the same fine pixel as the point before."""
    moved = np.ones(len(across), dtype=bool)
    moved[1:] = (np.diff(np.floor(across)) != 0.0) | (np.diff(np.floor(down)) != 0.0)
    return list(zip(across[moved].tolist(), down[moved].tolist(), strict=True))
