"""The timeline along the foot of the page: a drag shows earlier frames; every closing and opening of a contact is a tick."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.number_format import fixed, time_unit
from softcradle.sandbox.draw.palette import bead_colours, mix, tones
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.languages import _
from softcradle.sandbox.session.contact_events import ContactEvents
from softcradle.sandbox.session.lane_setup import FRAME_RATE
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.page_geometry import MARGIN

GROWTH = 1.5  # of the frames that the width stands for, relative to the history
LEAST_FRAMES = 6 * FRAME_RATE  # that the whole width stands for at first
PICTURES_BETWEEN_READINGS = 12  # a fifth of a second: new events are not searched for more often


class Timeline:
    """A bar over the frames of a session's history.

    Attributes:
        frames: number of frames that the whole width stands for.
        dragged: whether the pointer scrubs.
        events: the contact events that are drawn.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self.rect, self.unit = pygame.Rect(0, 0, 1, 1), 1.0
        self.frames, self.dragged = LEAST_FRAMES, False
        self.events: ContactEvents | None = None
        self._ticks: pygame.Surface | None = None
        self._seen: tuple[object, int] = (None, -1)
        self._last = -1
        self._age = 0  # pictures since the events were last read

    @property
    def bounds(self) -> tuple[int, int]:
        """First and last frame of the history."""
        return self.session.history.first, self.session.history.last

    def place(self, footer: pygame.Rect, unit: float) -> None:
        """Take the place at the top of the `footer` of a page."""
        margin = 2 * round((MARGIN - 2.0) * unit)
        self.rect = footer.inflate(-2 * margin, 0)
        self.rect.top, self.rect.height = footer.top + round(12 * unit), round(22 * unit)
        self.unit, self._ticks = unit, None

    def _time(self, frame: int) -> float:
        return self.session.history.snapshot(frame).time

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
                self.session.scrub_frame(self.frame(event.pos[0]))
            return self.dragged
        if event.type == pygame.MOUSEMOTION and self.dragged:
            self.session.scrub_frame(self.frame(event.pos[0]))
            return True
        if event.type == pygame.MOUSEBUTTONUP and self.dragged:
            self.dragged = False
            return True
        return False

    def make_room(self) -> None:
        """Let the width stand for more frames, or fewer, where the history needs it."""
        first, last = self.bounds
        if not self.frames / GROWTH**2 <= last - first <= self.frames:
            self.frames = max(LEAST_FRAMES, round(GROWTH * (last - first)))

    def scrub_to_event(self, direction: int) -> None:
        """Scrub to the next (1) or previous (-1) contact event."""
        frames, shown = self.session.contact_events().frame, self.session.frame
        chosen = frames[frames > shown][:1] if direction > 0 else frames[frames < shown][-1:]
        if len(chosen):
            self.session.scrub_frame(int(chosen[0]))

    def update(self) -> None:
        """Read new events now and then, and make room for more frames."""
        history = self.session.history
        self.make_room()
        self._age += 1
        seen = (history.branch, self.frames)
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
        (first, last), unit, rect = self.bounds, self.unit, self.rect
        radius = round(4 * unit)
        pygame.draw.rect(surface, tones.lane_background, rect, border_radius=radius)
        computed = pygame.Rect(rect.left, rect.top, round(self.x(last)) - rect.left, rect.height)
        pygame.draw.rect(surface, tones.grid, computed, border_radius=radius)
        x = round(self.x(self.session.frame))
        past = pygame.Rect(rect.left, rect.top, x - rect.left, rect.height)
        pygame.draw.rect(surface, mix(tones.background, tones.faint, 0.75), past, border_radius=radius)
        if self._ticks is not None:
            surface.blit(self._ticks, self.rect)
        if first > 0:
            place = (rect.left + 6 * unit, rect.centery)
            write(surface, _("older frames are dropped"), place, 13 * unit, tones.muted, align=(0, 0.5))
        knob = pygame.Rect(0, 0, round(4 * unit), rect.height + round(8 * unit))
        knob.center = (x, rect.centery)
        pygame.draw.rect(surface, tones.foreground, knob, border_radius=round(2 * unit))

    def paint_reading(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """Draw the time at the pointer."""
        if not (self.rect.collidepoint(point) or self.dragged):
            return
        first, last = self.bounds
        size, name = time_unit(max(self._time(last) - self._time(first), 1e-9))
        x = min(max(point[0], self.rect.left + 40 * self.unit), self.rect.right - 40 * self.unit)
        text = f"{fixed(self._time(self.frame(point[0])) / size, 3)} {name}"
        place = (x, self.rect.top - 5 * self.unit)
        box = write(surface, text, place, 13 * self.unit, tones.background, align=(0.5, 1))
        pygame.draw.rect(surface, tones.foreground, box.inflate(12 * self.unit, 4 * self.unit), border_radius=4)
        write(surface, text, place, 13 * self.unit, tones.background, align=(0.5, 1))
