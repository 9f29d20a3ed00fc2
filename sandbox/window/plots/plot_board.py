"""The plot board: all plots that are shown, in step with the history, and the cursor that reads values from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.languages import label_words
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.plots.cursor_readout import paint_readout
from softcradle.sandbox.window.plots.data_overlay import Overlaid
from softcradle.sandbox.window.plots.live_plots import Plot
from softcradle.sandbox.window.plots.plot_kinds import PAIR, PLOT_KINDS, PlotSetting
from softcradle.sandbox.window.plots.time_axis import SECONDS, TimeSpan

COLUMNS_AT_ONCE = 8  # of each plot, before the clock is read again
DRAWING_SECONDS = 0.003  # of a frame, for columns that are missing
LEAST_WIDTH = 190.0  # design pixels of a plot


def _balanced(names: list[str], most: int) -> list[list[str]]:
    """`names` in as few rows as hold at most `most` each, all about as long."""
    count = -(-len(names) // most)
    ends = [round(k * len(names) / count) for k in range(count + 1)]
    return [names[begin:end] for begin, end in pairwise(ends)]


class PlotBoard:
    """Plots of a session; `clock` [s] ends the drawing of missing columns in a frame.

    Attributes:
        shown: names of the kinds that are shown, in the order of the table.
        single: name of the only kind that is shown, at the first level; else empty.
        hidden: whether all plots are hidden for now.
        logarithmic: whether overlaps have a logarithmic axis.
        pair: the signals that a person has chosen for a plot.
        plots: those on the page.
        keys: kind and lane of each of them.
        overlays: what lies over the plots of a kind and lane.
        span: their time axis.
    """

    def __init__(self, session: Session, clock: Callable[[], float]) -> None:
        self.session, self.clock = session, clock
        self.shown = [name for name in self.available() if PLOT_KINDS[name].shown]
        self.hidden, self.logarithmic, self.single = False, True, ""
        self.pair = PAIR
        self.plots: list[Plot] = []
        self.keys: list[tuple[str, int]] = []
        self.overlays: dict[tuple[str, int], list[Overlaid]] = {}
        self.span = TimeSpan(SECONDS / session.slow, 100)
        self._seen: tuple[object, int, int] = (None, -1, -1)

    def available(self) -> list[str]:
        """Names of the kinds that this session can show."""
        return [name for name, kind in PLOT_KINDS.items() if len(self.session.lanes) == 2 or not kind.two_lanes]

    def rows(self, width: float) -> list[tuple[int, list[str]]]:
        """Lane and kinds of each row of plots, at least LEAST_WIDTH of the `width` [design pixels] wide.

        Two lanes have rows of their own; those of each end with their difference.
        """
        most = max(1, int(width / LEAST_WIDTH))
        return [(lane, row) for lane, names in self._kinds() for row in _balanced(names, most)]

    def _kinds(self) -> list[tuple[int, list[str]]]:
        """The kinds of each lane; those of the only lane in halves where there are many."""
        if self.hidden:
            return []
        if self.single:
            return [(lane, [self.single]) for lane in range(len(self.session.lanes))]
        own = [name for name in self.shown if not PLOT_KINDS[name].two_lanes]
        shared = [name for name in self.shown if PLOT_KINDS[name].two_lanes]
        if len(self.session.lanes) == 1:
            half = (len(own) + 1) // 2
            return [(0, own[:half]), (0, own[half:])] if len(own) > 3 else [(0, own)] if own else []
        return [(lane, [*own, *shared]) for lane in range(len(self.session.lanes))] if own or shared else []

    def toggle(self, name: str) -> None:
        """Show or hide a kind."""
        self.hidden = False
        if self.single:
            self.single = name
            return
        chosen = set(self.shown) ^ {name}
        self.shown = [other for other in PLOT_KINDS if other in chosen]

    def build(
        self,
        rows: Sequence[tuple[int, list[str]]],
        rects: Sequence[Sequence[pygame.Rect]],
        unit: float,
        scales: Scales,
    ) -> None:
        """Make the plots anew; their curves come back within some frames."""
        self.plots = [
            self._plot(name, lane, rect, unit, scales)
            for (lane, names), places in zip(rows, rects, strict=True)
            for name, rect in zip(names, places, strict=True)
        ]
        self.keys = [(name, lane) for lane, names in rows for name in names]
        if self.plots:
            self._set_span(min(plot.area.width for plot in self.plots))
        self._seen = (None, -1, -1)

    def _plot(self, name: str, lane: int, rect: pygame.Rect, unit: float, scales: Scales) -> Plot:
        kind, live, session = PLOT_KINDS[name], self.session.lanes[lane], self.session
        label = label_words(session.label(lane)) if len(session.lanes) > 1 and not kind.two_lanes else ""
        length = session.scene.view.length
        content = kind.content(PlotSetting(scales, lane, live.chain.contacts + 1, length, self.logarithmic, self.pair))
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

    @property
    def complete(self) -> bool:
        """Whether every plot shows all of the history."""
        return all(plot.complete for plot in self.plots)

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
        began = self.clock()
        for plot in self.plots:
            plot.update(grown, COLUMNS_AT_ONCE)
        while self.clock() - began < DRAWING_SECONDS and not all(plot.complete for plot in self.plots):
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
        for key, plot in zip(self.keys, self.plots, strict=True):
            plot.paint(surface, self.session.time, plot.values_at(self.session.frame))
            for laid in self.overlays.get(key, ()):
                laid.paint(surface, plot)

    def plot_at(self, point: tuple[int, int]) -> Plot | None:
        """The plot whose axes are at `point`."""
        return next((plot for plot in self.plots if plot.area.collidepoint(point)), None)

    def paint_reading(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """Draw a line through all plots at the pointer's time, and the values of the plot below the pointer."""
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
