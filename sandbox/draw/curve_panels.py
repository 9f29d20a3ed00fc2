"""Panels with live curves: axes and curves are drawn once, the curves uncovered up to the cursor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame
from softcradle.sandbox.draw.number_format import decades, ticks, time_unit
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND, GRID, MUTED, Colour, mix
from softcradle.sandbox.draw.supersampling import SUBPIXELS, draw_line, draw_marker
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.motion import Array

LEFT, RIGHT, TOP, BOTTOM = 46.0, 44.0, 24.0, 22.0  # design pixels around the axes
THICK = 2.2
MOST_LABELS = 10
LABEL_GAP = 14.0  # design pixels between names beside the axes


@dataclass(frozen=True)
class Axis:
    """A vertical axis: its title, its ends, its ticks, and whether values are put on it as powers of ten."""

    title: str
    low: float
    high: float
    ticks: tuple[tuple[float, str], ...]
    logarithmic: bool = False

    def on(self, values: Array) -> Array:
        """`values` in units of the axis; where a logarithmic axis has no place for them, its lower end."""
        if not self.logarithmic:
            return values
        logarithms: Array = np.log10(np.maximum(values, 10.0 ** (self.low - 1.0)))
        return logarithms


def linear_axis(title: str, low: float, high: float) -> Axis:
    """Axis from `low` to `high` with round ticks."""
    return Axis(title, low, high, tuple(ticks(low, high, 5)))


def decade_axis(title: str, low: int, high: int) -> Axis:
    """Axis of powers of ten."""
    return Axis(title, float(low), float(high), tuple(decades(low, high, 5)), True)


class Panel:
    """One plot: some curves against time. `inked` grows as the history does; what is drawn depends on the arguments."""

    def __init__(
        self,
        rect: pygame.Rect,
        unit: float,
        time: tuple[float, float],
        axis: Axis,
        *,
        colours: Sequence[Colour],
        names: Sequence[str],
    ) -> None:
        self.rect, self.unit, self.time, self.axis, self.colours, self.names = rect, unit, time, axis, colours, names
        left, top = rect.left + round(LEFT * unit), rect.top + round(TOP * unit)
        right, bottom = rect.right - round(RIGHT * unit), rect.bottom - round(BOTTOM * unit)
        self.area = pygame.Rect(left, top, max(8, right - left), max(8, bottom - top))
        self.inked = pygame.Surface(self.area.size, 0, 32)
        self.roomy = len(names) <= MOST_LABELS and len(names) * 0.75 * LABEL_GAP * unit <= self.area.height

    def x(self, time: Array | float) -> Array:
        """Pixel of `time` [s], from the left end of the axes."""
        return (
            (np.asarray(time, dtype=np.float64) - self.time[0]) / (self.time[1] - self.time[0]) * (self.area.width - 1)
        )

    def y(self, value: Array) -> Array:
        """Pixel of a value in units of the axis, from the top of the axes; those beyond it stay just outside."""
        share = np.clip((value - self.axis.low) / (self.axis.high - self.axis.low), -0.1, 1.1)
        return (self.area.height - 1) * (1.0 - share)

    def ink(self, time: Array, values: Array, since: float = -math.inf) -> None:
        """Draw the curves `values` (T, k) over `time` (T,) on the hidden sheet; only what is later than `since`."""
        joint = 1 + math.ceil(THICK * self.unit)  # pixels before `since` that the next piece of a curve touches too
        first = 0 if since < self.time[0] else min(max(0, int(self.x(since)) - 2 * joint), self.area.width - 1)
        strip = self._curves(time, values, self.colours, first)
        margin = joint if first else 0  # curves are not smooth where a strip cuts them
        self.inked.blit(strip, (first + margin, 0), (margin, 0, *strip.get_size()))

    def backdrop(self, surface: pygame.Surface, time: Array, values: Array, peaks: Array, ahead: float) -> None:
        """Axes, titles, names beside `peaks` (k,), and the curves to come, as strong as `ahead` (0 to 1)."""
        pale = [mix(BACKGROUND, colour, ahead) for colour in self.colours]
        surface.blit(self._curves(time, values, pale if ahead > 0.0 else (), 0), self.area)
        self._annotate(surface)
        self._names(surface, self.y(self.axis.on(peaks)))

    def paint(self, surface: pygame.Surface, time: float, values: Array) -> None:
        """Uncover the curves up to `time`; `values` (k,) are those at the cursor."""
        place = float(self.x(time))
        if not 0.0 <= place <= self.area.width:
            return
        done = round(place)
        surface.blit(self.inked, self.area, (0, 0, done, self.area.height))
        surface.fill(MUTED, (self.area.left + done, self.area.top, max(1, round(self.unit)), self.area.height))
        if not self.roomy:
            return
        heights = self.y(self.axis.on(values))
        for k in range(len(values) - 1, -1, -1):
            if 0.0 <= heights[k] <= self.area.height:
                centre = (self.area.left + place + 0.5, self.area.top + float(heights[k]) + 0.5)
                draw_marker(surface, k, centre, 3.6 * self.unit, self.colours[k])

    def _curves(self, time: Array, values: Array, colours: Sequence[Colour], first: int) -> pygame.Surface:
        """Grid and curves from pixel column `first` on; from any column the same pixels as from column 0."""
        start = max(0, int(np.searchsorted(self.x(time), first - 2 * THICK * self.unit)) - 1)
        wide, high = self.area.width - first, self.area.height
        fine = pygame.Surface((wide * SUBPIXELS, high * SUBPIXELS), 0, 32)
        fine.fill(BACKGROUND)
        self._grid(fine, first)
        across = (self.x(time[start:]) - first + 0.5) * SUBPIXELS
        for k in range(len(colours) - 1, -1, -1):
            down = (self.y(self.axis.on(values[start:, k])) + 0.5) * SUBPIXELS
            draw_line(fine, colours[k], _thinned(across, down), THICK * self.unit * SUBPIXELS)
        return pygame.transform.smoothscale(fine, (wide, high))

    def _grid(self, fine: pygame.Surface, first: int) -> None:
        for value, _ in self.axis.ticks:
            y = round(float(self.y(np.array(value))))
            tint = FAINT if value == 0.0 and not self.axis.logarithmic else GRID
            fine.fill(tint, (0, y * SUBPIXELS, fine.get_width(), SUBPIXELS))
        for value, _ in self._time_ticks():
            fine.fill(GRID, ((round(float(self.x(value))) - first) * SUBPIXELS, 0, SUBPIXELS, fine.get_height()))

    def _time_ticks(self) -> list[tuple[float, str]]:
        size, _ = time_unit(self.time[1] - self.time[0])
        return [(v * size, text) for v, text in ticks(self.time[0] / size, self.time[1] / size, 6)]

    def _annotate(self, surface: pygame.Surface) -> None:
        unit, area = self.unit, self.area
        write(surface, self.axis.title, (area.left, area.top - 5 * unit), 13.5 * unit, FOREGROUND, align=(0, 1))
        for value, text in self.axis.ticks:
            y = area.top + float(self.y(np.array(value)))
            write(surface, text, (area.left - 6 * unit, y), 12 * unit, MUTED, align=(1, 0.5))
        for value, text in self._time_ticks():
            place = (area.left + float(self.x(value)), area.bottom + 3 * unit)
            write(surface, text, place, 12 * unit, MUTED, align=(0.5, 0))
        name = f"t ({time_unit(self.time[1] - self.time[0])[1]})"
        write(surface, name, (self.rect.right, area.bottom + 3 * unit), 12 * unit, MUTED, align=(1, 0))

    def _names(self, surface: pygame.Surface, heights: Array) -> None:
        """A marker and a name beside the axes at each of `heights`, spread so that none hides another."""
        if not self.roomy:
            return
        unit, area = self.unit, self.area
        for k, y in enumerate(spread(heights.tolist(), LABEL_GAP * unit, 0.0, area.height - 5.0 * unit)):
            x, middle = area.right + 9 * unit, area.top + y
            draw_marker(surface, k, (x, middle), 3.6 * unit, self.colours[k])
            write(surface, self.names[k], (x + 7 * unit, middle), 13 * unit, FOREGROUND, align=(0, 0.5))


def spread(places: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """`places` moved apart to at least `gap` by the least squares of moves, in the same order, inside [low, high]."""
    order = sorted(range(len(places)), key=lambda k: places[k])
    gap = min(gap, (high - low) / max(1, len(places) - 1))
    groups: list[
        tuple[float, int]
    ] = []  # (mean of place - rank * gap, how many): each group stands shoulder to shoulder
    for rank, k in enumerate(order):
        mean, count = places[k] - rank * gap, 1
        while groups and groups[-1][0] >= mean:
            before, more = groups.pop()
            mean, count = (mean * count + before * more) / (count + more), count + more
        groups.append((mean, count))
    starts = [mean for mean, count in groups for _ in range(count)]
    moved = [0.0] * len(places)
    for rank, k in enumerate(order):
        moved[k] = min(max(starts[rank], low), high - (len(order) - 1) * gap) + rank * gap
    return moved


def _thinned(across: Array, down: Array) -> list[tuple[float, float]]:
    """Points of a curve, without those on the same (fine) pixel as the one before."""
    keep = np.ones(len(across), dtype=bool)
    keep[1:] = (np.diff(np.floor(across)) != 0.0) | (np.diff(np.floor(down)) != 0.0)
    return list(zip(across[keep].tolist(), down[keep].tolist(), strict=True))
