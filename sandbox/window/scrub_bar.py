"""The scrub bar along the foot of a page: every frame of a history; a drag on it shows earlier ones."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.number_format import fixed, time_unit
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.languages import _
from softcradle.sandbox.window.page_geometry import MARGIN

GROWTH = 1.5  # of the frames that the width stands for, relative to the history


class ScrubBar:
    """A bar over the frames of a history; what it is made from says which these are.

    Attributes:
        frames: number of frames that the whole width stands for.
        dragged: whether the pointer scrubs.
    """

    def __init__(self, least_frames: int) -> None:
        self.rect, self.unit = pygame.Rect(0, 0, 1, 1), 1.0
        self.frames = self.least_frames = least_frames
        self.dragged = False

    @property
    def bounds(self) -> tuple[int, int]:
        """First and last frame of the history."""
        raise NotImplementedError

    @property
    def shown(self) -> int:
        """The frame that is shown."""
        raise NotImplementedError

    def scrub(self, frame: int) -> None:
        """Show that frame."""
        raise NotImplementedError

    def time_of(self, frame: int) -> float:
        """Time of a frame of the history [s]."""
        raise NotImplementedError

    def place(self, footer: pygame.Rect, unit: float) -> None:
        """Take the place at the top of the `footer` of a page."""
        margin = 2 * round((MARGIN - 2.0) * unit)
        self.build(
            pygame.Rect(
                footer.left + margin, footer.top + round(12 * unit), footer.width - 2 * margin, round(22 * unit)
            ),
            unit,
        )

    def build(self, rect: pygame.Rect, unit: float) -> None:
        """Take its place."""
        self.rect, self.unit = rect, unit

    def x(self, frame: int) -> float:
        """Pixel of a frame."""
        return self.rect.left + (frame - self.bounds[0]) / self.frames * self.rect.width

    def frame(self, x: float) -> int:
        """The frame of the history nearest to pixel `x`."""
        first, last = self.bounds
        return min(max(first + round((x - self.rect.left) / self.rect.width * self.frames), first), last)

    def handle(self, event: pygame.Event) -> bool:
        """Scrub while the button is down."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.dragged = self.rect.inflate(0, round(10 * self.unit)).collidepoint(event.pos)
            if self.dragged:
                self.scrub(self.frame(event.pos[0]))
            return self.dragged
        if event.type == pygame.MOUSEMOTION and self.dragged:
            self.scrub(self.frame(event.pos[0]))
            return True
        if event.type == pygame.MOUSEBUTTONUP and self.dragged:
            self.dragged = False
            return True
        return False

    def make_room(self) -> None:
        """Let the width stand for more frames, or fewer, where the history needs it."""
        first, last = self.bounds
        if not self.frames / GROWTH**2 <= last - first <= self.frames:
            self.frames = max(self.least_frames, round(GROWTH * (last - first)))

    def paint(self, surface: pygame.Surface) -> None:
        """Draw it."""
        (first, last), unit, rect = self.bounds, self.unit, self.rect
        radius = round(4 * unit)
        pygame.draw.rect(surface, tones.lane_background, rect, border_radius=radius)
        computed = pygame.Rect(rect.left, rect.top, round(self.x(last)) - rect.left, rect.height)
        pygame.draw.rect(surface, tones.grid, computed, border_radius=radius)
        x = round(self.x(self.shown))
        past = pygame.Rect(rect.left, rect.top, x - rect.left, rect.height)
        pygame.draw.rect(surface, mix(tones.background, tones.faint, 0.75), past, border_radius=radius)
        self.paint_marks(surface)
        if first > 0:
            place = (rect.left + 6 * unit, rect.centery)
            write(surface, _("older frames are dropped"), place, 11 * unit, tones.muted, align=(0, 0.5))
        knob = pygame.Rect(0, 0, round(4 * unit), rect.height + round(8 * unit))
        knob.center = (x, rect.centery)
        pygame.draw.rect(surface, tones.foreground, knob, border_radius=round(2 * unit))

    def paint_marks(self, surface: pygame.Surface) -> None:
        """Draw what is marked on it."""

    def paint_reading(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """Draw the time at the pointer."""
        if not (self.rect.collidepoint(point) or self.dragged):
            return
        first, last = self.bounds
        size, name = time_unit(max(self.time_of(last) - self.time_of(first), 1e-9))
        x = min(max(point[0], self.rect.left + 40 * self.unit), self.rect.right - 40 * self.unit)
        text = f"{fixed(self.time_of(self.frame(point[0])) / size, 3)} {name}"
        place = (x, self.rect.top - 5 * self.unit)
        box = write(surface, text, place, 12 * self.unit, tones.background, align=(0.5, 1))
        pygame.draw.rect(surface, tones.foreground, box.inflate(12 * self.unit, 4 * self.unit), border_radius=4)
        write(surface, text, place, 12 * self.unit, tones.background, align=(0.5, 1))
