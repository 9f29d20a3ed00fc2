"""The grid of the gallery: places of cards below the titles of their sections, scrolled by wheel, keys or its bar."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.languages import _
from softcradle.sandbox.window.gallery import thumbnails
from softcradle.sandbox.window.gallery.sections import Section

MARGIN = 34.0  # design pixels on the left and right
HEADER = 90.0  # design pixels
GUTTER = 20.0  # design pixels between two cards
COLUMN = 285.0  # design pixels, the least width of a card
CAPTION = 82.0  # design pixels below a picture
TITLE = 30.0  # design pixels of the title of a section
BAR = 10.0  # design pixels, the width of the bar


class CardGrid:
    """Where cards are.

    Attributes:
        columns: number of cards in a row.
        picture_size: of each card's picture [pixels].
        scroll: pixels that are scrolled out of sight above.
    """

    def __init__(self) -> None:
        self.columns, self.picture_size, self.scroll = 1, (1, 1), 0.0
        self.size, self.unit, self._full, self._grip = (1, 1), 1.0, 1.0, 0.0
        self._cards: list[pygame.Rect] = []
        self._titles: list[tuple[str, float]] = []
        self.dragged = False

    def arrange(self, size: tuple[int, int], unit: float, sections: Sequence[Section]) -> None:
        """Find the places for a window of `size`."""
        self.size, self.unit = size, unit
        inner = size[0] - 2 * MARGIN * unit
        self.columns = max(1, int((inner + GUTTER * unit) // ((COLUMN + GUTTER) * unit)))
        wide = (inner - (self.columns - 1) * GUTTER * unit) / self.columns
        self.picture_size = round(wide), round(wide * thumbnails.SIZE[1] / thumbnails.SIZE[0])
        high = round(self.picture_size[1] + CAPTION * unit)
        self._cards, self._titles, y = [], [], HEADER * unit
        for section in sections:
            self._titles.append((_(section.title), y))
            y += TITLE * unit
            for k in range(len(section.names)):
                row, column = divmod(k, self.columns)
                x = MARGIN * unit + column * (wide + GUTTER * unit)
                place = pygame.Rect(round(x), round(y + row * (high + GUTTER * unit)), self.picture_size[0], high)
                self._cards.append(place)
            y += -(-len(section.names) // self.columns) * (high + GUTTER * unit)
        self._full = y
        self.scroll_by(0.0)

    def place(self, k: int) -> pygame.Rect:
        """Rectangle of card `k` on screen."""
        return self._cards[k].move(0, -round(self.scroll))

    def titles(self) -> list[tuple[str, float]]:
        """Titles of the sections and where they are on screen."""
        return [(title, y - self.scroll) for title, y in self._titles]

    def card_at(self, point: tuple[int, int]) -> int | None:
        """The visible card at `point`, or None."""
        if point[1] < HEADER * self.unit:
            return None
        return next((k for k in range(len(self._cards)) if self.place(k).collidepoint(point)), None)

    def neighbour(self, k: int, by: int) -> int:
        """The card nearest to card `k` in the next row below (1) or above (-1); `k` itself where there is none."""
        here = self._cards[k]
        rows = sorted({card.top for card in self._cards if (card.top - here.top) * by > 0}, reverse=by < 0)
        if not rows:
            return k
        row = [j for j, card in enumerate(self._cards) if card.top == rows[0]]
        return min(row, key=lambda j: abs(self._cards[j].left - here.left))

    def show(self, k: int) -> None:
        """Scroll until card `k` is in sight."""
        card = self.place(k)
        top, bottom = (HEADER + TITLE) * self.unit, self.size[1] - 10
        if card.top < top:
            self.scroll_by(card.top - top)
        elif card.bottom > bottom:
            self.scroll_by(card.bottom - bottom)

    def scroll_by(self, pixels: float) -> None:
        """Scroll, as far as there are cards."""
        self.scroll = min(max(self.scroll + pixels, 0.0), max(0.0, self._full - self.size[1]))

    def _bar(self) -> tuple[pygame.Rect, pygame.Rect] | None:
        """Track and knob of the bar; None where everything is in sight."""
        top, unit = round(HEADER * self.unit), self.unit
        if self._full <= self.size[1]:
            return None
        track = pygame.Rect(self.size[0] - round((BAR + 6) * unit), top, round(BAR * unit), self.size[1] - top - 6)
        share = (self.size[1] - top) / (self._full - top)
        knob = pygame.Rect(track.left, 0, track.width, max(round(24 * unit), math.ceil(share * track.height)))
        room = track.height - knob.height
        knob.top = track.top + round(room * self.scroll / (self._full - self.size[1]))
        return track, knob

    def handle(self, event: pygame.Event) -> bool:
        """Drag the knob; a press on the track takes it there."""
        bar = self._bar()
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1 and bar is not None:
            track, knob = bar
            self.dragged = track.inflate(8, 0).collidepoint(event.pos)
            self._grip = event.pos[1] - knob.top if knob.collidepoint(event.pos) else knob.height / 2
        elif event.type == pygame.MOUSEBUTTONUP and self.dragged:
            self.dragged = False
            return True
        if self.dragged and bar is not None and event.type in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEMOTION):
            track, knob = bar
            share = (event.pos[1] - self._grip - track.top) / max(1, track.height - knob.height)
            self.scroll_by(share * (self._full - self.size[1]) - self.scroll)
            return True
        return False

    def paint_bar(self, surface: pygame.Surface) -> None:
        """Draw the bar."""
        bar = self._bar()
        if bar is not None:
            track, knob = bar
            pygame.draw.rect(surface, tones.grid, track, border_radius=5)
            pygame.draw.rect(surface, tones.muted if self.dragged else tones.faint, knob, border_radius=5)
