"""Sprites of bodies: a bead, a draft gear with cylinder and piston, a wagon and a wall. The number on a bead has a
sprite as well.
"""

import math

import pygame
from softcradle.sandbox.draw.bodies import CYLINDER_HEIGHT, CYLINDER_LENGTH
from softcradle.sandbox.draw.palette import Colour, mix, tones
from softcradle.sandbox.draw.supersampling import SUBPIXELS, Sprites, make_sprites
from softcradle.sandbox.draw.surfaces import cached_surfaces
from softcradle.sandbox.draw.text import write

# Opacity of a bead in a magnified inset, from 0 to 255. If two beads overlap, both outlines remain visible. The overlap
# is a darker lens between the beads.
BEAD_OPACITY = 212
# Settings of the shading of a ball: the number of discs, the share of black at the rim, and the share of white at the
# highlight.
SHADES, SHADOW, HIGHLIGHT = 18, 0.2, 0.3
# Position of the highlight of a ball relative to the centre of the ball, as a fraction of the radius.
LIGHT = (-0.28, -0.34)
PLATE_LENGTH = 0.055  # Thickness of the plate at the end of a piston, as a fraction of the length of the draft gear.


def outline_colour(colour: Colour) -> Colour:
    """Return the colour of the outline of a body that is filled with `colour`."""
    return mix(colour, (0, 0, 0), 0.35)


@cached_surfaces(24)
def bead_sprite(diameter: float, colour: Colour, core: float) -> Sprites:
    """Draw a shaded ball with a dark core. The size of the core shows the mass of the bead.

    `core` is the radius of the core, relative to the radius of the ball (0 to 1).
    """
    side = math.ceil(diameter)

    def paint(fine: pygame.Surface, shift: float) -> None:
        centre, radius = (diameter / 2 * SUBPIXELS + shift, side / 2 * SUBPIXELS), diameter / 2 * SUBPIXELS
        rim = max(1.0, 0.03 * diameter) * SUBPIXELS
        pygame.draw.circle(fine, outline_colour(colour), centre, radius)
        _shaded_disc(fine, colour, centre, radius - rim)
        if core:
            _shaded_disc(fine, mix(colour, (0, 0, 0), 0.22), centre, core * (radius - rim))

    return make_sprites((side, side), outline_colour(colour), paint)


def _shaded_disc(fine: pygame.Surface, colour: Colour, centre: tuple[float, float], radius: float) -> None:
    """Draw a disc that looks like an illuminated ball. The disc is dark at its rim and bright at its highlight."""
    for k in range(SHADES):
        share = k / (SHADES - 1)
        if share < 0.4:
            tint = mix(colour, (0, 0, 0), SHADOW * (1.0 - share / 0.4) ** 2)
        else:
            tint = mix(colour, (255, 255, 255), HIGHLIGHT * (share - 0.4) / 0.6)
        place = centre[0] + 0.9 * share * LIGHT[0] * radius, centre[1] + 0.9 * share * LIGHT[1] * radius
        pygame.draw.circle(fine, tint, place, (1.0 - 0.85 * share) * radius)


# Heights of the floor and of the hood of a locomotive, and the radius of a wheel. All three are fractions of the height
# of a wagon.
FLOOR, HOOD, WHEEL = 0.80, 0.36, 0.15


@cached_surfaces(16)
def wagon_sprite(length: float, height: float, colour: Colour, locomotive: bool) -> Sprites:
    """Draw a wagon with wheels, or a locomotive with a cab."""
    wide, tall = CYLINDER_LENGTH * length, CYLINDER_HEIGHT * height
    dark = mix(colour, (0, 0, 0), 0.6)

    def paint(fine: pygame.Surface, shift: float) -> None:
        across, high = wide * SUBPIXELS, tall * SUBPIXELS
        corner, rim = round(0.08 * high), max(SUBPIXELS, round(0.03 * height * SUBPIXELS))
        for x in (0.2, 0.8) if not locomotive else (0.17, 0.5, 0.83):
            place = shift + x * across, (1.0 - WHEEL) * high
            pygame.draw.circle(fine, dark, place, WHEEL * high)
            pygame.draw.circle(fine, mix(dark, (255, 255, 255), 0.45), place, 0.45 * WHEEL * high)
        tops = ((0.0, 1.0, 0.0),) if not locomotive else ((0.0, 0.42, 0.0), (0.3, 1.0, HOOD))
        for left, right, top in tops:
            box = shift + left * across, top * high, (right - left) * across, (FLOOR - top) * high
            body = pygame.Rect(*map(round, box))
            pygame.draw.rect(fine, outline_colour(colour), body, border_radius=corner)
            inner = body.inflate(-2 * rim, -2 * rim)
            pygame.draw.rect(fine, colour, inner, border_radius=corner)
            light = pygame.Rect(inner.left, inner.top, inner.width, max(1, round(0.18 * high)))
            pygame.draw.rect(fine, mix(colour, (255, 255, 255), 0.3), light, border_radius=corner)
        if locomotive:
            window = pygame.Rect(*map(round, (shift + 0.09 * across, 0.14 * high, 0.22 * across, 0.24 * high)))
            pygame.draw.rect(fine, mix(tones.background, colour, 0.15), window, border_radius=corner // 2)
            funnel = pygame.Rect(*map(round, (shift + 0.78 * across, 0.14 * high, 0.09 * across, 0.28 * high)))
            pygame.draw.rect(fine, outline_colour(colour), funnel)

    return make_sprites((math.ceil(wide), math.ceil(tall)), outline_colour(colour), paint)


@cached_surfaces(16)
def cylinder_sprite(length: float, height: float, colour: Colour) -> Sprites:
    """Draw the cylinder of a draft gear. The head of the cylinder is a ring on the right."""
    wide, tall = CYLINDER_LENGTH * length, CYLINDER_HEIGHT * height

    def paint(fine: pygame.Surface, shift: float) -> None:
        body = pygame.Rect(round(shift), 0, round(wide * SUBPIXELS), math.ceil(tall) * SUBPIXELS)
        corner = round(0.10 * tall * SUBPIXELS)
        pygame.draw.rect(fine, outline_colour(colour), body, border_radius=corner)
        rim = max(SUBPIXELS, round(0.03 * height * SUBPIXELS))
        pygame.draw.rect(fine, colour, body.inflate(-2 * rim, -2 * rim), border_radius=corner)
        head = pygame.Rect(body.right - round(0.07 * wide * SUBPIXELS), 0, round(0.07 * wide * SUBPIXELS), body.height)
        pygame.draw.rect(fine, outline_colour(colour), head, border_radius=corner // 2)

    return make_sprites((math.ceil(wide), math.ceil(tall)), outline_colour(colour), paint)


@cached_surfaces(6)
def piston_sprite(length: float, height: float) -> Sprites:
    """Draw the piston of a draft gear, which consists of a rod and a plate. The plate is at the right edge. The
    cylinder is drawn later and covers the left part.
    """
    wide, tall = 0.5 * length, 0.44 * height

    def paint(fine: pygame.Surface, shift: float) -> None:
        full = math.ceil(tall) * SUBPIXELS
        plate = max(2 * SUBPIXELS, round(PLATE_LENGTH * length * SUBPIXELS))
        rod = pygame.Rect(round(shift), round(0.34 * full), round(wide * SUBPIXELS) - plate, round(0.32 * full))
        pygame.draw.rect(fine, tones.steel, rod)
        face = pygame.Rect(rod.right, 0, plate, full)
        pygame.draw.rect(fine, tones.muted, face, border_radius=SUBPIXELS)

    return make_sprites((math.ceil(wide), math.ceil(tall)), tones.muted, paint)


@cached_surfaces(4)
def wall_sprite(length: float, height: float) -> Sprites:
    """Draw a wall as a hatched block."""

    def paint(fine: pygame.Surface, shift: float) -> None:
        block = pygame.Rect(round(shift), 0, round(length * SUBPIXELS), round(height * SUBPIXELS))
        fine.fill(mix(tones.faint, tones.background, 0.5), block)
        fine.set_clip(block)
        step = max(2 * SUBPIXELS, round(0.16 * height * SUBPIXELS))
        for x in range(block.left - block.height, block.right, step):
            pygame.draw.line(fine, tones.muted, (x, block.bottom), (x + block.height, block.top), SUBPIXELS)
        pygame.draw.rect(fine, tones.muted, block, round(1.5 * SUBPIXELS))
        fine.set_clip(None)

    return make_sprites((math.ceil(length), math.ceil(height)), tones.muted, paint)


@cached_surfaces(4)
def number_sprite(label: str, size: float, colour: Colour) -> Sprites:
    """Draw the number of a bead on a transparent square with sides of 3 * `size` pixels.

    Numbers have separate sprites because they are drawn after all bodies.
    """
    side = math.ceil(3 * size)

    def paint(fine: pygame.Surface, shift: float) -> None:
        write(
            fine,
            label,
            (side / 2 * SUBPIXELS + shift, side / 2 * SUBPIXELS),
            size * SUBPIXELS,
            colour,
            bold=True,
            align=(0.5, 0.5),
        )

    return make_sprites((side, side), colour, paint)
