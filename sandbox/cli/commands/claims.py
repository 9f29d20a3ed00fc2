"""`softcradle claims`: the paper's statements and what was measured of each, as a table or as JSON."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from softcradle.sandbox.studies.claims.claim import Claim


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def main(args: argparse.Namespace) -> int:
    """Measure all claims and print them."""
    from softcradle.sandbox.studies.claims.claim_list import measure_claims

    found = measure_claims()
    if args.json:
        _print_json(found)
    else:
        _print_table(found)
    return 0


def _print_json(found: list[Claim]) -> None:
    import json
    from dataclasses import asdict

    from softcradle.physics.trajectory_file import versions

    print(json.dumps({"claims": [asdict(claim) for claim in found], "versions": versions()}, indent=2, allow_nan=False))


def _print_table(found: list[Claim]) -> None:
    from rich.text import Text
    from softcradle.sandbox.console import console, table
    from softcradle.sandbox.studies.claims.claim import Verdict

    colours = {Verdict.HOLDS: "green", Verdict.LIMIT: "yellow", Verdict.FAILS: "red"}
    grid = table("claim", "place", "what we measure", "how", "verdict")
    grid.show_lines = True
    for column, share in zip(grid.columns, (5, 2, 10, 4, 2), strict=True):
        column.ratio, column.overflow = share, "fold"
    grid.expand = True
    for claim in found:
        grid.add_row(
            claim.statement, claim.place, claim.measured, claim.how, Text(claim.verdict, colours[claim.verdict])
        )
    output = console()
    output.print(grid)
    for verdict, colour in colours.items():
        output.print(f"{verdict}: {sum(claim.verdict == verdict for claim in found)}", style=colour)
