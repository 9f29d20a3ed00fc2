"""`softcradle claims`: studies of the paper's statements, each with range, error bars, verdict, counter-example, picture."""

from __future__ import annotations

import argparse
from contextlib import nullcontext
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import WrittenFiles, add_open
from softcradle.sandbox.user_error import named

if TYPE_CHECKING:
    from pathlib import Path

    from softcradle.sandbox.studies.claims.claim import JudgedClaim

KEPT = "claims"  # name of the file in the folder of the output that keeps cases until all are measured


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
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
    """Measure the claims, print them, and write their pictures."""
    from softcradle.sandbox.console import console, print_table, table
    from softcradle.sandbox.studies.claims.claim_list import CLAIMS

    claims = named("claim", args.names, {claim.name: claim for claim in CLAIMS})
    if args.list:
        listed = table("claim", "place in the paper", "statement")
        for claim in claims:
            listed.add_row(claim.name, claim.place, claim.statement)
        print_table(console(), listed)
        return 0
    _measure_and_show(args)
    return 0


def _measure_and_show(args: argparse.Namespace) -> None:
    from softcradle.sandbox.files import filled_folder, output_file
    from softcradle.sandbox.studies.claims.study_figure import markdown, write_studies
    from softcradle.sandbox.studies.plot_style import require_matplotlib
    from softcradle.sandbox.sweeps.run_sweep import drop_kept

    output = args.output or ("out/claims" if args.names and not args.json else None)
    if output:
        require_matplotlib()
    # The folder is made before the runs, so that an unwritable place is refused at once.
    with filled_folder(output) if output else nullcontext() as folder:
        written = WrittenFiles(folder.iterdir() if folder else ())
        with output_file(args.markdown) if args.markdown else nullcontext() as table:
            found = _measured(args.names, folder / KEPT if folder else None)
            if table:
                table.write_text("\n".join(markdown(found)) + "\n", encoding="utf-8")
        _print(found, args)
        if folder is not None:
            paths = write_studies(found, folder)
            drop_kept(folder / KEPT)
            if not args.json:
                written.report(paths, show=args.open)


def _print(found: list[JudgedClaim], args: argparse.Namespace) -> None:
    from softcradle.sandbox.console import console
    from softcradle.sandbox.studies.claims.study_figure import print_studies, print_study

    if args.json:
        _print_json(found)
    elif args.names:
        for study in found:
            print_study(console(), study)
    else:
        print_studies(console(), found)


def _measured(names: list[str], kept: Path | None) -> list[JudgedClaim]:
    from softcradle.sandbox.console import ProgressShown
    from softcradle.sandbox.studies.claims.claim_list import measure_claims

    with ProgressShown("cases") as progress:
        return measure_claims(names, progress.tell, kept=kept)


def _print_json(found: list[JudgedClaim]) -> None:
    import json

    from softcradle.physics.trajectory_file import versions
    from softcradle.sandbox.studies.claims.study_figure import as_json

    print(
        json.dumps({"claims": [as_json(study) for study in found], "versions": versions()}, indent=2, allow_nan=False)
    )
