"""Icons on buttons, drawn as polygons: fonts differ in them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pygame
from softcradle.sandbox.draw.palette import Colour
from softcradle.sandbox.draw.surface_cache import cached_surfaces

Point = tuple[float, float]
Shape = Sequence[Sequence[Point]]

# Polygons on a square from -1 to 1.
_BAR_LEFT: Sequence[Point] = ((-0.9, -0.9), (-0.62, -0.9), (-0.62, 0.9), (-0.9, 0.9))
SHAPES: dict[str, Shape] = {
    "play": (((-0.7, -1.0), (1.0, 0.0), (-0.7, 1.0)),),
    "pause": (
        ((-0.8, -0.9), (-0.2, -0.9), (-0.2, 0.9), (-0.8, 0.9)),
        ((0.2, -0.9), (0.8, -0.9), (0.8, 0.9), (0.2, 0.9)),
    ),
    "back": (((0.3, -0.9), (-1.0, 0.0), (0.3, 0.9)), ((0.55, -0.9), (0.9, -0.9), (0.9, 0.9), (0.55, 0.9))),
    "forward": (((-0.3, -0.9), (1.0, 0.0), (-0.3, 0.9)), ((-0.55, -0.9), (-0.9, -0.9), (-0.9, 0.9), (-0.55, 0.9))),
    "first": (_BAR_LEFT, ((0.15, -0.9), (-0.6, 0.0), (0.15, 0.9)), ((0.95, -0.9), (0.2, 0.0), (0.95, 0.9))),
    "fit": (
        ((-1.0, 0.0), (-0.45, -0.5), (-0.45, 0.5)),
        ((1.0, 0.0), (0.45, -0.5), (0.45, 0.5)),
        ((-0.3, -0.25), (0.3, -0.25), (0.3, 0.25), (-0.3, 0.25)),
    ),
    "last": (
        ((0.9, -0.9), (0.62, -0.9), (0.62, 0.9), (0.9, 0.9)),
        ((-0.15, -0.9), (0.6, 0.0), (-0.15, 0.9)),
        ((-0.95, -0.9), (-0.2, 0.0), (-0.95, 0.9)),
    ),
}


def _restart(fine: pygame.Surface, colour: Colour, centre: Point, size: float) -> None:
    """An arrow along a circle."""
    box = pygame.Rect(0, 0, round(1.7 * size), round(1.7 * size))
    box.center = (round(centre[0]), round(centre[1]))
    pygame.draw.arc(fine, colour, box, 0.9, 6.6, max(2, round(0.26 * size)))
    x, y = box.right - 0.30 * size, box.top + 0.42 * size
    pygame.draw.polygon(
        fine, colour, [(x - 0.75 * size, y), (x + 0.35 * size, y + 0.1 * size), (x + 0.15 * size, y - 0.8 * size)]
    )


_DRAWN: dict[str, Callable[[pygame.Surface, Colour, Point, float], None]] = {"restart": _restart}


@cached_surfaces(1)
def icon(name: str, size: int, colour: Colour) -> pygame.Surface:
    """The icon `name`, `size` pixels wide and high, on a transparent surface."""
    fine = pygame.Surface((4 * size, 4 * size), pygame.SRCALPHA, 32)
    fine.fill((*colour, 0))
    half = 2.0 * size
    if name in _DRAWN:
        _DRAWN[name](fine, colour, (half, half), 0.92 * half)
    else:
        for polygon in SHAPES[name]:
            pygame.draw.polygon(fine, colour, [(half * (1 + 0.92 * x), half * (1 + 0.92 * y)) for x, y in polygon])
    return pygame.transform.smoothscale(fine, (size, size))


def draw_icon(surface: pygame.Surface, name: str, centre: Point, size: float, colour: Colour) -> None:
    """Draw it about `centre`."""
    image = icon(name, max(6, round(size)), colour)
    surface.blit(image, image.get_rect(center=(round(centre[0]), round(centre[1]))))
