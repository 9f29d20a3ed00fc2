"""Files and folders that are written either completely or not at all.

A file or folder is created under a temporary name and then moved to its final place.
"""

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

# Number of letters of the final name that the temporary name contains. With the whole final name, the path could become
# too long.
TOLD = 16


@contextmanager
def output_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary path with the suffix of `path`. The temporary file replaces `path` when the block ends without
    an error.

    The empty temporary file is created before the block begins. A missing write permission is therefore reported before
    any work is done. The temporary name is unique. If several processes write to one path, the result of the last one
    is kept. If `path` is a link, the target of the link is written. If `path` is a pipe or a device, the whole file is
    written to it at the end.

    Raises:
        OSError: `path` is a folder, or its folder is missing or not writable; the message is one sentence.
    """
    target = Path(path)
    if os.path.isdir(target):
        raise IsADirectoryError(Message("is_folder", "cannot write {path}: it is a folder", path=target))
    if os.path.exists(target) and not os.path.isfile(target):
        yield from _written_through(target)
        return
    # Write next to the final place, because a move is atomic only within one file system.
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
    """Yield an empty temporary folder. The folder is renamed to `path` when the block ends without an error.

    If `replaces` is True, an existing folder at `path` is replaced when the new folder is complete.

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
    """Move the folder `new` to `place`. Move an existing folder from `place` to `before` first.

    If a move fails, restore the previous state.
    """
    replaced = place.exists()
    if replaced:
        place.rename(before)  # Some systems cannot move a folder onto an existing folder, even an empty one.
    # Restore the replaced folder if the new one cannot be moved.
    try:
        new.rename(place)
    except OSError:
        if replaced:
            before.rename(place)
        raise
    shutil.rmtree(before, ignore_errors=True)


def followed(target: Path) -> Path:
    """Return the target of `target` if it is a link, otherwise `target` itself.

    The result is the file to write. Temporary files are created next to it.
    """
    return Path(os.path.realpath(target)) if os.path.islink(target) else target


def _made_beside(place: Path, target: Path, make: Callable[[Path], None]) -> Path:
    """Create a temporary file or folder next to `place` with `make`, and return its path.

    On failure, raise OSError with a message of one sentence.
    """
    temporary = _hidden_sibling(target, place.parent)
    try:
        with suppress(FileNotFoundError):
            # This call raises an error if the file system does not accept the name, for example if it is too long.
            place.lstat()
        make(temporary)
    except OSError as error:
        raise _refusal(target, place, error) from None
    return temporary


def _hidden_sibling(target: Path, folder: Path) -> Path:
    """Return a unique temporary name in the folder of `target`.

    A temporary file must lie in this folder, because a move is atomic only within one file system.
    """
    return folder / f".{target.stem[:TOLD]}.{secrets.token_hex(8)}.part{target.suffix}"


def _refusal(target: Path, place: Path, error: OSError) -> OSError:
    folder = place.absolute().parent
    # A missing folder gets its own error message.
    if not folder.is_dir():
        return FileNotFoundError(
            Message("no_folder", "cannot write {path}: the folder {folder} does not exist", path=target, folder=folder)
        )
    if isinstance(error, FileNotFoundError):  # This error occurs in file systems such as /proc.
        return PermissionError(
            Message("unwritable", "cannot write {path}: nothing can be written to {folder}", path=target, folder=folder)
        )
    reason = (error.strerror or str(error)).lower()
    return type(error)(Message("not_written", "cannot write {path}: {reason}", path=target, reason=reason))
