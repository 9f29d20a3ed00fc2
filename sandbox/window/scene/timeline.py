"""The timeline: every frame of the history; every closing and opening of a contact is a tick on it."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.number_format import fixed, time_unit
from softcradle.sandbox.draw.palette import (
    BACKGROUND,
    FAINT,
    FOREGROUND,
    GRID,
    LANE_BACKGROUND,
    MUTED,
    bead_colours,
    mix,
)
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.session.contact_events import ContactEvents
from softcradle.sandbox.session.lane_setup import FRAME_RATE
from softcradle.sandbox.session.session import Session

LEAST_FRAMES = 6 * FRAME_RATE  # that the whole width stands for at first
GROWTH = 1.5  # of the frames that the width stands for, relative to the history
PICTURES_BETWEEN_READINGS = 12  # a fifth of a second: new events are not searched for more often


class Timeline:
    """The bar along the foot of the page.

    Attributes:
        frames: number of frames that the whole width stands for.
        dragged: whether the pointer scrubs.
        events: the contact events that are drawn.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self.rect, self.unit = pygame.Rect(0, 0, 1, 1), 1.0
        self.frames = LEAST_FRAMES
        self.dragged = False
        self.events: ContactEvents | None = None
        self._ticks: pygame.Surface | None = None
        self._seen: tuple[object, int, int] = (None, -1, -1)
        self._last = -1
        self._age = 0  # pictures since the events were last read

    def build(self, rect: pygame.Rect, unit: float) -> None:
        """Take its place."""
        self.rect, self.unit, self._ticks = rect, unit, None

    def x(self, frame: int) -> float:
        """Pixel of a frame."""
        return self.rect.left + (frame - self.session.history.first) / self.frames * self.rect.width

    def frame(self, x: float) -> int:
        """The frame of the history nearest to pixel `x`."""
        history = self.session.history
        wanted = history.first + round((x - self.rect.left) / self.rect.width * self.frames)
        return min(max(wanted, history.first), history.last)

    def handle(self, event: pygame.Event) -> bool:
        """Scrub while the button is down."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.dragged = self.rect.inflate(0, round(10 * self.unit)).collidepoint(event.pos)
            if self.dragged:
                self.session.scrub_frame(self.frame(event.pos[0]))
            return self.dragged
        if event.type == pygame.MOUSEMOTION and self.dragged:
            self.session.scrub_frame(self.frame(event.pos[0]))
            return True
        if event.type == pygame.MOUSEBUTTONUP and self.dragged:
            self.dragged = False
            return True
        return False

    def scrub_to_event(self, direction: int) -> None:
        """Scrub to the next (1) or previous (-1) contact event."""
        frames, shown = self.session.contact_events().frame, self.session.frame
        chosen = frames[frames > shown][:1] if direction > 0 else frames[frames < shown][-1:]
        if len(chosen):
            self.session.scrub_frame(int(chosen[0]))

    def update(self) -> None:
        """Read new events now and then, and make room for more frames."""
        history = self.session.history
        count = history.last - history.first
        if not self.frames / GROWTH**2 <= count <= self.frames:
            self.frames = max(LEAST_FRAMES, round(GROWTH * count))
        self._age += 1
        seen = (history.blocks[-1], history.blocks[-1].revision, self.frames)
        grown = history.last != self._last and self._age > PICTURES_BETWEEN_READINGS
        if self._ticks is None or seen != self._seen or grown:
            self._seen, self._last, self._age = seen, history.last, 0
            self.events = self.session.contact_events()
            self._ticks = self._drawn_ticks(self.events)

    def _drawn_ticks(self, events: ContactEvents) -> pygame.Surface:
        """Ticks on a transparent surface: closings point up from the middle, openings down; one for each pixel."""
        surface = pygame.Surface(self.rect.size, pygame.SRCALPHA, 32)
        colours = bead_colours(max(lane.chain.contacts for lane in self.session.lanes) + 1)
        middle, height = self.rect.height // 2, round(0.42 * self.rect.height)
        drawn: set[tuple[int, bool]] = set()
        columns = (events.frame.tolist(), events.contact.tolist(), events.closed.tolist())
        for frame, contact, closed in zip(*columns, strict=True):
            x = round(self.x(frame) - self.rect.left)
            if (x, closed) in drawn:
                continue
            drawn.add((x, closed))
            colour = colours[min(contact + 1, len(colours) - 1)]
            top = middle - height if closed else middle + 2
            surface.fill(colour, (x - 1, top, max(2, round(2 * self.unit)), height))
        return surface

    def paint(self, surface: pygame.Surface) -> None:
        """Draw it."""
        history, unit, rect = self.session.history, self.unit, self.rect
        radius = round(4 * unit)
        pygame.draw.rect(surface, LANE_BACKGROUND, rect, border_radius=radius)
        computed = pygame.Rect(rect.left, rect.top, round(self.x(history.last)) - rect.left, rect.height)
        pygame.draw.rect(surface, GRID, computed, border_radius=radius)
        x = round(self.x(self.session.frame))
        past = pygame.Rect(rect.left, rect.top, x - rect.left, rect.height)
        pygame.draw.rect(surface, mix(BACKGROUND, FAINT, 0.75), past, border_radius=radius)
        if self._ticks is not None:
            surface.blit(self._ticks, rect)
        if history.first > 0:
            place = (rect.left + 6 * unit, rect.centery)
            write(surface, "older frames are dropped", place, 11 * unit, MUTED, align=(0, 0.5))
        knob = pygame.Rect(0, 0, round(4 * unit), rect.height + round(8 * unit))
        knob.center = (x, rect.centery)
        pygame.draw.rect(surface, FOREGROUND, knob, border_radius=round(2 * unit))

    def paint_reading(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """Draw the time at the pointer."""
        if not (self.rect.collidepoint(point) or self.dragged):
            return
        time = self.session.history.snapshot(self.frame(point[0])).time
        size, name = time_unit(max(self.session.span[1] - self.session.span[0], 1e-9))
        x = min(max(point[0], self.rect.left + 40 * self.unit), self.rect.right - 40 * self.unit)
        text, place = f"{fixed(time / size, 3)} {name}", (x, self.rect.top - 5 * self.unit)
        box = write(surface, text, place, 12 * self.unit, BACKGROUND, align=(0.5, 1))
        pygame.draw.rect(surface, FOREGROUND, box.inflate(12 * self.unit, 4 * self.unit), border_radius=4)
        write(surface, text, place, 12 * self.unit, BACKGROUND, align=(0.5, 1))
