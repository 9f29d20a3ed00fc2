"""The timeline: the scrub bar of a session; every closing and opening of a contact is a tick on it."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.palette import bead_colours
from softcradle.sandbox.session.contact_events import ContactEvents
from softcradle.sandbox.session.lane_setup import FRAME_RATE
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.scrub_bar import ScrubBar

LEAST_FRAMES = 6 * FRAME_RATE  # that the whole width stands for at first
PICTURES_BETWEEN_READINGS = 12  # a fifth of a second: new events are not searched for more often


class Timeline(ScrubBar):
    """The bar along the foot of the page.

    Attributes:
        events: the contact events that are drawn.
    """

    def __init__(self, session: Session) -> None:
        super().__init__(LEAST_FRAMES)
        self.session = session
        self.events: ContactEvents | None = None
        self._ticks: pygame.Surface | None = None
        self._seen: tuple[object, int, int] = (None, -1, -1)
        self._last = -1
        self._age = 0  # pictures since the events were last read

    @property
    def bounds(self) -> tuple[int, int]:
        """See `ScrubBar.bounds`."""
        return self.session.history.first, self.session.history.last

    @property
    def shown(self) -> int:
        """See `ScrubBar.shown`."""
        return self.session.frame

    def scrub(self, frame: int) -> None:
        """See `ScrubBar.scrub`."""
        self.session.scrub_frame(frame)

    def time_of(self, frame: int) -> float:
        """See `ScrubBar.time_of`."""
        return self.session.history.snapshot(frame).time

    def build(self, rect: pygame.Rect, unit: float) -> None:
        """Take its place."""
        super().build(rect, unit)
        self._ticks = None

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

    def paint_marks(self, surface: pygame.Surface) -> None:
        """Draw the ticks."""
        if self._ticks is not None:
            surface.blit(self._ticks, self.rect)
