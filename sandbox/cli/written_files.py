"""What a command says of the files that it wrote or replaced, and --open, which shows the first of them."""

from __future__ import annotations

import argparse
import os
import webbrowser
from collections.abc import Iterable, Sequence
from pathlib import Path

from softcradle.sandbox.console import note
from softcradle.sandbox.user_error import UserError


class WrittenFiles:
    """Knows which files were there before; made before anything is written.

    Arguments:
        candidates: paths of the files that may be written.
    """

    def __init__(self, candidates: Iterable[Path]) -> None:
        self._before = {path.absolute() for path in candidates if os.path.exists(path)}

    def report(self, paths: Sequence[Path], detail: str = "", show: bool = False) -> None:
        """Say what was written and what was replaced; `show` opens the first of the files.

        Raises:
            UserError: nothing on this machine opens it.
        """
        for path in paths:
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
