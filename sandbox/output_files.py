"""Output of the commands: whole files or none, and a refusal that is a sentence."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

from softcradle.physics import atomic_files as files
from softcradle.sandbox.user_error import UserError


@contextmanager
def output_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary path with the same suffix, moved to `path` at the end; UserError at once where that cannot be."""
    with _refusing(files.output_file, path) as temporary:
        yield temporary


@contextmanager
def output_folder(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary folder, moved to `path` at the end; UserError at once where that cannot be."""
    with _refusing(files.output_folder, path) as temporary:
        yield temporary


@contextmanager
def _refusing(
    opened: Callable[[str | os.PathLike[str]], AbstractContextManager[Path]], path: str | os.PathLike[str]
) -> Iterator[Path]:
    try:
        with opened(path) as temporary:
            yield temporary
    except OSError as error:  # also a full disk while writing
        raise UserError(str(error) if error.errno is None else f"cannot write {path}: {error.strerror}") from error
