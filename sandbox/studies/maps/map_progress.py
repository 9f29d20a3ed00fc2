"""The points of a map computed part by part; what is done is kept in a file beside the picture, and taken up again."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np
from softcradle.physics.version import version
from softcradle.sandbox.studies.data_table import Table
from softcradle.sandbox.studies.maps.rigidity_scan import TOLERANCE, Point, RigidityMap, point_rows, points_of
from softcradle.sandbox.user_error import UserError

PART = 64  # points that are computed, and kept, at once: some seconds at most

WHOLE_NUMBERS = ("n", "status", "warned")  # columns


def compute_map(scanned: RigidityMap, kept: Path | None = None, progress: Callable[[int], None] | None = None) -> Table:
    """The table of a map; with a file `kept`, its points are read from there where it has them, and added to it.

    The file holds a line a point below a line with the settings; other settings begin it anew.
    """
    points = points_of(scanned)
    rows = _read(kept, scanned) if kept else {}
    rows = {point: rows[point] for point in points if point in rows}
    _tell(progress, len(rows))
    todo = [point for point in points if point not in rows]
    for begin in range(0, len(todo), PART):
        part = todo[begin : begin + PART]
        table = point_rows(scanned, part)
        columns = list(table)
        rows |= dict(zip(part, zip(*(table[name].tolist() for name in columns), strict=True), strict=True))
        if kept:
            _add(kept, [rows[point] for point in part])
        _tell(progress, len(part))
    found = dict(zip(_columns(scanned), np.array([rows[point] for point in points]).T, strict=True))
    return found | {name: found[name].astype(int) for name in WHOLE_NUMBERS}


def _columns(scanned: RigidityMap) -> tuple[str, ...]:
    return (scanned.abscissa, "n", "rigidity at detachment", "rigidity at the end", "status", "warned")


def _tell(progress: Callable[[int], None] | None, count: int) -> None:
    if progress is not None and count:
        progress(count)


def _settings(scanned: RigidityMap) -> str:
    return f"{scanned.name}, tolerance {TOLERANCE:g}, softcradle {version()}"


def _read(kept: Path, scanned: RigidityMap) -> dict[Point, tuple[float, ...]]:
    """The rows of the file by point, a line that was cut off left out; a file of other settings, or none, begins anew."""
    try:
        lines = kept.read_text(encoding="utf-8").splitlines(keepends=True) if kept.exists() else []
        if lines[:1] != [_settings(scanned) + "\n"]:
            kept.write_text(_settings(scanned) + "\n", encoding="utf-8")
            return {}
        whole = [line for line in lines if line.endswith("\n")]
        kept.write_text("".join(whole), encoding="utf-8")
    except OSError as error:
        raise UserError(f"cannot write {kept}: {(error.strerror or str(error)).lower()}") from None
    rows = [tuple(map(float, row)) for row in csv.reader(whole[1:]) if len(row) == len(_columns(scanned))]
    return {(row[0], int(row[1])): row for row in rows}


def _add(kept: Path, rows: list[tuple[float, ...]]) -> None:
    with kept.open("a", encoding="utf-8") as file:
        file.write("".join(",".join(map(repr, row)) + "\n" for row in rows))
