"""The live kymograph: the beads over time, as a camera sees them from the side, with a marker on each: the paper's Fig. 4 (c)."""

from __future__ import annotations

import numpy as np
import pygame
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.draw.supersampling import SUBPIXELS
from softcradle.sandbox.window.plots.live_plots import THICKNESS, Plot, draw_curves

PALE = 0.45  # share of the background in the colour of a bead


class KymographPlot(Plot):
    """A pale band around each curve, and the curve in its middle as the marker."""

    marked = False

    def draw_columns(self, first: int, last: int) -> pygame.Surface:
        """Bands with markers in columns `first` to `last`."""
        fine = self.enlarged_background(first, last)
        colours, half = self.content.colours, 0.5 * self.content.band
        for time, values in self.samples(first, last):
            across = (time / self.span.column - first + 0.5) * SUBPIXELS
            across[[0, -1]] += -SUBPIXELS, SUBPIXELS  # no gap between slices of the history
            low, high = ((self.y(values + side * half) + 0.5) * SUBPIXELS for side in (-1.0, 1.0))
            for k in range(min(values.shape[1], len(colours))):
                edge = np.concatenate((across, across[::-1])), np.concatenate((low[:, k], high[::-1, k]))
                if len(across) > 1:
                    pygame.draw.polygon(fine, mix(colours[k], tones.background, PALE), np.column_stack(edge).tolist())
            down = (self.y(values) + 0.5) * SUBPIXELS
            markers = [tones.foreground] * values.shape[1]
            draw_curves(fine, markers, across, down, THICKNESS * self.unit * SUBPIXELS)
        return pygame.transform.smoothscale(fine, (last - first, self.area.height))
