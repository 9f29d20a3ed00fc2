"""`softcradle check FILE ...`: print every problem of every file on one line each. The exit code is 2 if there is a
problem.
"""

import argparse
import sys
from collections.abc import Iterable, Iterator


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the argument that names the files."""
    parser.add_argument(
        "files",
        metavar="FILE",
        nargs="+",
        help="scene file, name of a scene, a folder (all scene files in it and below), or a pattern such as '*.toml'",
    )


def main(args: argparse.Namespace) -> int:
    """Check all files and print how many files are correct."""
    found = [_check(file) for file in dict.fromkeys(_listed(args.files))]
    if len(found) > 1:
        wrong = len(found) - sum(found)
        print(f"{len(found)} files: {sum(found)} ok, {wrong} with problems" if wrong else f"{len(found)} files: all ok")
    return 0 if all(found) else 2


def _listed(words: Iterable[str]) -> Iterator[str]:
    """Yield the files that the arguments name. A folder stands for its scene files, and a pattern for the matching
    files.
    """
    from glob import glob, has_magic
    from pathlib import Path

    for word in words:
        if Path(word).is_dir():
            yield from _some(word, sorted(str(path) for path in Path(word).rglob("*.toml")))
        elif has_magic(word) and not Path(word).exists():
            yield from _some(word, sorted(glob(word, recursive=True)))
        else:
            yield word


def _some(word: str, files: list[str]) -> list[str]:
    """Return the files. If the list is empty, return the argument `word` itself. The check of this word then reports
    the problem.
    """
    return files or [word]


def _check(file: str) -> bool:
    """Print the problems of a file, or a message that the file is correct. Return True if the file is correct."""
    from pathlib import Path

    from softcradle.scenes import SceneError, load

    try:
        if Path(file).is_dir():
            raise SceneError([f"there is no file with the ending .toml in the folder {file}"])
        scene = load(file)
    except SceneError as error:
        for problem in error.problems:
            print(f"softcradle: {problem}", file=sys.stderr)
        return False
    beads = " and ".join(str(len(lane.velocity)) for lane in scene.lanes)
    print(f"{file}: ok, {scene.title!r} with {beads} beads")
    return True
