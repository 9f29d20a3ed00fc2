"""The points of a sweep that are done: a file for each chunk, from which a sweep that was stopped goes on.

The folder `NAME.partial` holds the study and the chunks, .npz files named by their first point and the one after their last.
Each is renamed into place when it is whole and on the disk, so that a listing of the folder tells what is done.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from os import fsync
from pathlib import Path
from typing import IO, Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.atomic_files import output_file
from softcradle.sandbox.sweeps.chunk_work import Chunk, stacked
from softcradle.sandbox.user_error import StudyError, reason

STUDY, LOCK, TRIED = "study.json", "lock", "tried"  # files beside the chunks
REASON_AT, REASONS = "reason at", "reasons"  # arrays of an .npz beside the columns
COLUMN = "column "  # before the names of columns there, so that no name of a measure is another's


def partial_folder(path: Path) -> Path:
    """Where the points of a sweep are kept until all are computed."""
    return path.with_name(f"{path.name}.partial")


class Store:
    """The chunks of a sweep; open once at a time.

    Arguments:
        folder: where they are, made if need be; None keeps them in memory.
        study: the study as text; a folder of another study is refused.
        fresh: begin anew, whatever is there.

    Raises:
        StudyError: the folder is of another study, in use, or cannot be written to.
    """

    def __init__(self, folder: Path | None, study: str, fresh: bool = False) -> None:
        self.folder, self._held = folder, list[Chunk]()
        self._lock: IO[bytes] | None = None
        try:
            if folder is not None:
                self._open(folder, study, fresh)
        except OSError as error:
            raise StudyError(f"cannot write {folder}: {reason(error)}") from None

    def _open(self, folder: Path, study: str, fresh: bool) -> None:
        if folder.is_file() and fresh:
            folder.unlink()
        elif folder.is_file():
            raise StudyError(f"{folder} was begun by another version: give another output, or begin afresh")
        folder.mkdir(exist_ok=True)
        self._lock = locked(folder)
        if self._lock is None:
            raise StudyError(f"{folder} is being written by another sweep")
        known = study_in(folder)
        if known not in (None, study) and not fresh:
            self.close()
            raise StudyError(
                f"{folder} was begun for another study, or by another version: give another output, or begin afresh"
            )
        if known is None or fresh:
            for file in [*folder.glob("*.npz"), folder / TRIED]:
                file.unlink(missing_ok=True)
            with output_file(folder / STUDY) as temporary:
                temporary.write_text(study, encoding="utf-8")

    def keep(self, chunk: Chunk) -> None:
        """Add a chunk. Raises StudyError where the disk is full; what was kept before stays."""
        if self.folder is None:
            self._held.append(chunk)
            return
        try:
            with output_file(self.folder / f"{chunk.begin}-{chunk.end}.npz") as temporary, temporary.open("wb") as file:
                np.savez(file, **_arrays(chunk))
                file.flush()
                fsync(file.fileno())
        except OSError as error:
            raise StudyError(f"cannot write {self.folder}: {reason(error)}") from None

    @property
    def done(self) -> int:
        """Points that are kept."""
        return sum(end - begin for begin, end in self._ranges())

    def _ranges(self) -> list[tuple[int, int]]:
        held = sorted((chunk.begin, chunk.end) for chunk in self._held)
        return held if self.folder is None else kept_ranges(self.folder)

    def missing(self, count: int) -> Iterator[tuple[int, int]]:
        """The points of `count` that are not kept, as ranges."""
        reached = 0
        for begin, end in self._ranges():
            if begin > reached:
                yield reached, begin
            reached = max(reached, end)
        if reached < count:
            yield reached, count

    def chunks(self) -> list[Chunk]:
        """All chunks, in the order of their points. Raises StudyError where a file cannot be read."""
        if self.folder is None:
            return sorted(self._held, key=lambda chunk: chunk.begin)
        return [_read(self.folder / f"{begin}-{end}.npz", begin, end) for begin, end in kept_ranges(self.folder)]

    @property
    def died(self) -> bool:
        """Whether the process that tried the first points died of it."""
        return self.folder is not None and (self.folder / TRIED).exists()

    @contextmanager
    def trying(self) -> Iterator[None]:
        """Leave a note on the disk while points are tried in this process, which a point might kill."""
        if self.folder is not None:
            (self.folder / TRIED).touch()
        try:
            yield
        finally:
            if self.folder is not None:
                (self.folder / TRIED).unlink(missing_ok=True)

    def close(self) -> None:
        """Let another sweep open it."""
        if self._lock is not None:
            self._lock.close()

    def remove(self) -> None:
        """Delete the folder."""
        self.close()
        if self.folder is not None:
            shutil.rmtree(self.folder, ignore_errors=True)


def locked(folder: Path) -> IO[bytes] | None:
    """The file whose lock says that a sweep writes into the folder, locked; None where another process has it."""
    file = (folder / LOCK).open("ab")
    with suppress(ImportError):  # Windows: two sweeps are not told apart
        import fcntl

        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.close()
            return None
    return file


def study_in(folder: Path) -> str | None:
    """The study that the folder was begun for; None where there is none."""
    with suppress(OSError, UnicodeDecodeError):
        return (folder / STUDY).read_text(encoding="utf-8")
    return None


def kept_ranges(folder: Path) -> list[tuple[int, int]]:
    """First point and the one after the last of every chunk in a folder, in order."""
    found = [re.fullmatch(r"(\d+)-(\d+)\.npz", file.name) for file in folder.iterdir()]
    return sorted((int(name[1]), int(name[2])) for name in found if name)


def merged(chunks: Sequence[Chunk], count: int) -> Chunk:
    """All chunks as one. Raises StudyError where a measure is a number at one point and a list at another."""
    names = dict.fromkeys(name for chunk in chunks for name in chunk.columns)
    columns = {name: _joined(name, chunks) for name in names}
    return Chunk(0, count, columns, {k: text for chunk in chunks for k, text in chunk.reasons.items()})


def _joined(name: str, chunks: Sequence[Chunk]) -> NDArray[Any]:
    """A column of all chunks one after the other, in the largest shape among them."""
    columns = [chunk.columns[name] for chunk in chunks if name in chunk.columns]
    if len(columns) == len(chunks) and len({column.shape[1:] for column in columns}) == 1:
        return np.concatenate(columns)
    if len({column.ndim for column in columns}) > 1:
        raise StudyError(f"measure {name!r} is a number at one point and a list at another")
    rows: list[Any] = []
    for chunk in chunks:
        rows.extend(chunk.columns.get(name, [None] * (chunk.end - chunk.begin)))
    return stacked(rows)


def _arrays(chunk: Chunk) -> dict[str, Any]:
    """The arrays of an .npz of the chunk."""
    columns: dict[str, Any] = {COLUMN + name: column for name, column in chunk.columns.items()}
    if chunk.reasons:
        columns[REASON_AT] = np.array(list(chunk.reasons), dtype=np.int64)
        columns[REASONS] = np.array(list(chunk.reasons.values()), dtype=str)
    return columns


def _read(path: Path, begin: int, end: int) -> Chunk:
    try:
        with np.load(path, allow_pickle=False) as file:
            found = {name: file[name] for name in file.files}
    except (OSError, ValueError, EOFError, BadZipFile):
        raise StudyError(f"cannot read {path}: delete it, and the same sweep computes its points again") from None
    told = (found[REASON_AT].tolist(), found[REASONS].tolist()) if REASONS in found else ((), ())
    columns = {name.removeprefix(COLUMN): array for name, array in found.items() if name.startswith(COLUMN)}
    return Chunk(begin, end, columns, dict(zip(*told, strict=True)))
