"""`softcradle methods`: list the integration methods and the purpose of each."""

import argparse

from softcradle.physics.methods import AUTO, METHODS
from softcradle.sandbox.console import print_json, print_rows

AUTO_PURPOSE = "wherever time matters: chosen from the chain and the wanted error, the same on every machine"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def main(args: argparse.Namespace) -> int:
    """Print the integration methods with their purposes."""
    takes = {method: "tolerance" if method.adaptive else "step" for method in METHODS}
    if args.json:
        names = ("name", "purpose", "summary", "order", "dissipative")
        tables = [{name: getattr(one, name) for name in names} | {"takes": takes[one]} for one in METHODS]
        print_json([{"name": AUTO, "purpose": AUTO_PURPOSE}, *tables])
        return 0
    rows = [(method.name, str(method.order), takes[method], method.purpose) for method in METHODS]
    print_rows(("method", "order", "takes", "what it is for"), [(AUTO, "", "tolerance", AUTO_PURPOSE), *rows])
    return 0
