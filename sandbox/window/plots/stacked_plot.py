"""The stacked plot: values of each column piled up, as the energy of beads and contacts."""

from __future__ import annotations

import numpy as np
import pygame
from softcradle.sandbox.draw.palette import Colour, bead_colours, tones
from softcradle.sandbox.motion import Array
from softcradle.sandbox.window.plots.live_plots import Plot


class StackedPlot(Plot):
    """Energies piled up: the kinetic energy of each bead, and above them what the contacts store."""

    marked = False

    def draw_columns(self, first: int, last: int) -> pygame.Surface:
        """Piles in columns `first` to `last`."""
        pixels = pygame.surfarray.array3d(self.curves.background)[:1].repeat(last - first, axis=0)
        middles = np.arange(self.area.height) + 0.5
        for time, values in self.samples(first, last):
            layers = values.shape[1]  # of these frames: beads may have been added or removed since
            colours = np.array([*_layer_colours(layers), tones.background], dtype=np.uint8)
            tops = self.y(np.cumsum(values, axis=1))
            for column, row in _latest(time / self.span.column, first, last):
                layer = np.searchsorted(-tops[row], -middles)  # the first layer that reaches as high as the pixel
                inside = layer < layers
                pixels[column - first, inside] = colours[layer[inside]]
        return pygame.surfarray.make_surface(pixels)


def _layer_colours(count: int) -> tuple[Colour, ...]:
    """Colours of the layers from below: the beads, and the contacts."""
    return *bead_colours(count - 1), tones.steel


def _latest(places: Array, first: int, last: int) -> list[tuple[int, int]]:
    """(column, row) for the columns `first` to `last`: the newest row at or before it; `places` (T,) in columns."""
    columns = np.arange(first, last)
    rows = np.searchsorted(places, columns + 1) - 1
    covered = (rows >= 0) & (columns <= places[-1])
    return list(zip(columns[covered].tolist(), rows[covered].tolist(), strict=True))
