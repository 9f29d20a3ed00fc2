"""A figure as files: a picture to look at, one to print, and its numbers."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING

from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.studies.figures import Figure
from softcradle.sandbox.studies.figures.figure_style import styled
from softcradle.sandbox.studies.figures.solved_cases import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Picture

SUFFIXES = (".png", ".pdf", ".csv")


def write(figure: Figure, folder: Path) -> list[Path]:
    """Compute `figure` and write it into `folder` as .png, .pdf and .csv, whole or not at all (UserError)."""
    table = figure.compute()
    with styled():
        return write_all(figure.picture(table), table, folder / f"figure-{figure.name}")


def write_all(picture: Picture, table: Table, stem: Path) -> list[Path]:
    """Write `picture` to `stem`.png and .pdf and its numbers to .csv, each whole or not at all; returns the paths."""
    paths = [stem.with_name(stem.name + suffix) for suffix in SUFFIXES]
    for path in paths[:2]:
        with output_file(path) as temporary:
            picture.savefig(temporary, metadata={"CreationDate": None} if path.suffix == ".pdf" else None)
    with output_file(paths[2]) as temporary:
        write_csv(table, temporary)
    return paths


def write_csv(table: Table, path: Path) -> None:
    """Write `table` to `path`: a header of column names, then a row a sample; numbers read back equal."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(table)
        writer.writerows(zip(*(column.tolist() for column in table.values()), strict=True))
