"""`softcradle compare`: simulate the same collision in several chains. Write a film or a report, or print numbers."""

import argparse
from pathlib import Path

from softcradle.sandbox.cli.arguments import (
    WrittenFiles,
    add_method,
    add_open,
    check_open,
    opened_outputs,
    picture_size,
    positive_number,
)
from softcradle.sandbox.console import ProgressShown, console, print_json
from softcradle.sandbox.user_error import GAVE_UP

DEFAULT_OUTPUT = "out/compare.html"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scenes", metavar="SCENE", nargs="+", help="names of scenes, or scene files; all their lanes")
    parser.add_argument(
        "--contact", action="append", default=[], metavar="LAW",
        help="beside one scene as it is, the same with LAW in every contact, such as 'power_law(1, 1/10)' or "
        "'draft_gear(5, 0.2)'; may be given several times",
    )  # fmt: skip
    parser.add_argument(
        "--match", nargs="?", const="force", choices=("force", "outcome"),
        help="beside one scene also the power law nearest to its draft gear, or the draft gear nearest to its power law: "
        "by the force of the struck contact (default), or by the outcome, final velocities and contact time",
    )  # fmt: skip
    parser.add_argument(
        "-o", "--output", action="append", default=[], metavar="OUT",
        help="report .html (which plays the motion), film .mp4 .gif, or numbers .json; may be given several "
        f"times (default: {DEFAULT_OUTPUT}, nothing with --json)",
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print the numbers as JSON instead of tables")
    parser.add_argument(
        "--size", type=picture_size, metavar="WxH", help="pixels of the film (default: 1280x720 or higher)"
    )
    parser.add_argument(
        "--slow", type=positive_number, help="seconds of film for a second of motion (default: the scenes')"
    )
    add_method(parser)
    add_open(parser)


def main(args: argparse.Namespace) -> int:
    """Compare the chains and write the outputs. Print the results as tables or as JSON."""
    from softcradle.sandbox.studies.compare.report import ComparisonReport, FilmSettings, check_outputs
    from softcradle.sandbox.studies.compare.results import print_tables, solve_sides
    from softcradle.sandbox.studies.compare.sides import add_match, comparison_of, side_to_match

    comparison = comparison_of(args.scenes, args.contact, args.method, args.step, added=1 if args.match else 0)
    if args.match:
        side_to_match(comparison)
    wanted = args.output or ([] if args.json else [DEFAULT_OUTPUT])
    check_open(args.open, wanted)
    paths, found = list(map(Path, wanted)), None
    written = WrittenFiles(paths)
    settings = FilmSettings(args.size, args.slow)
    check_outputs(paths, comparison, settings)
    with opened_outputs(paths) as places:
        if args.match:
            with ProgressShown("collisions") as shown:
                comparison, found = add_match(comparison, args.match, lambda done: shown.tell("collisions", done))
        report = ComparisonReport(comparison, solve_sides(comparison), settings, found)
        for path in places:
            report.write(path)
    if args.json:
        print_json(report.as_json())
    else:
        output = console()
        print_tables(output, comparison.title, report.results)
        for note in report.notes():
            output.print(note)
    written.report(paths, show=args.open, silent=args.json)
    return GAVE_UP if any(result.trajectory.status.gave_up for result in report.results) else 0
