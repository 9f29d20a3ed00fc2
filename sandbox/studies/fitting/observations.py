"""Interpretation of the columns of a measured table as observations of beads and contacts."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from softcradle.physics import Chain
from softcradle.sandbox.measured_table import (
    FORCE,
    POSITION,
    TIME,
    VELOCITY,
    Column,
    MeasuredTable,
    header_of,
    quantity_of,
    read_table,
)
from softcradle.sandbox.motion import Array
from softcradle.sandbox.user_error import StudyError

FITTED = (POSITION, VELOCITY, FORCE)  # Quantities that a fit can use.
UNIT_OF = {POSITION: "m", VELOCITY: "m/s", FORCE: "N"}
# Pattern of a name that consists of a quantity and the number of a bead or contact, such as v0, x_{1} or force 0-1.
NUMBERED = re.compile(r"(?:[a-z]|[^\W\d]{3,})[\s_{(]*(\d+)(?:\s*-\s*\d+)?[})]*$", re.IGNORECASE)
PLACE = re.compile(rf"({'|'.join(FITTED)})\s*[\[ .]?\s*(\d+)\]?$")


@dataclass(frozen=True, eq=False)
class Observation:
    """Column of data with the bead or contact that it describes.

    Attributes:
        name: name of the column in the data.
        quantity: position, velocity or force.
        index: number of the bead, or of the contact for a force.
        values: (T,) values in SI units; NaN if a value is missing.
    """

    name: str
    quantity: str
    index: int
    values: Array


def table_from(data: Any) -> MeasuredTable:
    """Return the measured table from a file or a mapping.

    A mapping contains arrays by names such as `time`, `velocity 0` and `left x (mm)`. Raise UserError or StudyError if
    the data are not a table with a time.
    """
    if isinstance(data, MeasuredTable):
        return data
    if isinstance(data, (str, Path)):
        return read_table(data)
    if not hasattr(data, "items"):
        raise StudyError(f"data must be a file, a table or a mapping of arrays, not {type(data).__name__}")
    arrays = {str(name): np.asarray(values, dtype=np.float64) for name, values in data.items()}
    meaning = {name: header_of(Path("data"), 1, k + 1, name) for k, name in enumerate(arrays)}
    times = [name for name, header in meaning.items() if header.quantity == TIME]
    if len(times) != 1:
        raise StudyError(f"data need exactly one time, not {len(times)}; they contain {', '.join(arrays)}")
    time = arrays.pop(times[0]) * meaning[times[0]].factor
    if time.ndim != 1 or time.size < 2 or not np.isfinite(time).all() or not (np.diff(time) > 0.0).all():
        raise StudyError(f"{times[0]} must be ascending finite times, at least two")
    wrong = next((name for name, values in arrays.items() if values.shape != time.shape), None)
    if wrong is not None:
        raise StudyError(f"{wrong} has the shape {arrays[wrong].shape}, but there are {time.size} times")
    columns = []
    for name, values in arrays.items():
        one = meaning[name]
        columns.append(Column(one.name, one.quantity, one.axis, one.unit, values * one.factor))
    return MeasuredTable("data", time, tuple(columns))


def observations(
    table: MeasuredTable, chain: Chain, quantities: Sequence[str] = (), columns: Mapping[str, str] | None = None
) -> list[Observation]:
    """Return the columns of `table` that a fit uses, each with its bead or contact.

    Without `quantities`, the fit uses the forces and the positions. If positions are missing, the fit uses velocities.
    The mapping `columns` gives the place of columns by name, such as "position 0". If it is given, only its columns are
    used. Raise StudyError if the place of a column is unclear.
    """
    if columns:
        return [_stated(table, chain, name, place) for name, place in columns.items()]
    present = [quantity for quantity in FITTED if table.along_row(quantity)]
    unknown = next((one for one in quantities if one not in FITTED), None)
    if unknown is not None:
        raise StudyError(f"a fit uses {', '.join(FITTED)}, not {unknown!r}")
    missing = next((one for one in quantities if one not in present), None)
    if missing is not None:
        raise StudyError(f"{table.name}: no column is a {missing}; it contains {_contents(table)}")
    if not present:
        raise StudyError(
            f"{table.name}: no column is a position, velocity or force; it contains {_contents(table)}; name the "
            "meaning of a column, such as --column 'NAME=position 0'"
        )
    used = list(quantities) or [one for one in present if one != VELOCITY or POSITION not in present]
    found = list[Observation]()
    for quantity in used:
        found += _placed(table, chain, quantity)
    return found


def _contents(table: MeasuredTable) -> str:
    return ", ".join(f"{one.name!r} ({one.quantity or 'unknown'})" for one in table.columns)


def _stated(table: MeasuredTable, chain: Chain, name: str, place: str) -> Observation:
    """Return the observation of a column whose place the user has given."""
    column = next((one for one in table.columns if one.name == name), None)
    if column is None:
        raise StudyError(f"{table.name}: there is no column {name!r}; it contains {_contents(table)}")
    match = PLACE.match(place.strip())
    if match is None:
        raise StudyError(f"column {name!r} must be such as 'position 0', 'velocity 1' or 'force 0', not {place!r}")
    quantity, index = match[1], int(match[2])
    if column.quantity and column.quantity != quantity:
        raise StudyError(f"column {name!r} of {table.name} is a {column.quantity}, not a {quantity}")
    count = chain.contacts + (quantity != FORCE)
    if index >= count:
        raise StudyError(f"column {name!r}: {quantity} {index} does not exist; the numbers are 0 to {count - 1}")
    return Observation(name, quantity, index, column.values)


def _placed(table: MeasuredTable, chain: Chain, quantity: str) -> list[Observation]:
    """Return the observations of a quantity.

    The numbers in the names of the columns are the numbers of the beads. Without numbers, the order of the columns
    counts. Positions of markers without numbers are sorted from left to right.
    """
    columns = table.along_row(quantity)
    count = chain.contacts + (quantity != FORCE)
    movable = [k for k in range(count) if quantity == FORCE or math.isfinite(chain.mass[k])]
    numbers = [_number(column) for column in columns]
    stated = [number for number in numbers if number is not None]
    if len(stated) == len(columns) == len(set(stated)):
        ordered = sorted(range(len(columns)), key=lambda k: stated[k])
        if max(stated) < count and (0 in stated or len(columns) < len(movable)):
            if 0 not in stated and len(columns) < count:
                raise _unclear(table, quantity, columns, count)
            return [Observation(columns[k].name, quantity, stated[k], columns[k].values) for k in ordered]
    elif quantity == FORCE or len(columns) not in (count, len(movable)):
        ordered = list(range(len(columns)))
    else:
        ordered = _from_left(table, columns)
    if len(columns) == count:
        places = list(range(count))
    elif len(columns) == len(movable):
        places = movable
    else:
        raise _unclear(table, quantity, columns, count)
    pairs = zip(ordered, places, strict=True)
    return [Observation(columns[k].name, quantity, place, columns[k].values) for k, place in pairs]


def _unclear(table: MeasuredTable, quantity: str, columns: Sequence[Column], count: int) -> StudyError:
    names = ", ".join(repr(one.name) for one in columns)
    owners = "contacts" if quantity == FORCE else "beads"
    return StudyError(
        f"{table.name}: which of the {count} {owners} the columns {names} belong to is unclear; state it, such as "
        f"--column '{columns[0].name}={quantity} 0'"
    )


def _number(column: Column) -> int | None:
    """Return the number of the bead or contact in the name of a column, or None."""
    match = NUMBERED.fullmatch(column.name.strip())
    return int(match[1]) if match and quantity_of(column.name)[0] == column.quantity else None


def _from_left(table: MeasuredTable, columns: Sequence[Column]) -> list[int]:
    """Return the order of the columns from left to right, given by their first positions."""
    places = table.along_row(POSITION)
    if len(places) != len(columns):
        return list(range(len(columns)))

    def first(k: int) -> float:
        values = places[k].values
        present = values[np.isfinite(values)]
        return float(present[0]) if present.size else math.inf

    return sorted(range(len(columns)), key=first)
