"""The board: all plots that are shown, in step with the history, and the cursor that reads values from them."""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter

import numpy as np
import pygame
from softcradle.sandbox.draw.number_format import fixed, scientific
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.draw.supersampling import draw_marker
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.plots.live_plots import Plot
from softcradle.sandbox.window.plots.plot_kinds import KINDS, Setting, make_plot
from softcradle.sandbox.window.plots.time_axis import SECONDS, TimeSpan

COLUMNS_AT_ONCE = 8
INKING = 0.003  # seconds of a frame for ink that is missing
MOST_READ = 10  # values listed at the cursor


class Board:
    """Plots of a session. `shown` are the kinds that are, `logarithmic` says how overlaps are put on their axis."""

    def __init__(self, session: Session, shown: Sequence[str]) -> None:
        self.session = session
        self.shown = [kind for kind in KINDS if kind in shown]
        self.hidden, self.logarithmic = False, True
        self.plots: list[Plot] = []
        self.span = TimeSpan(SECONDS / session.slow, 100)
        self._seen: tuple[object, int, int] = (None, -1, -1)

    @property
    def lanes(self) -> int:
        """Number of lanes."""
        return len(self.session.lanes)

    def rows(self) -> list[list[str]]:
        """The kinds in each row; in the rows of two lanes the last plot is their difference."""
        if self.hidden or not self.shown:
            return []
        own = [kind for kind in self.shown if kind != "difference"]
        if self.lanes == 1:
            half = (len(own) + 1) // 2
            return [own[:half], own[half:]] if len(own) > 3 else [own] if own else []
        apart = ["difference"] if "difference" in self.shown and self.lanes == 2 else []
        return [[*own, *apart] for _ in range(self.lanes)] if own or apart else []

    def toggle(self, kind: str) -> None:
        """Show or hide a kind."""
        self.hidden = False
        kept = set(self.shown) ^ {kind}
        self.shown = [one for one in KINDS if one in kept]

    def build(self, rects: Sequence[Sequence[pygame.Rect]], unit: float, scales: Scales) -> None:
        """Make the plots anew; their curves come back within some frames."""
        session, self.plots = self.session, []
        length = session.scene.view.length
        setting = Setting(session.lanes, scales, session.history, self.span, self.logarithmic, length)
        for row, (kinds, places) in enumerate(zip(self.rows(), rects, strict=True)):
            lane = row if self.lanes > 1 else 0
            self.plots += [make_plot(kind, lane, rect, unit, setting) for kind, rect in zip(kinds, places, strict=True)]
        if self.plots:
            self._respan(min(plot.area.width for plot in self.plots))
        self._seen = (None, -1, -1)

    def respan(self) -> None:
        """The slow motion has changed: plot as much as is seen in the same wall time."""
        self._respan(self.span.width)

    def _respan(self, wide: int) -> None:
        before = self.span.seconds, self.span.width
        share = self.span.x(self.session.time) / self.span.width
        self.span.seconds, self.span.width = SECONDS / self.session.slow, wide
        if before != (self.span.seconds, self.span.width):
            self.span.left = max(0, round(self.session.time / self.span.column - share * wide))
            self.forget()

    def forget(self) -> None:
        """All curves are stale."""
        for plot in self.plots:
            plot.sheet.forget()

    def backdrop(self, surface: pygame.Surface) -> None:
        """What stands still."""
        for plot in self.plots:
            plot.backdrop(surface)

    def update(self) -> None:
        """Ink what is new, then some of what is missing."""
        history = self.session.history
        self.span.follow(self.session.time)
        block, last = history.blocks[-1], history.last
        if (block, block.revision) != self._seen[:2]:
            self._stale()
        grown = self._seen[2] != last or (block, block.revision) != self._seen[:2]
        self._seen = block, block.revision, last
        began = perf_counter()
        for plot in self.plots:
            plot.update(grown, COLUMNS_AT_ONCE)
        while perf_counter() - began < INKING and not all(plot.complete for plot in self.plots):
            for plot in self.plots:
                plot.update(False, COLUMNS_AT_ONCE)

    def _stale(self) -> None:
        """Frames were dropped or replaced: what is later than the frame shown is ink of another branch."""
        history = self.session.history
        if history.first == history.last:
            self.forget()
            return
        column = int(history.moment(max(self.session.frame - 1, history.first)).time / self.span.column)
        for plot in self.plots:
            plot.sheet.cut(column)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw all plots with the cursor at the frame shown."""
        for plot in self.plots:
            plot.paint(surface, self.session.time, plot.now(self.session.frame))

    def at(self, point: tuple[int, int]) -> Plot | None:
        """The plot whose axes are at `point`."""
        return next((plot for plot in self.plots if plot.area.collidepoint(point)), None)

    def paint_reading(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """A line through all plots at the pointer's time, and the values of the one it is over."""
        plot = self.at(point)
        if plot is None:
            return
        x = point[0] - plot.area.left
        for other in self.plots:
            surface.fill(FOREGROUND, (other.area.left + min(x, other.area.width), other.area.top, 1, other.area.height))
        history = self.session.history
        frame = history.frame_at(self.span.time(x))
        values = plot.now(frame)
        time = float(history.moment(frame).time)
        self._table(surface, plot, point, time, values.tolist())

    def _table(
        self, surface: pygame.Surface, plot: Plot, point: tuple[int, int], time: float, values: list[float]
    ) -> None:
        unit = plot.unit
        names = plot.names
        chosen = list(range(min(len(values), len(names), len(plot.colours))))
        if len(chosen) > MOST_READ:
            heights = plot.area.top + plot.y(plot.axis.on(np.array(values[: len(chosen)])))
            chosen = sorted(np.argsort(abs(heights - point[1]))[:MOST_READ].tolist())
        size, name = self.span.unit()
        head = f"t = {fixed(time / size, 3)} {name}"
        lines = [f"{names[k]} = {scientific(values[k], 2)}" for k in chosen]
        wide = max(width(line, 12 * unit) for line in (head, *lines)) + 34 * unit
        box = pygame.Rect(0, 0, round(wide), round((len(lines) + 1) * 16 * unit + 10 * unit))
        box.topleft = (point[0] + 14, point[1] - box.height // 2)
        box.clamp_ip(surface.get_rect().inflate(-8, -8))
        if box.collidepoint(point):
            box.right = point[0] - 14
        pygame.draw.rect(surface, BACKGROUND, box, border_radius=4)
        pygame.draw.rect(surface, FAINT, box, 1, border_radius=4)
        write(surface, head, (box.left + 8 * unit, box.top + 4 * unit), 12 * unit, FOREGROUND, bold=True)
        for row, (k, line) in enumerate(zip(chosen, lines, strict=True)):
            y = box.top + (20 + 16 * row) * unit
            draw_marker(surface, k, (box.left + 14 * unit, y + 8 * unit), 3.4 * unit, plot.colours[k])
            write(surface, line, (box.left + 24 * unit, y), 12 * unit, FOREGROUND)
