"""Files and folders that are written whole or not at all: under a temporary name first, then moved into place."""

from __future__ import annotations

import os
import secrets
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

from softcradle.physics.messages import Message

# Number of letters that a temporary name takes from the final one. With the whole name the path could be too long.
TOLD = 16


@contextmanager
def output_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary path with the suffix of `path`. Its file replaces `path` when the block ends without an error.

    The temporary file exists and is empty when the block begins, so a folder without write permission is an error
    before any work is done. Its name is unique: if several processes write to one path, the last to finish is kept. A
    link stays, and its target is written. A pipe or a device stays as well: the whole file is written to it at the end.

    Raises:
        OSError: `path` is a folder, or its folder is missing or not writable; the message is one sentence.
    """
    target = Path(path)
    if os.path.isdir(target):
        raise IsADirectoryError(Message("is_folder", "cannot write {path}: it is a folder", path=target))
    if os.path.exists(target) and not os.path.isfile(target):
        yield from _written_through(target)
        return
    # Write next to the final place, because moving is atomic only within one file system.
    place = followed(target)
    temporary = _made_beside(place, target, partial(Path.touch, exist_ok=False))
    try:
        yield temporary
        temporary.replace(place)
    finally:
        temporary.unlink(missing_ok=True)


def _written_through(target: Path) -> Iterator[Path]:
    """Yield a temporary path whose content is copied to a pipe or a device when the block ends without an error."""
    if not os.access(target, os.W_OK):
        raise PermissionError(Message("no_permission", "cannot write {path}: permission denied", path=target))
    with tempfile.TemporaryDirectory() as folder:
        temporary = Path(folder, f"part{target.suffix}")
        temporary.touch()
        yield temporary
        with temporary.open("rb") as content, target.open("wb") as place:
            shutil.copyfileobj(content, place)


@contextmanager
def output_folder(path: str | os.PathLike[str], replaces: bool = False) -> Iterator[Path]:
    """Yield an empty temporary folder that becomes `path` when the block ends without an error.

    If it `replaces` a folder, that folder stays until the new one is complete.

    Raises:
        OSError: `path` exists and is not an empty folder, or must not be replaced, or its parent is not writable; the
            message is one sentence.
    """
    target = Path(path)
    if os.path.exists(target) and not (target.is_dir() and (replaces or not any(target.iterdir()))):
        raise FileExistsError(
            Message("is_not_empty", "cannot write {path}: it exists and is not an empty folder", path=target)
        )
    place = followed(target)
    temporary = _made_beside(place, target, Path.mkdir)
    try:
        yield temporary
        _exchange(temporary, place, _hidden_sibling(target, place.parent))
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _exchange(new: Path, place: Path, before: Path) -> None:
    """Move a folder to its `place`. A folder there is moved to `before` first; if something fails, everything is
    restored.
    """
    replaced = place.exists()
    if replaced:
        place.rename(before)  # some systems do not move a folder onto another one, even if it is empty
    # Restore the replaced folder if the new one cannot be moved.
    try:
        new.rename(place)
    except OSError:
        if replaced:
            before.rename(place)
        raise
    shutil.rmtree(before, ignore_errors=True)


def followed(target: Path) -> Path:
    """Return the path, or the target of the path if it is a link. The target is written, and temporary files are put
    next to it.
    """
    return Path(os.path.realpath(target)) if os.path.islink(target) else target


def _made_beside(place: Path, target: Path, make: Callable[[Path], None]) -> Path:
    """Create a temporary file or folder next to `place` with `make`, and return its path. Raise OSError with one
    sentence on failure.
    """
    temporary = _hidden_sibling(target, place.parent)
    try:
        with suppress(FileNotFoundError):
            place.lstat()  # raises an error if the file system does not accept the name, for example if it is too long
        make(temporary)
    except OSError as error:
        raise _refusal(target, place, error) from None
    return temporary


def _hidden_sibling(target: Path, folder: Path) -> Path:
    """Return a unique name in the folder of `target`, because moving within one file system is atomic."""
    return folder / f".{target.stem[:TOLD]}.{secrets.token_hex(8)}.part{target.suffix}"


def _refusal(target: Path, place: Path, error: OSError) -> OSError:
    folder = place.absolute().parent
    # A missing folder has its own message.
    if not folder.is_dir():
        return FileNotFoundError(
            Message("no_folder", "cannot write {path}: the folder {folder} does not exist", path=target, folder=folder)
        )
    if isinstance(error, FileNotFoundError):  # error of file systems such as /proc
        return PermissionError(
            Message("unwritable", "cannot write {path}: nothing can be written to {folder}", path=target, folder=folder)
        )
    reason = (error.strerror or str(error)).lower()
    return type(error)(Message("not_written", "cannot write {path}: {reason}", path=target, reason=reason))
