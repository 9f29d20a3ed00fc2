"""Live plots: axes drawn once, curves on a surface that scrolls with time, a cursor that reads values."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pygame
from numpy.typing import NDArray
from softcradle.sandbox.draw.curve_panels import Axis, ticks_apart
from softcradle.sandbox.draw.palette import Colour, tones
from softcradle.sandbox.draw.supersampling import SUBPIXELS, draw_marker
from softcradle.sandbox.draw.surface_cache import cached_surfaces
from softcradle.sandbox.draw.text import shortened, width, write
from softcradle.sandbox.label_places import spread
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.session.frame_history import History
from softcradle.sandbox.session.history_slices import history_slices, slice_at
from softcradle.sandbox.window.plots.scrolling_surface import ScrollingSurface
from softcradle.sandbox.window.plots.time_axis import TimeSpan

LEFT, RIGHT, TOP, BOTTOM = 44.0, 38.0, 22.0, 20.0  # design pixels around the axes
THICKNESS = 2.0  # design pixels of a curve
POINTS_A_COLUMN = 3  # frames of the history that a column of pixels takes, where there are more
SMOOTH_TURN = 0.97  # cosine of the largest turn of a curve that is drawn without a round joint
LINE = 12.0  # design pixels between labels, and between names that are written
MOST_MARKED = 10  # curves that have a marker at the cursor
VEIL_OPACITY = 150  # of 255, over what is later than the cursor


@dataclass(frozen=True)
class PlotContent:
    """What a plot shows.

    Attributes:
        title: above the axes.
        axis: the vertical axis.
        names, colours: of the curves.
        values: (T, k) values of the curves, from a Motion.
        darkest: value of the darkest shade, in a plot that shades.
        band: height of the band around each curve, in a plot that has bands.
    """

    title: str
    axis: Axis
    names: Sequence[str]
    colours: Sequence[Colour]
    values: Callable[[Motion], Array]
    darkest: float = 1.0
    band: float = 0.0

    def labelled(self, label: str) -> PlotContent:
        """The same content with `label` after its title, if there is one."""
        return replace(self, title=f"{self.title} · {label}") if label else self


class Plot:
    """One plot of curves. What is drawn depends on the history alone; `paint` adds the cursor.

    Arguments:
        rect: of the whole plot; pixels.
        unit: pixels that a pixel of the design is.
        content: what it shows.
        history, lane: where the frames come from.
        span: the time axis, shared by all plots of a page.
    """

    marked = True  # whether curves have markers at the cursor
    timed = True  # whether its horizontal axis is the time that all plots share

    def __init__(
        self, rect: pygame.Rect, unit: float, content: PlotContent, history: History, lane: int, span: TimeSpan
    ) -> None:
        self.rect, self.unit, self.content = rect, unit, content
        self.history, self.lane, self.span = history, lane, span
        self.axis = content.axis
        self.area = area_of(rect, unit)
        self.curves = ScrollingSurface(self._background(), self.draw_columns)

    def _background(self) -> pygame.Surface:
        background = pygame.Surface(self.area.size, 0, 32)
        background.fill(tones.background)
        for value, _ in self.axis.ticks:
            tint = tones.faint if value == 0.0 and not self.axis.logarithmic else tones.grid
            background.fill(tint, (0, round(float(self.y(np.array(value)))), self.area.width, 1))
        return background

    def y(self, value: Array) -> Array:
        """Pixel of a value in units of the axis, from the top; those beyond it are just outside."""
        share = np.clip((value - self.axis.low) / (self.axis.high - self.axis.low), -0.1, 1.1)
        return (self.area.height - 1) * (1.0 - share)

    def frames(self, first: int, last: int) -> tuple[int, int, int]:
        """First and last frame of columns `first` to `last`, with a margin, and how many frames to take."""
        margin = THICKNESS * self.unit + 1
        low = self.history.frame_at((first - margin) * self.span.column) - 1
        high = self.history.frame_at((last + margin) * self.span.column) + 1
        return low, high, POINTS_A_COLUMN * (last - first + 8)

    def samples(self, first: int, last: int) -> list[tuple[Array, Array]]:
        """Times (T,) and values (T, k) of columns `first` to `last`; a pair for every slice of the history."""
        slices = history_slices(self.history, self.lane, *self.frames(first, last))
        return [(part.time, self.content.values(part)) for part in slices]

    def values_at(self, frame: int) -> Array:
        """(k,) values at `frame`."""
        values: Array = self.content.values(slice_at(self.history, self.lane, frame))[0]
        return values

    def enlarged_background(self, first: int, last: int) -> pygame.Surface:
        """The background of columns `first` to `last`, SUBPIXELS times as large, to be drawn on and averaged down."""
        size = (last - first) * SUBPIXELS, self.area.height * SUBPIXELS
        return pygame.transform.scale(self.curves.background.subsurface((0, 0, 1, self.area.height)), size)

    def draw_columns(self, first: int, last: int) -> pygame.Surface:
        """Columns `first` to `last` with antialiased curves."""
        fine = self.enlarged_background(first, last)
        thickness = THICKNESS * self.unit * SUBPIXELS
        for time, values in self.samples(first, last):
            across = (time / self.span.column - first + 0.5) * SUBPIXELS
            down = (self.y(self.axis.on(values)) + 0.5) * SUBPIXELS
            draw_curves(fine, self.content.colours, across, down, thickness)
        return pygame.transform.smoothscale(fine, (last - first, self.area.height))

    def update(self, grown: bool, budget: int) -> int:
        """Draw what the history has and the surface lacks; see `ScrollingSurface.update`."""
        column = self.span.column
        self.curves.scroll(self.span.left)
        return self.curves.update(self.history.first_time / column, self.history.last_time / column, grown, budget)

    @property
    def complete(self) -> bool:
        """Whether all of the visible history is drawn."""
        return self.curves.low <= max(self.curves.left, math.floor(self.history.first_time / self.span.column))

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the title and the labels of the vertical axis."""
        unit, area, title = self.unit, self.area, self.content.title
        for end in (" · ", ": "):  # the name of the lane, then what explains the title
            if width(title, 13 * unit) > area.width + 20 * unit:
                title = title.split(end)[0]
        title = shortened(title, 13 * unit, area.width + 20 * unit)
        write(surface, title, (area.left, area.top - 4 * unit), 13 * unit, tones.foreground, align=(0, 1))
        for value, text in ticks_apart(self.axis.ticks, area.height / (self.axis.high - self.axis.low), LINE * unit):
            y = area.top + float(self.y(np.array(value)))
            if area.top - 1 <= y <= area.bottom + 1:
                write(surface, text, (area.left - 6 * unit, y), 11.5 * unit, tones.muted, align=(1, 0.5))
        place = (area.right, area.bottom + 3 * unit)
        write(surface, f"t ({self.span.unit()[1]})", place, 11.5 * unit, tones.muted, align=(1, 0))

    def paint(self, surface: pygame.Surface, time: float, values: Array) -> None:
        """Draw the curves, the times below them, and the cursor at `time` with the curves' `values` (k,) there."""
        area = self.area
        surface.blit(self.curves.surface, area)
        place = area.left + self.span.x(time)
        self._times(surface)
        if not area.left <= place <= area.right:
            return
        self._paint_veil(surface, round(place))
        surface.fill(tones.muted, (round(place), area.top, max(1, round(self.unit)), area.height))
        if self.marked and len(self.content.names) <= MOST_MARKED:
            self._markers(surface, place, values)

    def _times(self, surface: pygame.Surface) -> None:
        area, unit = self.area, self.unit
        for time, text in self.span.ticks():
            x = area.left + self.span.x(time)
            if area.left - 1 <= x <= area.right - 46 * unit:
                surface.fill(tones.muted, (round(x), area.bottom, 1, round(3 * unit)))
                write(surface, text, (x, area.bottom + 3 * unit), 11.5 * unit, tones.muted, align=(0.5, 0))

    def _paint_veil(self, surface: pygame.Surface, x: int) -> None:
        """Make what is later than the cursor pale: a new branch will drop it."""
        if self.curves.left + x - self.area.left + 2 < self.curves.high:
            surface.blit(veil(self.area.size), (x, self.area.top), (0, 0, self.area.right - x, self.area.height))

    def _markers(self, surface: pygame.Surface, x: float, values: Array) -> None:
        """A marker on every curve at the cursor, and the same one with the curve's name beside the axes."""
        area, unit, colours = self.area, self.unit, self.content.colours
        count = min(len(values), len(colours))
        heights = np.nan_to_num(self.y(self.axis.on(values[:count]))).tolist()
        for k in range(count - 1, -1, -1):
            if 0.0 <= heights[k] <= area.height:
                draw_marker(surface, k, (x + 0.5, area.top + heights[k] + 0.5), 3.4 * unit, colours[k])
        places = spread(heights, 13.0 * unit, 2.0 * unit, area.height - 4.0 * unit)
        written = -math.inf  # where the last name is; where there is no room, markers stand alone
        for k, y in sorted(enumerate(places), key=lambda pair: pair[1]):
            draw_marker(surface, k, (area.right + 8 * unit, area.top + y), 3.4 * unit, colours[k])
            if y >= written + LINE * unit:
                written, place = y, (area.right + 14 * unit, area.top + y)
                write(surface, self.content.names[k], place, 12 * unit, tones.foreground, align=(0, 0.5))


def draw_curves(fine: pygame.Surface, colours: Sequence[Colour], across: Array, down: Array, thickness: float) -> None:
    """Draw curves through (T,) `across` and (T, k) `down`, the first on top, with round joints where they turn."""
    turns = _turns(across, down)
    xs, line_width = across.tolist(), max(1, round(thickness))
    for k in range(min(down.shape[1], len(colours)) - 1, -1, -1):
        points = list(zip(xs, down[:, k].tolist(), strict=True))
        if len(points) > 1:
            pygame.draw.lines(fine, colours[k], False, points, line_width)
        for joint in np.flatnonzero(turns[:, k]).tolist():
            pygame.draw.circle(fine, colours[k], points[joint], 0.5 * thickness)


def _turns(across: Array, down: Array) -> NDArray[np.bool_]:
    """(T, k) points at which a curve turns by more than SMOOTH_TURN, and its last one."""
    sharp = np.ones(down.shape, dtype=bool)
    if len(across) > 2:
        dx, dy = np.diff(across)[:, None], np.diff(down, axis=0)
        length = np.hypot(dx, dy) + 1e-9
        cosine = (dx[:-1] * dx[1:] + dy[:-1] * dy[1:]) / (length[:-1] * length[1:])
        sharp[1:-1] = cosine < SMOOTH_TURN
        sharp[0] = False
    return sharp


def area_of(rect: pygame.Rect, unit: float) -> pygame.Rect:
    """The axes inside a plot's rectangle."""
    left, top = rect.left + round(LEFT * unit), rect.top + round(TOP * unit)
    right, bottom = rect.right - round(RIGHT * unit), rect.bottom - round(BOTTOM * unit)
    return pygame.Rect(left, top, max(8, right - left), max(8, bottom - top))


@cached_surfaces(8)
def veil(size: tuple[int, int]) -> pygame.Surface:
    """A surface of the background colour that lets what is below shine through."""
    surface = pygame.Surface(size, 0, 32)
    surface.fill(tones.background)
    surface.set_alpha(VEIL_OPACITY)
    return surface
