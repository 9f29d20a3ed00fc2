"""The space-time strip: a row for each contact, from left to right downwards; a greater force is darker."""

from __future__ import annotations

import numpy as np
import pygame
from softcradle.sandbox.draw.number_format import prefixed
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.motion import Array
from softcradle.sandbox.window.plots.live_plots import Plot

SHADES = 256
SCALE = 7.0  # design pixels, the width of the scale


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

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw title and labels, and beside the axes the scale of the shades."""
        super().backdrop(surface)
        unit, area = self.unit, self.area
        bar = pygame.Rect(area.right + round(6 * unit), area.top, max(3, round(SCALE * unit)), area.height)
        shades = _shades()
        rows = ((bar.height - 1 - np.arange(bar.height)) * (SHADES - 1)) // max(1, bar.height - 1)
        column = pygame.surfarray.make_surface(np.broadcast_to(shades[rows], (bar.width, bar.height, 3)))
        surface.blit(column, bar)
        pygame.draw.rect(surface, tones.faint, bar, 1)
        shares = (0.0, 0.5, 1.0) if area.height > 60 * unit else (0.0, 1.0) if area.height > 24 * unit else (1.0,)
        for share in shares:
            y = bar.bottom - share * bar.height
            text = prefixed(share * self.content.darkest) if share else "0"
            place = (bar.right + 3 * unit, min(max(y, bar.top + 6 * unit), bar.bottom - 6 * unit))
            write(surface, text, place, 10.5 * unit, tones.muted, align=(0, 0.5))


def _shades() -> Array:
    """(SHADES, 3) colours from 0 to the darkest."""
    ramp = tones.shades
    places = np.linspace(0, len(ramp) - 1, SHADES)
    rows = [mix(ramp[int(p)], ramp[min(int(p) + 1, len(ramp) - 1)], float(p) % 1.0) for p in places]
    return np.array(rows, dtype=np.uint8)
