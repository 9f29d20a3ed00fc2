"""The timeline: everything that is remembered, frame by frame; every closing and opening of a contact is a mark."""

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
from softcradle.sandbox.session.contact_events import Marks
from softcradle.sandbox.session.lane_setup import FRAME_RATE
from softcradle.sandbox.session.session import Session

LEAST_FRAMES = 6 * FRAME_RATE  # that the whole width stands for at first
GROWTH = 1.5
FRAMES_BETWEEN_READINGS = 12  # drawn frames: marks need not be younger than a fifth of a second


class Timeline:
    """The bar along the foot of the page."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.rect, self.unit = pygame.Rect(0, 0, 1, 1), 1.0
        self.room = LEAST_FRAMES
        self.held = False
        self.marks: Marks | None = None
        self._layer: pygame.Surface | None = None
        self._seen: tuple[object, int, int] = (None, -1, -1)
        self._last = -1
        self._age = 0

    def build(self, rect: pygame.Rect, unit: float) -> None:
        """Take its place."""
        self.rect, self.unit, self._layer = rect, unit, None

    def x(self, frame: int) -> float:
        """Pixel of a frame."""
        return self.rect.left + (frame - self.session.history.first) / self.room * self.rect.width

    def frame(self, x: float) -> int:
        """The kept frame nearest to pixel `x`."""
        history = self.session.history
        wanted = history.first + round((x - self.rect.left) / self.rect.width * self.room)
        return min(max(wanted, history.first), history.last)

    def handle(self, event: pygame.Event) -> bool:
        """Scrub while the button is held."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.held = self.rect.inflate(0, round(10 * self.unit)).collidepoint(event.pos)
            if self.held:
                self.session.scrub_frame(self.frame(event.pos[0]))
            return self.held
        if event.type == pygame.MOUSEMOTION and self.held:
            self.session.scrub_frame(self.frame(event.pos[0]))
            return True
        if event.type == pygame.MOUSEBUTTONUP and self.held:
            self.held = False
            return True
        return False

    def to_mark(self, direction: int) -> None:
        """Scrub to the next (1) or previous (-1) mark."""
        frames, here = self.session.marks().frame, self.session.frame
        chosen = frames[frames > here][:1] if direction > 0 else frames[frames < here][-1:]
        if len(chosen):
            self.session.scrub_frame(int(chosen[0]))

    def update(self) -> None:
        """Read new marks now and then, and make room for more frames."""
        history = self.session.history
        count = history.last - history.first
        if not self.room / GROWTH**2 <= count <= self.room:
            self.room = max(LEAST_FRAMES, round(GROWTH * count))
        self._age += 1
        changed = (history.blocks[-1], history.blocks[-1].revision, self.room)
        grown = history.last != self._last and self._age > FRAMES_BETWEEN_READINGS
        if self._layer is None or changed != self._seen or grown:
            self._seen, self._last, self._age = changed, history.last, 0
            self.marks = self.session.marks()
            self._layer = self._drawn(self.marks)

    def _drawn(self, marks: Marks) -> pygame.Surface:
        """All marks on a transparent sheet: closings stand up from the middle, openings hang down."""
        layer = pygame.Surface(self.rect.size, pygame.SRCALPHA, 32)
        colours = bead_colours(max(lane.chain.contacts for lane in self.session.lanes) + 1)
        middle, high = self.rect.height // 2, round(0.42 * self.rect.height)
        taken: set[tuple[int, bool]] = set()
        for frame, contact, closed in zip(
            marks.frame.tolist(), marks.contact.tolist(), marks.closed.tolist(), strict=True
        ):
            place = (round(self.x(frame) - self.rect.left), closed)
            if place in taken:
                continue
            taken.add(place)
            colour = colours[min(contact + 1, len(colours) - 1)]
            top = middle - high if closed else middle + 2
            layer.fill(colour, (place[0] - 1, top, max(2, round(2 * self.unit)), high))
        return layer

    def paint(self, surface: pygame.Surface) -> None:
        """Draw it."""
        history, unit, rect = self.session.history, self.unit, self.rect
        pygame.draw.rect(surface, LANE_BACKGROUND, rect, border_radius=round(4 * unit))
        done = pygame.Rect(rect.left, rect.top, round(self.x(history.last)) - rect.left, rect.height)
        pygame.draw.rect(surface, GRID, done, border_radius=round(4 * unit))
        now = round(self.x(self.session.frame))
        past = pygame.Rect(rect.left, rect.top, now - rect.left, rect.height)
        pygame.draw.rect(surface, mix(BACKGROUND, FAINT, 0.75), past, border_radius=round(4 * unit))
        if self._layer is not None:
            surface.blit(self._layer, rect)
        if history.first > 0:
            write(surface, "older is forgotten", (rect.left + 6 * unit, rect.centery), 11 * unit, MUTED, align=(0, 0.5))
        knob = pygame.Rect(0, 0, round(4 * unit), rect.height + round(8 * unit))
        knob.center = (now, rect.centery)
        pygame.draw.rect(surface, FOREGROUND, knob, border_radius=round(2 * unit))

    def paint_reading(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """The time under the pointer."""
        if not (self.rect.collidepoint(point) or self.held):
            return
        time = self.session.history.moment(self.frame(point[0])).time
        size, name = time_unit(max(self.session.span[1] - self.session.span[0], 1e-9))
        x = min(max(point[0], self.rect.left + 40 * self.unit), self.rect.right - 40 * self.unit)
        text = f"{fixed(time / size, 3)} {name}"
        place = write(surface, text, (x, self.rect.top - 5 * self.unit), 12 * self.unit, BACKGROUND, align=(0.5, 1))
        pygame.draw.rect(surface, FOREGROUND, place.inflate(12 * self.unit, 4 * self.unit), border_radius=4)
        write(surface, text, (x, self.rect.top - 5 * self.unit), 12 * self.unit, BACKGROUND, align=(0.5, 1))
