"""Live plots with fixed axes, curves on a surface that scrolls with time, and a cursor with the current values."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pygame
from numpy.typing import NDArray
from softcradle.sandbox.draw.axes import TEXT, Axes, VerticalAxis
from softcradle.sandbox.draw.palette import Colour, mix, tones
from softcradle.sandbox.draw.supersampling import SUBPIXELS, Point
from softcradle.sandbox.draw.surfaces import cached_surfaces
from softcradle.sandbox.draw.text import shortened, width, write
from softcradle.sandbox.languages import _
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.session.frame_history import History
from softcradle.sandbox.session.history_slices import history_slices, slice_at
from softcradle.sandbox.story.numbers import fixed, ticks, time_unit, with_prefix
from softcradle.sandbox.window.page import Derived

# Number of columns at the right end of the curves that are drawn again in every update. The curves continue there.
REDRAWN = 4


class ScrollingSurface:
    """The surface with the curves of one plot. Each pixel column is one interval of time.

    Arguments:
        background: picture without curves; all its columns are equal.
        draw: function; `draw(first, last)` returns a surface with the columns from `first` up to but not including
            `last`.

    Attributes:
        surface: the drawn surface.
        left: column at the left edge.
        low, high: range of drawn columns, without `high`.
        stale: True while the other columns still show the curves at the previous scales.
    """

    def __init__(self, background: pygame.Surface, draw: Callable[[int, int], pygame.Surface]) -> None:
        self.background, self.surface, self.draw = background, background.copy(), draw
        self.left = 0
        self.low = self.high = 0
        self.stale = False

    @property
    def width(self) -> int:
        """Width in pixels."""
        return self.surface.get_width()

    def invalidate(self) -> None:
        """Clear the surface, so that all columns are drawn again."""
        self.low = self.high = 0
        self.stale = False

    def replace(self, picture: pygame.Surface, left: int) -> None:
        """Show `picture` until the columns are redrawn, so that the curves do not vanish. Its left edge is column
        `left`.
        """
        self.surface.blit(picture, (0, 0))
        self.left, self.low, self.high, self.stale = left, 0, 0, True

    def invalidate_from(self, column: int) -> None:
        """Mark the columns from `column` on as not drawn."""
        self.high = max(self.low, min(self.high, column))

    def scroll(self, left: int) -> None:
        """Scroll so that column `left` is at the left edge."""
        by, self.left = left - self.left, left
        if abs(by) >= self.width:
            self.invalidate()
        elif by:
            self.surface.scroll(-by, 0)
            self._clear(0 if by < 0 else self.width - by, abs(by))
            self.low, self.high = max(self.low, left), min(self.high, left + self.width)

    def update(self, first: float, last: float, grown: bool, budget: int) -> int:
        """Draw up to about `budget` missing columns, and return their number. The history covers columns `first` to
        `last`.

        `grown` is True if the newest column has changed since the last call.
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


SECONDS = 8.0  # Wall time in seconds that a plot spans.
LATEST = 0.92  # Rightmost position of the cursor as a fraction of the width.
EARLIEST = 0.08  # Leftmost position of the cursor as a fraction of the width, except at the start of the scene.


@dataclass
class TimeSpan:
    """The time axis.

    Attributes:
        seconds: model time that the axis spans [s].
        width: width in pixels; each column is one pixel wide.
        left: column at the left edge; column 0 is t = 0.
    """

    seconds: float
    width: int
    left: int = 0

    @property
    def column(self) -> float:
        """Model time of one column [s]."""
        return self.seconds / self.width

    def follow(self, time: float) -> None:
        """Scroll by whole columns until `time` is visible. The start of the scene remains visible as long as possible."""
        place = time / self.column - self.left
        if place > LATEST * self.width:
            self.left += round(place - LATEST * self.width)
        elif place < EARLIEST * self.width:
            self.left = max(round(time / self.column - EARLIEST * self.width), min(0, round(time / self.column)))

    def x(self, time: float) -> float:
        """Return the distance in pixels of `time` from the left edge."""
        return time / self.column - self.left

    def time(self, x: float) -> float:
        """Return the time [s] at `x` pixels from the left edge."""
        return (x + self.left) * self.column

    def unit(self) -> tuple[float, str]:
        """Return the size of the unit of the labels in seconds, and its name."""
        return time_unit(self.seconds)

    def clock(self, time: float) -> str:
        """Return `time` [s] as the text of the clock. It has the unit of the axis and resolves a thousandth of the
        axis.
        """
        size, name = self.unit()
        return f"{fixed(time / size, max(0, 3 - math.floor(math.log10(self.seconds / size))))} {name}"

    def ticks(self) -> list[tuple[float, str]]:
        """Return (time [s], label) of each labelled time on the visible axis. The times are round numbers."""
        size = self.unit()[0]
        low, high = self.left * self.column / size, (self.left + self.width) * self.column / size
        return [(value * size, text) for value, text in ticks(low, high, 5)]


RIGHT = 30.0  # Width in design pixels to the right of the axes.
MARGINS = 44.0, RIGHT, 22.0, 22.0  # Margins around the axes in design pixels.
THICKNESS = 2.0  # Thickness of a curve in design pixels.
POINTS_A_COLUMN = 3  # Largest number of history frames per pixel column; more frames are thinned out.
SMOOTH_TURN = 0.97  # Cosine of the largest turn of a curve that is drawn without a round joint.
MOST_MARKED = 10  # Largest number of curves that get a marker at the cursor.
# Largest stretched size of old curves relative to the plot. Beyond it the curves are redrawn at once.
MOST_STRETCHED = 6
# A curve of the previous run is drawn with this fraction of its colour. The rest is the colour of the background.
GHOST = 0.5
# Points of a previous run are left out if their distance from the plot is larger than this number of pixels.
MOST_BEYOND = 2000
VEIL_OPACITY = 150  # Opacity of the veil over the part of a plot to the right of the cursor, from 0 to 255.


@dataclass(frozen=True)
class PlotContent:
    """The content of a plot.

    Attributes:
        title: title above the axes.
        axis: the vertical axis.
        names, colours: names and colours of the curves.
        values: returns the (T, k) values of the curves from a Motion.
        darkest: value of the darkest shade, for plots with shades.
        band: height of the band around each curve, for plots with bands.
    """

    title: str
    axis: VerticalAxis
    names: Sequence[str]
    colours: Sequence[Colour]
    values: Callable[[Motion], Array]
    darkest: float = 1.0
    band: float = 0.0

    def labelled(self, label: str) -> PlotContent:
        """Return the same content with `label` after the title, if `label` is not empty."""
        return replace(self, title=f"{self.title} · {label}") if label else self


class Plot(Axes):
    """A plot of curves. The drawn curves depend only on the history. The method `paint` adds the cursor.

    Arguments:
        rect: rectangle of the whole plot [pixels].
        unit: number of pixels per design pixel.
        content: content of the plot.
        history, lane: source of the frames.
        span: time axis shared by all plots of a page.
    """

    marked = True  # True if curves have markers at the cursor.
    timed = True  # True if the horizontal axis is the common time axis.
    at_values = True  # True if each curve is drawn at its own values, so that measured values can be drawn over it.

    def __init__(
        self, rect: pygame.Rect, unit: float, content: PlotContent, history: History, lane: int, span: TimeSpan
    ) -> None:
        super().__init__(rect, unit, content.axis, MARGINS)
        self.content, self.history, self.lane, self.span = content, history, lane, span
        self.curves = ScrollingSurface(self._background(), self.draw_columns)
        self._ghost_of: Sequence[Motion] = ()
        self._ghost = pygame.Surface((1, 1))
        self._ghost_drawn = Derived(lambda: (id(self._ghost_of), span.left, span.column), self._draw_ghost)

    def _background(self) -> pygame.Surface:
        background = pygame.Surface(self.area.size, 0, 32)
        background.fill(tones.background)
        for y, tint in self.levels():
            background.fill(tint, (0, y, self.area.width, 1))
        return background

    def frames(self, first: int, last: int) -> tuple[int, int, int]:
        """Return the first and the last frame for drawing columns `first` to `last`, and the number of frames to use.

        The range includes a margin on both sides.
        """
        margin = THICKNESS * self.unit + 1
        low = self.history.frame_at((first - margin) * self.span.column) - 1
        high = self.history.frame_at((last + margin) * self.span.column) + 1
        return low, high, POINTS_A_COLUMN * (last - first + 8)

    def samples(self, first: int, last: int) -> list[tuple[Array, Array]]:
        """Return times (T,) and values (T, k) of columns `first` to `last`, as one pair for every slice of the history."""
        return self.samples_of_frames(*self.frames(first, last))

    def samples_of_frames(self, first: int, last: int, most: int = 0) -> list[tuple[Array, Array]]:
        """Return times (T,) and values (T, k) of frames `first` to `last`, as one pair for every slice of the history.

        If `most` > 0, use fewer frames; see `history_slices`.
        """
        slices = history_slices(self.history, self.lane, first, last, most)
        return [(part.time, self.content.values(part)) for part in slices]

    def values_at(self, frame: int) -> Array:
        """Return the (k,) values at `frame`."""
        values: Array = self.content.values(slice_at(self.history, self.lane, frame))[0]
        return values

    def enlarged_background(self, first: int, last: int) -> pygame.Surface:
        """Return the background of columns `first` to `last`, enlarged by the factor SUBPIXELS.

        Curves are drawn on the enlarged background, which is then scaled down to smooth them.
        """
        size = (last - first) * SUBPIXELS, self.area.height * SUBPIXELS
        return pygame.transform.scale(self.curves.background.subsurface((0, 0, 1, self.area.height)), size)

    def draw_columns(self, first: int, last: int) -> pygame.Surface:
        """Return a surface with columns `first` to `last` and antialiased curves."""
        fine = self.enlarged_background(first, last)
        thickness = THICKNESS * self.unit * SUBPIXELS
        for time, values in self.samples(first, last):
            across = (time / self.span.column - first + 0.5) * SUBPIXELS
            down = (self.y(self.axis.on(values)) + 0.5) * SUBPIXELS
            draw_curves(fine, self.content.colours, across, down, thickness)
        return pygame.transform.smoothscale(fine, (last - first, self.area.height))

    def take_over(self, before: Plot, span: TimeSpan) -> None:
        """Show the curves of the previous plot `before` until this plot is drawn. Its time axis was `span`.

        The old curves are stretched to the new axes. The plot stays empty if the axes are of another kind or differ too
        much.
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
        """Draw parts of the history that are still missing; see `ScrollingSurface.update`."""
        column = self.span.column
        self.curves.scroll(self.span.left)
        return self.curves.update(self.history.first_time / column, self.history.last_time / column, grown, budget)

    @property
    def complete(self) -> bool:
        """True if the visible part of the history is completely drawn."""
        return self.curves.low <= max(self.curves.left, math.floor(self.history.first_time / self.span.column))

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the title and the labels of the vertical axis."""
        title, mark, lane = self.content.title.partition(" · ")
        title = with_prefix(title, self.axis.prefix)
        size, room = TEXT * self.unit, self.title_room()
        if width(title + mark + lane, size) > room:
            # Drop the explanation after the colon, but keep the name of the lane. The title gets at least a third of
            # the width.
            title = title.split(": ")[0]
            title = shortened(title, size, room - min(width(mark + lane, size), room / 3))
        self.write_title(surface, title + mark + lane)
        self.write_down(surface)

    def paint(self, surface: pygame.Surface, time: float, values: Array) -> None:
        """Draw the curves, the labels of the time axis, and the cursor at `time`. Markers show the `values` (k,) at the
        cursor.
        """
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

    def paint_ghost(self, surface: pygame.Surface, parts: Sequence[Motion]) -> None:
        """Draw the curves of a previous run faintly over this plot, if the axes of both agree."""
        if not (self.timed and self.at_values):
            return
        self._ghost_of = parts
        self._ghost_drawn.follow()
        surface.blit(self._ghost, self.area)
        place = self.area.right, self.area.top - 5 * self.unit
        write(surface, _("faint: previous run"), place, TEXT * self.unit, tones.muted, align=(1, 1))

    def _draw_ghost(self) -> None:
        """Draw the curves of the previous run on a transparent surface."""
        self._ghost = pygame.Surface(self.area.size, pygame.SRCALPHA, 32)
        self._ghost.fill((*tones.background, 0))
        points: list[list[Point]] = [[] for _colour in self.content.colours]
        for part in self._ghost_of:
            across = (part.time / self.span.column - self.span.left).tolist()
            down = self.y(self.axis.on(self.content.values(part)))
            for k in range(min(down.shape[1], len(points))):
                points[k] += zip(across, down[:, k].tolist(), strict=True)
        for colour, line in zip(self.content.colours, points, strict=True):
            seen = [point for point in line if -MOST_BEYOND < point[0] < self.area.width + MOST_BEYOND]
            if len(seen) > 1:
                pygame.draw.aalines(self._ghost, mix(tones.background, colour, GHOST), False, seen)

    def _paint_veil(self, surface: pygame.Surface, x: int) -> None:
        """Fade the curves to the right of the cursor. A new branch of the history will replace them."""
        if self.curves.left + x - self.area.left + 2 < self.curves.high:
            surface.blit(veil(self.area.size), (x, self.area.top), (0, 0, self.area.right - x, self.area.height))

    def _markers(self, surface: pygame.Surface, x: float, values: Array) -> None:
        """Draw a marker with the name of the curve where each curve meets the cursor. Names of close curves are moved
        apart.
        """
        colours = self.content.colours
        heights = np.nan_to_num(self.y(self.axis.on(values[: len(colours)]))).tolist()
        self.mark(surface, x, heights, colours)
        self.write_names(surface, x + 10 * self.unit, heights, self.content.names, colours)


def draw_curves(fine: pygame.Surface, colours: Sequence[Colour], across: Array, down: Array, thickness: float) -> None:
    """Draw curves through the points `across` (T,), `down` (T, k). The first curve is on top. Sharp turns get round
    joints.
    """
    turns = _turns(across, down)
    xs, line_width = across.tolist(), max(1, round(thickness))
    for k in range(min(down.shape[1], len(colours)) - 1, -1, -1):
        points = list(zip(xs, down[:, k].tolist(), strict=True))
        if len(points) > 1:
            pygame.draw.lines(fine, colours[k], False, points, line_width)
        for joint in np.flatnonzero(turns[:, k]).tolist():
            pygame.draw.circle(fine, colours[k], points[joint], 0.5 * thickness)


def _turns(across: Array, down: Array) -> NDArray[np.bool_]:
    """Return (T, k) flags of the points at which a curve needs a round joint.

    These are the points at which the curve turns by more than SMOOTH_TURN, and its last point.
    """
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
    """Return a translucent surface in the background colour."""
    surface = pygame.Surface(size, 0, 32)
    surface.fill(tones.background)
    surface.set_alpha(VEIL_OPACITY)
    return surface
