"""Whole files or none: write beside the target under another name, move into place at the end, clean up on failure."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def output_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a temporary path with the suffix of `path`; it takes the place of `path` when the block ends without error.

    The temporary file exists, empty, while the block runs: a folder that cannot be written to is found before any work.

    Raises:
        OSError: `path` is a folder, or its folder is missing or cannot be written to; the message is one sentence.
    """
    target = Path(path)
    if target.is_dir():
        raise IsADirectoryError(f"cannot write {target}: it is a folder")
    temporary = _hidden_sibling(target)
    try:
        temporary.open("xb").close()
    except OSError as error:
        raise _refusal(target, error) from None
    try:
        yield temporary
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def output_folder(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give an empty temporary folder that becomes `path` when the block ends without error.

    Raises:
        OSError: `path` exists and is not an empty folder, or its parent cannot be written to; one sentence.
    """
    target = Path(path)
    if target.exists() and not (target.is_dir() and not any(target.iterdir())):
        raise FileExistsError(f"cannot write {target}: it exists and is not an empty folder")
    temporary = _hidden_sibling(target)
    try:
        temporary.mkdir()
    except OSError as error:
        raise _refusal(target, error) from None
    try:
        yield temporary
        if target.exists():
            target.rmdir()  # empty, as checked above; not every system moves a folder onto another
        temporary.rename(target)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _hidden_sibling(target: Path) -> Path:
    """A name in the same folder, so that the final move stays on one file system and is atomic."""
    return target.with_name(f".{target.stem}.{os.getpid()}.part{target.suffix}")


def _refusal(target: Path, error: OSError) -> OSError:
    folder = target.absolute().parent
    if not folder.is_dir():
        return FileNotFoundError(f"cannot write {target}: there is no folder {folder}")
    if isinstance(error, FileNotFoundError):  # file systems such as /proc answer so
        return PermissionError(f"cannot write {target}: nothing can be written to {folder}")
    return type(error)(f"cannot write {target}: {(error.strerror or str(error)).lower()}")
