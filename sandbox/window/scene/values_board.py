"""The board of values: tables of beads and contacts in place of the plots; a click on a row selects it for editing."""

from __future__ import annotations

import math

import pygame
from softcradle.sandbox.draw.number_format import scientific, subscript
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.values_table import ValuesTable, bead_table, contact_table
from softcradle.sandbox.window.scene.pick import Pick
from softcradle.sandbox.window.scene.scene_editor import SceneEditor

LINE = 19.0  # design pixels of a row
DIGITS = 3  # after the first, of a number


class ValuesBoard:
    """The tables; `shown` says whether they are on screen."""

    def __init__(self, session: Session, editor: SceneEditor) -> None:
        self.session, self.editor = session, editor
        self.shown = False
        self._rows: list[tuple[pygame.Rect, Pick]] = []

    def toggle(self) -> None:
        """Show or hide the tables."""
        self.shown = not self.shown

    def handle(self, event: pygame.Event) -> bool:
        """A click on a row selects its bead or contact."""
        if self.shown and event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            for rect, pick in self._rows:
                if rect.collidepoint(event.pos):
                    self.editor.selection = pick
                    return True
        return False

    def paint(self, surface: pygame.Surface, area: pygame.Rect, unit: float) -> None:
        """Draw the tables of each lane side by side; rows for which there is no room are counted."""
        self._rows = []
        surface.fill(tones.background, area)
        count = len(self.session.lanes)
        for lane in range(count):
            height = area.height // count
            rect = pygame.Rect(area.left, area.top + lane * height, area.width, height)
            half = round(0.55 * rect.width)
            left = pygame.Rect(rect.left, rect.top, half - round(16 * unit), rect.height)
            right = pygame.Rect(rect.left + half, rect.top, rect.width - half, rect.height)
            self._table(surface, left, unit, lane, "bead", bead_table(self.session, lane))
            self._table(surface, right, unit, lane, "contact", contact_table(self.session, lane))

    def _table(
        self, surface: pygame.Surface, rect: pygame.Rect, unit: float, lane: int, kind: str, table: ValuesTable
    ) -> None:
        line, pitch = LINE * unit, rect.width / len(table.columns)
        for k, name in enumerate(table.columns):
            words = name.replace(" (", "\n(").split("\n")
            for row, word in enumerate(words):
                place = (rect.left + (k + 1) * pitch - 6 * unit, rect.top + (2 + 14 * row) * unit)
                write(surface, word, place, 11.5 * unit, tones.muted, align=(1, 0))
        y = rect.top + 34 * unit
        surface.fill(tones.faint, (rect.left, round(y - 2 * unit), rect.width, 1))
        room = max(0, int((rect.bottom - y) // line))
        for row, numbers in enumerate(table.rows[:room]):
            if row == room - 1 and len(table.rows) > room:
                text = f"and {len(table.rows) - row} more: copy them with C"
                write(surface, text, (rect.left + 8 * unit, y), 12 * unit, tones.muted)
                break
            pick = Pick(lane, kind, row)
            strip = pygame.Rect(rect.left, round(y), rect.width, round(line))
            if pick == self.editor.selection:
                surface.fill(tones.grid, strip)
            self._rows.append((strip, pick))
            self._numbers(surface, rect, unit, y, kind, numbers)
            y += line

    def _numbers(
        self,
        surface: pygame.Surface,
        rect: pygame.Rect,
        unit: float,
        y: float,
        kind: str,
        numbers: tuple[float, ...],
    ) -> None:
        pitch, first = rect.width / len(numbers), int(numbers[0])
        name = str(first) if kind == "bead" else subscript(first, first + 1)
        texts = [name, *(scientific(value, DIGITS) if math.isfinite(value) else "wall" for value in numbers[1:])]
        for k, text in enumerate(texts):
            right = rect.left + (k + 1) * pitch - 6 * unit
            write(surface, text, (right, y + 2 * unit), 12 * unit, tones.foreground, align=(1, 0))
