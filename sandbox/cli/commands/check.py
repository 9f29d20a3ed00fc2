"""`softcradle check FILE ...`: every problem of every file, one line each; exit code 2 if there is any."""

import argparse
import sys


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", metavar="FILE", nargs="+", help="scene file, or name of a scene")


def main(args: argparse.Namespace) -> int:
    """Check all files, those after a bad one too."""
    return max([_check(file) for file in args.files])


def _check(file: str) -> int:
    from softcradle.scenes import SceneError, load

    try:
        scene = load(file)
    except SceneError as error:
        for problem in error.problems:
            print(f"softcradle: {problem}", file=sys.stderr)
        return 2
    beads = " and ".join(str(len(lane.velocity)) for lane in scene.lanes)
    print(f"{file}: ok, {scene.title!r} with {beads} beads")
    return 0
