"""MagnifiedInsets: every contact under its own magnification, so that overlaps which fall by decades are seen side by side."""

from __future__ import annotations

import math

import pygame
from softcradle.sandbox.draw.bead_sprites import GLASS, dark
from softcradle.sandbox.draw.lane_drawing import LaneDrawing, is_gear
from softcradle.sandbox.draw.number_format import factor, round_down, scientific, subscript
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND, GRID, MUTED, STEEL, Colour, mix
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.draw.supersampling import SUBPIXELS, Sprites, blit_sprite, fill_rectangle, make_sprites
from softcradle.sandbox.draw.surface_cache import cached_surfaces
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.motion import Array, Motion

CURVE = 1.5  # radius of the caps in radii of the loupe
DEEPEST = 1.05  # radii of the loupe that the greatest overlap fills at most
TEXT_ROOM = 100.0  # design pixels beside a loupe


class MagnifiedInsets:
    """The loupes of one lane, as many as find room, counted from the contact that is pressed deepest."""

    def __init__(
        self, rect: pygame.Rect, unit: float, stage: LaneDrawing, deepest: tuple[float, ...], scales: Scales
    ) -> None:
        self.rect, self.unit, self.stage = rect, unit, stage
        self.radius = max(min(0.5 * rect.height - 7 * unit, 38 * unit), 0.0)
        self.side = 2 * math.ceil(self.radius) + 4
        pitch = self.side + (TEXT_ROOM + 4) * unit
        self.shown = _shown(deepest, int(rect.width // pitch)) if self.radius > 8 * unit else range(0)
        self.pitch = min(rect.width / max(1, len(self.shown)), 1.25 * max(pitch, stage.bead))
        largest = max(deepest)
        self.magnify = {k: _magnify(DEEPEST * self.radius, stage.scale * (deepest[k] or largest)) for k in self.shown}

    def centre(self, slot: int) -> tuple[float, float]:
        """Middle of the loupe in place `slot`, counted from the left."""
        x = self.rect.centerx + (slot - (len(self.shown) - 1) / 2) * self.pitch - 0.5 * TEXT_ROOM * self.unit
        return x, self.rect.centery + 2 * self.unit

    def backdrop(self, surface: pygame.Surface) -> None:
        """Magnifications and names."""
        for slot, contact in enumerate(self.shown):
            x, y = self.centre(slot)
            place = x + self.radius + 10 * self.unit
            write(
                surface,
                f"overlap δ{subscript(contact, contact + 1)}",
                (place, y - 30 * self.unit),
                13 * self.unit,
                MUTED,
            )
            text = factor(self.magnify[contact])
            write(surface, f"seen at {text}", (place, y + 9 * self.unit), 13 * self.unit, MUTED)

    def paint(self, surface: pygame.Surface, track: Motion, row: int, contacts: Array) -> None:
        """Draw the loupes for row `row` of `track`; `contacts` says where on the stage each looks [pixels]."""
        for slot, contact in enumerate(self.shown):
            x, y = self.centre(slot)
            overlap = float(track.overlap[row, contact])
            self._pointer(surface, float(contacts[contact]), (x, y))
            glass = self._glass(contact, overlap * self.stage.scale * self.magnify[contact])
            surface.blit(glass, (round(x) - self.side // 2, round(y) - self.side // 2))
            depth = f"{scientific(overlap)} m" if overlap > 0.0 else "apart" if overlap < 0.0 else "touching"
            place = (x + self.radius + 10 * self.unit, y - 13 * self.unit)
            write(surface, depth, place, 15 * self.unit, FOREGROUND if overlap > 0.0 else MUTED, bold=overlap > 0.0)

    def _pointer(self, surface: pygame.Surface, contact: float, centre: tuple[float, float]) -> None:
        """Thin line from the contact on the ground to the top of its loupe."""
        start = (min(max(contact, self.rect.left), self.rect.right), self.stage.ground + 2)
        pygame.draw.aaline(surface, FAINT, start, (centre[0], centre[1] - self.radius))

    def _glass(self, contact: int, depth: float) -> pygame.Surface:
        """What the loupe shows of an overlap `depth` [its own pixels]; apart where negative."""
        glass = pygame.Surface((self.side, self.side), 0, 32)
        glass.fill(BACKGROUND)
        depth = max(depth, -1.1 * self.radius)
        colours = self.stage.colours[contact], self.stage.colours[contact + 1]
        if is_gear(self.stage.chain.contact[contact]):
            self._gear(glass, colours, depth)
        else:
            self._caps(glass, colours, depth)
        glass.blit(_frame(self.side, self.radius), (0, 0))
        return glass

    def _caps(self, glass: pygame.Surface, colours: tuple[Colour, Colour], depth: float) -> None:
        middle, radius = self.side / 2, CURVE * self.radius
        y = middle - math.ceil(radius)
        blit_sprite(glass, cap(radius, colours[0]), middle + depth / 2 - 2 * radius, y)
        blit_sprite(glass, cap(radius, colours[1]), middle - depth / 2, y)

    def _gear(self, glass: pygame.Surface, colours: tuple[Colour, Colour], depth: float) -> None:
        """Cylinder head, piston and the face it meets; the dashes show where the piston's face rests."""
        middle, r = self.side / 2, self.radius
        head, face = middle - 0.75 * r, middle + 0.45 * r
        pushed = face - max(depth, 0.0)
        fill_rectangle(glass, STEEL, (head, middle - 0.22 * r, pushed - head, 0.44 * r))
        fill_rectangle(glass, MUTED, (pushed - 0.16 * r, middle - 0.5 * r, 0.16 * r, r))
        fill_rectangle(glass, colours[0], (0, middle - 0.8 * r, head, 1.6 * r))
        fill_rectangle(glass, dark(colours[0]), (head - 0.2 * r, middle - 0.8 * r, 0.2 * r, 1.6 * r))
        other = face - depth
        fill_rectangle(glass, dark(colours[1]), (other, middle - 0.8 * r, 2.0, 1.6 * r))
        fill_rectangle(glass, colours[1], (other + 2.0, middle - 0.8 * r, self.side - other, 1.6 * r))
        for k in range(-4, 5, 2):
            fill_rectangle(glass, FOREGROUND, (face - 0.5, middle + (k - 0.5) * 0.1 * r, 1.0, 0.1 * r))


def _shown(deepest: tuple[float, ...], room: int) -> range:
    """The contacts that get one of `room` loupes: neighbours, from the deepest one on."""
    first = max(0, min(deepest.index(max(deepest)), len(deepest) - room))
    return range(first, min(len(deepest), first + room))


def _magnify(room: float, deepest: float) -> float:
    return round_down(room / deepest) if deepest > 0.0 else 1.0


@cached_surfaces(4)
def cap(radius: float, colour: Colour) -> Sprites:
    """One side of a contact: a piece of a large disc."""
    side = math.ceil(2 * radius)

    def paint(fine: pygame.Surface, shift: float) -> None:
        centre = (radius * SUBPIXELS + shift, side / 2 * SUBPIXELS)
        pygame.draw.circle(fine, dark(colour), centre, radius * SUBPIXELS)
        pygame.draw.circle(fine, (*colour, GLASS), centre, radius * SUBPIXELS - 1.5 * SUBPIXELS)

    return make_sprites((side, side), dark(colour), paint)


@cached_surfaces(4)
def _frame(side: int, radius: float) -> pygame.Surface:
    """Paper with a round hole and a ring about it."""
    fine = pygame.Surface((side * SUBPIXELS, side * SUBPIXELS), pygame.SRCALPHA, 32)
    fine.fill((*mix(FAINT, MUTED, 0.4), 255))
    centre = (side / 2 * SUBPIXELS, side / 2 * SUBPIXELS)
    outside = pygame.Surface(fine.get_size(), pygame.SRCALPHA, 32)
    outside.fill((*BACKGROUND, 255))
    pygame.draw.circle(outside, (*GRID, 0), centre, radius * SUBPIXELS)
    ring = mix(FAINT, MUTED, 0.4)
    fine.fill((*ring, 0))
    pygame.draw.circle(fine, (*ring, 255), centre, (radius + 0.5) * SUBPIXELS, round(1.5 * SUBPIXELS))
    outside.blit(fine, (0, 0))
    return pygame.transform.smoothscale(outside, (side, side))
