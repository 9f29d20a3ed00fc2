"""Files of the program: assets of the package, and output files. An output file is written either completely or not at
all. Errors become UserErrors.
"""

import json
import os
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path

from softcradle.physics import atomic_files
from softcradle.sandbox.languages import _
from softcradle.sandbox.user_error import UserError, reason

Name = str | os.PathLike[str]
_PACKAGE = Path(__file__).parent


def output_file(path: Name) -> AbstractContextManager[Path]:
    """Yield a temporary path with the suffix of `path`. At the end, the temporary file is moved to `path`. Raise
    UserError at once if `path` cannot be written.
    """
    return _user_errors(atomic_files.output_file(path), path)


def output_folder(path: Name) -> AbstractContextManager[Path]:
    """Yield a temporary folder. At the end, the folder is moved to `path`. Raise UserError at once if `path` cannot be
    written.
    """
    return _user_errors(atomic_files.output_folder(path), path)


@contextmanager
def _user_errors(opened: AbstractContextManager[Path], path: Name) -> Iterator[Path]:
    try:
        with opened as temporary:
            yield temporary
    # An OSError is raised when the file is opened, or when the disk becomes full during writing.
    except OSError as error:
        if error.errno is None:
            raise UserError(str(error)) from error
        raise UserError(_("cannot write {path}: {reason}", path=path, reason=reason(error))) from error


@contextmanager
def filled_folder(path: Name) -> Iterator[Path]:
    """Yield the folder `path`. Create the folder if it does not exist. If a new folder is empty at the end, remove it.

    Raise UserError if the folder cannot be created.
    """
    is_new = not os.path.exists(path)
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        missing = isinstance(error, FileNotFoundError)
        why = _("nothing can be written there") if missing else reason(error)
        raise UserError(_("cannot write to {path}: {reason}", path=path, reason=why)) from None
    try:
        yield folder
    finally:
        if is_new:
            with suppress(OSError):  # A folder that is not empty cannot be removed.
                folder.rmdir()


def readable_json(content: object) -> str:
    """Return `content` as indented JSON. Raise ValueError if it contains NaN or infinity, which callers must replace by
    None.
    """
    return json.dumps(content, indent=2, allow_nan=False)


def resource(name: str) -> Path:
    """Return the path of the file `name` in assets/. Raise FileNotFoundError if the installation is incomplete."""
    for folder in (_PACKAGE / "assets", _PACKAGE.parent / "assets"):
        if (folder / name).is_file():
            return folder / name
    raise FileNotFoundError(f"{name} is missing from softcradle's assets: install softcradle again")
