"""`softcradle figures`: the figures of the paper and of the data it does not show, as pictures and numbers."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import WrittenFiles, add_open, open_with_desktop
from softcradle.sandbox.console import ProgressShown, console, print_table, table
from softcradle.sandbox.files import filled_folder

if TYPE_CHECKING:
    from pathlib import Path

    from softcradle.sandbox.studies.data_table import Table
    from softcradle.sandbox.studies.figures.figure_list import FigureEntry

KEPT = "figures"  # name of the file in the folder of the output that keeps tables until all figures are drawn


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("names", metavar="NAME", nargs="*", help="figures to draw, such as 1b 2c B (default: all)")
    parser.add_argument(
        "-o", "--output", metavar="FOLDER", default="out/figures", help="where to write (default: out/figures)"
    )
    parser.add_argument("--list", action="store_true", help="list the figures instead")
    add_open(parser)


def main(args: argparse.Namespace) -> int:
    """Draw the figures, or list them."""
    from softcradle.sandbox.studies.figures.figure_list import figures_named, write_figure

    figures = figures_named(args.names)
    if args.list:
        listed = table("name", "place in the paper", "what it shows")
        for figure in figures:
            listed.add_row(figure.name, figure.place, figure.caption)
        print_table(console(), listed)
        return 0
    from softcradle.sandbox.studies.plot_style import require_matplotlib
    from softcradle.sandbox.sweeps.run_sweep import drop_kept

    require_matplotlib()
    with filled_folder(args.output) as folder:
        written = WrittenFiles(folder.iterdir())
        kept = folder / KEPT
        for figure, found in zip(figures, _tables(figures, kept), strict=True):
            written.report(list(write_figure(figure, folder, found)))
        drop_kept(kept)
    if args.open:
        open_with_desktop(folder)
    return 0


def _tables(figures: list[FigureEntry], kept: Path) -> list[Table]:
    """The tables of the figures; they are kept in a file on the way, from which a command that was stopped goes on."""
    from softcradle.sandbox.studies.figures.figure_list import compute_tables

    with ProgressShown("figures") as progress:
        return list(compute_tables(figures, kept, progress.tell))
