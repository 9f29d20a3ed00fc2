"""`softcradle run`: compute a scene, print the results of each lane as tables or JSON, and write its trajectories."""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import (
    WrittenFiles,
    add_method,
    add_open,
    add_scene,
    positive_number,
    whole_number,
)
from softcradle.sandbox.scene_runs import load_scene, run_scene
from softcradle.sandbox.user_error import GAVE_UP, UserError

if TYPE_CHECKING:
    from softcradle.physics import Trajectory
    from softcradle.sandbox.trajectory_summary import Summary
    from softcradle.scenes import Scene

MOST_SAMPLES = 1_000_000  # a typing error must not fill the memory
FORMATS = (".npz", ".csv")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
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
        help="time to run (default: until no contact can close again)",
    )
    parser.add_argument(
        "--samples", type=whole_number(2, MOST_SAMPLES), default=1001, help="number of samples to write (default: 1001)"
    )
    printed = parser.add_mutually_exclusive_group()
    printed.add_argument("--json", action="store_true", help="print the results as JSON instead of tables")
    printed.add_argument("--describe", action="store_true", help="say in words what happens instead of tables")


def main(args: argparse.Namespace) -> int:
    """Compute the lanes, write their trajectories and print the results."""
    scene = load_scene(args.scene)
    outputs = [path for wanted in args.output for path in _outputs(wanted, len(scene.lanes))]
    if len({path.absolute() for path in outputs}) < len(outputs):
        raise UserError("the same file is given twice with -o")
    written = WrittenFiles(outputs)
    with ExitStack() as stack:
        # The files are opened before the run, so that an unwritable place is refused at once.
        temporary = [_open(stack, path) for path in outputs]
        trajectories = _run(scene, args)
        for trajectory, path in zip(cycle(trajectories), temporary, strict=False):
            _write(trajectory, path)
    if args.describe:
        _describe(scene, trajectories)
    else:
        _print(scene, trajectories, args.json)
    if not args.json:
        written.report(outputs, show=args.open)
    return GAVE_UP if any(trajectory.status.gave_up for trajectory in trajectories) else 0


def _outputs(wanted: str, lanes: int) -> list[Path]:
    """One path for each lane. Raises UserError for a format that run does not write."""
    path = Path(wanted)
    if path.suffix not in FORMATS:
        raise UserError(f"cannot write {wanted}: run writes {' or '.join(FORMATS)}")
    return [path] if lanes == 1 else [path.with_name(f"{path.stem}-{i + 1}{path.suffix}") for i in range(lanes)]


def _open(stack: ExitStack, path: Path) -> Path:
    from softcradle.sandbox.files import output_file

    return stack.enter_context(output_file(path))


def _write(trajectory: Trajectory, path: Path) -> None:
    if path.suffix == ".npz":
        trajectory.save(str(path))
    else:
        trajectory.to_csv(str(path))


def _run(scene: Scene, args: argparse.Namespace) -> list[Trajectory]:
    return run_scene(
        scene,
        method=args.method,
        step=args.step,
        tolerance=args.tolerance,
        duration=args.duration,
        samples=args.samples,
    )


def _print(scene: Scene, trajectories: list[Trajectory], as_json: bool) -> None:
    from softcradle.sandbox.trajectory_summary import summarise

    summaries = [summarise(lane.label, found) for lane, found in zip(scene.lanes, trajectories, strict=True)]
    if as_json:
        _print_json(scene, summaries)
    else:
        from softcradle.sandbox.cli.result_tables import print_report

        print_report(scene, summaries)


def _describe(scene: Scene, trajectories: list[Trajectory]) -> None:
    from softcradle.sandbox.trajectory_summary import describe

    print(scene.title if scene.title.endswith((".", "?", "!")) else f"{scene.title}.")
    for lane, found in zip(scene.lanes, trajectories, strict=True):
        print(describe(lane.label, found))


def _print_json(scene: Scene, summaries: list[Summary]) -> None:
    import json
    from dataclasses import asdict

    from softcradle.physics.trajectory_file import versions

    lanes = [asdict(summary) for summary in summaries]
    results = {"title": scene.title, "source": scene.source, "lanes": lanes, "versions": versions()}
    print(json.dumps(results, indent=2, allow_nan=False))
