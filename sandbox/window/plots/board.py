"""The plot board. It contains all visible plots, which follow the history, and shows the values under the pointer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.draw.supersampling import draw_marker
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.languages import scene_words
from softcradle.sandbox.motion import Array
from softcradle.sandbox.session.history_slices import HistorySlice, history_slices
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.story.numbers import ROUND_OFF, fixed, scientific
from softcradle.sandbox.window.page import Derived
from softcradle.sandbox.window.plots.curves import LATEST, SECONDS, Plot, TimeSpan
from softcradle.sandbox.window.plots.data_overlay import NumbersOverlay, PictureOverlay
from softcradle.sandbox.window.plots.kinds import PAIR, PLOT_KINDS, PlotSetting

MOST_CURVES = 10


def paint_readout(surface: pygame.Surface, plot: Plot, point: tuple[int, int], time: float, values: Array) -> None:
    """Draw a box next to `point` with the values of a plot at one time.

    The box contains `time` [s] and `values` (k,) in the unit of the axis.
    """
    unit, chosen = plot.unit, _chosen(plot, point, values)
    size, name = plot.span.unit()
    head = f"t = {fixed(time / size, 3)} {name}"
    shown = values / plot.axis.size
    # Show tiny values as 0. The velocity of a bead at rest is a sum of increments and can be 1e-16 m/s.
    if not plot.axis.logarithmic:
        shown = np.where(abs(values) > ROUND_OFF * max(abs(plot.axis.low), abs(plot.axis.high)), shown, 0.0)
    lines = [f"{plot.content.names[k]} = {scientific(float(shown[k]), 2)}" for k in chosen]
    wide = max(width(line, 13 * unit) for line in (head, *lines)) + 34 * unit
    box = pygame.Rect(0, 0, round(wide), round((len(lines) + 1) * 16 * unit + 10 * unit))
    box.topleft = (point[0] + 14, point[1] - box.height // 2)
    box.clamp_ip(surface.get_rect().inflate(-8, -8))
    if box.collidepoint(point):
        box.right = point[0] - 14
    pygame.draw.rect(surface, tones.background, box, border_radius=4)
    pygame.draw.rect(surface, tones.faint, box, 1, border_radius=4)
    write(surface, head, (box.left + 8 * unit, box.top + 4 * unit), 13 * unit, tones.foreground, bold=True)
    for row, (k, line) in enumerate(zip(chosen, lines, strict=True)):
        y = box.top + (20 + 16 * row) * unit
        draw_marker(surface, k, (box.left + 14 * unit, y + 8 * unit), 3.4 * unit, plot.content.colours[k])
        write(surface, line, (box.left + 24 * unit, y), 13 * unit, tones.foreground)


def _chosen(plot: Plot, point: tuple[int, int], values: Array) -> list[int]:
    """Return the indices of the curves whose values are shown. If there are many curves, choose those nearest to the
    pointer.
    """
    count = min(len(values), len(plot.content.names), len(plot.content.colours))
    if count <= MOST_CURVES:
        return list(range(count))
    heights = plot.area.top + plot.y(plot.axis.on(values[:count]))
    return sorted(np.argsort(abs(heights - point[1]))[:MOST_CURVES].tolist())


COLUMNS_AT_ONCE = 8  # Number of columns of each plot that are drawn before the clock is read again.
DRAWING_SECONDS = 0.003  # Time in seconds that each frame spends on drawing missing columns.
GHOST_POINTS = 600  # Number of points of the curves of a previous run.
LEAST_WIDTH = 190.0  # Smallest width of a plot in design pixels.


Key = tuple[str, int]  # Kind and lane of a plot.


def _balanced(names: list[Key], most: int) -> list[list[Key]]:
    """Distribute `names` over as few rows as possible. A row has at most `most` names, and all rows have similar
    lengths.
    """
    count = -(-len(names) // most)
    ends = [round(k * len(names) / count) for k in range(count + 1)]
    return [names[begin:end] for begin, end in pairwise(ends)]


def copied(part: HistorySlice) -> HistorySlice:
    """Return a copy of a slice with its own arrays. A copy is needed because the history reuses its memory."""
    values = {one.name: getattr(part, one.name) for one in fields(part)}
    copies: dict[str, Any] = {name: value.copy() for name, value in values.items() if isinstance(value, np.ndarray)}
    return replace(part, **copies)


class PlotBoard:
    """The plots of a session. In each frame, `clock` [s] limits the time for drawing missing columns.

    Attributes:
        chosen: names of the kinds of plots that the user wants, in the order of the table. Some of them may not
            fit the session.
        single: name of the only visible kind in Explore; empty in the Lab.
        hidden: True while all plots are hidden.
        logarithmic: True if overlaps have a logarithmic axis.
        whole: True if the time axis spans the complete history, if the history is longer than the usual span.
        pair: the two signals that the user chose for the x-y plot.
        plots: the plots on the page.
        keys: kind and lane of each plot.
        overlays: measured data drawn over the plots, by kind and lane.
        ghosts: motion of each lane in the previous run, in slices; empty before the second run.
        span: the time axis that the plots share.
    """

    def __init__(self, session: Session, clock: Callable[[], float], chosen: Sequence[str] | None = None) -> None:
        self.session, self.clock = session, clock
        self.chosen = [name for name, kind in PLOT_KINDS.items() if (kind.shown if chosen is None else name in chosen)]
        self.hidden, self.logarithmic, self.whole, self.single = False, True, False, ""
        self.pair = PAIR
        self.plots: list[Plot] = []
        self.keys: list[Key] = []
        self.overlays: dict[Key, list[NumbersOverlay | PictureOverlay]] = {}
        self.ghosts: list[list[HistorySlice]] = []
        self.span = TimeSpan(SECONDS / session.slow, 100)
        self._last = -1  # Newest frame that has been drawn.
        self._spanned = Derived(lambda: (session.slow, self.whole, self._width), self._set_span)
        self._branch = Derived(lambda: session.history.branch, self._invalidate_branch)

    def available(self) -> list[str]:
        """Return the names of the kinds of plots that this session can show."""
        counts = [lane.chain.contacts for lane in self.session.lanes]
        comparable = len(counts) == 2 and counts[0] == counts[1]
        return [name for name, kind in PLOT_KINDS.items() if comparable or not kind.two_lanes]

    @property
    def shown(self) -> list[str]:
        """Names of the kinds of plots that the user wants and that this session can show."""
        return [name for name in self.available() if name in self.chosen]

    @property
    def present(self) -> list[str]:
        """Names of the kinds of plots on screen."""
        return [] if self.hidden else [self.single] if self.single else self.shown

    def rows(self, width: float) -> list[list[Key]]:
        """Return the plots in each row. A plot needs at least LEAST_WIDTH of the `width` [design pixels].

        Two lanes have separate rows, and each row ends with the difference of the lanes. If each lane has a single
        plot, both plots are side by side.
        """
        most = max(1, int(width / LEAST_WIDTH))
        return [row for keys in self._wanted() for row in _balanced(keys, most)]

    def _wanted(self) -> list[list[Key]]:
        """Return the plots of each lane. If a single lane has many plots, they are divided into two halves."""
        lanes = range(len(self.session.lanes))
        if self.single and not self.hidden:
            return [[(self.single, lane) for lane in lanes]]
        shown = sorted(self.present, key=lambda name: PLOT_KINDS[name].two_lanes)
        wanted = [[(name, lane) for name in shown] for lane in lanes]
        if len(wanted) == 1 and len(shown) > 3:
            half = (len(shown) + 1) // 2
            wanted = [wanted[0][:half], wanted[0][half:]]
        return [row for row in wanted if row]

    def keep_ghost(self) -> None:
        """Store the present motion as the previous run, if a contact has carried a force in it."""
        history = self.session.history
        found = [
            [copied(part) for part in history_slices(history, lane, history.first, history.last, GHOST_POINTS)]
            for lane in range(len(self.session.lanes))
        ]
        if any(part.force.any() for parts in found for part in parts):
            self.ghosts = found

    def toggle(self, name: str) -> None:
        """Show or hide a kind of plot."""
        self.hidden = False
        if self.single:
            self.single = name
            return
        chosen = set(self.chosen) ^ {name}
        self.chosen = [other for other in PLOT_KINDS if other in chosen]

    def show(self, name: str) -> None:
        """Show a kind of plot."""
        self.hidden = False
        if name not in self.present:
            self.toggle(name)

    def build(
        self, rows: Sequence[Sequence[Key]], rects: Sequence[Sequence[pygame.Rect]], unit: float, scales: Scales
    ) -> None:
        """Create the plots again.

        Redrawing the curves takes some frames. Until then, the old curves are stretched to the new scales.
        """
        before, span = dict(zip(self.keys, self.plots, strict=True)), replace(self.span)
        self.plots = [
            self._plot(name, lane, rect, unit, scales)
            for keys, places in zip(rows, rects, strict=True)
            for (name, lane), rect in zip(keys, places, strict=True)
        ]
        self.keys = [key for row in rows for key in row]
        self._spanned.forget()  # The complete history may be longer now.
        self._spanned.follow()
        self._last = -1
        for key, plot in zip(self.keys, self.plots, strict=True):
            if type(before.get(key)) is type(plot):
                plot.take_over(before[key], span)

    def _plot(self, name: str, lane: int, rect: pygame.Rect, unit: float, scales: Scales) -> Plot:
        kind, live, session = PLOT_KINDS[name], self.session.lanes[lane], self.session
        label = scene_words(session.label(lane)) if len(session.lanes) > 1 and not kind.two_lanes else ""
        length = session.scene.view.length
        content = kind.content(PlotSetting(scales, lane, live.chain.contacts + 1, length, self.logarithmic, self.pair))
        return kind.plot(rect, unit, content.labelled(label), session.history, lane, self.span)

    @property
    def _width(self) -> int:
        """Width in pixels of the time axis that all plots share."""
        return min((plot.area.width for plot in self.plots), default=self.span.width)

    def _set_span(self) -> None:
        before, width = (self.span.seconds, self.span.width), self._width
        share = self.span.x(self.session.time) / self.span.width
        history, seconds = self.session.history, SECONDS / self.session.slow
        if self.whole:
            seconds = max(seconds, (history.last_time - history.first_time) / LATEST)
        old = replace(self.span)
        self.span.seconds, self.span.width = seconds, width
        if self.whole or before != (seconds, width):
            left = history.first_time if self.whole else self.session.time - share * seconds
            self.span.left = max(0, round(left / self.span.column))
            for plot in self.plots:
                plot.take_over(plot, old)

    @property
    def complete(self) -> bool:
        """True if every plot shows the complete history."""
        return all(plot.complete for plot in self.plots)

    def _invalidate(self) -> None:
        for plot in self.plots:
            plot.curves.invalidate()

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw titles and axes."""
        for plot in self.plots:
            plot.backdrop(surface)

    def update(self) -> None:
        """Draw the new part of the curves, then some of the missing columns."""
        last = self.session.history.last
        self._spanned.follow()
        self.span.follow(self.session.time)
        grown = self._branch.follow() or last != self._last
        self._last = last
        began = self.clock()
        for plot in self.plots:
            plot.update(grown, COLUMNS_AT_ONCE)
        while self.clock() - began < DRAWING_SECONDS and not all(plot.complete for plot in self.plots):
            for plot in self.plots:
                plot.update(False, COLUMNS_AT_ONCE)

    def _invalidate_branch(self) -> None:
        """Redraw the curves after the current frame, because the history was cut or replaced."""
        history = self.session.history
        if history.first == history.last:
            self._invalidate()
            return
        column = int(history.snapshot(max(self.session.frame - 1, history.first)).time / self.span.column)
        for plot in self.plots:
            plot.curves.invalidate_from(column)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw all plots with the cursor at the current frame."""
        for key, plot in zip(self.keys, self.plots, strict=True):
            plot.paint(surface, self.session.time, plot.values_at(self.session.frame))
            if key[1] < len(self.ghosts):
                plot.paint_ghost(surface, self.ghosts[key[1]])
            for laid in self.overlays.get(key, ()):
                laid.paint(surface, plot)

    def plot_at(self, point: tuple[int, int]) -> Plot | None:
        """Return the plot whose axes contain `point`, or None."""
        return next((plot for plot in self.plots if plot.area.collidepoint(point)), None)

    def paint_reading(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """Draw a line through all plots at the time under the pointer. Show the values of the plot under the pointer."""
        plot = self.plot_at(point)
        if plot is None or not plot.timed:
            return
        x = point[0] - plot.area.left
        for other in (other for other in self.plots if other.timed):
            place = (other.area.left + min(x, other.area.width), other.area.top, 1, other.area.height)
            surface.fill(tones.foreground, place)
        history = self.session.history
        frame = history.frame_at(self.span.time(x))
        paint_readout(surface, plot, point, float(history.snapshot(frame).time), plot.values_at(frame))
