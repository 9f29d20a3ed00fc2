"""`softcradle run`: simulate a scene and write its trajectories. Print the results of each lane as tables or JSON."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import (
    WrittenFiles,
    add_method,
    add_open,
    add_scene,
    check_open,
    opened_outputs,
    positive_number,
    whole_number,
)
from softcradle.sandbox.console import console, print_json, print_rows
from softcradle.sandbox.scene_runs import load_scene, run_scene
from softcradle.sandbox.user_error import GAVE_UP, UserError

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table
    from softcradle.physics import Trajectory
    from softcradle.sandbox.trajectory_summary import Summary
    from softcradle.scenes import Scene

MOST_SAMPLES = 1_000_000  # Largest number of samples. With this limit, a typing error cannot fill the memory.
FORMATS = (".npz", ".csv")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_scene(parser)
    parser.add_argument(
        "-o", "--output", metavar="OUT", action="append", default=[],
        help="write the motion to OUT.npz (everything) or OUT.csv (a table); OUT-1, OUT-2 ... for several lanes; may be "
        "given several times",
    )  # fmt: skip
    add_open(parser)
    add_method(parser)
    parser.add_argument("--tolerance", type=positive_number, help="wanted error of an adaptive method")
    parser.add_argument(
        "--duration",
        type=positive_number,
        metavar="SECONDS",
        help="time to run (default: the scene's, or until no contact can close again)",
    )
    parser.add_argument(
        "--samples",
        type=whole_number(2, MOST_SAMPLES),
        default=1001,
        help="number of samples to write, of which the tables have their largest overlaps and forces (default: 1001)",
    )
    printed = parser.add_mutually_exclusive_group()
    printed.add_argument("--json", action="store_true", help="print the results as JSON instead of tables")
    printed.add_argument("--describe", action="store_true", help="say in words what happens instead of tables")


def main(args: argparse.Namespace) -> int:
    """Simulate the lanes, write their trajectories and print the results."""
    check_open(args.open, args.output)
    scene = load_scene(args.scene)
    outputs = [path for wanted in args.output for path in _outputs(wanted, len(scene.lanes))]
    written = WrittenFiles(outputs)
    settings = {name: getattr(args, name) for name in ("method", "step", "tolerance", "duration", "samples")}
    with opened_outputs(outputs) as temporary:
        trajectories = run_scene(scene, **settings)
        for trajectory, path in zip(cycle(trajectories), temporary, strict=False):
            (trajectory.save if path.suffix == ".npz" else trajectory.to_csv)(str(path))
    _tell(scene, trajectories, args)
    written.report(outputs, show=args.open, silent=args.json)
    return GAVE_UP if any(trajectory.status.gave_up for trajectory in trajectories) else 0


def _outputs(wanted: str, lanes: int) -> list[Path]:
    """Return one output path for each lane. Raise UserError if `run` cannot write this file format."""
    path = Path(wanted)
    if path.suffix not in FORMATS:
        raise UserError(f"cannot write {wanted}: run writes {' or '.join(FORMATS)}")
    return [path] if lanes == 1 else [path.with_name(f"{path.stem}-{i + 1}{path.suffix}") for i in range(lanes)]


def _tell(scene: Scene, trajectories: list[Trajectory], args: argparse.Namespace) -> None:
    """Print the results as sentences, as JSON or as tables."""
    from dataclasses import asdict

    from softcradle.physics.trajectory_file import versions
    from softcradle.sandbox.story.sentences import describe
    from softcradle.sandbox.trajectory_summary import summarise

    lanes = [(lane.label, found) for lane, found in zip(scene.lanes, trajectories, strict=True)]
    if args.describe:
        print(scene.title if scene.title.endswith((".", "?", "!")) else f"{scene.title}.")
        for label, found in lanes:
            print(describe(label, found))
        return
    summaries = [summarise(label, found) for label, found in lanes]
    if args.json:
        tables = [asdict(summary) for summary in summaries]
        print_json({"title": scene.title, "source": scene.source, "lanes": tables, "versions": versions()})
    else:
        print_report(scene, summaries)


def print_report(scene: Scene, summaries: Sequence[Summary]) -> None:
    """Print the title and the source of the scene, followed by the tables of each lane."""
    output = console()
    output.print(scene.title, style="bold")
    if scene.source:
        output.print(scene.source, style="dim")
    for summary in summaries:
        _print_lane(output, summary)


def _print_lane(output: Console, summary: Summary) -> None:
    from softcradle.sandbox.trajectory_summary import bead_table, contact_table

    output.print()
    if summary.label:
        output.print(summary.label, style="bold cyan")
    # `breaks` is the largest number of line breaks in a column title.
    for found, breaks in ((bead_table(summary), 0), (contact_table(summary), 1)):
        print_rows([title.replace(" ", "\n", breaks) for title in found.titles], found.rows, True, output)
    output.print(_cost(summary))
    for sentence in summary.warnings:
        output.print(f"warning: {sentence}", style="yellow")


def _cost(summary: Summary) -> Table:
    from rich.table import Table
    from softcradle.sandbox.trajectory_summary import in_unit, unit_prefix

    grid = Table.grid(padding=(0, 2))
    resolution = f"step {summary.step:.4g} s" if summary.step else f"tolerance {summary.tolerance:g}"
    grid.add_row("method", f"{summary.method}, {resolution}")
    if summary.choice:
        grid.add_row("chosen", summary.choice)
    if summary.velocity_error is not None:
        grid.add_row("velocity error", f"{summary.velocity_error:.1e} m/s at most, as estimated along the run")
    grid.add_row(
        "energy error", f"{_error(summary.energy_error)} at most, {_error(summary.energy_error_at_end)} at the end"
    )
    absorbed = (summary.absorbed_by_contacts, summary.absorbed_by_bed)
    if any(part != 0.0 for part in absorbed):
        size, prefix = unit_prefix(max(part or 0.0 for part in absorbed))
        by_contacts, by_bed = (in_unit(part, size) for part in absorbed)
        grid.add_row("absorbed", f"{by_contacts} {prefix}J by contacts, {by_bed} {prefix}J by the bed")
    momentum = "not defined" if summary.momentum_error is None else f"{summary.momentum_error:.1e} at most"
    grid.add_row("momentum error", momentum)
    grid.add_row("cost", f"{summary.steps} steps, {summary.evaluations} evaluations, {summary.milliseconds:.3g} ms")
    return grid


def _error(relative: float | None) -> str:
    return "not defined" if relative is None else f"{relative:.1e}"
