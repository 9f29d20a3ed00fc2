"""Measured data: a table of numbers over time, from a CSV file of somebody's experiment."""

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.motion import Array
from softcradle.sandbox.user_error import UserError, reason

DELIMITERS = ",;\t"
TIMES_ASCEND = N_("{path}: times must ascend, but {next:.6g} s in row {row} follows {last:.6g} s")


@dataclass(frozen=True, eq=False)
class MeasuredData:
    """What was measured.

    Attributes:
        name: of the file.
        columns: names of the quantities.
        time: (T,) [s], ascending.
        values: (T, k) in the units of the plot that shows them; nan where a cell is empty.
    """

    name: str
    columns: tuple[str, ...]
    time: Array
    values: Array


def load_measured(path: str | Path) -> MeasuredData:
    """Read a CSV file: a line of names, then rows of a time [s] and a number a column. UserError where it is none.

    Columns are parted by commas, semicolons or tabs; beside semicolons and tabs numbers may have decimal commas.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise UserError(_("cannot read {path}: {error}", path=path, error=reason(error))) from None
    except UnicodeDecodeError:
        raise UserError(_("{path}: not a table in UTF-8", path=path)) from None
    lines = text.splitlines()
    delimiter = max(DELIMITERS, key=next(filter(str.strip, lines), "").count)
    reader = csv.reader(lines, delimiter=delimiter)
    try:
        filled = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except csv.Error:  # a cell beyond the limit, mostly all that follows a stray quote
        most = csv.field_size_limit()
        raise UserError(
            _("{path}: a cell has more than {most} characters; is a quote not closed?", path=path, most=most)
        ) from None
    line, rows = zip(*filled, strict=True) if filled else ((), ())
    if len(rows) < 3 or len(rows[0]) < 2:
        raise UserError(
            _("{path}: needs a line of names, time first, and at least two rows of numbers below it", path=path)
        )
    names = tuple(cell.strip() for cell in rows[0])
    if all(math.isfinite(_number(cell, delimiter)) for cell in rows[0]):
        raise UserError(_("{path}: its first line must be names, time first, not numbers", path=path))
    numbers = np.array([_row(path, row, at, names, delimiter) for row, at in zip(rows[1:], line[1:], strict=True)])
    time = numbers[:, 0]
    late = np.flatnonzero(~(np.diff(time) > 0.0))
    if late.size:
        k = int(late[0])
        raise UserError(_(TIMES_ASCEND, path=path, next=float(time[k + 1]), row=line[k + 2], last=float(time[k])))
    return MeasuredData(path.name, names[1:], time, numbers[:, 1:])


def _row(path: Path, row: list[str], line: int, names: tuple[str, ...], delimiter: str) -> list[float]:
    """The numbers of one line; an empty cell is nan, but for the time."""
    if len(row) != len(names):
        raise UserError(
            _(
                "{path}: row {row} has {cells} cells, and {names} names are above it",
                path=path,
                row=line,
                cells=len(row),
                names=len(names),
            )
        )
    found = [_number(cell, delimiter) for cell in row]
    for k, (name, cell, number) in enumerate(zip(names, row, found, strict=True)):
        if math.isnan(number) and (k == 0 or cell.strip()):
            raise UserError(
                _(
                    "{path}: {name!r} in row {row} is {cell!r}, not a finite number",
                    path=path,
                    name=name,
                    row=line,
                    cell=cell.strip(),
                )
            )
    return found


def _number(cell: str, delimiter: str) -> float:
    """The finite number in a cell, else nan."""
    try:
        number = float(cell.replace(",", ".") if delimiter != "," else cell)
    except ValueError:
        return math.nan
    return number if math.isfinite(number) else math.nan
