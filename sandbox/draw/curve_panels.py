"""Panels with curves over time. The axes and the curves are drawn only once. Each frame shows the part of the curves
before the cursor.
"""

from collections.abc import Sequence

import numpy as np
import pygame
from softcradle.sandbox.draw.axes import LINE, Axes, VerticalAxis
from softcradle.sandbox.draw.palette import Colour, mix, tones
from softcradle.sandbox.draw.supersampling import SUBPIXELS, draw_line
from softcradle.sandbox.motion import Array
from softcradle.sandbox.story.numbers import ticks, time_unit

# Distances between the axes and the left, right, top and bottom edge of a panel [design pixels]. The labels, the names
# of curves and the title are written in these margins.
MARGINS = 46.0, 44.0, 24.0, 22.0
LINE_WIDTH = 2.2  # Thickness of a curve [design pixels].
# Largest number of curves with names and markers. If a panel has more curves, none of them has a name or a marker.
MOST_LABELS = 10


class Panel(Axes):
    """Panel with curves over time. :meth:`draw_curves` draws the curves once. :meth:`paint` shows the part of the
    curves before the cursor.

    Arguments:
        rect: rectangle of the panel [pixels].
        unit: pixels per design pixel.
        time: ends of the time axis [s].
        axis: the vertical axis.
        colours, names: colour and name of each curve.
    """

    def __init__(
        self,
        rect: pygame.Rect,
        unit: float,
        time: tuple[float, float],
        axis: VerticalAxis,
        *,
        colours: Sequence[Colour],
        names: Sequence[str],
    ) -> None:
        super().__init__(rect, unit, axis, MARGINS)
        self.time, self.colours, self.names = time, colours, names
        self.curves = pygame.Surface(self.area.size, 0, 32)
        self.labelled = len(names) <= MOST_LABELS and len(names) * 0.75 * LINE * unit <= self.area.height

    def x(self, time: Array | float) -> Array:
        """Return the distance [pixels] between the position of `time` [s] and the left end of the axes."""
        share = (np.asarray(time, dtype=np.float64) - self.time[0]) / (self.time[1] - self.time[0])
        return share * (self.area.width - 1)

    def draw_curves(self, time: Array, values: Array) -> None:
        """Draw the curves `values` (T, k) over `time` (T,). Each frame shows a part of this drawing."""
        self.curves = self._drawn(time, values, self.colours)

    def backdrop(self, surface: pygame.Surface, time: Array, values: Array, peaks: Array, ahead: float) -> None:
        """Draw the axes, the title and the names of the curves. Draw all curves in pale colours.

        `peaks` (k,) contains one value of each curve. The name of the curve is written at the height of this value.
        `ahead` (0 to 1) is the strength of the pale colours.
        """
        pale = [mix(tones.background, colour, ahead) for colour in self.colours]
        surface.blit(self._drawn(time, values, pale if ahead > 0.0 else ()), self.area)
        self.write_title(surface, self.axis.title)
        self.write_down(surface)
        labels = [(self.area.left + float(self.x(at)), text) for at, text in self._time_ticks()]
        self.write_across(surface, labels, f"t ({time_unit(self.time[1] - self.time[0])[1]})", self.rect.right)
        if self.labelled:
            heights = self.y(self.axis.on(peaks)).tolist()
            self.write_names(surface, self.area.right + 9 * self.unit, heights, self.names, self.colours)

    def paint(self, surface: pygame.Surface, time: float, values: Array) -> None:
        """Show the part of the curves before the cursor at `time` [s]. Draw a marker at the cursor for each of the
        `values` (k,).
        """
        place = float(self.x(time))
        if not 0.0 <= place <= self.area.width:
            return
        end = round(place)
        surface.blit(self.curves, self.area, (0, 0, end, self.area.height))
        surface.fill(tones.muted, (self.area.left + end, self.area.top, max(1, round(self.unit)), self.area.height))
        if self.labelled:
            self.mark(surface, self.area.left + place, self.y(self.axis.on(values)).tolist(), self.colours)

    def _drawn(self, time: Array, values: Array, colours: Sequence[Colour]) -> pygame.Surface:
        """Return a surface with the grid and the curves. The first curve is drawn last and covers the others."""
        wide, high = self.area.size
        fine = pygame.Surface((wide * SUBPIXELS, high * SUBPIXELS), 0, 32)
        fine.fill(tones.background)
        self._grid(fine)
        across = (self.x(time) + 0.5) * SUBPIXELS
        for k in range(len(colours) - 1, -1, -1):
            down = (self.y(self.axis.on(values[:, k])) + 0.5) * SUBPIXELS
            draw_line(fine, colours[k], _thinned(across, down), LINE_WIDTH * self.unit * SUBPIXELS)
        return pygame.transform.smoothscale(fine, (wide, high))

    def _grid(self, fine: pygame.Surface) -> None:
        for y, tint in self.levels():
            fine.fill(tint, (0, y * SUBPIXELS, fine.get_width(), SUBPIXELS))
        for time, _ in self._time_ticks():
            fine.fill(tones.grid, (round(float(self.x(time))) * SUBPIXELS, 0, SUBPIXELS, fine.get_height()))

    def _time_ticks(self) -> list[tuple[float, str]]:
        size, _ = time_unit(self.time[1] - self.time[0])
        return [(v * size, text) for v, text in ticks(self.time[0] / size, self.time[1] / size, 6)]


def _thinned(across: Array, down: Array) -> list[tuple[float, float]]:
    """Return the points of a curve. Omit each point that falls on the same fine pixel as the previous point."""
    moved = np.ones(len(across), dtype=bool)
    moved[1:] = (np.diff(np.floor(across)) != 0.0) | (np.diff(np.floor(down)) != 0.0)
    return list(zip(across[moved].tolist(), down[moved].tolist(), strict=True))
