"""`softcradle figures`: draw the figures of the paper. The command also draws figures of data that the paper mentions
but does not show.
"""

import argparse

from softcradle.sandbox.cli.arguments import LISTED, add_open, open_with_desktop, picture_folder, refuse_options
from softcradle.sandbox.console import ProgressShown, print_rows

# Name of a file store in the output folder. The store keeps the computed tables until all figures are drawn.
KEPT = "figures"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("names", metavar="NAME", nargs="*", help="figures to draw, such as 1b 2c B (default: all)")
    parser.add_argument(
        "-o", "--output", metavar="FOLDER", default="out/figures", help="where to write (default: out/figures)"
    )
    parser.add_argument("--list", action="store_true", help="list the figures instead")
    add_open(parser)


def main(args: argparse.Namespace) -> int:
    """Draw the figures, or print the list of figures."""
    from softcradle.sandbox.studies.figures.catalogue import compute_tables, figures_named, write_figure

    figures = figures_named(args.names)
    if args.list:
        refuse_options(args, LISTED, "open")
        rows = [(figure.name, figure.place, figure.caption) for figure in figures]
        print_rows(("name", "place in the paper", "what it shows"), rows)
        return 0
    with picture_folder(args.output, KEPT) as (folder, kept, written):
        with ProgressShown("figures") as progress:
            tables = list(compute_tables(figures, kept, progress.tell))
        for figure, found in zip(figures, tables, strict=True):
            written.report(write_figure(figure, folder, found))
    if args.open:
        open_with_desktop(folder)
    return 0
