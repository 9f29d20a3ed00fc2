"""Files and folders written whole or not at all: under another name first, moved into place at the end."""

from __future__ import annotations

import os
import secrets
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

TOLD = 16  # letters of a name that its temporary one has too: the whole could be too long for the file system with more added


@contextmanager
def output_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary path with the suffix of `path`; the file there replaces `path` when the block ends without error.

    The temporary file exists, empty, when the block begins: a folder that cannot be written to is an error before any work.
    Its name is its own: of several that write to one path the last to end is kept. A link stays, and what it leads to is written.
    A pipe or a device stays too: the whole file is written to it at the end.

    Raises:
        OSError: `path` is a folder, or its folder is missing or cannot be written to; the message is one sentence.
    """
    target = Path(path)
    if os.path.isdir(target):
        raise IsADirectoryError(f"cannot write {target}: it is a folder")
    if os.path.exists(target) and not os.path.isfile(target):
        yield from _written_through(target)
        return
    place = followed(target)
    temporary = _made_beside(place, target, partial(Path.touch, exist_ok=False))
    try:
        yield temporary
        temporary.replace(place)
    finally:
        temporary.unlink(missing_ok=True)


def _written_through(target: Path) -> Iterator[Path]:
    """Yield a temporary path whose content goes to a pipe or a device when the block ends without error."""
    if not os.access(target, os.W_OK):
        raise PermissionError(f"cannot write {target}: permission denied")
    with tempfile.TemporaryDirectory() as folder:
        temporary = Path(folder, f"part{target.suffix}")
        temporary.touch()
        yield temporary
        with temporary.open("rb") as content, target.open("wb") as place:
            shutil.copyfileobj(content, place)


@contextmanager
def output_folder(path: str | os.PathLike[str], replaces: bool = False) -> Iterator[Path]:
    """Yield an empty temporary folder that becomes `path` when the block ends without error.

    Where it `replaces` a folder, that stays until the new one is whole.

    Raises:
        OSError: `path` exists and is not an empty folder, or none that may be replaced, or its parent cannot be written to; one
            sentence.
    """
    target = Path(path)
    if os.path.exists(target) and not (target.is_dir() and (replaces or not any(target.iterdir()))):
        raise FileExistsError(f"cannot write {target}: it exists and is not an empty folder")
    place = followed(target)
    temporary = _made_beside(place, target, Path.mkdir)
    try:
        yield temporary
        _exchange(temporary, place, _hidden_sibling(target, place.parent))
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _exchange(new: Path, place: Path, before: Path) -> None:
    """Move a folder to its `place`, in which a folder goes by way of `before`; where that fails, all is as it was."""
    replaced = place.exists()
    if replaced:
        place.rename(before)  # some systems do not move a folder onto another, be it empty
    try:
        new.rename(place)
    except OSError:
        if replaced:
            before.rename(place)
        raise
    shutil.rmtree(before, ignore_errors=True)


def followed(target: Path) -> Path:
    """The path itself, or what it leads to, if it is a link: that is written, and what is kept lies beside it."""
    return Path(os.path.realpath(target)) if os.path.islink(target) else target


def _made_beside(place: Path, target: Path, make: Callable[[Path], None]) -> Path:
    """What `make` makes beside `place`, to which `target` leads; OSError of one sentence where nothing can be written there."""
    temporary = _hidden_sibling(target, place.parent)
    try:
        with suppress(FileNotFoundError):
            place.lstat()  # an error where the file system takes no such name, be it too long
        make(temporary)
    except OSError as error:
        raise _refusal(target, place, error) from None
    return temporary


def _hidden_sibling(target: Path, folder: Path) -> Path:
    """A name that nothing else has, in the folder where `target` is: a move on one file system is atomic."""
    return folder / f".{target.stem[:TOLD]}.{secrets.token_hex(8)}.part{target.suffix}"


def _refusal(target: Path, place: Path, error: OSError) -> OSError:
    folder = place.absolute().parent
    if not folder.is_dir():
        return FileNotFoundError(f"cannot write {target}: there is no folder {folder}")
    if isinstance(error, FileNotFoundError):  # the error of file systems such as /proc
        return PermissionError(f"cannot write {target}: nothing can be written to {folder}")
    return type(error)(f"cannot write {target}: {(error.strerror or str(error)).lower()}")
