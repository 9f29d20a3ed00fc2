"""`softcradle sweep`: compute a study with many points, on this machine or with a Dask scheduler. An interrupted study
can be continued later.
"""

from __future__ import annotations

import argparse
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import DEFAULT_FOLDER, positive_number, refuse_options, whole_number
from softcradle.sandbox.console import ProgressShown, console, note, print_rows
from softcradle.sandbox.user_error import POINTS_LOST, UserError

if TYPE_CHECKING:
    import xarray as xr
    from softcradle.sandbox.sweeps.study_file import SweepStudy

MOST_WORKERS = 1024
REASONS_SHOWN = 3  # Largest number of reasons that are printed for points without numbers.


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("study", metavar="STUDY", nargs="?", help="path of a study file (.toml)")
    parser.add_argument(
        "-o", "--output", metavar="FILE", help="a .zarr folder or a .nc file (default: out/NAME.zarr, by the study)"
    )
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="of Dask, such as tcp://127.0.0.1:8786; else this machine"
    )
    parser.add_argument(
        "--workers", type=whole_number(1, MOST_WORKERS), metavar="N", help="processes or threads (default: one a core)"
    )
    parser.add_argument(
        "--chunk", type=positive_number, metavar="SECONDS", default=1.0,
        help="work of a chunk (default 1; more for hundreds of workers)",
    )  # fmt: skip
    parser.add_argument("--threads", action="store_true", help="threads in place of processes")
    parser.add_argument("--fresh", action="store_true", help="begin anew, and replace what is there")
    parser.add_argument("--status", action="store_true", help="say how far the study is, and compute nothing")
    parser.add_argument("--measures", action="store_true", help="list the measures that a study can name")


def main(args: argparse.Namespace) -> int:
    """Compute the points of the study that are still missing, and print a summary."""
    if args.measures:
        from softcradle.sandbox.sweeps.measure_table import MEASURES

        print_rows(("measure", "unit", "of each", "meaning"), [(m.name, m.unit, m.each, m.meaning) for m in MEASURES])
        return 0
    if args.study is None:
        raise UserError("a study file is missing (softcradle sweep STUDY.toml; --measures lists what it can measure)")
    if args.scheduler:
        refuse_options(args, "{option} is for this machine, --scheduler for another", "threads", "workers")
    if args.status:
        refuse_options(args, "--status computes nothing: {option} does", "fresh", "threads", "scheduler", "workers")
    from softcradle.sandbox.files import filled_folder
    from softcradle.sandbox.sweeps.study_file import load_study

    study = load_study(args.study)
    output = Path(args.output or DEFAULT_FOLDER / f"{Path(args.study).stem}.zarr")
    with nullcontext() if args.output else filled_folder(DEFAULT_FOLDER):
        return _tell_status(study, output) if args.status else _compute(args, study, output)


def _tell_status(study: SweepStudy, output: Path) -> int:
    """Print how many points of the study are computed. Return the exit code, which is not 0 if points are lost."""
    from softcradle.sandbox.sweeps.run_sweep import sweep_status

    lost, sentence = sweep_status(study.scene, study.points, study.measures, output, study.title)
    print(f"{study.title or study.scene.title}: {sentence}")
    return POINTS_LOST if lost else 0


def _compute(args: argparse.Namespace, study: SweepStudy, output: Path) -> int:
    """Compute the study and print a summary. Return the exit code, which is not 0 if points are lost."""
    from softcradle.sandbox.sweeps.dataset import lost_points
    from softcradle.sandbox.sweeps.run_sweep import sweep

    with ProgressShown("points") as progress:
        found = sweep(
            study.scene,
            study.points,
            study.measures,
            output=output,
            executor="threads" if args.threads else "auto",
            scheduler=args.scheduler,
            workers=args.workers,
            title=study.title,
            fresh=args.fresh,
            progress=progress.tell,
            chunk_seconds=args.chunk,
        )
    _print_summary(found)
    lost = lost_points(found)
    found.close()
    note(f"complete, {study.points.count} points are in {output}")
    return POINTS_LOST if lost else 0


def _print_summary(found: xr.Dataset) -> None:
    """Print the size of the Dataset, the range of every measured quantity, and the reasons why the numbers of some
    points are missing.
    """
    from softcradle.sandbox.sweeps.dataset import reasons_of, summary_rows

    output = console()
    output.print(
        found.attrs["title"] + ": " + " x ".join(f"{size} {name}" for name, size in found["status"].sizes.items())
    )
    print_rows(("measure", "least", "mean", "greatest", "points without"), summary_rows(found), True, output)
    reasons = reasons_of(found)
    for text, count in reasons[:REASONS_SHOWN]:
        output.print(f"{count} points without numbers: {text}" if count > 1 else f"a point without numbers: {text}")
    if more := sum(count for _, count in reasons[REASONS_SHOWN:]):
        output.print(f"and {more} more; the variable `reason` has them all")
