"""A picture as files: .png to look at, .pdf to print, .csv with its numbers; each is written whole or not at all."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.studies.data_table import Table, write_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".pdf", ".csv")


def save_figure(figure: Figure, path: Path, dpi: float | None = None) -> None:
    """Write `figure` in the format of the name `path`; the same figure makes the same file.

    It is drawn in memory first: on a full disk the writer of .pdf would raise the error of a library of its own.

    Raises:
        OSError: it cannot be written.
    """
    metadata = {"CreationDate": None} if path.suffix == ".pdf" else {"Date": None} if path.suffix == ".svg" else None
    drawn = BytesIO()
    figure.savefig(drawn, format=path.suffix[1:], metadata=metadata, dpi=dpi)
    path.write_bytes(drawn.getvalue())


def write_picture(picture: Figure, table: Table, stem: Path) -> list[Path]:
    """Write `picture` to `stem`.png and .pdf and its numbers to .csv; return the paths (UserError where that fails)."""
    png, pdf, numbers = paths = [stem.with_name(stem.name + suffix) for suffix in SUFFIXES]
    with output_file(png) as temporary:
        save_figure(picture, temporary)
    with output_file(pdf) as temporary:
        save_figure(picture, temporary)
    with output_file(numbers) as temporary:
        write_table(table, temporary)
    return paths
