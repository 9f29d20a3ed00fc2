"""`softcradle claims`: measure the statements of the paper. Each statement gets a range, error bars, a verdict, a
counter-example and a picture.
"""

from __future__ import annotations

import argparse
from contextlib import nullcontext
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import LISTED, add_open, check_open, picture_folder, refuse_options
from softcradle.sandbox.console import ProgressShown, console, print_json, print_rows
from softcradle.sandbox.user_error import named

if TYPE_CHECKING:
    from softcradle.sandbox.studies.claims.claim import JudgedClaim

# Name of a file store in the output folder. The store keeps the measured cases until all cases are measured.
KEPT = "claims"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("names", metavar="ID", nargs="*", help="claims to measure, with all their cases (default: all)")
    parser.add_argument(
        "-o", "--output", metavar="FOLDER",
        help="where to write the pictures and their numbers (default: out/claims for claims that are named, else none)",
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    parser.add_argument("--markdown", metavar="FILE", help="write the verdicts as a table into this file, too")
    parser.add_argument("--list", action="store_true", help="list the claims instead of measuring them")
    add_open(parser)


def main(args: argparse.Namespace) -> int:
    """Measure the statements of the paper, print the results, and write the pictures."""
    from softcradle.sandbox.files import output_file
    from softcradle.sandbox.studies.claims.catalogue import CLAIMS, measure_claims
    from softcradle.sandbox.studies.claims.study_figure import markdown, write_studies

    claims = named("claim", args.names, {claim.name: claim for claim in CLAIMS})
    if args.list:
        refuse_options(args, LISTED, "output", "json", "markdown", "open")
        print_rows(
            ("claim", "place in the paper", "statement"), [(one.name, one.place, one.statement) for one in claims]
        )
        return 0
    output = args.output or ("out/claims" if args.names and not args.json else None)
    check_open(args.open, output)
    with picture_folder(output, KEPT) if output else nullcontext((None, None, None)) as (folder, kept, written):
        with output_file(args.markdown) if args.markdown else nullcontext() as table:
            with ProgressShown("cases") as progress:
                found = measure_claims(args.names, progress.tell, kept=kept)
            if table:
                table.write_text("\n".join(markdown(found)) + "\n", encoding="utf-8")
        _print(found, args)
        if folder is not None and written is not None:
            paths = write_studies(found, folder)
            written.report(paths, show=args.open, silent=args.json)
    return 0


def _print(found: list[JudgedClaim], args: argparse.Namespace) -> None:
    from softcradle.physics.trajectory_file import versions
    from softcradle.sandbox.studies.claims.study_figure import as_json, print_studies, print_study

    if args.json:
        print_json({"claims": [as_json(study) for study in found], "versions": versions()})
    elif args.names:
        for study in found:
            print_study(console(), study)
    else:
        print_studies(console(), found)
