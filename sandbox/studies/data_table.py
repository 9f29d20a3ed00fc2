"""Table of numbers in columns, used for the data of a figure and for its .csv file."""

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray


def write_rows(path: Path, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write the row `header` and the `rows` to the .csv file `path`."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows(rows)


Array = NDArray[np.float64]
Table = dict[str, Array]  # Maps each column name to the values (T,) of the column.


def long_table(columns: Sequence[str], blocks: Sequence[Sequence[ArrayLike]]) -> Table:
    """Return a table that consists of the rows of all `blocks`.

    A block contains a value or an array for each column. The values and arrays of a block are broadcast together.
    """
    arrays = [
        np.column_stack(np.broadcast_arrays(*[np.atleast_1d(np.asarray(value, dtype=np.float64)) for value in block]))
        for block in blocks
    ]
    stacked = np.concatenate(arrays)
    return {name: stacked[:, k] for k, name in enumerate(columns)}


def rows_where(table: Table, **values: float) -> Table:
    """Return the rows of `table` in which the named columns have the given values."""
    rows = np.ones(len(next(iter(table.values()))), dtype=bool)
    for name, value in values.items():
        rows &= np.isclose(table[name], value, rtol=1e-12, atol=0.0)
    return {name: column[rows] for name, column in table.items()}


def write_table(table: Table, path: Path) -> None:
    """Write `table` to the .csv file `path`, with the column names in the first row.

    Numbers that are read from the file are equal to the numbers of the table.
    """
    write_rows(path, tuple(table), zip(*(column.tolist() for column in table.values()), strict=True))
