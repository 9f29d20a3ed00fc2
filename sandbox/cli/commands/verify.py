"""`softcradle verify`: everything that is known from outside, each number with its source, ours, and the error."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from softcradle.sandbox.studies.verify import Checked

DISAGREES = 1  # exit code where a number is not met


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def main(args: argparse.Namespace) -> int:
    """Compute all numbers and print them; the exit code is 1 where one is not met."""
    from softcradle.sandbox.console import ProgressShown
    from softcradle.sandbox.studies.verify import known_numbers, verified

    with ProgressShown("numbers", len(known_numbers())) as progress:
        found = verified(lambda _: progress.advance())
    if args.json:
        _print_json(found)
    else:
        _print(found)
    return 0 if all(row.agrees for row in found) else DISAGREES


def _print(found: list[Checked]) -> None:
    from softcradle.sandbox.console import console, print_table, table

    grid = table("number", "known", "source", "found", "error", "at most", "")
    for row in found:
        known, verdict = row.known, "met" if row.agrees else "missed"
        shown = (f"{known.value:.10g}", known.source, f"{row.found:.10g}", f"{row.error:.1e}", f"{known.allowed:.0e}")
        grid.add_row(known.name, *shown, verdict)
    print_table(console(), grid)


def _print_json(found: list[Checked]) -> None:
    import json

    names = ("name", "value", "source", "allowed")
    rows = [
        {
            **{name: getattr(row.known, name) for name in names},
            "found": row.found,
            "error": row.error,
            "met": row.agrees,
        }
        for row in found
    ]
    print(json.dumps({"numbers": rows}, indent=2, allow_nan=False))
