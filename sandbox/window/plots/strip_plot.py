"""The space-time strip: a row for each contact, from left to right downwards; a greater force is darker."""

from __future__ import annotations

import numpy as np
import pygame
from softcradle.sandbox.draw.palette import BACKGROUND, Colour, mix
from softcradle.sandbox.motion import Array
from softcradle.sandbox.window.plots.live_plots import Plot

RAMP: tuple[Colour, ...] = (BACKGROUND, (198, 222, 240), (86, 160, 211), (0, 94, 160), (10, 34, 82))
SHADES = 256


class StripPlot(Plot):
    """A strip of shades for each curve, one below the other."""

    marked = False

    def draw_columns(self, first: int, last: int) -> pygame.Surface:
        """Shades in columns `first` to `last`: of each column the darkest."""
        image = np.zeros((last - first, self.area.height), dtype=np.uint8)
        for time, values in self.samples(first, last):
            columns = np.floor(time / self.span.column).astype(int) - first
            inside = (columns >= 0) & (columns < last - first)
            shade = np.clip(values[inside] / self.content.darkest * (SHADES - 1), 0, SHADES - 1).astype(np.uint8)
            strips = (np.arange(self.area.height) * values.shape[1]) // self.area.height
            np.maximum.at(image, columns[inside], shade[:, strips])
        return pygame.surfarray.make_surface(_shades()[image])


def _shades() -> Array:
    """(SHADES, 3) colours from 0 to the darkest."""
    places = np.linspace(0, len(RAMP) - 1, SHADES)
    rows = [mix(RAMP[int(p)], RAMP[min(int(p) + 1, len(RAMP) - 1)], float(p) % 1.0) for p in places]
    return np.array(rows, dtype=np.uint8)
