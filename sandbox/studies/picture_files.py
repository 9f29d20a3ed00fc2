"""A picture as files: .png to look at, .pdf to print, .csv with its numbers; each is written whole or not at all."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.studies.data_table import Table, write_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".pdf", ".csv")


def write_picture(picture: Figure, table: Table, stem: Path) -> list[Path]:
    """Write `picture` to `stem`.png and .pdf and its numbers to .csv; return the paths (UserError where that fails)."""
    png, pdf, numbers = paths = [stem.with_name(stem.name + suffix) for suffix in SUFFIXES]
    with output_file(png) as temporary:
        picture.savefig(temporary)
    with output_file(pdf) as temporary:
        picture.savefig(temporary, metadata={"CreationDate": None})  # the same figure makes the same file
    with output_file(numbers) as temporary:
        write_table(table, temporary)
    return paths
