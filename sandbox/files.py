"""Files: assets of the package; what commands write, complete or not at all, with a UserError where that cannot be."""

import json
import os
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path

from softcradle.physics import atomic_files
from softcradle.sandbox.user_error import UserError, reason

Name = str | os.PathLike[str]
_PACKAGE = Path(__file__).parent


def output_file(path: Name) -> AbstractContextManager[Path]:
    """A temporary path with the same suffix, moved to `path` at the end; UserError at once where that cannot be."""
    return _user_errors(atomic_files.output_file(path), path)


def output_folder(path: Name) -> AbstractContextManager[Path]:
    """A temporary folder, moved to `path` at the end; UserError at once where that cannot be."""
    return _user_errors(atomic_files.output_folder(path), path)


@contextmanager
def _user_errors(opened: AbstractContextManager[Path], path: Name) -> Iterator[Path]:
    try:
        with opened as temporary:
            yield temporary
    except OSError as error:  # raised on opening, and by a full disk while writing
        raise UserError(str(error) if error.errno is None else f"cannot write {path}: {reason(error)}") from error


@contextmanager
def filled_folder(path: Name) -> Iterator[Path]:
    """The folder of that name, made where it does not exist, and removed again where it is left empty (UserError)."""
    is_new = not os.path.exists(path)
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        told = "nothing can be written there" if isinstance(error, FileNotFoundError) else reason(error)
        raise UserError(f"cannot write to {path}: {told}") from None
    try:
        yield folder
    finally:
        if is_new:
            with suppress(OSError):  # of a folder that something was written to
                folder.rmdir()


def readable_json(content: object) -> str:
    """JSON on lines of its own; what is no number must be None. Raises ValueError."""
    return json.dumps(content, indent=2, allow_nan=False)


def resource(name: str) -> Path:
    """Path of the file `name` under assets/. Raises FileNotFoundError where the installation is incomplete."""
    for folder in (_PACKAGE / "assets", _PACKAGE.parent / "assets"):
        if (folder / name).is_file():
            return folder / name
    raise FileNotFoundError(f"{name} is missing from softcradle's assets: install softcradle again")
