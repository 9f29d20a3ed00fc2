"""Live plots: axes drawn once, curves on a sheet that scrolls with time, a cursor that reads values."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray
from softcradle.sandbox.draw.curve_panels import Axis, spread
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND, GRID, MUTED, Colour
from softcradle.sandbox.draw.supersampling import SUBPIXELS, draw_marker
from softcradle.sandbox.draw.text import shortened, width, write
from softcradle.sandbox.motion import Array
from softcradle.sandbox.session.history import History
from softcradle.sandbox.window.plots.history_curves import Rows, at_frame, stretches
from softcradle.sandbox.window.plots.scrolling_surface import Sheet
from softcradle.sandbox.window.plots.time_axis import TimeSpan

LEFT, RIGHT, TOP, BOTTOM = 44.0, 38.0, 22.0, 20.0  # design pixels around the axes
THICK = 2.0
POINTS_A_COLUMN = 3
JOINT = 0.97  # cosine of the angle from which a joint shows
MOST_MARKED = 10  # curves that carry a marker at the cursor


@dataclass(frozen=True)
class Source:
    """Where a plot's numbers come from: the history of lane `lane`, through `values(rows) -> (T, k)`.

    `most` is what the darkest shade stands for.
    """

    history: History
    lane: int
    values: Callable[[Rows], Array]
    most: float = 1.0


@dataclass(frozen=True)
class Content:
    """What a plot shows: a title, the vertical axis, names and colours of the curves, and where they come from."""

    title: str
    axis: Axis
    names: Sequence[str]
    colours: Sequence[Colour]
    source: Source


class Plot:
    """One plot. What is inked depends on the history alone; `paint` adds the cursor.

    Arguments:
        rect: of the whole plot; pixels.
        unit: pixels that a pixel of the design is.
        content: what it shows.
        span: the time axis, shared by all plots of a page.
    """

    marked = True  # whether curves carry markers at the cursor

    def __init__(self, rect: pygame.Rect, unit: float, content: Content, span: TimeSpan) -> None:
        self.rect, self.unit, self.span = rect, unit, span
        self.title, self.axis, self.source = content.title, content.axis, content.source
        self.names, self.colours = content.names, content.colours
        self.area = area_of(rect, unit)
        self.sheet = Sheet(self._ground(), self.ink)

    def _ground(self) -> pygame.Surface:
        ground = pygame.Surface(self.area.size, 0, 32)
        ground.fill(BACKGROUND)
        for value, _ in self.axis.ticks:
            tint = FAINT if value == 0.0 and not self.axis.logarithmic else GRID
            ground.fill(tint, (0, round(float(self.y(np.array(value)))), self.area.width, 1))
        return ground

    def y(self, value: Array) -> Array:
        """Pixel of a value in units of the axis, from the top; those beyond it stay just outside."""
        share = np.clip((value - self.axis.low) / (self.axis.high - self.axis.low), -0.1, 1.1)
        return (self.area.height - 1) * (1.0 - share)

    def frames(self, first: int, last: int) -> tuple[int, int, int]:
        """First and last frame that columns `first` to `last` show, with some on either side, and how many to take."""
        history, margin = self.source.history, THICK * self.unit + 1
        low = history.frame_at((first - margin) * self.span.column) - 1
        high = history.frame_at((last + margin) * self.span.column) + 1
        return low, high, POINTS_A_COLUMN * (last - first + 8)

    def curves(self, first: int, last: int) -> list[tuple[Array, Array]]:
        """Times (T,) and values (T, k) that columns `first` to `last` show; a pair for every stretch."""
        found = stretches(self.source.history, self.source.lane, *self.frames(first, last))
        return [(rows.time, self.source.values(rows)) for rows in found]

    def now(self, frame: int) -> Array:
        """(k,) values at `frame`."""
        values: Array = self.source.values(at_frame(self.source.history, self.source.lane, frame))[0]
        return values

    def ink(self, first: int, last: int) -> pygame.Surface:
        """Curves in columns `first` to `last`, smooth."""
        size = (last - first) * SUBPIXELS, self.area.height * SUBPIXELS
        fine = pygame.transform.scale(self.sheet.ground.subsurface((0, 0, 1, self.area.height)), size)
        thick = THICK * self.unit * SUBPIXELS
        for time, values in self.curves(first, last):
            across = (time / self.span.column - first + 0.5) * SUBPIXELS
            down = (self.y(self.axis.on(values)) + 0.5) * SUBPIXELS
            strokes(fine, self.colours, across, down, thick)
        return pygame.transform.smoothscale(fine, (last - first, self.area.height))

    def update(self, grown: bool, budget: int) -> int:
        """Bring the sheet up to the history; see `Sheet.update`."""
        history, column = self.source.history, self.span.column
        self.sheet.scroll(self.span.left)
        return self.sheet.update(history.first_time / column, history.last_time / column, grown, budget)

    @property
    def complete(self) -> bool:
        """Whether all the history in sight is inked."""
        history = self.source.history
        return self.sheet.low <= max(self.sheet.left, math.floor(history.first_time / self.span.column))

    def backdrop(self, surface: pygame.Surface) -> None:
        """Title and labels of the vertical axis: what stands still."""
        unit, area = self.unit, self.area
        whole = width(self.title, 13 * unit) <= area.width + 20 * unit
        title = self.title if whole else shortened(self.title.split(" · ")[0], 13 * unit, area.width)
        write(surface, title, (area.left, area.top - 4 * unit), 13 * unit, FOREGROUND, align=(0, 1))
        for value, text in self.axis.ticks:
            y = area.top + float(self.y(np.array(value)))
            if area.top - 1 <= y <= area.bottom + 1:
                write(surface, text, (area.left - 6 * unit, y), 11.5 * unit, MUTED, align=(1, 0.5))
        write(
            surface,
            f"t ({self.span.unit()[1]})",
            (area.right, area.bottom + 3 * unit),
            11.5 * unit,
            MUTED,
            align=(1, 0),
        )

    def paint(self, surface: pygame.Surface, time: float, values: Array) -> None:
        """Draw the sheet, the times below it, and the cursor at `time` with the curves' `values` (k,) there."""
        area, unit = self.area, self.unit
        surface.blit(self.sheet.surface, area)
        place = area.left + self.span.x(time)
        self._times(surface)
        if not area.left <= place <= area.right:
            return
        self._veil(surface, round(place))
        surface.fill(MUTED, (round(place), area.top, max(1, round(unit)), area.height))
        if self.marked and len(self.names) <= MOST_MARKED:
            self._markers(surface, place, values)

    def _times(self, surface: pygame.Surface) -> None:
        area, unit = self.area, self.unit
        for time, text in self.span.ticks():
            x = area.left + self.span.x(time)
            if area.left - 1 <= x <= area.right - 46 * unit:
                surface.fill(MUTED, (round(x), area.bottom, 1, round(3 * unit)))
                write(surface, text, (x, area.bottom + 3 * unit), 11.5 * unit, MUTED, align=(0.5, 0))

    def _veil(self, surface: pygame.Surface, x: int) -> None:
        """Pale over what comes after the cursor: it will be dropped when a new branch begins."""
        if self.sheet.left + x - self.area.left + 2 < self.sheet.high:
            surface.blit(veil(self.area.size), (x, self.area.top), (0, 0, self.area.right - x, self.area.height))

    def _markers(self, surface: pygame.Surface, x: float, values: Array) -> None:
        """A marker on every curve at the cursor, and beside the axes the same with the curve's name."""
        area, unit = self.area, self.unit
        count = min(len(values), len(self.colours))
        heights = np.nan_to_num(self.y(self.axis.on(values[:count]))).tolist()
        for k in range(count - 1, -1, -1):
            if 0.0 <= heights[k] <= area.height:
                draw_marker(surface, k, (x + 0.5, area.top + heights[k] + 0.5), 3.4 * unit, self.colours[k])
        for k, y in enumerate(spread(heights, 13.0 * unit, 2.0 * unit, area.height - 4.0 * unit)):
            draw_marker(surface, k, (area.right + 8 * unit, area.top + y), 3.4 * unit, self.colours[k])
            place = (area.right + 14 * unit, area.top + y)
            write(surface, self.names[k], place, 12 * unit, FOREGROUND, align=(0, 0.5))


def strokes(fine: pygame.Surface, colours: Sequence[Colour], across: Array, down: Array, thickness: float) -> None:
    """Lines through (T,) `across` and (T, k) `down`, the first on top, with round joints where they turn."""
    turns = _turns(across, down)
    xs, width = across.tolist(), max(1, round(thickness))
    for k in range(min(down.shape[1], len(colours)) - 1, -1, -1):
        points = list(zip(xs, down[:, k].tolist(), strict=True))
        if len(points) > 1:
            pygame.draw.lines(fine, colours[k], False, points, width)
        for joint in np.flatnonzero(turns[:, k]).tolist():
            pygame.draw.circle(fine, colours[k], points[joint], 0.5 * thickness)


def _turns(across: Array, down: Array) -> NDArray[np.bool_]:
    """(T, k) where a line turns by more than JOINT, and at its ends."""
    sharp = np.ones(down.shape, dtype=bool)
    if len(across) > 2:
        dx, dy = np.diff(across)[:, None], np.diff(down, axis=0)
        length = np.hypot(dx, dy) + 1e-9
        cosine = (dx[:-1] * dx[1:] + dy[:-1] * dy[1:]) / (length[:-1] * length[1:])
        sharp[1:-1] = cosine < JOINT
        sharp[0] = False
    return sharp


def area_of(rect: pygame.Rect, unit: float) -> pygame.Rect:
    """The axes inside a plot's rectangle."""
    left, top = rect.left + round(LEFT * unit), rect.top + round(TOP * unit)
    right, bottom = rect.right - round(RIGHT * unit), rect.bottom - round(BOTTOM * unit)
    return pygame.Rect(left, top, max(8, right - left), max(8, bottom - top))


_veils: dict[tuple[int, int], pygame.Surface] = {}


def veil(size: tuple[int, int]) -> pygame.Surface:
    """A sheet of thin paper."""
    if size not in _veils:
        if len(_veils) > 8:
            _veils.clear()
        made = pygame.Surface(size, 0, 32)
        made.fill(BACKGROUND)
        made.set_alpha(150)
        _veils[size] = made
    return _veils[size]
