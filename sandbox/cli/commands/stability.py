"""`softcradle stability`: draw maps of the time steps at which each method fails. The maps also show how it fails."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import WrittenFiles, add_open, figure_path, opened_outputs
from softcradle.sandbox.console import ProgressShown, console, print_rows
from softcradle.sandbox.user_error import named

if TYPE_CHECKING:
    from softcradle.sandbox.studies.stability.failure_scans import ScanRun

TITLES = ("varied", "method", "failed", "how", "finest that fails", "finer than estimated", "not warned of")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "scans", metavar="SCAN", nargs="*", help="what to vary beside the step: alpha, n, preload (default: all)"
    )
    parser.add_argument(
        "-o", "--output", metavar="PICTURE", default="out/stability.png",
        help="picture to write, with a .csv of every run beside it (default: out/stability.png)",
    )  # fmt: skip
    parser.add_argument(
        "--details", action="store_true", help="draw energy, velocities and switches of every run too: PICTURE-details"
    )
    add_open(parser)


def main(args: argparse.Namespace) -> int:
    """Run the scans of time steps, draw the maps and print the summary."""
    from softcradle.sandbox.studies.plot_style import save_figure, styled
    from softcradle.sandbox.studies.stability.failure_scans import SCANS, swept_runs, write_csv
    from softcradle.sandbox.studies.stability.scan_maps import draw_details, draw_overview

    path = figure_path(args.output, "stability")
    scans = named("scan", args.scans, {scan.name: scan for scan in SCANS})
    paths = [path, path.with_suffix(".csv"), *[path.with_stem(f"{path.stem}-details")] * args.details]
    written = WrittenFiles(paths)
    with opened_outputs(paths) as (picture, numbers, *details), styled():
        with ProgressShown("runs") as progress:
            runs = swept_runs(scans, progress.tell)
        save_figure(draw_overview(runs, scans), picture, 140.0)
        for detail in details:
            save_figure(draw_details(runs, scans), detail, 140.0)
        write_csv(runs, numbers)
    _print(runs)
    written.report(paths, show=args.open)
    return 0


def _print(runs: Sequence[ScanRun]) -> None:
    from softcradle.physics.advice.stability_limits import TRUSTED_ERROR
    from softcradle.physics.methods import find_method
    from softcradle.sandbox.studies.stability.failure_scans import ADAPTIVE_ERROR_FACTOR, summarise_failures

    rows = []
    for found in summarise_failures(runs):
        finest = (
            "-" if found.finest is None else f"{found.finest.fineness:.2g} at {found.scan} = {found.finest.value:.2g}"
        )
        how = ", ".join(f"{kind} {count}" for kind, count in found.kinds) or "-"
        unsafe = "-" if find_method(found.method).adaptive else str(found.below_limit)
        failed = f"{found.failed} of {found.runs}"
        rows.append((found.scan, found.method, failed, how, finest, unsafe, str(found.silent)))
    output = console()
    print_rows(TITLES, rows, output=output)
    output.print(
        f"failed: target velocities off by more than {TRUSTED_ERROR:g} of the closing speed, or "
        f"{ADAPTIVE_ERROR_FACTOR:g} times the tolerance; chatter: contacts switch more often than they should; error: "
        "they do not; blow-up: the energy has at least doubled. Letters in the maps of --details: c, e, b; red without a warning."
    )
    output.print(_caution())


def _caution() -> str:
    """Return a sentence about the energy that a Newton's cradle gains or loses with the rigid contacts of pymunk."""
    from softcradle.sandbox.studies.stability.rigid_cradle import DURATION, STEPS, remaining_energy, strike

    energies = ", ".join(f"{remaining_energy(step):.2f} at 1/{1.0 / step:.0f} s" for step in STEPS)
    final = " ".join(f"{speed:.2f}" for speed in strike(STEPS[0]) + 0.0)
    return (
        f"caution: with pymunk's own rigid contacts, a cradle of five has after {DURATION:g} s this part of its energy: "
        f"{energies}; one on four ends with {final} at any step: the last ball leaves alone, not the cluster."
    )
