"""Sprites of what stands on the ground: bead, draft gear (cylinder and piston) and wall."""

from __future__ import annotations

import math

import pygame
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, MUTED, STEEL, Colour, mix
from softcradle.sandbox.draw.supersampling import SUBPIXELS, Sprites, make_sprites
from softcradle.sandbox.draw.surface_cache import cached_surfaces
from softcradle.sandbox.draw.text import write

GLASS = 212  # opacity of a bead's body: where two overlap, both outlines show and the lens between them darkens
BODY = 0.80  # of a draft gear's length: the cylinder; the rest is its piston
BODY_HEIGHT = 0.66
PLATE = 0.055
Canvas = pygame.Surface


def dark(colour: Colour) -> Colour:
    """Outline of a body of that colour."""
    return mix(colour, (0, 0, 0), 0.35)


@cached_surfaces(24)
def bead(diameter: float, colour: Colour, core: float) -> Sprites:
    """Disc; `core` (0 to 1) is the radius of the dark core that shows the bead's share of the greatest mass."""
    side = math.ceil(diameter)

    def paint(fine: Canvas, shift: float) -> None:
        centre, radius = (diameter / 2 * SUBPIXELS + shift, side / 2 * SUBPIXELS), diameter / 2 * SUBPIXELS
        rim = max(1.0, 0.03 * diameter) * SUBPIXELS
        pygame.draw.circle(fine, dark(colour), centre, radius)
        pygame.draw.circle(fine, (*colour, GLASS), centre, radius - rim)
        if core:
            pygame.draw.circle(fine, (*mix(colour, (0, 0, 0), 0.22), GLASS), centre, core * (radius - rim))

    return make_sprites((side, side), dark(colour), paint)


@cached_surfaces(16)
def cylinder(length: float, height: float, colour: Colour) -> Sprites:
    """The body of a draft gear with its annular head on the right."""
    wide, tall = BODY * length, BODY_HEIGHT * height

    def paint(fine: Canvas, shift: float) -> None:
        body = pygame.Rect(round(shift), 0, round(wide * SUBPIXELS), math.ceil(tall) * SUBPIXELS)
        corner = round(0.10 * tall * SUBPIXELS)
        pygame.draw.rect(fine, dark(colour), body, border_radius=corner)
        rim = max(SUBPIXELS, round(0.03 * height * SUBPIXELS))
        pygame.draw.rect(fine, colour, body.inflate(-2 * rim, -2 * rim), border_radius=corner)
        head = pygame.Rect(body.right - round(0.07 * wide * SUBPIXELS), 0, round(0.07 * wide * SUBPIXELS), body.height)
        pygame.draw.rect(fine, dark(colour), head, border_radius=corner // 2)

    return make_sprites((math.ceil(wide), math.ceil(tall)), dark(colour), paint)


@cached_surfaces(6)
def piston(length: float, height: float) -> Sprites:
    """Rod and plate of a draft gear; its right edge is the plate's face, its left part hides inside the cylinder."""
    wide, tall = 0.5 * length, 0.44 * height

    def paint(fine: Canvas, shift: float) -> None:
        full = math.ceil(tall) * SUBPIXELS
        plate = max(2 * SUBPIXELS, round(PLATE * length * SUBPIXELS))
        rod = pygame.Rect(round(shift), round(0.34 * full), round(wide * SUBPIXELS) - plate, round(0.32 * full))
        pygame.draw.rect(fine, STEEL, rod)
        face = pygame.Rect(rod.right, 0, plate, full)
        pygame.draw.rect(fine, MUTED, face, border_radius=SUBPIXELS)

    return make_sprites((math.ceil(wide), math.ceil(tall)), MUTED, paint)


@cached_surfaces(4)
def wall(length: float, height: float) -> Sprites:
    """Hatched block."""

    def paint(fine: Canvas, shift: float) -> None:
        block = pygame.Rect(round(shift), 0, round(length * SUBPIXELS), round(height * SUBPIXELS))
        fine.fill(mix(FAINT, BACKGROUND, 0.5), block)
        fine.set_clip(block)
        step = max(2 * SUBPIXELS, round(0.16 * height * SUBPIXELS))
        for x in range(block.left - block.height, block.right, step):
            pygame.draw.line(fine, MUTED, (x, block.bottom), (x + block.height, block.top), SUBPIXELS)
        pygame.draw.rect(fine, MUTED, block, round(1.5 * SUBPIXELS))
        fine.set_clip(None)

    return make_sprites((math.ceil(length), math.ceil(height)), MUTED, paint)


@cached_surfaces(4)
def number(label: str, size: float) -> Sprites:
    """The number of a bead, on a square of three times `size` [pixels]; apart from its body, to be on top of all."""
    side = math.ceil(3 * size)

    def paint(fine: Canvas, shift: float) -> None:
        write(
            fine,
            label,
            (side / 2 * SUBPIXELS + shift, side / 2 * SUBPIXELS),
            size * SUBPIXELS,
            BACKGROUND,
            bold=True,
            align=(0.5, 0.5),
        )

    return make_sprites((side, side), BACKGROUND, paint)
