"""`softcradle methods`: what there is to compute a motion with, and what each method is for."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from softcradle.physics.methods import Method

AUTO_PURPOSE = "wherever time matters: chosen from the chain and the wanted error, the same on every machine"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def main(args: argparse.Namespace) -> int:
    """Print the methods."""
    from softcradle.physics.methods import AUTO, METHODS

    if args.json:
        import json

        print(json.dumps([{"name": AUTO, "purpose": AUTO_PURPOSE}, *map(_as_json, METHODS)], indent=2))
        return 0
    from softcradle.sandbox.console import console, print_table, table

    grid = table("method", "order", "takes", "what it is for")
    grid.add_row(AUTO, "", "tolerance", AUTO_PURPOSE)
    for method in METHODS:
        grid.add_row(method.name, str(method.order), "tolerance" if method.adaptive else "step", method.purpose)
    print_table(console(), grid)
    return 0


def _as_json(method: Method) -> dict[str, str | int | bool]:
    return {
        "name": method.name,
        "purpose": method.purpose,
        "summary": method.summary,
        "order": method.order,
        "takes": "tolerance" if method.adaptive else "step",
        "dissipative": method.dissipative,
    }
