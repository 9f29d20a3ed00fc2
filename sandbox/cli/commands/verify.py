"""`softcradle verify`: everything that is known from outside, each number with its source, ours, and the error."""

import argparse

from softcradle.sandbox.console import ProgressShown, print_json, print_rows

DISAGREES = 1  # exit code where a number is not met


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def main(args: argparse.Namespace) -> int:
    """Compute all numbers and print them; the exit code is 1 where one is not met."""
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
