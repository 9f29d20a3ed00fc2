"""Magnified insets of contacts. Each contact has a separate magnification because the overlaps of neighbouring contacts
differ by several powers of ten.
"""

import math
from collections.abc import Mapping

import pygame
from softcradle.sandbox.draw.bead_sprites import BEAD_OPACITY, outline_colour
from softcradle.sandbox.draw.lane_drawing import LaneDrawing
from softcradle.sandbox.draw.palette import Colour, mix, tones
from softcradle.sandbox.draw.supersampling import SUBPIXELS, Sprites, blit_sprite, fill_rectangle, make_sprites
from softcradle.sandbox.draw.surfaces import cached_surfaces
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.languages import _
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.story.bodies import is_gear
from softcradle.sandbox.story.numbers import factor, round_down, scientific, subscript

CAP_RADIUS = 1.5  # Radius of the discs that stand for the two bodies of a contact, relative to the radius of the inset.
GREATEST_DEPTH = 1.05  # Upper limit of the drawn overlap, relative to the radius of the inset.
SMALLEST_RADIUS = 8.0  # Smallest radius of a readable inset [design pixels]. Smaller insets are omitted.
TEXT_ROOM = 100.0  # Width of the space for text next to an inset [design pixels].
# Limits of insets with captions [design pixels]: the largest radius, the largest distance between two insets, and the
# height of the captions.
LARGEST_RADIUS, WIDEST_PITCH, CAPTION = 44.0, 190.0, 58.0
# Limits of insets if insets of full size do not fit [design pixels]. The first number is the width of the space for
# shortened text. The second number is the smallest radius of an inset.
LEAST_TEXT_ROOM, LEAST_RADIUS = 86.0, 20.0


class MagnifiedInsets:
    """Magnified insets of the contacts of one lane.

    If there is not enough space for all contacts, the insets show neighbouring contacts. The first inset shows the
    contact with the largest overlap. The last contact of the lane is always shown, because its overlap is the smallest.

    Arguments:
        rect: rectangle of the insets [pixels].
        unit: pixels per design pixel.
        drawing: the drawing of the lane.
        deepest: (n,) largest overlap of each contact [m].
    """

    def __init__(self, rect: pygame.Rect, unit: float, drawing: LaneDrawing, deepest: tuple[float, ...]) -> None:
        self.rect, self.unit, self.drawing = rect, unit, drawing
        self.radius = max(min(0.5 * rect.height - 7 * unit, 38 * unit), 0.0)
        self.text_room = TEXT_ROOM * unit
        if self._pitch * len(deepest) > rect.width:
            self.text_room = LEAST_TEXT_ROOM * unit
            fitting = (rect.width / len(deepest) - self.text_room - 4 * unit - 4) / 2 - 1
            self.radius = min(self.radius, max(fitting, LEAST_RADIUS * unit))
        self.side, pitch = self._side, self._pitch
        self.shown = _shown(deepest, int(rect.width // pitch)) if self.radius > SMALLEST_RADIUS * unit else ()
        self.pitch = min(rect.width / max(1, len(self.shown)), 1.25 * max(pitch, drawing.bead))
        room, largest = GREATEST_DEPTH * self.radius, max(deepest)
        self.magnify = {k: _magnification(room, drawing.scale * (deepest[k] or largest)) for k in self.shown}

    @property
    def _side(self) -> int:
        """Length [pixels] of the sides of the square around an inset."""
        return 2 * math.ceil(self.radius) + 4

    @property
    def _pitch(self) -> float:
        """Width [pixels] of an inset together with its text."""
        return self._side + self.text_room + 4 * self.unit

    def centre(self, slot: int) -> tuple[float, float]:
        """Return the centre [pixels] of the inset number `slot`, counted from the left."""
        x = self.rect.centerx + (slot - (len(self.shown) - 1) / 2) * self.pitch - 0.5 * self.text_room
        return x, self.rect.centery + 2 * self.unit

    def backdrop(self, surface: pygame.Surface) -> None:
        """Write the names and the magnifications of the insets."""
        size = 13 * self.unit
        for slot, contact in enumerate(self.shown):
            x, y = self.centre(slot)
            left = x + self.radius + 10 * self.unit
            name, magnification = subscript(contact, contact + 1), factor(self.magnify[contact])
            title = _("overlap {name}", name=f"δ{name}")
            fits = width(title, size) <= self.pitch - 2 * self.radius - 10 * self.unit
            write(surface, title if fits else f"δ{name}", (left, y - 30 * self.unit), size, tones.muted)
            seen = _("seen at {times}", times=magnification)
            seen = seen if width(seen, size) <= self.text_room else magnification
            write(surface, seen, (left, y + 9 * self.unit), size, tones.muted)

    def paint(self, surface: pygame.Surface, motion: Motion, row: int, contacts: Array) -> None:
        """Draw the insets for the sample `row` of `motion`. `contacts` (n,) contains the horizontal position of each
        contact in the lane [pixels].
        """
        for slot, contact in enumerate(self.shown):
            x, y = self.centre(slot)
            overlap = float(motion.overlap[row, contact])
            self._leader(surface, float(contacts[contact]), (x, y))
            inset = self._inset(contact, overlap * self.drawing.scale * self.magnify[contact])
            surface.blit(inset, (round(x) - self.side // 2, round(y) - self.side // 2))
            resting = (
                _("pulled") if motion.force[row, contact] < 0.0 else _("apart") if overlap < 0.0 else _("touching")
            )
            depth = f"{scientific(overlap)} m" if overlap > 0.0 else resting
            place = (x + self.radius + 10 * self.unit, y - 13 * self.unit)
            write(
                surface,
                depth,
                place,
                15 * self.unit,
                tones.foreground if overlap > 0.0 else tones.muted,
                bold=overlap > 0.0,
            )

    def _leader(self, surface: pygame.Surface, contact: float, centre: tuple[float, float]) -> None:
        """Draw a thin line from a contact on the ground to the top of the inset of this contact."""
        start = (min(max(contact, self.rect.left), self.rect.right), self.drawing.ground + 2)
        pygame.draw.aaline(surface, tones.faint, start, (centre[0], centre[1] - self.radius))

    def _inset(self, contact: int, depth: float) -> pygame.Surface:
        """Draw an inset in which the two bodies overlap by `depth` pixels. If `depth` is negative, the bodies are
        apart.
        """
        inset = pygame.Surface((self.side, self.side), 0, 32)
        inset.fill(tones.background)
        depth = max(depth, -1.1 * self.radius)
        colours = self.drawing.colours[contact], self.drawing.colours[contact + 1]
        if is_gear(self.drawing.chain.contact[contact]):
            self._gear(inset, colours, depth)
        else:
            self._caps(inset, colours, depth)
        inset.blit(_frame(self.side, self.radius), (0, 0))
        return inset

    def _caps(self, inset: pygame.Surface, colours: tuple[Colour, Colour], depth: float) -> None:
        middle, radius = self.side / 2, CAP_RADIUS * self.radius
        y = middle - math.ceil(radius)
        blit_sprite(inset, _cap(radius, colours[0]), middle + depth / 2 - 2 * radius, y)
        blit_sprite(inset, _cap(radius, colours[1]), middle - depth / 2, y)

    def _gear(self, inset: pygame.Surface, colours: tuple[Colour, Colour], depth: float) -> None:
        """Draw the cylinder head, the piston and the opposite face of a draft gear. A dashed line marks the position of
        the piston face at zero overlap.
        """
        middle, r = self.side / 2, self.radius
        head, face = middle - 0.75 * r, middle + 0.45 * r
        pushed = face - max(depth, 0.0)
        fill_rectangle(inset, tones.steel, (head, middle - 0.22 * r, pushed - head, 0.44 * r))
        fill_rectangle(inset, tones.muted, (pushed - 0.16 * r, middle - 0.5 * r, 0.16 * r, r))
        fill_rectangle(inset, colours[0], (0, middle - 0.8 * r, head, 1.6 * r))
        fill_rectangle(inset, outline_colour(colours[0]), (head - 0.2 * r, middle - 0.8 * r, 0.2 * r, 1.6 * r))
        other = face - depth
        fill_rectangle(inset, outline_colour(colours[1]), (other, middle - 0.8 * r, 2.0, 1.6 * r))
        fill_rectangle(inset, colours[1], (other + 2.0, middle - 0.8 * r, self.side - other, 1.6 * r))
        for k in range(-4, 5, 2):
            fill_rectangle(inset, tones.foreground, (face - 0.5, middle + (k - 0.5) * 0.1 * r, 1.0, 0.1 * r))


class CaptionedInsets(MagnifiedInsets):
    """Magnified insets with captions below them. The insets show chosen contacts at one moment.

    Arguments:
        rect: rectangle of the insets and their captions [pixels].
        unit: pixels per design pixel.
        drawing: the drawing of the lane.
        overlaps: overlap [m] of each contact that is shown.
        captions: two lines of text for each of these contacts.
        leaders: True if a line connects each contact with its inset.
    """

    def __init__(
        self,
        rect: pygame.Rect,
        unit: float,
        drawing: LaneDrawing,
        overlaps: Mapping[int, float],
        captions: Mapping[int, tuple[str, str]],
        leaders: bool,
    ) -> None:
        self.rect, self.unit, self.drawing = rect, unit, drawing
        self.captions, self.leaders = captions, leaders
        self.shown = tuple(sorted(overlaps))
        self.pitch = min(rect.width / len(self.shown), WIDEST_PITCH * unit)
        room = min(rect.height - CAPTION * unit, self.pitch - 8 * unit)
        self.radius = min(max(0.5 * room - 3.0, SMALLEST_RADIUS * unit), LARGEST_RADIUS * unit)
        self.side, self.text_room = self._side, 0.0
        depth, largest = GREATEST_DEPTH * self.radius, max(overlaps.values())
        self.magnify = {k: _magnification(depth, drawing.scale * (overlaps[k] or largest)) for k in self.shown}

    def centre(self, slot: int) -> tuple[float, float]:
        """Return the centre [pixels] of the inset number `slot`, counted from the left."""
        x = self.rect.centerx + (slot - (len(self.shown) - 1) / 2) * self.pitch
        return x, self.rect.top + self.radius + 2.0

    def backdrop(self, surface: pygame.Surface) -> None:
        """Write the captions and the magnifications of the insets."""
        for slot, contact in enumerate(self.shown):
            (x, y), (first, second) = self.centre(slot), self.captions[contact]
            top = y + self.radius + 4 * self.unit
            write(surface, first, (x, top), 16 * self.unit, bold=True, align=(0.5, 0))
            write(surface, second, (x, top + 19 * self.unit), 13 * self.unit, align=(0.5, 0))
            magnification = factor(self.magnify[contact])
            write(surface, magnification, (x, top + 36 * self.unit), 13 * self.unit, tones.muted, align=(0.5, 0))

    def paint(self, surface: pygame.Surface, motion: Motion, row: int, contacts: Array) -> None:
        """Draw the insets for the sample `row` of `motion`. See :meth:`MagnifiedInsets.paint`."""
        for slot, contact in enumerate(self.shown):
            x, y = self.centre(slot)
            if self.leaders:
                self._leader(surface, float(contacts[contact]), (x, y))
            inset = self._inset(
                contact, float(motion.overlap[row, contact]) * self.drawing.scale * self.magnify[contact]
            )
            surface.blit(inset, (round(x) - self.side // 2, round(y) - self.side // 2))


def _shown(deepest: tuple[float, ...], room: int) -> tuple[int, ...]:
    """Return the contacts that have an inset. There is space for `room` insets.

    The contacts are neighbours. The first of the chosen contacts has the largest overlap. If the last contact of the
    lane is missing, it replaces the last of the chosen contacts.
    """
    last = len(deepest) - 1
    first = max(0, min(deepest.index(max(deepest)), len(deepest) - room))
    shown = tuple(range(first, min(len(deepest), first + room)))
    return shown if not shown or shown[-1] == last or room < 2 else (*shown[:-1], last)


def _magnification(room: float, deepest: float) -> float:
    """Return the round magnification that draws an overlap of `deepest` pixels about `room` pixels wide."""
    return round_down(room / deepest) if deepest > 0.0 else 1.0


@cached_surfaces(4)
def _cap(radius: float, colour: Colour) -> Sprites:
    """Draw the body on one side of a contact as the edge of a large disc."""
    side = math.ceil(2 * radius)

    def paint(fine: pygame.Surface, shift: float) -> None:
        centre = (radius * SUBPIXELS + shift, side / 2 * SUBPIXELS)
        pygame.draw.circle(fine, outline_colour(colour), centre, radius * SUBPIXELS)
        pygame.draw.circle(fine, (*colour, BEAD_OPACITY), centre, radius * SUBPIXELS - 1.5 * SUBPIXELS)

    return make_sprites((side, side), outline_colour(colour), paint)


@cached_surfaces(4)
def _frame(side: int, radius: float) -> pygame.Surface:
    """Draw the background of an inset with a round hole, and a ring around the hole."""
    size = (side * SUBPIXELS, side * SUBPIXELS)
    centre, colour = (side / 2 * SUBPIXELS, side / 2 * SUBPIXELS), mix(tones.faint, tones.muted, 0.4)
    frame = pygame.Surface(size, pygame.SRCALPHA, 32)
    frame.fill((*tones.background, 255))
    pygame.draw.circle(frame, (*tones.grid, 0), centre, radius * SUBPIXELS)
    ring = pygame.Surface(size, pygame.SRCALPHA, 32)
    ring.fill((*colour, 0))
    pygame.draw.circle(ring, (*colour, 255), centre, (radius + 0.5) * SUBPIXELS, round(1.5 * SUBPIXELS))
    frame.blit(ring, (0, 0))
    return pygame.transform.smoothscale(frame, (side, side))
