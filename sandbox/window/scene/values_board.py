"""The board of values: tables of beads and contacts in place of the plots; a click on a row selects it for editing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import pygame
from softcradle.sandbox.draw.number_format import MINUS, scientific, subscript
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.languages import _, ngettext, pgettext
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.values_table import ValuesTable, bead_table, contact_table
from softcradle.sandbox.window.scene.pick import Pick
from softcradle.sandbox.window.scene.scene_editor import SceneEditor

LINE = 19.0  # design pixels of a row
GAP = 12.0  # design pixels between columns
HEAD, BODY = 11.5, 12.0  # sizes of text, design pixels
MOST_DIGITS, LEAST_DIGITS = 3, 2  # after the first, of a number
# Columns that are left out where there is no room, the first of these first; their values are copied with the others.
LESS_NEEDED = ("kinetic energy (J)", "stored energy (J)", "momentum (N s)", "rate (m/s)", "mass (kg)")


@dataclass(frozen=True)
class Columns:
    """The columns of a table for which there is room.

    Attributes:
        shown: their indices.
        right: right end of each, from that of the table [pixels].
        digits: of numbers, after the first.
    """

    shown: tuple[int, ...]
    right: tuple[float, ...]
    digits: int


def fitting(names: Sequence[str], room: float, unit: float) -> Columns:
    """The columns that fit into `room` pixels whatever their numbers are, with as many digits as may be."""
    left_out: set[str] = set()
    for digits, drop in [*((digits, None) for digits in range(MOST_DIGITS, LEAST_DIGITS - 1, -1)), *_drops(names)]:
        left_out |= {drop} if drop else set()
        shown = tuple(k for k, name in enumerate(names) if name not in left_out)
        needed = [_column_width(names[k], unit, digits, k == 0) for k in shown]
        if sum(needed) <= room:
            break
    spare = max(0.0, room - sum(needed)) / len(needed)
    ends = tuple(sum(needed[: k + 1]) + (k + 1) * spare for k in range(len(needed)))
    return Columns(shown, ends, digits)


def _drops(names: Sequence[str]) -> list[tuple[int, str]]:
    return [(LEAST_DIGITS, name) for name in LESS_NEEDED if name in names]


def _column_width(name: str, unit: float, digits: int, first: bool) -> float:
    """Pixels of the widest number and of the name, which is broken before its unit."""
    number = "88" if first else f"{MINUS}8.{digits * '8'}·10⁻⁸"
    words = [width(part, HEAD * unit) for part in _head(name)]
    return max(*words, width(number, BODY * unit)) + GAP * unit


def _head(name: str) -> list[str]:
    return pgettext("column", name).replace(" (", "\n(").split("\n")


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
        line, columns = LINE * unit, fitting(table.columns, rect.width, unit)
        for k, right in zip(columns.shown, columns.right, strict=True):
            for row, word in enumerate(_head(table.columns[k])):
                place = (rect.left + right - 6 * unit, rect.top + (2 + 14 * row) * unit)
                write(surface, word, place, HEAD * unit, tones.muted, align=(1, 0))
        y = rect.top + 34 * unit
        surface.fill(tones.faint, (rect.left, round(y - 2 * unit), rect.width, 1))
        room = max(0, int((rect.bottom - y) // line))
        for row, numbers in enumerate(table.rows[:room]):
            if row == room - 1 and len(table.rows) > room:
                text = ngettext("and {n} more: copy it with C", "and {n} more: copy them with C", len(table.rows) - row)
                write(surface, text, (rect.left + 8 * unit, y), 12 * unit, tones.muted)
                break
            pick = Pick(lane, kind, row)
            strip = pygame.Rect(rect.left, round(y), rect.width, round(line))
            if pick == self.editor.selection:
                surface.fill(tones.grid, strip)
            self._rows.append((strip, pick))
            texts = _texts(kind, numbers, columns.digits)
            for k, right in zip(columns.shown, columns.right, strict=True):
                place = (rect.left + right - 6 * unit, y + 2 * unit)
                write(surface, texts[k], place, BODY * unit, tones.foreground, align=(1, 0))
            y += line


def _texts(kind: str, numbers: Sequence[float], digits: int) -> list[str]:
    """The cells of a row; its first number is that of the bead or contact."""
    first = int(numbers[0])
    name = str(first) if kind == "bead" else subscript(first, first + 1)
    return [name, *(scientific(value, digits) if math.isfinite(value) else _("wall") for value in numbers[1:])]
