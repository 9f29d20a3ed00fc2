"""Live plots: axes drawn once, curves on a surface that scrolls with time, a cursor that reads values."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pygame
from numpy.typing import NDArray
from softcradle.sandbox.draw.axes import TEXT, Axes, VerticalAxis
from softcradle.sandbox.draw.palette import Colour, tones
from softcradle.sandbox.draw.supersampling import SUBPIXELS
from softcradle.sandbox.draw.surfaces import cached_surfaces
from softcradle.sandbox.draw.text import shortened, width
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.session.frame_history import History
from softcradle.sandbox.session.history_slices import history_slices, slice_at
from softcradle.sandbox.story.numbers import fixed, ticks, time_unit, with_prefix

REDRAWN = 4  # columns drawn again at the newest end, where the curve goes on


class ScrollingSurface:
    """The curves of one plot.

    Arguments:
        background: what it looks like without curves; the same in every column.
        draw: gives columns `first` to `last` (not included): `draw(first, last) -> surface` that wide.

    Attributes:
        surface: what is drawn.
        left: the column at its left edge.
        low, high: the columns that are drawn: low to high, not included.
        stale: whether the other columns show the curves at the scales before, until they are drawn.
    """

    def __init__(self, background: pygame.Surface, draw: Callable[[int, int], pygame.Surface]) -> None:
        self.background, self.surface, self.draw = background, background.copy(), draw
        self.left = 0
        self.low = self.high = 0
        self.stale = False

    @property
    def width(self) -> int:
        """Pixels."""
        return self.surface.get_width()

    def invalidate(self) -> None:
        """Draw all columns again, on an empty surface."""
        self.low = self.high = 0
        self.stale = False

    def replace(self, picture: pygame.Surface, left: int) -> None:
        """Show `picture`, whose left edge is column `left`, until the columns are drawn again: curves do not vanish meanwhile."""
        self.surface.blit(picture, (0, 0))
        self.left, self.low, self.high, self.stale = left, 0, 0, True

    def invalidate_from(self, column: int) -> None:
        """Columns from `column` on are stale."""
        self.high = max(self.low, min(self.high, column))

    def scroll(self, left: int) -> None:
        """Put column `left` at the left edge."""
        by, self.left = left - self.left, left
        if abs(by) >= self.width:
            self.invalidate()
        elif by:
            self.surface.scroll(-by, 0)
            self._clear(0 if by < 0 else self.width - by, abs(by))
            self.low, self.high = max(self.low, left), min(self.high, left + self.width)

    def update(self, first: float, last: float, grown: bool, budget: int) -> int:
        """Draw about `budget` missing columns of `first` to `last`, those of the history; returns how many it drew.

        `grown` says whether the newest column has changed since the last call.
        """
        oldest, newest = max(self.left, math.floor(first)), min(self.left + self.width, math.floor(last) + 1)
        if newest <= oldest:
            self._clear(0, self.width)
            self.invalidate()
            return 0
        if self.high <= self.low or self.low >= newest or self.high <= oldest:
            self.low = self.high = newest
            self._clear(newest - self.left if self.stale else 0, self.width)
        done = self._draw_newer(newest, oldest, budget) if grown or newest != self.high else 0
        if done < budget and self.low > oldest:
            done += self._draw_older(oldest, budget - done)
        if self.stale and self.low <= oldest:
            self.stale = False
            self._clear(0, oldest - self.left)
        return done

    def _draw_newer(self, newest: int, oldest: int, budget: int) -> int:
        start = max(self.low, oldest, min(self.high, newest) - REDRAWN)
        if newest - start > max(budget, 3 * REDRAWN):
            self.low = start = newest - budget
        self._draw(start, newest)
        self.low, self.high = min(self.low, start), newest
        self._clear(newest - self.left, self.width)
        return newest - start

    def _draw_older(self, oldest: int, budget: int) -> int:
        start = max(oldest, self.low - budget)
        self._draw(start, self.low)
        done, self.low = self.low - start, start
        return done

    def _draw(self, first: int, last: int) -> None:
        if last > first:
            self.surface.blit(self.draw(first, last), (first - self.left, 0))

    def _clear(self, x: int, width: int) -> None:
        place = pygame.Rect(x, 0, width, self.surface.get_height())
        self.surface.blit(self.background, place, place)


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

    def clock(self, time: float) -> str:
        """`time` [s] as a clock shows it: in that unit, whatever the time, with digits for a thousandth of the axis."""
        size, name = self.unit()
        return f"{fixed(time / size, max(0, 3 - math.floor(math.log10(self.seconds / size))))} {name}"

    def ticks(self) -> list[tuple[float, str]]:
        """(time [s], label) of the round times that are visible."""
        size, _ = self.unit()
        low, high = self.left * self.column / size, (self.left + self.width) * self.column / size
        return [(value * size, text) for value, text in ticks(low, high, 5)]


RIGHT = 30.0  # design pixels right of the axes
MARGINS = 44.0, RIGHT, 22.0, 22.0  # design pixels around the axes
THICKNESS = 2.0  # design pixels of a curve
POINTS_A_COLUMN = 3  # frames of the history that a column of pixels takes, where there are more
SMOOTH_TURN = 0.97  # cosine of the largest turn of a curve that is drawn without a round joint
MOST_MARKED = 10  # curves that have a marker at the cursor
MOST_STRETCHED = 6  # times the size of a plot: curves that would be stretched beyond it are drawn again at once instead
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
    axis: VerticalAxis
    names: Sequence[str]
    colours: Sequence[Colour]
    values: Callable[[Motion], Array]
    darkest: float = 1.0
    band: float = 0.0

    def labelled(self, label: str) -> PlotContent:
        """The same content with `label` after its title, if there is one."""
        return replace(self, title=f"{self.title} · {label}") if label else self


class Plot(Axes):
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
    at_values = True  # whether each curve stands at its own values, so that measured ones can be laid beside it

    def __init__(
        self, rect: pygame.Rect, unit: float, content: PlotContent, history: History, lane: int, span: TimeSpan
    ) -> None:
        super().__init__(rect, unit, content.axis, MARGINS)
        self.content, self.history, self.lane, self.span = content, history, lane, span
        self.curves = ScrollingSurface(self._background(), self.draw_columns)

    def _background(self) -> pygame.Surface:
        background = pygame.Surface(self.area.size, 0, 32)
        background.fill(tones.background)
        for y, tint in self.levels():
            background.fill(tint, (0, y, self.area.width, 1))
        return background

    def frames(self, first: int, last: int) -> tuple[int, int, int]:
        """First and last frame of columns `first` to `last`, with a margin, and how many frames to take."""
        margin = THICKNESS * self.unit + 1
        low = self.history.frame_at((first - margin) * self.span.column) - 1
        high = self.history.frame_at((last + margin) * self.span.column) + 1
        return low, high, POINTS_A_COLUMN * (last - first + 8)

    def samples(self, first: int, last: int) -> list[tuple[Array, Array]]:
        """Times (T,) and values (T, k) of columns `first` to `last`; a pair for every slice of the history."""
        return self.samples_of_frames(*self.frames(first, last))

    def samples_of_frames(self, first: int, last: int, most: int = 0) -> list[tuple[Array, Array]]:
        """Times (T,) and values (T, k) of frames `first` to `last`, thinned with `most` > 0; see `history_slices`."""
        slices = history_slices(self.history, self.lane, first, last, most)
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

    def take_over(self, before: Plot, span: TimeSpan) -> None:
        """Show the curves of the plot `before`, whose time axis was `span`, at the scales of this one until it is drawn.

        They are stretched to the new axes. Axes that differ in kind, or by too much, leave the plot empty until then.
        """
        old, new = before.axis, self.axis
        known = before.curves.stale or before.curves.high > before.curves.low
        self.curves.invalidate()
        if old.logarithmic != new.logarithmic or not self.timed or not known:
            return
        area, drawn = self.area, before.curves.surface
        across = span.column / self.span.column
        down = (old.high - old.low) / (new.high - new.low) * (area.height - 1) / max(1, before.area.height - 1)
        size = round(drawn.get_width() * across), round(drawn.get_height() * down)
        if min(size) < 1 or max(size) > MOST_STRETCHED * max(area.size):
            return
        picture = self.curves.background.copy()
        top = (area.height - 1) * (new.high - old.high) / (new.high - new.low)
        left = before.curves.left * across - self.span.left
        picture.blit(pygame.transform.scale(drawn, size), (round(left), round(top)))
        self.curves.replace(picture, self.span.left)

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
        title, mark, lane = self.content.title.partition(" · ")
        title = with_prefix(title, self.axis.prefix)
        size, room = TEXT * self.unit, self.title_room()
        if width(title + mark + lane, size) > room:
            title = title.split(": ")[0]  # what explains it goes, the name of the lane stays, a third at the least
            title = shortened(title, size, room - min(width(mark + lane, size), room / 3))
        self.write_title(surface, title + mark + lane)
        self.write_down(surface)

    def paint(self, surface: pygame.Surface, time: float, values: Array) -> None:
        """Draw the curves, the times below them, and the cursor at `time` with the curves' `values` (k,) there."""
        area = self.area
        surface.blit(self.curves.surface, area)
        place = area.left + self.span.x(time)
        labels = [(area.left + self.span.x(at), text) for at, text in self.span.ticks()]
        self.write_across(surface, labels, f"t ({self.span.unit()[1]})", area.right)
        if not area.left <= place <= area.right:
            return
        self._paint_veil(surface, round(place))
        surface.fill(tones.muted, (round(place), area.top, max(1, round(self.unit)), area.height))
        if self.marked and len(self.content.names) <= MOST_MARKED:
            self._markers(surface, place, values)

    def _paint_veil(self, surface: pygame.Surface, x: int) -> None:
        """Make what is later than the cursor pale: a new branch will drop it."""
        if self.curves.left + x - self.area.left + 2 < self.curves.high:
            surface.blit(veil(self.area.size), (x, self.area.top), (0, 0, self.area.right - x, self.area.height))

    def _markers(self, surface: pygame.Surface, x: float, values: Array) -> None:
        """A marker on every curve at the cursor, and its name beside it, moved apart where curves are close."""
        colours = self.content.colours
        heights = np.nan_to_num(self.y(self.axis.on(values[: len(colours)]))).tolist()
        self.mark(surface, x, heights, colours)
        self.write_names(surface, x + 10 * self.unit, heights, self.content.names, colours)


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


@cached_surfaces(8)
def veil(size: tuple[int, int]) -> pygame.Surface:
    """A surface of the background colour that lets what is below shine through."""
    surface = pygame.Surface(size, 0, 32)
    surface.fill(tones.background)
    surface.set_alpha(VEIL_OPACITY)
    return surface
