"""Arguments that several commands share. The argument types reject an invalid value with a clear message."""

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

DEFAULT_FOLDER = Path("out")  # Default folder for output files.
LISTED = "--list computes nothing: {option} is for what is computed"


def positive_number(text: str) -> float:
    """Convert `text` to a positive number. Fractions such as 1/60 are allowed. The number must be within the limits of
    the simulation.
    """
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
    """Return an argument type for whole numbers from `least` to `most`."""

    def checked(text: str) -> int:
        if not re.fullmatch(r"\d{1,12}", text) or not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(f"must be a whole number from {least} to {most}, not {text!r}")
        return int(text)

    return checked


def picture_size(text: str) -> tuple[int, int]:
    """Convert a text such as 1280x720 to (width, height) [pixels]."""
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
    """Add the options for the method and its time step."""
    from softcradle.physics.methods import known_methods

    method = parser.add_argument(
        "--method", help=f"one of {', '.join(known_methods())} (softcradle methods tells what each is for)"
    )
    completed(method, lambda **_: known_methods())
    parser.add_argument("--step", type=positive_number, metavar="SECONDS", help="step of a fixed-step method")


def completed(action: argparse.Action, words: Callable[..., list[str]]) -> None:
    """Register the completions of an argument in the shell. The completions are the result of `words` and file names."""
    action.completer = words  # type: ignore[attr-defined]  # what argcomplete looks for


def scene_words(prefix: str = "", **_: object) -> list[str]:
    """Return the completions of an argument that names a scene. The completions are scene names, scene files,
    trajectory files and folders.
    """
    from glob import escape, glob

    from softcradle.scenes import names

    files = [f"{name}/" if os.path.isdir(name) else name for name in glob(escape(prefix) + "*")]
    return [*names(), *(name for name in files if name.endswith(("/", ".toml", ".npz")))]


FIGURE_SUFFIXES = (".png", ".pdf", ".svg")


def figure_path(name: str, command: str) -> Path:
    """Return the path of a picture that matplotlib will draw.

    Raise UserError if the file format is not supported. Raise ImportError if matplotlib is not installed.
    """
    if Path(name).suffix not in FIGURE_SUFFIXES:
        raise UserError(f"cannot write {name}: {command} writes {', '.join(FIGURE_SUFFIXES)}")
    from softcradle.sandbox.studies.plot_style import require_matplotlib

    # The package is checked before the simulations. If the package were missing after the simulations, their results
    # would be lost.
    require_matplotlib()
    return Path(name)


@contextmanager
def opened_outputs(paths: Sequence[Path]) -> Iterator[list[Path]]:
    """Yield temporary files that replace `paths` when the block ends without an error.

    The files are opened before the simulations. An unwritable path is therefore reported at once. The default folder is
    created if necessary. Other folders must exist. Raise UserError if two paths are the same file.
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
    """Create the folder for the pictures of a study before its simulations start.

    Yield three values. The first value is the folder. The second value is the path of the store that keeps computed
    points until all pictures are drawn. The third value is a record of the files that the folder already contained. The
    store is removed at the end.
    """
    from softcradle.sandbox.files import filled_folder
    from softcradle.sandbox.studies.plot_style import require_matplotlib
    from softcradle.sandbox.sweeps.run_sweep import drop_kept

    require_matplotlib()
    with filled_folder(name) as folder:
        yield folder, folder / kept, WrittenFiles(folder.iterdir())
        drop_kept(folder / kept)


class WrittenFiles:
    """Record of the files that exist before a command writes. With this record, the report distinguishes new files from
    replaced files.

    Arguments:
        candidates: paths of the files that may be written.
    """

    def __init__(self, candidates: Iterable[Path]) -> None:
        self._before = {path.absolute() for path in candidates if os.path.isfile(path) or os.path.isdir(path)}

    def report(self, paths: Sequence[Path], detail: str = "", show: bool = False, silent: bool = False) -> None:
        """Print which files were written and which were replaced. Print nothing if `silent` is True. If `show` is True,
        open the first file.

        Raises:
            UserError: no program on this machine can open the file.
        """
        for path in paths if not silent else ():
            note(f"{'replaced' if path.absolute() in self._before else 'written'}: {path}{detail}")
        if show and paths:
            open_with_desktop(paths[0])


def open_with_desktop(path: Path) -> None:
    """Open a file or folder with the default program of the desktop. Raise UserError if such a program is not
    installed.
    """
    if not webbrowser.open(path.absolute().as_uri()):
        raise UserError(f"{path} is written, but no program was found to open it with")


def add_open(parser: argparse.ArgumentParser) -> None:
    """Add the option --open, which opens the written file."""
    parser.add_argument("--open", action="store_true", help="open the file with the desktop's program for it")


def refuse_options(args: argparse.Namespace, sentence: str, *names: str) -> None:
    """Raise UserError if one of the options `names` is given. The message is `sentence`, in which ``{option}`` is
    replaced by the name of the option.
    """
    for name in names:
        if getattr(args, name) not in (None, False):
            raise UserError(sentence.format(option=f"--{name.replace('_', '-')}"))


def check_open(wanted: bool, output: object) -> None:
    """Raise UserError if the option --open is given (`wanted`) but no file is written (`output` is empty)."""
    if wanted and not output:
        raise UserError("--open opens the file that is written: give one with -o, too")
