"""Special plots: kymographs, stacked energies, space-time plots, differences of lanes, and x-y plots of two signals."""

from __future__ import annotations

import math

import numpy as np
import pygame
from softcradle.sandbox.draw.axes import VerticalAxis, linear_axis, ticks_apart
from softcradle.sandbox.draw.palette import Colour, bead_colours, mix, tones
from softcradle.sandbox.draw.supersampling import SUBPIXELS, draw_marker
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.languages import _
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.session.history_slices import history_slices, slice_at
from softcradle.sandbox.story.numbers import TIMES, power_of_ten, prefixed
from softcradle.sandbox.window.page import Derived
from softcradle.sandbox.window.plots.curves import RIGHT, THICKNESS, Plot, draw_curves


class DifferencePlot(Plot):
    """The curves of the second lane minus the curves of the first lane. Both lanes must have equal numbers of beads."""

    def samples_of_frames(self, first: int, last: int, most: int = 0) -> list[tuple[Array, Array]]:
        """Return times and differences, as in `Plot.samples_of_frames`. Values are (T, 0) if the lanes cannot be
        compared.
        """
        slices = (history_slices(self.history, lane, first, last, most) for lane in (0, 1))
        return [(a.time, self._differences(a, b)) for a, b in zip(*slices, strict=True)]

    def values_at(self, frame: int) -> Array:
        """Return the differences at a frame, as in `Plot.values_at`."""
        return self._differences(*(slice_at(self.history, lane, frame) for lane in (0, 1)))[0]

    def _differences(self, a: Motion, b: Motion) -> Array:
        if a.overlap.shape != b.overlap.shape:
            return np.zeros((len(a.time), 0))
        differences: Array = self.content.values(b) - self.content.values(a)
        return differences


PALE = 0.45  # Fraction of the background colour in the band of a bead.


class KymographPlot(Plot):
    """A plot of positions. Each bead has a pale band, and a curve marks its centre."""

    marked = False

    def draw_columns(self, first: int, last: int) -> pygame.Surface:
        """Return a surface with the bands and markers of columns `first` to `last`."""
        fine = self.enlarged_background(first, last)
        colours, half = self.content.colours, 0.5 * self.content.band
        for time, values in self.samples(first, last):
            across = (time / self.span.column - first + 0.5) * SUBPIXELS
            # Extend each slice of the history by a pixel, so that no gap appears between slices.
            across[[0, -1]] += -SUBPIXELS, SUBPIXELS
            low, high = ((self.y(values + side * half) + 0.5) * SUBPIXELS for side in (-1.0, 1.0))
            for k in range(min(values.shape[1], len(colours))):
                edge = np.concatenate((across, across[::-1])), np.concatenate((low[:, k], high[::-1, k]))
                if len(across) > 1:
                    pygame.draw.polygon(fine, mix(colours[k], tones.background, PALE), np.column_stack(edge).tolist())
            down = (self.y(values) + 0.5) * SUBPIXELS
            markers = [tones.foreground] * values.shape[1]
            draw_curves(fine, markers, across, down, THICKNESS * self.unit * SUBPIXELS)
        return pygame.transform.smoothscale(fine, (last - first, self.area.height))


class StackedPlot(Plot):
    """A plot of stacked energies: the kinetic energy of each bead at the bottom, and the energy stored in the contacts
    on top.
    """

    at_values = False

    marked = False

    def draw_columns(self, first: int, last: int) -> pygame.Surface:
        """Return a surface with the stacked energies of columns `first` to `last`."""
        pixels = pygame.surfarray.array3d(self.curves.background)[:1].repeat(last - first, axis=0)
        middles = np.arange(self.area.height) + 0.5
        for time, values in self.samples(first, last):
            layers = values.shape[1]  # Number of layers in these frames. Beads may have been added or removed later.
            colours = np.array([*_layer_colours(layers), tones.background], dtype=np.uint8)
            tops = self.y(np.cumsum(values, axis=1))
            for column, row in _latest(time / self.span.column, first, last):
                # For each pixel, the first layer that is high enough to cover it.
                layer = np.searchsorted(-tops[row], -middles)
                inside = layer < layers
                pixels[column - first, inside] = colours[layer[inside]]
        return pygame.surfarray.make_surface(pixels)


def _layer_colours(count: int) -> tuple[Colour, ...]:
    """Return the colours of the layers from bottom to top: first the beads, then the contacts."""
    return *bead_colours(count - 1), tones.steel


def _latest(places: Array, first: int, last: int) -> list[tuple[int, int]]:
    """Return (column, row) for columns `first` to `last`. The row is the newest sample at or before the column.

    `places` (T,) are the times of the samples, measured in columns.
    """
    columns = np.arange(first, last)
    rows = np.searchsorted(places, columns + 1) - 1
    covered = (rows >= 0) & (columns <= places[-1])
    return list(zip(columns[covered].tolist(), rows[covered].tolist(), strict=True))


SHADES = 256
SCALE = 7.0  # Width of the scale of shades in design pixels.


class StripPlot(Plot):
    """A plot of shaded strips, one below the other. Each curve is drawn as one horizontal strip."""

    at_values = False

    marked = False

    def draw_columns(self, first: int, last: int) -> pygame.Surface:
        """Return a surface with the shades of columns `first` to `last`. A column has the shade of its largest sample."""
        image = np.zeros((last - first, self.area.height), dtype=np.uint8)
        for time, values in self.samples(first, last):
            columns = np.floor(time / self.span.column).astype(int) - first
            inside = (columns >= 0) & (columns < last - first)
            shade = np.clip(values[inside] / self.content.darkest * (SHADES - 1), 0, SHADES - 1).astype(np.uint8)
            strips = (np.arange(self.area.height) * values.shape[1]) // self.area.height
            np.maximum.at(image, columns[inside], shade[:, strips])
        return pygame.surfarray.make_surface(_shades()[image])

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw title and labels, and the scale of the shades to the right of the axes."""
        super().backdrop(surface)
        unit, area = self.unit, self.area
        bar = pygame.Rect(area.right + round(6 * unit), area.top, max(3, round(SCALE * unit)), area.height)
        shades = _shades()
        rows = ((bar.height - 1 - np.arange(bar.height)) * (SHADES - 1)) // max(1, bar.height - 1)
        column = pygame.surfarray.make_surface(np.broadcast_to(shades[rows], (bar.width, bar.height, 3)))
        surface.blit(column, bar)
        pygame.draw.rect(surface, tones.faint, bar, 1)
        end = area.right + (RIGHT + 8) * unit  # Leave a distance to the left edge of the panel.
        write(surface, self._darkest(), (end, area.top - 4 * unit), 13 * unit, tones.muted, align=(1, 1))
        write(surface, "0", (bar.right + 3 * unit, bar.bottom - 6 * unit), 13 * unit, tones.muted, align=(0, 0.5))

    def title_room(self) -> float:
        """Return the width in pixels for the title. The rest of the line is for the number above the scale."""
        return self.area.width + RIGHT * self.unit - width(self._darkest(), 13 * self.unit)

    def _darkest(self) -> str:
        number, _space, prefix = prefixed(self.content.darkest).partition(" ")
        return f"{number} {prefix}N"


def _shades() -> Array:
    """Return the (SHADES, 3) colours from value 0 to the darkest shade."""
    ramp = tones.shades
    places = np.linspace(0, len(ramp) - 1, SHADES)
    rows = [mix(ramp[int(p)], ramp[min(int(p) + 1, len(ramp) - 1)], float(p) % 1.0) for p in places]
    return np.array(rows, dtype=np.uint8)


MOST_POINTS = 1500  # Largest number of points of the curve; more points are evenly thinned out.
MARGIN = 0.06  # Margin of the axes beyond the range of the values, as a fraction of this range.
LATER = 0.25  # Fraction of the curve's colour in the part after the current frame.


class PhasePlot(Plot):
    """An x-y plot that shows the complete history as one curve. The axes adapt to the values.

    The `values` of the content are (T, 2): y, x.
    """

    timed = marked = False

    def __init__(self, *arguments: object) -> None:
        super().__init__(*arguments)  # type: ignore[arg-type]
        self._points = np.zeros((0, 3))  # Columns: time, y, x.
        self._found = Derived(lambda: self.history.version, self._find_points)

    def update(self, grown: bool, budget: int) -> int:
        """Return 0: this plot draws nothing ahead of time."""
        return 0

    @property
    def complete(self) -> bool:
        """Always True, because no columns are drawn."""
        return True

    def points(self) -> Array:
        """Return the (T, 3) times, y and x values of the history."""
        self._found.follow()
        return self._points

    def _find_points(self) -> None:
        parts = history_slices(self.history, self.lane, self.history.first, self.history.last, MOST_POINTS)
        self._points = np.concatenate(
            [np.column_stack((part.time, self.content.values(part))) for part in parts] or [np.zeros((0, 3))]
        )

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw nothing, because the axes change with the values."""

    def paint(self, surface: pygame.Surface, time: float, values: Array) -> None:
        """Draw the axes, the curve, and a marker at the current frame. The curve is stronger up to the current frame."""
        unit, area, points = self.unit, self.area, self.points()
        surface.fill(tones.background, self.rect)
        low, high = (_ends(points[:, column], values[column - 1]) for column in (1, 2))
        self.axis = VerticalAxis("", *low, tuple(scaled_ticks(low)))
        names = [f"{name}{_factor(ends)}" for name, ends in zip(self.content.names, (low, high), strict=True)]
        self.write_title(surface, _("{vertical} against {horizontal}", vertical=names[0], horizontal=names[1]))

        def places(rows: Array) -> Array:
            across = area.left + (rows[:, 1] - high[0]) / (high[1] - high[0]) * area.width
            return np.column_stack((across, area.top + self.y(rows[:, 0])))

        ticks = scaled_ticks(high)
        gap = max((width(text, 13 * unit) for _value, text in ticks), default=0.0) + 8 * unit
        apart = ticks_apart(ticks, area.width / (high[1] - high[0]), gap)
        labels = [(float(places(np.array([[low[0], value]]))[0, 0]), text) for value, text in apart]
        for x, _text in labels:
            surface.fill(tones.grid, (round(x), area.top, 1, area.height))
        for y in self.write_down(surface):
            surface.fill(tones.grid, (area.left, round(y), area.width, 1))
        self.write_across(surface, labels, names[1], area.right)
        colour = self.content.colours[0]
        known = np.isfinite(points).all(axis=1)
        for rows, tint in (
            (points[known & (points[:, 0] >= time)], mix(tones.background, colour, LATER)),
            (points[known & (points[:, 0] <= time)], colour),
        ):
            if len(rows) > 1:
                pygame.draw.aalines(surface, tint, False, places(rows[:, 1:]).tolist())
        if np.isfinite(values).all():
            draw_marker(surface, 0, tuple(places(values[None])[0].tolist()), 3.6 * unit, colour)


def exponent_of(ends: tuple[float, float]) -> int:
    """Return the exponent of the common power of ten that the labels of an axis omit. It is a multiple of 3.

    It is 0 if the labels are short anyway.
    """
    greatest = math.log10(max(map(abs, ends)))
    return 0 if -2.0 < greatest < 4.0 else 3 * math.floor(greatest / 3.0)


def scaled_ticks(ends: tuple[float, float]) -> list[tuple[float, str]]:
    """Return (value, label) for each labelled value of an axis. The labels omit their common power of ten."""
    size = 10.0 ** exponent_of(ends)
    return [(value * size, text) for value, text in linear_axis("", ends[0] / size, ends[1] / size).ticks]


def _factor(ends: tuple[float, float]) -> str:
    exponent = exponent_of(ends)
    return f" {TIMES}{power_of_ten(exponent)}" if exponent else ""


def _ends(values: Array, present: float) -> tuple[float, float]:
    """Return the ends of an axis that contains all values."""
    known = values[np.isfinite(values)]
    low = float(min(known.min(initial=np.inf), present if np.isfinite(present) else np.inf))
    high = float(max(known.max(initial=-np.inf), present if np.isfinite(present) else -np.inf))
    if not np.isfinite(low) or low == high:
        middle = low if np.isfinite(low) else 0.0
        half = 0.5 * abs(middle) or 1.0
        return middle - half, middle + half
    margin = MARGIN * (high - low)
    return low - margin, high + margin
