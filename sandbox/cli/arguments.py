"""Arguments that several commands have, and types that refuse a bad value in a sentence."""

from __future__ import annotations

import argparse
import math
import os
import re
import webbrowser
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from softcradle.sandbox.console import note
from softcradle.sandbox.user_error import UserError

DEFAULT_FOLDER = Path("out")  # of what commands write that are not told where
LISTED = "--list computes nothing: {option} is for what is computed"


def positive_number(text: str) -> float:
    """A number > 0 that can be computed with; it may be a fraction such as 1/60."""
    from softcradle.physics.checked_input import LARGEST, SMALLEST

    numerator, slash, denominator = text.partition("/")
    try:
        value = float(numerator) / float(denominator) if slash else float(text)
    except (ValueError, ZeroDivisionError):
        value = math.nan
    if not SMALLEST <= value <= LARGEST:
        raise argparse.ArgumentTypeError(f"must be a number from {SMALLEST:g} to {LARGEST:g}, not {text!r}")
    return value


def whole_number(least: int, most: int) -> Callable[[str], int]:
    """The type of a whole number from `least` to `most`."""

    def checked(text: str) -> int:
        if not re.fullmatch(r"\d{1,12}", text) or not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(f"must be a whole number from {least} to {most}, not {text!r}")
        return int(text)

    return checked


def picture_size(text: str) -> tuple[int, int]:
    """Width and height in pixels from a text such as 1280x720."""
    match = re.fullmatch(r"(\d{1,5})x(\d{1,5})", text)
    if match is None:
        raise argparse.ArgumentTypeError(f"must be WIDTHxHEIGHT such as 1280x720, not {text!r}")
    return int(match[1]), int(match[2])


def add_scene(parser: argparse.ArgumentParser) -> None:
    """Add the argument that names a scene."""
    completed(
        parser.add_argument("scene", metavar="SCENE", help="name of a scene, or path of a scene file"), scene_words
    )


def add_method(parser: argparse.ArgumentParser) -> None:
    """Add the options that choose the method and its step."""
    from softcradle.physics.methods import known_methods

    method = parser.add_argument(
        "--method", help=f"one of {', '.join(known_methods())} (softcradle methods tells what each is for)"
    )
    completed(method, lambda **_: known_methods())
    parser.add_argument("--step", type=positive_number, metavar="SECONDS", help="step of a fixed-step method")


def completed(action: argparse.Action, words: Callable[..., list[str]]) -> None:
    """Let a shell complete the argument with `words()`, and with names of files."""
    action.completer = words  # type: ignore[attr-defined]  # what argcomplete looks for


def scene_words(prefix: str = "", **_: object) -> list[str]:
    """What a shell completes a scene with: names of scenes, and files and folders."""
    from glob import escape, glob

    from softcradle.scenes import names

    files = [f"{name}/" if os.path.isdir(name) else name for name in glob(escape(prefix) + "*")]
    return [*names(), *(name for name in files if name.endswith(("/", ".toml", ".npz")))]


FIGURE_SUFFIXES = (".png", ".pdf", ".svg")


def figure_path(name: str, command: str) -> Path:
    """The path of a picture that matplotlib draws. UserError for another kind, ImportError where that is missing."""
    if Path(name).suffix not in FIGURE_SUFFIXES:
        raise UserError(f"cannot write {name}: {command} writes {', '.join(FIGURE_SUFFIXES)}")
    from softcradle.sandbox.studies.plot_style import require_matplotlib

    require_matplotlib()  # before the runs, not after them
    return Path(name)


@contextmanager
def opened_outputs(paths: Sequence[Path]) -> Iterator[list[Path]]:
    """Temporary files that become `paths` at the end; opened before the runs, so that an unwritable place is refused at once.

    Of folders the one is made in which commands write that are not told where. UserError for a file that is given twice.
    """
    from softcradle.sandbox.files import filled_folder, output_file

    if len({os.path.realpath(path) for path in paths}) < len(paths):
        raise UserError("the same file is given twice with -o")
    with ExitStack() as stack:
        if any(path.parent == DEFAULT_FOLDER for path in paths):
            stack.enter_context(filled_folder(DEFAULT_FOLDER))
        yield [stack.enter_context(output_file(path)) for path in paths]


@contextmanager
def picture_folder(name: str, kept: str) -> Iterator[tuple[Path, Path, WrittenFiles]]:
    """The folder of a study's pictures, made before the runs; where in it points are kept until all is drawn; what it had."""
    from softcradle.sandbox.files import filled_folder
    from softcradle.sandbox.studies.plot_style import require_matplotlib
    from softcradle.sandbox.sweeps.run_sweep import drop_kept

    require_matplotlib()
    with filled_folder(name) as folder:
        yield folder, folder / kept, WrittenFiles(folder.iterdir())
        drop_kept(folder / kept)


class WrittenFiles:
    """Knows which files were there before; made before anything is written.

    Arguments:
        candidates: paths of the files that may be written.
    """

    def __init__(self, candidates: Iterable[Path]) -> None:
        self._before = {path.absolute() for path in candidates if os.path.isfile(path) or os.path.isdir(path)}

    def report(self, paths: Sequence[Path], detail: str = "", show: bool = False, silent: bool = False) -> None:
        """Say what was written and what was replaced, unless `silent`; `show` opens the first of the files.

        Raises:
            UserError: nothing on this machine opens it.
        """
        for path in paths if not silent else ():
            note(f"{'replaced' if path.absolute() in self._before else 'written'}: {path}{detail}")
        if show and paths:
            open_with_desktop(paths[0])


def open_with_desktop(path: Path) -> None:
    """Open a file or folder with the desktop's program for it. Raises UserError where there is none."""
    if not webbrowser.open(path.absolute().as_uri()):
        raise UserError(f"{path} is written, but no program was found to open it with")


def add_open(parser: argparse.ArgumentParser) -> None:
    """Add the option that opens what was written."""
    parser.add_argument("--open", action="store_true", help="open the file with the desktop's program for it")


def refuse_options(args: argparse.Namespace, sentence: str, *names: str) -> None:
    """Refuse those options that are given, in the `sentence` with {option} for it. Raises UserError."""
    for name in names:
        if getattr(args, name) not in (None, False):
            raise UserError(sentence.format(option=f"--{name.replace('_', '-')}"))


def check_open(wanted: bool, output: object) -> None:
    """Refuse to open what is written where there is no `output`. Raises UserError."""
    if wanted and not output:
        raise UserError("--open opens the file that is written: give one with -o, too")
