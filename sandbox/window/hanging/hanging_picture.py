"""Pictures of the hanging cradle: beam, strings and balls, and the map between pixels and metres."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pygame
from softcradle.sandbox.draw.bead_sprites import bead_sprite
from softcradle.sandbox.draw.palette import bead_colours, tones
from softcradle.sandbox.draw.supersampling import blit_sprite
from softcradle.sandbox.window.hanging.hanging_cradle import BALLS, RADIUS, anchors, start_places

WIDTH = 2.6  # m of a picture
HEIGHT = 1.35  # m of a picture


def pixels_a_metre(rect: pygame.Rect) -> float:
    """Scale of the picture."""
    return min(rect.width / WIDTH, rect.height / HEIGHT)


def _origin(rect: pygame.Rect) -> tuple[float, float]:
    """Pixel of the first string's anchor."""
    return rect.centerx - (BALLS - 1) * RADIUS * pixels_a_metre(rect), rect.top + 0.06 * rect.height


def to_screen(rect: pygame.Rect, place: tuple[float, float]) -> tuple[float, float]:
    """Pixel of a place [m]."""
    x, y = _origin(rect)
    return x + place[0] * pixels_a_metre(rect), y - place[1] * pixels_a_metre(rect)


def to_model(rect: pygame.Rect, point: tuple[int, int]) -> tuple[float, float]:
    """Place [m] of a pixel."""
    x, y = _origin(rect)
    return (point[0] - x) / pixels_a_metre(rect), (y - point[1]) / pixels_a_metre(rect)


def paint_cradle(surface: pygame.Surface, rect: pygame.Rect, places: Sequence[tuple[float, float]]) -> None:
    """A beam, strings and balls."""
    ends = [to_screen(rect, (x, 0.0)) for x in anchors()]
    size = 2.0 * RADIUS * pixels_a_metre(rect)
    beam = pygame.Rect(0, 0, round(ends[-1][0] - ends[0][0] + 2 * size), max(4, round(0.1 * size)))
    beam.midbottom = (round((ends[0][0] + ends[-1][0]) / 2), round(ends[0][1]))
    surface.fill(tones.muted, beam)
    for end, place, colour in zip(ends, places, bead_colours(BALLS), strict=True):
        centre = to_screen(rect, place)
        share = 1.0 - 0.5 * size / max(math.dist(end, centre), size)  # of the string, outside the ball
        tip = end[0] + share * (centre[0] - end[0]), end[1] + share * (centre[1] - end[1])
        pygame.draw.aaline(surface, tones.muted, end, tip, 2)
        side = math.ceil(size)
        blit_sprite(surface, bead_sprite(size, colour, 0.0), centre[0] - 0.5 * side, centre[1] - 0.5 * side)


def hanging_thumbnail(size: tuple[int, int]) -> pygame.Surface:
    """The picture for the gallery."""
    surface = pygame.Surface(size, 0, 32)
    surface.fill(tones.lane_background)
    paint_cradle(surface, surface.get_rect(), start_places(1))
    return surface
