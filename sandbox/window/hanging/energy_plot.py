"""The plot of the hanging cradle: the energies of both sides, as shares of those at the start."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.curve_panels import linear_axis
from softcradle.sandbox.draw.number_format import fixed
from softcradle.sandbox.draw.palette import OKABE_ITO, tones
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.languages import _
from softcradle.sandbox.window.hanging.hanging_badges import NAMES
from softcradle.sandbox.window.hanging.hanging_model import HangingModel

SPAN = 12.0  # seconds of the plot
CURVES = (OKABE_ITO[0], OKABE_ITO[3])


def paint_energies(surface: pygame.Surface, rect: pygame.Rect, unit: float, model: HangingModel) -> None:
    """Draw axes, both curves up to the last frame, and a line at the frame that is shown."""
    area = pygame.Rect(rect.left + round(44 * unit), rect.top + round(22 * unit), 1, 1)
    area.width, area.height = rect.right - area.left - round(8 * unit), rect.bottom - area.top - round(24 * unit)
    title = _("energy, as a share of that at the start")
    write(surface, title, (area.left, area.top - 5 * unit), 13 * unit, align=(0, 1))
    begin = max(model.frames[0].time, model.time - SPAN)
    shares = [model.energy_shares(side, SPAN) for side in (0, 1)]
    values = [share for side in shares for _, share in side] or [1.0]
    low, high = min(0.9, *values), max(1.04, *values)

    def point(time: float, share: float) -> tuple[float, float]:
        x = area.left + (time - begin) / SPAN * area.width
        return x, area.bottom - (share - low) / (high - low) * area.height

    for value, text in linear_axis("", low, high).ticks:
        y = point(begin, value)[1]
        surface.fill(tones.grid, (area.left, round(y), area.width, 1))
        write(surface, text, (area.left - 6 * unit, y), 11.5 * unit, tones.muted, align=(1, 0.5))
    for side, colour in enumerate(CURVES):
        points = [point(*pair) for pair in shares[side]]
        if len(points) > 1:
            pygame.draw.aalines(surface, colour, False, points)
            pygame.draw.aalines(surface, colour, False, [(x, y + 1) for x, y in points])
    surface.fill(tones.muted, (round(point(model.time, 1.0)[0]), area.top, 1, area.height))
    x = float(area.left)
    for side, colour in enumerate(CURVES):
        surface.fill(colour, (round(x), round(area.bottom + 12 * unit), round(16 * unit), max(2, round(2 * unit))))
        place = (x + 22 * unit, area.bottom + 5 * unit)
        x = write(surface, _(NAMES[side]), place, 12 * unit, tones.foreground).right + 20 * unit
    write(surface, f"{fixed(SPAN, 0)} s", (area.right, area.bottom + 5 * unit), 11.5 * unit, tones.muted, align=(1, 0))
