"""The layout of the tables of values: which columns and rows there is room for, and where each cell is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import pygame
from softcradle.sandbox.draw.number_format import MINUS
from softcradle.sandbox.draw.text import width
from softcradle.sandbox.languages import pgettext
from softcradle.sandbox.session.values_table import BEAD_COLUMNS, CONTACT_COLUMNS
from softcradle.sandbox.window.scene.pick import Pick

LINE = 20.0  # design pixels of a row
GAP = 12.0  # design pixels between columns
HEADING = 34.0  # design pixels above the first row
BETWEEN = 16.0  # design pixels between the two tables of a lane
BEADS_SHARE = 0.55  # of the width, for the table of beads
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

    def cells(self, row: int) -> Iterator[tuple[str, pygame.Rect]]:
        """Column and rectangle of each cell of a row."""
        strip, left = self.strip(row), 0.0
        for k, right in zip(self.columns.shown, self.columns.right, strict=True):
            yield self.names[k], pygame.Rect(round(strip.left + left), strip.top, round(right - left), strip.height)
            left = right

    def row_at(self, point: tuple[int, int]) -> int | None:
        """The row at `point`, or None."""
        return next((row for row in range(self.first, self.last) if self.strip(row).collidepoint(point)), None)


def table_places(
    contacts: Sequence[int], area: pygame.Rect, unit: float, first: Mapping[tuple[int, str], int]
) -> list[TablePlace]:
    """The tables of lanes with so many contacts, beads and contacts of each side by side; `first` says where they begin."""
    places = []
    for lane, count in enumerate(contacts):
        height = area.height // len(contacts)
        rect = pygame.Rect(area.left, area.top + lane * height, area.width, height)
        half = round(BEADS_SHARE * rect.width)
        left = pygame.Rect(rect.left, rect.top, half - round(BETWEEN * unit), rect.height)
        right = pygame.Rect(rect.left + half, rect.top, rect.width - half, rect.height)
        places.append(_place(Pick(lane, "bead", count + 1), left, BEAD_COLUMNS, unit, first))
        places.append(_place(Pick(lane, "contact", count), right, CONTACT_COLUMNS, unit, first))
    return places


def _place(
    end: Pick, rect: pygame.Rect, names: tuple[str, ...], unit: float, first: Mapping[tuple[int, str], int]
) -> TablePlace:
    """A table of `end.index` rows in `rect`; where they do not all fit, the last line says which are shown."""
    line, top, count = round(LINE * unit), rect.top + HEADING * unit, end.index
    room = max(0, int((rect.bottom - top) // line))
    shown = count if room >= count else max(0, room - 1)
    begin = min(max(first.get((end.lane, end.kind), 0), 0), count - shown)
    columns = fitting(names, rect.width, unit)
    return TablePlace(end.lane, end.kind, rect, names, columns, begin, begin + shown, count, line, top)
