"""Antialiased shapes. Each shape is drawn at four times its size and then reduced by averaging. A sprite has one image
for each quarter of a pixel.
"""

import math
from collections.abc import Callable, Sequence

import pygame
from softcradle.sandbox.draw.palette import Colour, mix, tones
from softcradle.sandbox.draw.surfaces import cached_surfaces

SUBPIXELS = 4  # Factor by which shapes are drawn larger. It is also the number of positions of a sprite within a pixel.
Point = tuple[float, float]
Sprites = tuple[pygame.Surface, ...]


def make_sprites(size: tuple[int, int], rim: Colour, paint: Callable[[pygame.Surface, float], None]) -> Sprites:
    """Return the images of a shape at four positions, which are a quarter of a pixel apart.

    ``paint(surface, shift)`` draws the shape at four times its size. The function `paint` moves the shape to the right
    by `shift` fine pixels. `rim` is the colour of the outline. The transparent background also gets this colour. With
    another colour, averaging would darken the edge of the shape.
    """
    images = []
    for shift in range(SUBPIXELS):
        fine = pygame.Surface(((size[0] + 1) * SUBPIXELS, size[1] * SUBPIXELS), pygame.SRCALPHA, 32)
        fine.fill((*rim, 0))
        paint(fine, float(shift))
        images.append(pygame.transform.smoothscale(fine, (size[0] + 1, size[1])))
    return tuple(images)


def blit_sprite(surface: pygame.Surface, images: Sprites, x: float, y: float) -> None:
    """Blit the sprite with its top left corner at (x, y). `x` is rounded to a quarter of a pixel, and `y` to a whole
    pixel.
    """
    quarters = round(x * SUBPIXELS)
    surface.blit(images[quarters % SUBPIXELS], (quarters // SUBPIXELS, round(y)))


def fill_rectangle(surface: pygame.Surface, colour: Colour, area: tuple[float, float, float, float]) -> None:
    """Fill the rectangle (left, top, width, height) [pixels]. Each partly covered pixel becomes a mixture of `colour`
    and its previous colour.
    """
    x, y, width, height = area
    if width <= 0.0 or height <= 0.0:
        return
    (right_end, bottom_end), rows = surface.get_size(), _spans(y, y + height)
    for left, right, across in _spans(x, x + width):
        for top, bottom, down in rows:
            share, tint = across * down, colour
            if share <= 0.005 or left == right or top == bottom:
                continue
            if share <= 0.995 and 0 <= left < right_end and 0 <= top < bottom_end:
                red, green, blue, _ = surface.get_at((left, top))
                tint = mix((red, green, blue), colour, share)
            surface.fill(tint, (left, top, right - left, bottom - top))


def _spans(low: float, high: float) -> list[tuple[int, int, float]]:
    """Return the pixels between `low` and `high` as (first, end, coverage). Pixels at the two ends can be partly
    covered.
    """
    first, last = math.floor(low), math.floor(high)
    if first == last:
        return [(first, first + 1, high - low)]
    return [(first, first + 1, first + 1 - low), (first + 1, last, 1.0), (last, last + 1, high - last)]


def draw_line(fine: pygame.Surface, colour: Colour, points: Sequence[Point], thickness: float) -> None:
    """Draw a line through `points` with round joints. All lengths are in pixels of the magnified surface `fine`."""
    width = max(1, round(thickness))
    if len(points) > 1:
        pygame.draw.lines(fine, colour, False, points, width)
    if width > 2:
        for point in points:
            pygame.draw.circle(fine, colour, point, width / 2)


# Markers with corners. The numbers are the count of corners, the angle of the first corner [degrees], and the size
# relative to the radius. The shapes are a square, a triangle on its base, a diamond and a triangle on its tip. With
# these sizes, all markers look equally large. Marker 0 is a disc.
CORNERED_MARKERS = {1: (4, 45, 1.2), 2: (3, -90, 1.3), 3: (4, 0, 1.25), 4: (3, 90, 1.3)}
MARKERS = 1 + len(CORNERED_MARKERS)
# Width of the ring in the background colour around a marker [pixels]. The ring separates the marker from the curves.
MARKER_RIM = 1.2


@cached_surfaces(2)
def marker_sprite(shape: int, radius: float, colour: Colour) -> Sprites:
    """Draw the marker number `shape`. If the number is MARKERS or larger, the shapes repeat."""
    side = math.ceil(2 * radius + 4)

    def paint(fine: pygame.Surface, shift: float) -> None:
        centre = (side / 2 * SUBPIXELS + shift, side / 2 * SUBPIXELS)
        for tint, size in ((tones.background, radius + MARKER_RIM), (colour, radius)):
            _marker(fine, tint, shape % MARKERS, centre, size * SUBPIXELS)

    return make_sprites((side, side), tones.background, paint)


def draw_marker(surface: pygame.Surface, shape: int, centre: Point, radius: float, colour: Colour) -> None:
    """Draw a marker around `centre`."""
    half = math.ceil(2 * radius + 4) / 2
    blit_sprite(surface, marker_sprite(shape, radius, colour), centre[0] - half, centre[1] - half)


def _marker(surface: pygame.Surface, colour: Colour, shape: int, centre: Point, radius: float) -> None:
    if shape == 0:
        pygame.draw.circle(surface, colour, centre, radius)
        return
    corners, first, size = CORNERED_MARKERS[shape]
    angles = [math.radians(first + 360 * k / corners) for k in range(corners)]
    corner = [(centre[0] + size * radius * math.cos(a), centre[1] + size * radius * math.sin(a)) for a in angles]
    pygame.draw.polygon(surface, colour, corner)


def draw_arrow(surface: pygame.Surface, colour: Colour, start: Point, length: float, unit: float) -> None:
    """Draw a horizontal arrow from `start`. The arrow points to the right and is `length` pixels long. If `length` is
    negative, it points to the left.
    """
    x, y = start
    if abs(length) < 2.5 * unit:
        return
    head = math.copysign(min(7.0 * unit, 0.6 * abs(length)), length)
    fill_rectangle(surface, colour, (min(x, x + length - head), y - unit, abs(length - head), 2.0 * unit))
    tip, back = x + length, x + length - head
    half = 0.6 * abs(head)
    corners = [(tip, y), (back, y - half), (back, y + half)]
    pygame.draw.polygon(surface, colour, corners)
    pygame.draw.aalines(surface, colour, True, corners)
