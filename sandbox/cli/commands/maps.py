"""`softcradle maps`: where a struck cluster moves like a rigid body, over softness or speed, and size."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import WrittenFiles, add_open
from softcradle.sandbox.user_error import UserError, named

if TYPE_CHECKING:
    from softcradle.sandbox.studies.data_table import Table
    from softcradle.sandbox.studies.rigidity_maps import RigidityMap

NAMES = ("power-law", "draft-gear")
COLUMNS = 200  # abscissae of a map, where none are given
ROWS = 20  # cluster sizes of a map, where none are given
MOST_POINTS = 2000  # along either side of a map: a typing error must not run for days


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
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
    """Compute the maps, draw them and write their numbers."""
    names = named("map", args.names, dict(zip(NAMES, NAMES, strict=True)))
    columns, rows = _points(args.points)
    from softcradle.sandbox.files import filled_folder
    from softcradle.sandbox.studies.plot_style import require_matplotlib
    from softcradle.sandbox.studies.rigidity_maps import rigidity_maps
    from softcradle.sandbox.sweeps.run_sweep import drop_kept

    require_matplotlib()
    with filled_folder(args.output) as folder:
        written = WrittenFiles(folder.iterdir())
        for wanted in rigidity_maps(columns, rows):
            if wanted.name in names:
                kept = folder / f"map-{wanted.name}"
                written.report(_write(wanted, _computed(wanted, kept), folder), show=args.open)
                drop_kept(kept)
    return 0


def _points(text: str) -> tuple[int, int]:
    columns, _, rows = text.partition("x")
    if not all(number.isdigit() and 2 <= int(number) <= MOST_POINTS for number in (columns, rows)):
        limits = f"two whole numbers from 2 to {MOST_POINTS}, such as {COLUMNS}x{ROWS}"
        raise UserError(f"--points must be {limits}, not {text!r}")
    return int(columns), int(rows)


def _computed(wanted: RigidityMap, kept: Path) -> Table:
    """The table of a map; its points are kept in a file on the way, from which a command that was stopped goes on."""
    from softcradle.sandbox.console import ProgressShown
    from softcradle.sandbox.studies.rigidity_maps import compute_map

    with ProgressShown(f"{wanted.title}: points") as progress:
        return compute_map(wanted, kept, progress.tell)


def _write(wanted: RigidityMap, table: Table, folder: Path) -> list[Path]:
    from softcradle.sandbox.studies.plot_style import styled, write_picture
    from softcradle.sandbox.studies.rigidity_maps import draw_map

    with styled():
        return write_picture(draw_map(wanted, table), table, folder / f"map-{wanted.name}")
