"""The board of values: tables of beads and contacts in place of the plots, whose numbers can be typed over."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import pygame
from softcradle.sandbox.draw.number_format import scientific
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import shortened, write
from softcradle.sandbox.languages import _
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.value_edits import can_be_edited
from softcradle.sandbox.session.values_table import ValuesTable, bead_table, contact_table
from softcradle.sandbox.window.scene.cell_editor import Cell, CellEditor
from softcradle.sandbox.window.scene.pick import Pick
from softcradle.sandbox.window.scene.scene_editor import SceneEditor
from softcradle.sandbox.window.scene.values_layout import BODY, HEAD, TablePlace, heading, table_places
from softcradle.sandbox.window.window_page import Host

MARGIN = 6.0  # design pixels between a number and the right end of its cell
ROWS_A_TURN = 3  # of a table, by which the wheel moves it


class ValuesBoard:
    """The tables; `area` is the place for them, None while they are not on screen.

    Attributes:
        places: where the tables are.
        cells: types into one of their cells.
    """

    def __init__(
        self, host: Host, session: Session, editor: SceneEditor, area: Callable[[], pygame.Rect | None]
    ) -> None:
        self.host, self.session, self.editor, self.area = host, session, editor, area
        self.places: list[TablePlace] = []
        self.cells = CellEditor(host, session, editor, self)
        self._first: dict[tuple[int, str], int] = {}  # rows that tables begin with, by lane and kind
        self._seen: Pick | None = None  # the selection that was brought into view

    def arrange(self) -> None:
        """Find the places of the tables; the row that is selected comes into view."""
        area, contacts = self.area(), [lane.chain.contacts for lane in self.session.lanes]
        self.places = [] if area is None else table_places(contacts, area, self.host.unit, self._first)
        pick = self.editor.selection
        if pick != self._seen and self.places:
            self._seen = pick
            self.bring_into_view(pick)

    def bring_into_view(self, pick: Pick | None) -> None:
        """Scroll to the row of `pick`."""
        place = next((one for one in self.places if pick and (one.lane, one.kind) == (pick.lane, pick.kind)), None)
        if pick is None or place is None or place.first <= pick.index < place.last:
            return
        before = pick.index < place.first
        self._scroll(place, pick.index - place.first if before else pick.index - place.last + 1)

    def _scroll(self, place: TablePlace, by: int) -> None:
        self._first[place.lane, place.kind] = place.first + by
        self.arrange()

    def shown(self) -> list[tuple[Cell, pygame.Rect]]:
        """The cells on screen that can be edited, and where they are."""
        return [
            (Cell(Pick(place.lane, place.kind, row), column), rect)
            for place in self.places
            for row in range(place.first, place.last)
            for column, rect in place.cells(row)
            if can_be_edited(self.session.lanes[place.lane], column, row)
        ]

    def all_cells(self) -> list[Cell]:
        """The cells that can be edited, those to scroll to included, in the order of Tab."""
        return [
            Cell(Pick(place.lane, place.kind, row), place.names[k])
            for place in self.places
            for row in range(place.count)
            for k in place.columns.shown
            if can_be_edited(self.session.lanes[place.lane], place.names[k], row)
        ]

    def handle(self, event: pygame.Event) -> bool:
        """Typing; a click selects a row and edits the cell below it; the wheel scrolls."""
        if self.cells.handle(event):
            return True
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            return self._click(event.pos)
        if event.type == pygame.MOUSEWHEEL:
            return self._wheel(pygame.mouse.get_pos(), -event.y)
        return False

    def _click(self, point: tuple[int, int]) -> bool:
        for cell, rect in self.shown():
            if rect.collidepoint(point):
                self.cells.begin(cell)
                return True
        for place in self.places:
            row = place.row_at(point)
            if row is not None:
                self.editor.selection = Pick(place.lane, place.kind, row)
                return True
        return False

    def _wheel(self, point: tuple[int, int], by: int) -> bool:
        for place in self.places:
            if place.rect.collidepoint(point):
                self._scroll(place, ROWS_A_TURN * by)
                return True
        return False

    def update(self) -> None:
        """Follow the page and the selection."""
        self.arrange()
        self.cells.update()

    def paint(self, surface: pygame.Surface, area: pygame.Rect) -> None:
        """Draw the tables."""
        surface.fill(tones.background, area)
        for place in self.places:
            table = (bead_table if place.kind == "bead" else contact_table)(self.session, place.lane)
            self._table(surface, place, table)
        if not self.cells.typing:
            self._outline(surface, pygame.mouse.get_pos())

    def _table(self, surface: pygame.Surface, place: TablePlace, table: ValuesTable) -> None:
        unit, columns = self.host.unit, place.columns
        for k, right in zip(columns.shown, columns.right, strict=True):
            for line, word in enumerate(heading(table.columns[k])):
                point = (place.rect.left + right - MARGIN * unit, place.rect.top + (2 + 14 * line) * unit)
                write(surface, word, point, HEAD * unit, tones.muted, align=(1, 0))
        surface.fill(tones.faint, (place.rect.left, round(place.top - 2 * unit), place.rect.width, 1))
        for row in range(place.first, place.last):
            if Pick(place.lane, place.kind, row) == self.editor.selection:
                surface.fill(tones.grid, place.strip(row))
            texts = _texts(place.kind, table.rows[row], columns.digits)
            for k, (column, rect) in zip(columns.shown, place.cells(row), strict=True):
                if not self.cells.at(Cell(Pick(place.lane, place.kind, row), column)):
                    point = (rect.right - MARGIN * unit, rect.centery)
                    write(surface, texts[k], point, BODY * unit, tones.foreground, align=(1, 0.5))
        if not place.whole:
            text = _("{first} to {last} of {n}: scroll; C copies all", **_numbers(place))
            point = (place.rect.left + 8 * unit, place.strip(place.last).centery)
            text = shortened(text, BODY * unit, place.rect.width - 16 * unit)
            write(surface, text, point, BODY * unit, tones.muted, align=(0, 0.5))

    def _outline(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """Draw a line about the cell below the pointer, if it can be edited."""
        rect = next((rect for _, rect in self.shown() if rect.collidepoint(point)), None)
        if rect is not None:
            pygame.draw.rect(surface, tones.muted, rect, 1)


def _numbers(place: TablePlace) -> dict[str, int]:
    return {"first": place.first, "last": place.last - 1, "n": place.count}


def _texts(kind: str, numbers: Sequence[float], digits: int) -> list[str]:
    """The cells of a row; its first number is that of the bead or contact."""
    first = int(numbers[0])
    name = str(first) if kind == "bead" else f"{first}-{first + 1}"
    return [name, *(scientific(value, digits) if math.isfinite(value) else _("wall") for value in numbers[1:])]
