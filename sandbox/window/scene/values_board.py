"""The board of values: tables of beads and contacts in place of the plots, with the columns and rows there is room for."""

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

MARGIN = 6.0  # design pixels between a number and the right end of its cell
ROWS_A_TURN = 3  # of a table, by which the wheel moves it
LINE = 20.0  # design pixels of a row
GAP = 12.0  # design pixels between columns
HEADING = 34.0  # design pixels above the first row
BETWEEN = 16.0  # design pixels between the two tables of a lane
BEADS_SHARE = 0.55  # of the width, for the table of beads
HEAD, BODY = 13.0, 13.0  # sizes of text, design pixels
MOST_DIGITS, LEAST_DIGITS = 3, 2  # after the first, of a number
# Columns that are left out where there is no room, the first of these first; their values are copied with the others.
LESS_NEEDED = (*reversed(SET_COLUMNS), *(quantity.column for quantity in (KINETIC, STORED, MOMENTUM, RATE, MASS)))


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
    number = "88-88" if first else f"{MINUS}8.{digits * '8'}·10⁻⁸"
    words = [width(part, HEAD * unit) for part in heading(name)]
    return max(*words, width(number, BODY * unit)) + GAP * unit


def heading(name: str) -> list[str]:
    """The lines above a column."""
    return pgettext("column", name).replace(" (", "\n(").split("\n")


@dataclass(frozen=True)
class TablePlace:
    """Where the table of the beads or contacts of a lane is.

    Attributes:
        lane, kind: "bead" or "contact".
        rect: all of it.
        names: of all columns.
        columns: those that are shown.
        first, last: the rows that are shown, of `count`; `last` is not.
        line: height of a row [pixels].
        top: upper edge of the first row that is shown [pixels].
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
    def whole(self) -> bool:
        """Whether all rows are shown."""
        return self.last - self.first == self.count

    def strip(self, row: int) -> pygame.Rect:
        """The rectangle of a row."""
        return pygame.Rect(self.rect.left, round(self.top + (row - self.first) * self.line), self.rect.width, self.line)

    def row_at(self, point: tuple[int, int]) -> int | None:
        """The row at `point`, or None."""
        return next((row for row in range(self.first, self.last) if self.strip(row).collidepoint(point)), None)


def table_places(
    lanes: Sequence[LiveLane], area: pygame.Rect, unit: float, first: Mapping[tuple[int, str], int], chosen: int = 0
) -> list[TablePlace]:
    """The tables of lanes, beads and contacts of each side by side; `first` says where they begin.

    Where there is no room for all lanes, that of the `chosen` one.
    """
    places, roomy = [], area.height >= len(lanes) * (HEADING + 2.0 * LINE) * unit
    for lane, live in enumerate(lanes) if roomy else [(chosen, lanes[chosen])]:
        height = area.height // (len(lanes) if roomy else 1)
        rect = pygame.Rect(area.left, area.top + (lane * height if roomy else 0), area.width, height)
        half = round(BEADS_SHARE * rect.width)
        left = pygame.Rect(rect.left, rect.top, half - round(BETWEEN * unit), rect.height)
        right = pygame.Rect(rect.left + half, rect.top, rect.width - half, rect.height)
        for kind, count, side in ((BEAD, live.chain.contacts + 1, left), (CONTACT, live.chain.contacts, right)):
            places.append(_place(Pick(lane, kind, count), side, columns_of(live, kind), unit, first))
    return places


def _place(
    end: Pick, rect: pygame.Rect, names: tuple[str, ...], unit: float, first: Mapping[tuple[int, str], int]
) -> TablePlace:
    """A table of `end.index` rows in `rect`; where they do not all fit, the last line says which are shown."""
    line, top, count = round(LINE * unit), rect.top + HEADING * unit, end.index
    room = max(0, int((rect.bottom - top) // line))
    shown = count if room >= count else max(1, room - 1)
    begin = min(max(first.get((end.lane, end.kind), 0), 0), count - shown)
    columns = fitting(names, rect.width, unit)
    return TablePlace(end.lane, end.kind, rect, names, columns, begin, begin + shown, count, line, top)


class ValuesBoard:
    """The tables; `area` is the place for them, None while they are not on screen.

    Attributes:
        places: where the tables are.
    """

    def __init__(
        self, host: Host, session: Session, editor: SceneEditor, area: Callable[[], pygame.Rect | None]
    ) -> None:
        self.host, self.session, self.editor, self.area = host, session, editor, area
        self.places: list[TablePlace] = []
        self._first: dict[tuple[int, str], int] = {}  # rows that tables begin with, by lane and kind
        self._shown = Derived(lambda: editor.selection, lambda: self.bring_into_view(editor.selection))

    def arrange(self) -> None:
        """Find the places of the tables; the row that is selected comes into view."""
        area, pick = self.area(), self.editor.selection
        chosen = 0 if pick is None else pick.lane
        lanes, unit = self.session.lanes, self.host.unit
        self.places = [] if area is None else table_places(lanes, area, unit, self._first, chosen)
        if self.places:
            self._shown.follow()

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

    def handle(self, event: pygame.Event) -> bool:
        """A click selects a row; the wheel scrolls."""
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
    """The cells of a row; its first number is that of the bead or contact."""
    first = int(numbers[0])
    name, none = (str(first), _("wall")) if kind == BEAD else (f"{first}-{first + 1}", MINUS)
    return [name, *(scientific(value, digits) if math.isfinite(value) else none for value in numbers[1:])]
