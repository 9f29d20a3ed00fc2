"""The cell editor: a number of the tables of values is typed in its place, and applied as one edit."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol

import pygame
import pygame_gui
from softcradle.sandbox.languages import _, pgettext
from softcradle.sandbox.session.inputs import Place
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.value_edits import can_be_edited, edit_of
from softcradle.sandbox.session.values_table import middles, value_of
from softcradle.sandbox.window.scene.editable_parameters import number
from softcradle.sandbox.window.scene.parameter_control import number_text
from softcradle.sandbox.window.scene.pick import Pick, pick_title
from softcradle.sandbox.window.scene.scene_editor import SceneEditor
from softcradle.sandbox.window.text_entry import TextEntry
from softcradle.sandbox.window.window_page import Host

STOPPED_SHORT = 1e-9  # relative: a bead further from the place that was typed was stopped by a wall
ROWS = {pygame.K_UP: -1, pygame.K_DOWN: 1}


class Cell(NamedTuple):
    """The column of a bead or contact."""

    pick: Pick
    column: str


class Cells(Protocol):
    """The tables as the editor sees them."""

    def shown(self) -> list[tuple[Cell, pygame.Rect]]:
        """The cells on screen that can be edited, and where they are."""

    def all_cells(self) -> list[Cell]:
        """The cells that can be edited, in the order of Tab."""

    def bring_into_view(self, pick: Pick | None) -> None:
        """Scroll to a row."""


class CellEditor:
    """Types into one cell at a time.

    Attributes:
        cell: it; None while nothing is typed.
    """

    def __init__(self, host: Host, session: Session, editor: SceneEditor, cells: Cells) -> None:
        self.host, self.session, self.editor, self.cells = host, session, editor, cells
        self.cell: Cell | None = None
        self._entry: TextEntry | None = None
        self._before = ""  # the text at first: where it is left as it is, nothing is changed
        self._columns: dict[str, str] = {}  # by kind, the column that was edited last

    @property
    def typing(self) -> bool:
        """Whether keys go into a cell."""
        return self._entry is not None and self._entry.is_focused

    def at(self, cell: Cell) -> bool:
        """Whether `cell` is being edited."""
        return cell == self.cell

    def begin_at_selection(self) -> None:
        """Edit the selected row, else the first: in the column that was edited last."""
        cells, pick = self.cells.all_cells(), self.editor.selection
        row = [cell for cell in cells if cell.pick == pick] or cells[:1]
        if row:
            row = [cell for cell in cells if cell.pick == row[0].pick]
            last = self._columns.get(row[0].pick.kind)
            self.begin(next((cell for cell in row if cell.column == last), row[0]))

    def begin(self, cell: Cell) -> None:
        """Edit `cell`; what was being typed elsewhere is applied."""
        if self.cell is not None:
            self._apply()
        self._end()
        self.editor.selection = cell.pick
        self.cells.bring_into_view(cell.pick)
        self._columns[cell.pick.kind] = cell.column
        self._before = self._present(cell)
        self._make(cell, self._before)

    def _present(self, cell: Cell) -> str:
        value = value_of(self.session, cell.pick.lane, cell.pick.kind, cell.pick.index, cell.column)
        return number_text(value) if math.isfinite(value) else ""

    def _make(self, cell: Cell, text: str) -> None:
        """The line to type in, with the keyboard."""
        rect = dict(self.cells.shown()).get(cell)
        if rect is None:
            return
        self.cell = cell
        self._entry = TextEntry(rect, self.host.manager, object_id="#cell", initial_text=text)
        self._entry.name = f"{pick_title(self.session, cell.pick)}, {pgettext('column', cell.column)}"
        self.host.manager.set_focus_set({self._entry})
        if text == self._before:
            self._entry.select_all()

    def _end(self) -> None:
        if self._entry is not None:
            self._entry.kill()
        self.cell = self._entry = None

    def stop(self) -> None:
        """Leave the cell as it was."""
        if self._entry is not None:
            self.host.manager.set_focus_set(None)
        self._end()

    def build(self) -> None:
        """Make the line again in a page that is built anew: the old one is gone."""
        old, cell = self._entry, self.cell
        if old is None or cell is None:
            return
        self._make(cell, old.get_text())
        new = self._entry
        if new is None or new is old:  # there is no place for it any more
            self._apply()
            self._end()
        elif old.get_text() != self._before:
            new.place_cursor(old.edit_position)

    def handle(self, event: pygame.Event) -> bool:
        """Enter applies; Tab and arrows up and down apply and go on to another cell."""
        if self.cell is None:
            return False
        if event.type == pygame_gui.UI_TEXT_ENTRY_FINISHED and event.ui_element is self._entry:
            self._apply()
            self.stop()
            return True
        if event.type != pygame.KEYDOWN or not self.typing:
            return False
        if event.key == pygame.K_TAB:
            self._go_on(self._along(-1 if event.mod & pygame.KMOD_SHIFT else 1))
        elif event.key in ROWS:
            self._go_on(self._across(ROWS[event.key]))
        else:
            return False
        return True

    def _go_on(self, find: Callable[[Cell], Cell]) -> None:
        """Apply, and edit the cell that is found from this one; one whose number is refused stays, with its old number."""
        cell = self.cell
        if cell is not None:
            target = find(cell) if self._apply() else cell
            self._end()
            self.begin(target)

    def _along(self, by: int) -> Callable[[Cell], Cell]:
        def find(cell: Cell) -> Cell:
            cells = self.cells.all_cells()
            return cells[(cells.index(cell) + by) % len(cells)] if cell in cells else cells[0]

        return find

    def _across(self, by: int) -> Callable[[Cell], Cell]:
        def find(cell: Cell) -> Cell:
            pick = cell.pick
            next_row = Cell(Pick(pick.lane, pick.kind, pick.index + by), cell.column)
            return next_row if next_row in self.cells.all_cells() else cell

        return find

    def _apply(self) -> bool:
        """Apply what was typed; False where it is refused, which is said in a sentence."""
        cell, entry = self.cell, self._entry
        if cell is None or entry is None or not self._exists(cell):
            return False
        text = entry.get_text()
        if text == self._before:
            return True
        try:
            value = number(text)
        except ValueError:
            name = pgettext("column", cell.column)
            self._refuse(_("{name}: {text!r} is not a number", name=name, text=text))
            return False
        try:
            item = edit_of(self.session, cell.pick.lane, cell.column, cell.pick.index, value)
        except ValueError as error:
            self._refuse(str(error))
            return False
        accepted = self.editor.apply(item)
        if accepted and isinstance(item, Place):
            self._compare(item)
        return accepted

    def _exists(self, cell: Cell) -> bool:
        """Whether there still is such a number."""
        lane, beads = self.session.lanes[cell.pick.lane], cell.pick.kind == "bead"
        return cell.pick.index < lane.chain.contacts + beads and can_be_edited(lane, cell.column, cell.pick.index)

    def _refuse(self, sentence: str) -> None:
        self.host.messages.show(sentence, warning=True)

    def _compare(self, item: Place) -> None:
        """Say where a wall has stopped a bead."""
        live = self.session.lanes[item.lane]
        if abs(live.position[item.bead] - item.position) > STOPPED_SHORT * max(1.0, abs(item.position)):
            place = float(middles(live)[item.bead])
            self._refuse(_("a wall is in the way: bead {bead} stops at {place:.5g} m", bead=item.bead, place=place))

    def update(self) -> None:
        """Apply a number that was left by a click elsewhere; follow the cell to another place."""
        if self.cell is None or self._entry is None:
            return
        rect = dict(self.cells.shown()).get(self.cell)
        if rect is None or not self._entry.is_focused:
            self._apply()
            self.stop()
        elif rect != self._entry.rect:
            self._entry.set_relative_position(rect.topleft)
            self._entry.set_dimensions(rect.size)
