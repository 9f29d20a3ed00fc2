"""`softcradle maps`: draw maps that show how rigidly a struck cluster of beads moves. One axis of a map is the size of
the cluster. The other axis is the softness or the speed.
"""

import argparse
from contextlib import suppress

from softcradle.sandbox.cli.arguments import add_open, picture_folder, picture_size
from softcradle.sandbox.console import ProgressShown
from softcradle.sandbox.user_error import UserError, named

NAMES = ("power-law", "draft-gear")
COLUMNS = 200  # Default number of columns of a map. Each column has one value of softness or speed.
ROWS = 20  # Default number of rows of a map. Each row has one cluster size.
# Largest number of rows or columns. With this limit, a typing error cannot start a computation of several days.
MOST_POINTS = 2000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "names", metavar="NAME", nargs="*", help=f"maps to draw: {', '.join(NAMES)} (default: all)"
    )  # fmt: skip
    parser.add_argument(
        "-o", "--output", metavar="FOLDER", default="out/maps", help="where to write (default: out/maps)"
    )
    parser.add_argument(
        "--points", metavar="WxH", default=f"{COLUMNS}x{ROWS}",
        help=f"abscissae and cluster sizes (default: {COLUMNS}x{ROWS})",
    )  # fmt: skip
    add_open(parser)


def main(args: argparse.Namespace) -> int:
    """Compute the maps, draw them and write their numbers to files."""
    names = named("map", args.names, dict(zip(NAMES, NAMES, strict=True)))
    columns, rows = _points(args.points)
    from softcradle.sandbox.studies.plot_style import styled, write_picture
    from softcradle.sandbox.studies.rigidity_maps import compute_map, draw_map, rigidity_maps

    for wanted in rigidity_maps(columns, rows):
        stem = f"map-{wanted.name}"
        if wanted.name in names:
            with picture_folder(args.output, stem) as (folder, kept, written), styled():
                with ProgressShown(f"{wanted.title}: points") as progress:
                    table = compute_map(wanted, kept, progress.tell)
                written.report(write_picture(draw_map(wanted, table), table, folder / stem), show=args.open)
    return 0


def _points(text: str) -> tuple[int, int]:
    with suppress(argparse.ArgumentTypeError):
        columns, rows = picture_size(text)
        if min(columns, rows) >= 2 and max(columns, rows) <= MOST_POINTS:
            return columns, rows
    limits = f"two whole numbers from 2 to {MOST_POINTS}, such as {COLUMNS}x{ROWS}"
    raise UserError(f"--points must be {limits}, not {text!r}")
