"""`softcradle run`: compute a scene, print a table of results a lane, write its trajectories."""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import add_method, add_scene, load_scene, positive, whole
from softcradle.sandbox.user_error import UserError

if TYPE_CHECKING:
    from softcradle.physics import Trajectory
    from softcradle.sandbox.trajectory_summary import Summary
    from softcradle.scenes import Scene

MOST_SAMPLES = 1_000_000  # a slip of the keyboard must not fill the memory
WRITERS = {".npz": "save", ".csv": "to_csv"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_scene(parser)
    parser.add_argument(
        "-o", "--output", metavar="OUT",
        help="write the motion to OUT.npz (everything) or OUT.csv (a table); OUT-1, OUT-2 ... for several lanes",
    )  # fmt: skip
    add_method(parser)
    parser.add_argument("--tolerance", type=positive, help="wanted error of an adaptive method")
    parser.add_argument("--duration", type=positive, metavar="SECONDS", help="time to run (default: until all is over)")
    parser.add_argument(
        "--samples", type=whole(2, MOST_SAMPLES), default=1001, help="samples to take and write (default: 1001)"
    )
    parser.add_argument("--json", action="store_true", help="print the results as JSON instead of tables")


def main(args: argparse.Namespace) -> int:
    """Compute, write, print."""
    scene = load_scene(args.scene)
    outputs = _outputs(args.output, len(scene.lanes))
    with ExitStack() as stack:
        temporary = [_open(stack, path) for path in outputs]  # before the work: an unwritable place is said at once
        trajectories = _solve(scene, args)
        for trajectory, path in zip(trajectories, temporary, strict=False):
            getattr(trajectory, WRITERS[path.suffix])(path)
    _print(scene, trajectories, outputs, args.json)
    return 0


def _outputs(wanted: str | None, lanes: int) -> list[Path]:
    """One path a lane; a UserError for a format that is not ours."""
    if wanted is None:
        return []
    path = Path(wanted)
    if path.suffix not in WRITERS:
        raise UserError(f"cannot write {wanted}: run writes {' or '.join(WRITERS)}")
    return [path] if lanes == 1 else [path.with_name(f"{path.stem}-{i + 1}{path.suffix}") for i in range(lanes)]


def _open(stack: ExitStack, path: Path) -> Path:
    from softcradle.sandbox.output_files import output_file

    return stack.enter_context(output_file(path))


def _solve(scene: Scene, args: argparse.Namespace) -> list[Trajectory]:
    from softcradle.sandbox.scene_runs import solve

    return solve(
        scene,
        method=args.method,
        step=args.step,
        tolerance=args.tolerance,
        duration=args.duration,
        samples=args.samples,
    )


def _print(scene: Scene, trajectories: list[Trajectory], outputs: list[Path], as_json: bool) -> None:
    from softcradle.sandbox.trajectory_summary import summarise

    summaries = [summarise(lane.label, found) for lane, found in zip(scene.lanes, trajectories, strict=True)]
    if as_json:
        _print_json(scene, summaries)
    else:
        from softcradle.sandbox.cli.result_tables import print_report

        print_report(scene, summaries, outputs)


def _print_json(scene: Scene, summaries: list[Summary]) -> None:
    import json
    from dataclasses import asdict

    from softcradle.physics.storage import versions

    lanes = [asdict(summary) for summary in summaries]
    told = {"title": scene.title, "source": scene.source, "lanes": lanes, "versions": versions()}
    print(json.dumps(told, indent=2, allow_nan=False))
