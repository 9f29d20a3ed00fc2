"""The plot board: all plots that are shown, in step with the history, and the cursor that reads values from them."""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter

import pygame
from softcradle.sandbox.draw.palette import FOREGROUND
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.plots.cursor_readout import paint_readout
from softcradle.sandbox.window.plots.live_plots import Plot
from softcradle.sandbox.window.plots.plot_kinds import PLOT_KINDS, PlotSetting
from softcradle.sandbox.window.plots.time_axis import SECONDS, TimeSpan

COLUMNS_AT_ONCE = 8  # of each plot, before the clock is read again
DRAWING_SECONDS = 0.003  # of a frame, for columns that are missing


class PlotBoard:
    """Plots of a session.

    Attributes:
        shown: names of the kinds that are shown, in the order of the table.
        hidden: whether all plots are hidden for now.
        logarithmic: whether overlaps have a logarithmic axis.
        plots: those on the page.
        span: their time axis.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self.shown = [name for name in self.available() if PLOT_KINDS[name].shown]
        self.hidden, self.logarithmic = False, True
        self.plots: list[Plot] = []
        self.span = TimeSpan(SECONDS / session.slow, 100)
        self._seen: tuple[object, int, int] = (None, -1, -1)

    def available(self) -> list[str]:
        """Names of the kinds that this session can show."""
        return [name for name, kind in PLOT_KINDS.items() if len(self.session.lanes) == 2 or not kind.two_lanes]

    def rows(self) -> list[list[str]]:
        """The kinds in each row: beside two lanes a row for each, which ends with their difference."""
        if self.hidden:
            return []
        own = [name for name in self.shown if not PLOT_KINDS[name].two_lanes]
        shared = [name for name in self.shown if PLOT_KINDS[name].two_lanes]
        if len(self.session.lanes) == 1:
            half = (len(own) + 1) // 2
            return [own[:half], own[half:]] if len(own) > 3 else [own] if own else []
        return [[*own, *shared] for _ in self.session.lanes] if own or shared else []

    def toggle(self, name: str) -> None:
        """Show or hide a kind."""
        self.hidden = False
        chosen = set(self.shown) ^ {name}
        self.shown = [other for other in PLOT_KINDS if other in chosen]

    def build(self, rects: Sequence[Sequence[pygame.Rect]], unit: float, scales: Scales) -> None:
        """Make the plots anew; their curves come back within some frames."""
        several = len(self.session.lanes) > 1
        self.plots = [
            self._plot(name, row if several else 0, rect, unit, scales)
            for row, (names, places) in enumerate(zip(self.rows(), rects, strict=True))
            for name, rect in zip(names, places, strict=True)
        ]
        if self.plots:
            self._set_span(min(plot.area.width for plot in self.plots))
        self._seen = (None, -1, -1)

    def _plot(self, name: str, lane: int, rect: pygame.Rect, unit: float, scales: Scales) -> Plot:
        kind, live, session = PLOT_KINDS[name], self.session.lanes[lane], self.session
        label = live.label if len(session.lanes) > 1 and not kind.two_lanes else ""
        length = session.scene.view.length
        content = kind.content(PlotSetting(scales, lane, live.chain.contacts + 1, length, self.logarithmic))
        return kind.plot(rect, unit, content.labelled(label), session.history, lane, self.span)

    def follow_slow_motion(self) -> None:
        """Span the same wall time as before: the slow motion has changed."""
        self._set_span(self.span.width)

    def _set_span(self, width: int) -> None:
        before = self.span.seconds, self.span.width
        share = self.span.x(self.session.time) / self.span.width
        self.span.seconds, self.span.width = SECONDS / self.session.slow, width
        if before != (self.span.seconds, self.span.width):
            self.span.left = max(0, round(self.session.time / self.span.column - share * width))
            self._invalidate()

    def _invalidate(self) -> None:
        for plot in self.plots:
            plot.curves.invalidate()

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw titles and axes."""
        for plot in self.plots:
            plot.backdrop(surface)

    def update(self) -> None:
        """Draw what is new, then some of what is missing."""
        history = self.session.history
        self.span.follow(self.session.time)
        block, last = history.blocks[-1], history.last
        if (block, block.revision) != self._seen[:2]:
            self._invalidate_branch()
        grown = self._seen[2] != last or (block, block.revision) != self._seen[:2]
        self._seen = block, block.revision, last
        began = perf_counter()
        for plot in self.plots:
            plot.update(grown, COLUMNS_AT_ONCE)
        while perf_counter() - began < DRAWING_SECONDS and not all(plot.complete for plot in self.plots):
            for plot in self.plots:
                plot.update(False, COLUMNS_AT_ONCE)

    def _invalidate_branch(self) -> None:
        """Frames were dropped or replaced: curves later than the frame shown are those of another branch."""
        history = self.session.history
        if history.first == history.last:
            self._invalidate()
            return
        column = int(history.snapshot(max(self.session.frame - 1, history.first)).time / self.span.column)
        for plot in self.plots:
            plot.curves.invalidate_from(column)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw all plots with the cursor at the frame shown."""
        for plot in self.plots:
            plot.paint(surface, self.session.time, plot.values_at(self.session.frame))

    def plot_at(self, point: tuple[int, int]) -> Plot | None:
        """The plot whose axes are at `point`."""
        return next((plot for plot in self.plots if plot.area.collidepoint(point)), None)

    def paint_reading(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """Draw a line through all plots at the pointer's time, and the values of the plot below the pointer."""
        plot = self.plot_at(point)
        if plot is None:
            return
        x = point[0] - plot.area.left
        for other in self.plots:
            place = (other.area.left + min(x, other.area.width), other.area.top, 1, other.area.height)
            surface.fill(FOREGROUND, place)
        history = self.session.history
        frame = history.frame_at(self.span.time(x))
        paint_readout(surface, plot, point, float(history.snapshot(frame).time), plot.values_at(frame))
