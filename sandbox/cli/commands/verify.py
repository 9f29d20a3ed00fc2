"""`softcradle verify`: compute numbers that are known from other sources. Print the source, the result and the error of
each number.
"""

import argparse

from softcradle.sandbox.console import ProgressShown, print_json, print_rows

DISAGREES = 1  # Exit code if a computed number is wrong.


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def main(args: argparse.Namespace) -> int:
    """Compute and print all numbers. Return 1 if one of them is wrong, otherwise 0."""
    from softcradle.sandbox.studies.verify import known_numbers, verified

    with ProgressShown("numbers", len(known_numbers())) as progress:
        found = verified(lambda _: progress.advance())
    if args.json:
        names = ("name", "value", "source", "allowed")
        numbers = [{name: getattr(row.known, name) for name in names} for row in found]
        measured = [{"found": row.found, "error": row.error, "met": row.agrees} for row in found]
        print_json({"numbers": [one | other for one, other in zip(numbers, measured, strict=True)]})
    else:
        rows = [
            (row.known.name, f"{row.known.value:.10g}", row.known.source, f"{row.found:.10g}", f"{row.error:.1e}",
             f"{row.known.allowed:.0e}", "met" if row.agrees else "missed")
            for row in found
        ]  # fmt: skip
        print_rows(("number", "known", "source", "found", "error", "at most", ""), rows)
    return 0 if all(row.agrees for row in found) else DISAGREES
