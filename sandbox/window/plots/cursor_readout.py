"""The readout at the pointer: the time there, and the values of a plot's curves, those nearest to the pointer first."""

from __future__ import annotations

import numpy as np
import pygame
from softcradle.sandbox.draw.number_format import fixed, scientific
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.supersampling import draw_marker
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.motion import Array
from softcradle.sandbox.window.plots.live_plots import Plot

MOST_CURVES = 10


def paint_readout(surface: pygame.Surface, plot: Plot, point: tuple[int, int], time: float, values: Array) -> None:
    """Draw a box beside `point` with `time` [s] and the `values` (k,) of `plot` there."""
    unit, chosen = plot.unit, _chosen(plot, point, values)
    size, name = plot.span.unit()
    head = f"t = {fixed(time / size, 3)} {name}"
    lines = [f"{plot.content.names[k]} = {scientific(float(values[k]), 2)}" for k in chosen]
    wide = max(width(line, 12 * unit) for line in (head, *lines)) + 34 * unit
    box = pygame.Rect(0, 0, round(wide), round((len(lines) + 1) * 16 * unit + 10 * unit))
    box.topleft = (point[0] + 14, point[1] - box.height // 2)
    box.clamp_ip(surface.get_rect().inflate(-8, -8))
    if box.collidepoint(point):
        box.right = point[0] - 14
    pygame.draw.rect(surface, tones.background, box, border_radius=4)
    pygame.draw.rect(surface, tones.faint, box, 1, border_radius=4)
    write(surface, head, (box.left + 8 * unit, box.top + 4 * unit), 12 * unit, tones.foreground, bold=True)
    for row, (k, line) in enumerate(zip(chosen, lines, strict=True)):
        y = box.top + (20 + 16 * row) * unit
        draw_marker(surface, k, (box.left + 14 * unit, y + 8 * unit), 3.4 * unit, plot.content.colours[k])
        write(surface, line, (box.left + 24 * unit, y), 12 * unit, tones.foreground)


def _chosen(plot: Plot, point: tuple[int, int], values: Array) -> list[int]:
    """Numbers of the curves that are listed; of many, those nearest to the pointer."""
    count = min(len(values), len(plot.content.names), len(plot.content.colours))
    if count <= MOST_CURVES:
        return list(range(count))
    heights = plot.area.top + plot.y(plot.axis.on(values[:count]))
    return sorted(np.argsort(abs(heights - point[1]))[:MOST_CURVES].tolist())
