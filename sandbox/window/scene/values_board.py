"""The table of values. It replaces the plots by numbers of beads and contacts, with as many columns and rows as fit."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import shortened, width, write
from softcradle.sandbox.languages import _, pgettext
from softcradle.sandbox.quantities import BEAD, CONTACT, KINETIC, MASS, MOMENTUM, RATE, STORED
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.values_table import SET_COLUMNS, ValuesTable, columns_of, values_table
from softcradle.sandbox.story.numbers import MINUS, scientific
from softcradle.sandbox.window.page import Derived, Host
from softcradle.sandbox.window.scene.editor import Pick, SceneEditor

MARGIN = 6.0  # Distance in design pixels between a number and the right edge of its cell.
ROWS_A_TURN = 3  # Number of rows by which one notch of the wheel scrolls.
LINE = 20.0  # Height of a row in design pixels.
GAP = 12.0  # Distance between columns in design pixels.
HEADING = 34.0  # Height above the first row in design pixels.
BETWEEN = 16.0  # Distance between the two tables of a lane in design pixels.
BEADS_SHARE = 0.55  # Width of the table of beads as a fraction of the total width.
HEAD, BODY = 13.0, 13.0  # Text sizes of the heading and the rows in design pixels.
MOST_DIGITS, LEAST_DIGITS = 3, 2  # Largest and smallest number of digits after the decimal point in a table.
# Columns that are omitted if there is too little space, in the order of omission. The clipboard always receives their
# values.
LESS_NEEDED = (*reversed(SET_COLUMNS), *(quantity.column for quantity in (KINETIC, STORED, MOMENTUM, RATE, MASS)))


@dataclass(frozen=True)
class Columns:
    """The columns of a table that fit on the page.

    Attributes:
        shown: indices of the columns.
        right: right edge of each column, relative to the left edge of the table [pixels].
        digits: number of digits after the decimal point.
    """

    shown: tuple[int, ...]
    right: tuple[float, ...]
    digits: int


def fitting(names: Sequence[str], room: float, unit: float) -> Columns:
    """Return the columns that fit into `room` pixels, with as many digits as possible. They have space for all possible
    numbers.
    """
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
    """Return the width of a column in pixels. It has space for the widest number and for the column name.

    The column name is wrapped before its unit.
    """
    number = "88-88" if first else f"{MINUS}8.{digits * '8'}·10⁻⁸"
    words = [width(part, HEAD * unit) for part in heading(name)]
    return max(*words, width(number, BODY * unit)) + GAP * unit


def heading(name: str) -> list[str]:
    """Return the lines of a column heading."""
    return pgettext("column", name).replace(" (", "\n(").split("\n")


@dataclass(frozen=True)
class TablePlace:
    """The layout of the table of the beads or contacts of a lane.

    Attributes:
        lane, kind: number of the lane; "bead" or "contact".
        rect: rectangle of the complete table.
        names: names of all columns.
        columns: the visible columns.
        first, last: range of the visible rows, without `last`.
        count: number of all rows.
        line: height of a row [pixels].
        top: upper edge of the first visible row [pixels].
    """

    lane: int
    kind: str
    rect: pygame.Rect
    names: tuple[str, ...]
    columns: Columns
    first: int
    last: int
    count: int
    line: float
    top: float

    @property
    def fits(self) -> bool:
        """True if the columns have enough space."""
        return self.columns.right[-1] <= self.rect.width + 0.5

    @property
    def whole(self) -> bool:
        """True if all rows are visible."""
        return self.last - self.first == self.count

    def strip(self, row: int) -> pygame.Rect:
        """Return the rectangle of a row."""
        return pygame.Rect(self.rect.left, round(self.top + (row - self.first) * self.line), self.rect.width, self.line)

    def row_at(self, point: tuple[int, int]) -> int | None:
        """Return the row at `point`, or None."""
        return next((row for row in range(self.first, self.last) if self.strip(row).collidepoint(point)), None)


def table_places(
    lanes: Sequence[LiveLane],
    area: pygame.Rect,
    unit: float,
    first: Mapping[tuple[int, str], int],
    chosen: Pick | None = None,
) -> list[TablePlace]:
    """Return the layouts of the tables of all lanes. Beads and contacts are side by side.

    `first` contains the first visible row of each table. If there is too little space for all lanes, return only the
    tables of the lane of the selection `chosen`. If two tables do not fit side by side, return only the table of beads.
    If a contact is selected, return the table of contacts instead.
    """
    places, roomy = [], area.height >= len(lanes) * (HEADING + 2.0 * LINE) * unit
    only, alone = (BEAD, 0) if chosen is None else (chosen.kind, chosen.lane)
    for lane, live in enumerate(lanes) if roomy else [(alone, lanes[alone])]:
        height = area.height // (len(lanes) if roomy else 1)
        rect = pygame.Rect(area.left, area.top + (lane * height if roomy else 0), area.width, height)
        half = round(BEADS_SHARE * rect.width)
        left = pygame.Rect(rect.left, rect.top, half - round(BETWEEN * unit), rect.height)
        right = pygame.Rect(rect.left + half, rect.top, rect.width - half, rect.height)
        ends = (Pick(lane, BEAD, live.chain.contacts + 1), left), (Pick(lane, CONTACT, live.chain.contacts), right)
        tables = [_place(end, side, columns_of(live, end.kind), unit, first) for end, side in ends]
        if all(table.fits for table in tables):
            places += tables
        else:
            end = next(end for end, _side in ends if end.kind == only)
            places.append(_place(end, rect, columns_of(live, only), unit, first))
    return places


def _place(
    end: Pick, rect: pygame.Rect, names: tuple[str, ...], unit: float, first: Mapping[tuple[int, str], int]
) -> TablePlace:
    """Return the layout of a table with `end.index` rows in `rect`. If some rows do not fit, the last line contains a
    note.
    """
    line, top, count = round(LINE * unit), rect.top + HEADING * unit, end.index
    room = max(0, int((rect.bottom - top) // line))
    shown = count if room >= count else max(1, room - 1)
    begin = min(max(first.get((end.lane, end.kind), 0), 0), count - shown)
    columns = fitting(names, rect.width, unit)
    return TablePlace(end.lane, end.kind, rect, names, columns, begin, begin + shown, count, line, top)


class ValuesBoard:
    """The tables of values. The function `area` returns their rectangle, or None while they are hidden.

    Attributes:
        places: layouts of the tables.
    """

    def __init__(
        self, host: Host, session: Session, editor: SceneEditor, area: Callable[[], pygame.Rect | None]
    ) -> None:
        self.host, self.session, self.editor, self.area = host, session, editor, area
        self.places: list[TablePlace] = []
        self._first: dict[tuple[int, str], int] = {}  # First visible row of each table, by lane and kind.
        self._shown = Derived(lambda: editor.selection, lambda: self.bring_into_view(editor.selection))

    def arrange(self) -> None:
        """Place the tables, and scroll to the row of the selected bead or contact."""
        area, lanes = self.area(), self.session.lanes
        pick, unit = self.editor.selection, self.host.unit
        self.places = [] if area is None else table_places(lanes, area, unit, self._first, pick)
        if self.places:
            self._shown.follow()

    def bring_into_view(self, pick: Pick | None) -> None:
        """Scroll to the row of the bead or contact `pick`."""
        place = next((one for one in self.places if pick and (one.lane, one.kind) == (pick.lane, pick.kind)), None)
        if pick is None or place is None or place.first <= pick.index < place.last:
            return
        before = pick.index < place.first
        self._scroll(place, pick.index - place.first if before else pick.index - place.last + 1)

    def _scroll(self, place: TablePlace, by: int) -> None:
        self._first[place.lane, place.kind] = place.first + by
        self.arrange()

    def handle(self, event: pygame.Event) -> bool:
        """Handle an event. A click selects a row, and the wheel scrolls."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            return self._click(event.pos)
        if event.type == pygame.MOUSEWHEEL:
            return self._wheel(pygame.mouse.get_pos(), -event.y)
        return False

    def _click(self, point: tuple[int, int]) -> bool:
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

    def paint(self, surface: pygame.Surface, area: pygame.Rect) -> None:
        """Draw the tables."""
        surface.fill(tones.background, area)
        for place in self.places:
            self._table(surface, place, values_table(self.session, place.lane, place.kind))

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
            for k, right in zip(columns.shown, columns.right, strict=True):
                point = (place.rect.left + right - MARGIN * unit, place.strip(row).centery)
                write(surface, texts[k], point, BODY * unit, tones.foreground, align=(1, 0.5))
        if not place.whole and place.strip(place.last).bottom <= place.rect.bottom:
            text = _(
                "{first} to {last} of {n}: scroll; C copies all", first=place.first, last=place.last - 1, n=place.count
            )
            point = (place.rect.left + 8 * unit, place.strip(place.last).centery)
            text = shortened(text, BODY * unit, place.rect.width - 16 * unit)
            write(surface, text, point, BODY * unit, tones.muted, align=(0, 0.5))


def _texts(kind: str, numbers: Sequence[float], digits: int) -> list[str]:
    """Return the texts of the cells in a row. The first number is the index of the bead or contact."""
    first = int(numbers[0])
    name, none = (str(first), _("wall")) if kind == BEAD else (f"{first}-{first + 1}", MINUS)
    return [name, *(scientific(value, digits) if math.isfinite(value) else none for value in numbers[1:])]
