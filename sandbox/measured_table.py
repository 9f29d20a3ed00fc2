"""Reader for tables of measurements that other programs have exported. The reader finds the quantity and the unit of
each column. If it finds a problem, it reports the line and the column of the problem.

A table consists of numbers with one line of names above them. Tracker, phyphox, Qualisys, Logger Pro, Capstone,
spreadsheets and pandas write such tables. The quantity of a column follows from its name and its unit, never from its
numbers.

Tests: tests/sandbox/test_measured_table.py
"""

from __future__ import annotations

import contextlib
import csv
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.motion import Array
from softcradle.sandbox.user_error import UserError, reason

TIME, POSITION, VELOCITY, ACCELERATION, FORCE, ENERGY, MOMENTUM, MASS = (
    "time",
    "position",
    "velocity",
    "acceleration",
    "force",
    "energy",
    "momentum",
    "mass",
)
# Names of the quantities in error messages.
QUANTITY_NAMES = {
    TIME: N_("time"),
    POSITION: N_("position"),
    VELOCITY: N_("velocity"),
    ACCELERATION: N_("acceleration"),
    FORCE: N_("force"),
    ENERGY: N_("energy"),
    MOMENTUM: N_("momentum"),
    MASS: N_("mass"),
}
# Characters that separate the cells of a line. If several characters fit a file equally well, the first one is used.
DELIMITERS = ("\t", ";", ",", None)  # None means blanks.
# Texts that stand for a missing value, in lower case. pandas, NumPy, R and Excel (English, German, French) write them,
# and people write them by hand.
MISSING = frozenset(
    ("", "nan", "na", "n/a", "#n/a", "#na", "#nv", "null", "none", "-", "--", "—", "#div/0!", "#value!")
)
# Names of columns that contain the numbers of rows or frames.
COUNTERS = ("frame", "#", "index", "row", "sample", "bild", "nr", "n")
# Smallest number of lines with numbers that a table must have.
FEWEST_ROWS = 2
# Quantity of each unit, and the factor from the unit to the SI unit of the quantity.
UNITS: dict[str, tuple[str, float]] = {
    "s": (TIME, 1.0),
    "sec": (TIME, 1.0),
    "ms": (TIME, 1e-3),
    "us": (TIME, 1e-6),
    "min": (TIME, 60.0),
    "m": (POSITION, 1.0),
    "cm": (POSITION, 1e-2),
    "mm": (POSITION, 1e-3),
    "um": (POSITION, 1e-6),
    "km": (POSITION, 1e3),
    "in": (POSITION, 0.0254),
    "ft": (POSITION, 0.3048),
    "m/s": (VELOCITY, 1.0),
    "cm/s": (VELOCITY, 1e-2),
    "mm/s": (VELOCITY, 1e-3),
    "km/h": (VELOCITY, 1.0 / 3.6),
    "ft/s": (VELOCITY, 0.3048),
    "mph": (VELOCITY, 0.44704),
    "m/s2": (ACCELERATION, 1.0),
    "cm/s2": (ACCELERATION, 1e-2),
    "mm/s2": (ACCELERATION, 1e-3),
    "g": (ACCELERATION, 9.80665),
    "n": (FORCE, 1.0),
    "mn": (FORCE, 1e-3),
    "kn": (FORCE, 1e3),
    "lbf": (FORCE, 4.4482216152605),
    "j": (ENERGY, 1.0),
    "mj": (ENERGY, 1e-3),
    "kj": (ENERGY, 1e3),
    "ns": (MOMENTUM, 1.0),
    "kgm/s": (MOMENTUM, 1.0),
    "kg": (MASS, 1.0),
}
# Units that need a capital letter. UNITS contains another unit with the same letters in lower case.
EXACT_UNITS = {"MN": (FORCE, 1e6), "MJ": (ENERGY, 1e6)}
SUPERSCRIPTS = str.maketrans({"²": "2", "³": "3", "⁻": "-", "¹": "1", "·": "", "*": "", "^": "", "µ": "u", "μ": "u"})
# Words and symbols of each quantity, in English, German and French. A symbol can have an index, for example v0, v_x,
# v_{x} or vx.
WORDS = {
    TIME: ("time", "zeit", "temps", "sekunden", "seconds"),
    POSITION: ("position", "ort", "weg", "strecke", "place", "abscisse", "displacement", "distance"),
    VELOCITY: ("velocity", "geschwindigkeit", "vitesse"),
    ACCELERATION: ("acceleration", "beschleunigung", "accélération"),
    FORCE: ("force", "kraft"),
    ENERGY: ("energy", "energie", "énergie"),
    MOMENTUM: ("momentum", "impuls", "quantité de mouvement"),
}
SYMBOLS = {"t": TIME, "x": POSITION, "y": POSITION, "z": POSITION, "v": VELOCITY, "a": ACCELERATION, "f": FORCE}
SYMBOL = re.compile(r"([a-z])[ _]*(?:\{([^}]*)\}|\(([a-z\d]+)\)|([xyz]?\d*|\d+-\d+))")
AXIS = re.compile(r"(?:^|[\s_{(])([xyz])(?:[\s_})]|$)")
# Names of quantities without a direction. Such columns are not velocities or accelerations along the chain.
ABSOLUTE = re.compile(r"\bspeed\b|\babsolute?\b|\babsolut\w*\b|^\|.*\|$|\bmagnitude\b|\btempo\b|\bbetrag\b")
UNIT_IN_NAME = re.compile(r"^(.*?)\s*(?:\(([^()]+)\)|\[([^\[\]]+)\]|\s/\s*(\S+)|\bin\s+(\S+))((?:\s.*)?)$")


class Header(NamedTuple):
    """Meaning of a column. A header consists of the name, the quantity, the axis, the factor to SI units, and the unit
    in the file. The quantity is "" if it is unknown.
    """

    name: str
    quantity: str
    axis: str
    factor: float
    unit: str


@dataclass(frozen=True, eq=False)
class Column:
    """Measured quantity as a function of time.

    Attributes:
        name: name in the file, without its unit.
        quantity: "position", "velocity", "acceleration", "force", "energy", "momentum" or "mass"; "" if unknown.
        axis: "x", "y" or "z" if the name contains it, else "".
        unit: unit in the file; "" if the file contains no unit. The values are then assumed to be in SI units.
        values: (T,) in SI units; NaN if a cell is empty.
    """

    name: str
    quantity: str
    axis: str
    unit: str
    values: Array


@dataclass(frozen=True, eq=False)
class MeasuredTable:
    """Table of measurements.

    Attributes:
        name: name of the file.
        time: (T,) [s], strictly ascending.
        columns: the other columns, in the order of the file.
    """

    name: str
    time: Array
    columns: tuple[Column, ...]

    def along_row(self, quantity: str) -> tuple[Column, ...]:
        """Return the columns of a quantity along the chain of beads. The result contains the columns for the x axis and
        the columns without an axis.
        """
        return tuple(one for one in self.columns if one.quantity == quantity and one.axis in ("", "x"))

    @property
    def quantities(self) -> tuple[str, ...]:
        """The known quantities of the columns, without repetitions."""
        return tuple(dict.fromkeys(one.quantity for one in self.columns if one.quantity))


def read_table(path: str | Path) -> MeasuredTable:
    """Read a table of measurements. If the meaning of the table is unclear, raise UserError. The message of the error
    contains the line, the column and a remedy.
    """
    path = Path(path)
    lines = re.split(r"\r\n|\r|\n", _text(path))
    layout = _layout(path, lines)
    headers = _headers(path, lines, layout)
    numbers = np.array([row for _line, row in layout.rows])
    at = np.array([line for line, _row in layout.rows])
    timed, time = _time(path, headers, numbers, lines, layout)
    present = np.isfinite(np.delete(numbers, timed, axis=1) if timed is not None else numbers).any(axis=1)
    kept = np.isfinite(time) | present  # A row without any number is a blank line in the file.
    time, at, numbers = time[kept], at[kept], numbers[kept]
    name = headers[timed].name if timed is not None else "time"
    column = 1 if timed is None else timed + 1
    for k in np.flatnonzero(~np.isfinite(time)).tolist():
        raise _wrong(path, at[k], column, _("{name!r} is empty, but the line has numbers", name=name))
    for k in np.flatnonzero(~(np.diff(time) > 0.0)).tolist():
        first, second = float(time[k]), float(time[k + 1])
        text = _(
            "the times must increase, but {next:.6g} s follows {last:.6g} s; export one run", next=second, last=first
        )
        raise _wrong(path, at[k + 1], column, text)
    columns = [
        Column(header.name, header.quantity, header.axis, header.unit, numbers[:, k] * header.factor)
        for k, header in enumerate(headers)
        if k != timed and header.quantity != TIME and not _counts(header)
    ]
    if not columns:
        raise _wrong(path, layout.names_line, 1, _("the time is the only column"))
    return MeasuredTable(path.name, time, tuple(columns))


def _wrong(path: Path, line: int, column: int, problem: str) -> UserError:
    """Return the error for a problem at a position in the file. Lines and columns are counted from 1."""
    return UserError(
        _("{path}, line {line}, column {column}: {problem}", path=path, line=line, column=column, problem=problem)
    )


def _text(path: Path) -> str:
    """Return the text of a file. The encoding can be UTF-8, UTF-16 or Windows-1252."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UserError(_("cannot read {path}: {error}", path=path, error=reason(error))) from None
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        encodings = ["utf-16"]
    elif b"\0" in data[:2000]:
        encodings = ["utf-16-le" if data[1:2] == b"\0" else "utf-16-be"]
    else:
        encodings = ["utf-8-sig", "cp1252"]
    for encoding in encodings:
        try:
            return data.decode(encoding)
        except UnicodeDecodeError:
            continue
    raise _wrong(path, 1, 1, _("not a text file: save the table as text in UTF-8"))


class Layout(NamedTuple):
    """Format of a file.

    A format consists of the delimiter, the decimal mark, the number of the line with the names, the cells of this line,
    and the rows of numbers. Lines are counted from 1.
    """

    delimiter: str | None
    mark: str
    names_line: int
    names: list[str]
    rows: list[tuple[int, list[float]]]


def _cells(line: str, delimiter: str | None) -> list[str]:
    """Return the cells of a line. Blanks around the cells are removed."""
    if delimiter is None:
        return re.split(r"\s+(?![(\[])", line.strip())  # A unit in brackets belongs to the name in front of it.
    # If a quotation mark is not closed, the line is split at every delimiter. The cell is then not a number.
    with contextlib.suppress(csv.Error):
        return [
            cell.strip()
            for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True, strict=True), [])
        ]
    return [cell.strip() for cell in line.split(delimiter)]


def _value(cell: str, mark: str) -> float | None:
    """Return the number in a cell. Return NaN if the cell is empty, and None if it does not contain a finite number."""
    if cell.lower() in MISSING:
        return math.nan
    text = cell.replace("\u2212", "-")
    if mark == ",":
        if "." in text:
            return None
        text = text.replace(",", ".")
    try:
        number = float(text) if "_" not in text else math.inf
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _numeric(cells: Sequence[str], mark: str) -> bool:
    """Return True if a line looks like a line of data.

    A line of data has at least two cells, and all its cells are numeric or empty. The first cell or any two cells are
    numeric.
    """
    if len(cells) < 2:
        return False
    values = [_value(cell, mark) for cell in cells]
    if any(value is None for value in values):
        return False
    return sum(value is not None and not math.isnan(value) for value in values) >= 2 or not math.isnan(values[0] or 0.0)


def _layout(path: Path, lines: list[str]) -> Layout:
    """Return the format of the file. The delimiter and the decimal mark are chosen to make most lines numeric."""
    best: tuple[int, str | None, str] = (0, None, ".")
    for delimiter in DELIMITERS:
        for mark in ".", ",":
            count = sum(_numeric(_cells(line, delimiter), mark) for line in lines if line.strip())
            if count > best[0]:
                best = (count, delimiter, mark)
    count, delimiter, mark = best
    filled = [k for k, line in enumerate(lines) if line.strip()]
    if count == 0:
        last = filled[-1] + 1 if filled else 1
        text = _("no numbers below a line of names; export a table with a time and one column for each quantity")
        raise _wrong(path, last, 1, text)
    first = next(k for k in filled if _numeric(_cells(lines[k], delimiter), mark))
    width = max(len(_cells(lines[k], delimiter)) for k in filled if k >= first)
    above = next((k for k in reversed(filled) if k < first), None)
    names = [] if above is None else _cells(lines[above], delimiter)
    rows = [(k + 1, _row(path, k + 1, _cells(lines[k], delimiter), mark, names)) for k in filled if k >= first]
    if len(rows) < FEWEST_ROWS:
        raise _wrong(path, first + 1, 1, _("a table needs at least two lines of numbers"))
    width = max(width, len(names))
    rows = [(line, row + [math.nan] * (width - len(row))) for line, row in rows]
    return Layout(delimiter, mark, 0 if above is None else above + 1, names, rows)


def _row(path: Path, line: int, cells: list[str], mark: str, names: list[str]) -> list[float]:
    """Return the numbers of a line. Raise UserError if a cell is not a number."""
    found = []
    for k, cell in enumerate(cells):
        number = _value(cell, mark)
        if number is None:
            name = names[k] if k < len(names) and names[k] else _("column {column}", column=k + 1)
            if (mark == "," and "." in cell) or (mark == "." and "," in cell):
                text = _(
                    "{name!r} is {cell!r}, but other numbers have the decimal mark {mark!r}",
                    name=name,
                    cell=cell,
                    mark=mark,
                )
            else:
                text = _("{name!r} is {cell!r}, not a finite number; leave the cell empty", name=name, cell=cell)
            raise _wrong(path, line, k + 1, text)
        found.append(number)
    return found


def _headers(path: Path, lines: list[str], layout: Layout) -> list[Header]:
    """Return the meaning of each column. The meaning follows from the line of names. If a line of units follows, it is
    used as well.
    """
    width = len(layout.rows[0][1])
    markers = _qualisys_markers(lines)
    if markers and 3 * len(markers) == width:
        named = [(marker, axis) for marker in markers for axis in "xyz"]
        return [Header(f"{marker} {axis.upper()}", POSITION, axis, UNITS["mm"][1], "mm") for marker, axis in named]
    names, line = list(layout.names), layout.names_line
    if names and all(_unit(cell) or not cell for cell in names) and any(names) and line >= 2:
        upper = _cells(lines[line - 2], layout.delimiter)
        if len(upper) == len(names):
            names = [f"{name} ({unit})" if unit else name for name, unit in zip(upper, names, strict=True)]
    while len(names) > width and not names[-1]:
        names.pop()
    first = layout.rows[0][0]
    if not any(re.search(r"[^\W\d]", name) for name in names):
        raise _wrong(path, first, 1, _("the numbers need a line of names above them, such as t (s), v1 (m/s)"))
    if len(names) < width:
        full = next(
            (at, row) for at, row in layout.rows if np.isfinite(row[len(names) :]).any() or at == layout.rows[-1][0]
        )
        if np.isfinite(full[1][len(names) :]).any():
            text = _(
                "the line has {cells} cells, but line {line} has {names} names",
                cells=width,
                line=line,
                names=len(names),
            )
            raise _wrong(path, full[0], len(names) + 1, text)
        names += [""] * (width - len(names))
    owners = _owners(lines, layout, len(names))
    headers = [header_of(path, line, k + 1, name) for k, name in enumerate(names)]
    _require_units(path, line, headers)
    # In files of the program Tracker, v and a are absolute values, while v_{x} and a_{x} are components.
    if owners and headers[0].quantity == TIME:
        headers = [one._replace(quantity="") if one.name in ("v", "a") else one for one in headers]
    return [
        one._replace(name=f"{owners[k]} {one.name}".strip()) if k in owners and k else one
        for k, one in enumerate(headers)
    ]


def _require_units(path: Path, line: int, headers: list[Header]) -> None:
    """Raise UserError if the unit of a column is missing and another column of the same quantity is not in SI units."""
    for k, one in enumerate(headers):
        other = next((two for two in headers if two.quantity == one.quantity and two.factor != 1.0), None)
        if one.quantity and not one.unit and other is not None:
            text = _(
                "{name!r} needs a unit because {other!r} is in {unit}",
                name=one.name,
                other=other.name,
                unit=other.unit,
            )
            raise _wrong(path, line, k + 1, text)


def _owners(lines: list[str], layout: Layout, width: int) -> dict[int, str]:
    """Return the names of the tracked objects by column. The program Tracker writes them in the line above the column
    names.
    """
    line = layout.names_line - 1
    if line < 1:
        return {}
    above = _cells(lines[line - 1], layout.delimiter)
    if len(above) == 1 and re.fullmatch(r"[\w .-]+", above[0]) and not "".join(lines[: line - 1]).strip():
        return {0: above[0]}
    if line >= 2 and lines[line - 2].strip().startswith("#multi:"):
        owner, found = "", {}
        for k in range(width):
            owner = above[k] if k < len(above) and above[k] else owner
            if owner:
                found[k] = owner
        return found
    return {}


def header_of(path: Path, line: int, column: int, text: str) -> Header:
    """Return the meaning of a column name such as ``Velocity (m/s)``. Raise UserError if its unit is unknown or does
    not match its name.
    """
    match = UNIT_IN_NAME.match(text)
    unit = next(filter(None, match.groups()[1:5]), "").strip() if match else ""
    found = _unit(unit) if unit else None
    if match is None or (unit and found is None and SYMBOL.fullmatch(text.lower())):
        name, unit = text, ""
    else:
        name = f"{match[1]}{match[6]}".strip()
    quantity, axis = quantity_of(name)
    if unit and found is None and (quantity or "/" in unit):
        known = ", ".join(UNITS)
        raise _wrong(
            path,
            line,
            column,
            _("{name!r} has the unknown unit {unit!r}; known are {known}", name=text, unit=unit, known=known),
        )
    if found is None:
        return Header(name, quantity, axis, 1.0, "")
    if quantity and quantity != found[0]:
        by_name, by_unit = _(QUANTITY_NAMES[quantity]), _(QUANTITY_NAMES[found[0]])
        text = _(
            "{name!r} means {by_name} by its name, but {by_unit} by its unit; rename it",
            name=text,
            by_name=by_name,
            by_unit=by_unit,
        )
        raise _wrong(path, line, column, text)
    absolute = ABSOLUTE.search(name.lower()) and found[0] in (VELOCITY, ACCELERATION)
    return Header(name, "" if absolute else found[0], axis, found[1], unit)


def _unit(text: str) -> tuple[str, float] | None:
    """Return the quantity that a unit measures, and the factor to SI units. Return None if the unit is unknown."""
    plain = text.translate(SUPERSCRIPTS).replace(" ", "").strip("()[]")
    plain = re.sub(r"s-(\d)$", lambda found: "/s" if found[1] == "1" else f"/s{found[1]}", plain)
    plain = plain.replace("/s/s", "/s2")
    return EXACT_UNITS.get(plain) or UNITS.get(plain.lower())


def quantity_of(name: str) -> tuple[str, str]:
    """Return the quantity and the axis that a name without a unit contains. A missing quantity or axis is ""."""
    plain = name.strip().lower()
    axis = next((found[1] for found in [AXIS.search(plain)] if found), "")
    if ABSOLUTE.search(plain):
        return "", axis
    symbol = SYMBOL.fullmatch(plain)
    if symbol and symbol[1] in SYMBOLS:
        index = next(filter(None, symbol.groups()[1:]), "")
        axis = symbol[1] if symbol[1] in "xyz" else next((part for part in index if part in "xyz"), "")
        return SYMBOLS[symbol[1]], axis
    for quantity, words in WORDS.items():
        if any(re.search(rf"\b{word}\b", plain) for word in words):
            return quantity, axis
    return "", axis


def _counts(header: Header) -> bool:
    """Return True if the column contains the numbers of frames or rows."""
    return not header.quantity and header.name.lower() in ("", "unnamed: 0", *COUNTERS)


def _time(
    path: Path, headers: list[Header], numbers: Array, lines: list[str], layout: Layout
) -> tuple[int | None, Array]:
    """Return the number of the time column (or None) and the times [s]. Raise UserError if the time is missing or not
    unique.
    """
    timed = [k for k, header in enumerate(headers) if header.quantity == TIME]
    if len(timed) > 1:
        first, second = (headers[k].name for k in timed[:2])
        text = _("{second!r} and {first!r} are both times; export one run", first=first, second=second)
        raise _wrong(path, layout.names_line, timed[1] + 1, text)
    if timed:
        return timed[0], numbers[:, timed[0]] * headers[timed[0]].factor
    rate = _qualisys_rate(lines)
    if rate is not None:
        return None, np.arange(len(numbers)) / rate
    raise _wrong(path, max(layout.names_line, 1), 1, _("no column is a time; name one t (s)"))


def _tagged(lines: list[str]) -> Iterator[list[str]]:
    """Yield the lines in the header of a Qualisys file, split into cells."""
    if lines[0].startswith(("FILE_VERSION", "NO_OF_FRAMES")):
        for line in lines:
            if not re.match(r"[A-Z_]+\t", line):
                return
            yield line.split("\t")


def _qualisys_markers(lines: list[str]) -> list[str]:
    """Return the names of the markers in the header of a Qualisys file. The positions of the markers are in mm."""
    return next(
        (
            [name.strip() for name in cells[1:] if name.strip()]
            for cells in _tagged(lines)
            if cells[0] == "MARKER_NAMES"
        ),
        [],
    )


def _qualisys_rate(lines: list[str]) -> float | None:
    """Return the number of frames per second in the header of a Qualisys file. Return None if the header does not
    contain it.
    """
    for cells in _tagged(lines):
        if cells[0] == "FREQUENCY":
            try:
                rate = float(cells[1])
            except ValueError:
                return None
            return rate if rate > 0.0 else None
    return None
