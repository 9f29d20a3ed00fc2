"""The journal of a sweep: one file to which computed chunks are appended, and from which a stopped sweep goes on.

A line of JSON with the study, then chunks: a line of JSON (points, bytes, check sum, shapes) and an .npz of the arrays. Each is
on the disk before the next is taken; one that a kill or a full disk has cut off is cut away when the file is opened again.
"""

from __future__ import annotations

import io
import json
import os
import zlib
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.sweeps.chunk_work import Chunk, stacked
from softcradle.sandbox.sweeps.study_error import StudyError
from softcradle.sandbox.user_error import reason

REASON_AT, REASONS = "reason at", "reasons"  # arrays of an .npz beside the columns
COLUMN = "column "  # before the names of columns there, so that no name of a measure is another's


class Entry(NamedTuple):
    """Where a chunk is in the file: points from `begin` to `end`, its bytes, and the shape of a point of every column."""

    begin: int
    end: int
    place: int
    size: int
    shapes: dict[str, tuple[int, ...]]


class Journal:
    """The journal in a file; opened once at a time.

    Arguments:
        path: its file, which is made if there is none; None keeps the chunks in memory.
        study: the study as JSON text; a file of another study is refused.
        fresh: begin anew, whatever is there.

    Raises:
        StudyError: the file is of another study, in use, or cannot be written to.
    """

    def __init__(self, path: Path | None, study: str, fresh: bool = False) -> None:
        self.path, self.entries = path, list[Entry]()
        self._loaded: tuple[Entry | None, Chunk | None] = (None, None)
        try:
            self._file: BinaryIO = io.BytesIO() if path is None else path.open("r+b" if path.exists() else "x+b")
        except OSError as error:
            raise StudyError(f"cannot write {path}: {reason(error)}") from None
        try:
            self._lock()
            self._open(study, fresh)
        except BaseException as error:
            self.close()
            if isinstance(error, OSError):
                raise StudyError(f"cannot write {path}: {reason(error)}") from None
            raise

    def _lock(self) -> None:
        if self.path is None:
            return
        try:
            import fcntl
        except ImportError:  # Windows: an open file cannot be replaced there, but two sweeps are not told apart
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise StudyError(f"{self.path} is being written by another sweep") from None

    def _open(self, study: str, fresh: bool) -> None:
        first = self._file.readline()
        if fresh or not first.endswith(b"\n"):
            self._file.seek(0)
            self._file.truncate()
            self._file.write(study.encode() + b"\n")
            self._sync()
        elif first.decode(errors="replace") != study + "\n":
            raise StudyError(
                f"{self.path} was begun for another study, or by another version: give another output, or begin afresh"
            )
        self._end = self._read_entries()
        self._file.truncate(self._end)

    def _read_entries(self) -> int:
        """Find all chunks that are whole. Returns where the last of them ends."""
        size, end = self._file.seek(0, os.SEEK_END), 0
        self._file.seek(0)
        end += len(self._file.readline())
        while True:
            self._file.seek(end)
            line = self._file.readline()
            head = _head(line)
            if head is None or end + len(line) + head["bytes"] > size:
                return end
            last = end + len(line) + head["bytes"] == size  # what was cut off is the last: a file only grows
            if last and zlib.crc32(self._file.read(head["bytes"])) != head["sum"]:
                return end
            shapes = {name: tuple(shape) for name, shape in head["shapes"].items()}
            self.entries.append(Entry(head["begin"], head["end"], end + len(line), head["bytes"], shapes))
            end += len(line) + head["bytes"]

    def append(self, chunk: Chunk) -> None:
        """Add a chunk. Raises StudyError where the disk is full; the file is then as it was."""
        body = _body(chunk)
        shapes = {name: column.shape[1:] for name, column in chunk.columns.items()}
        head = {"begin": chunk.begin, "end": chunk.end, "bytes": len(body), "sum": zlib.crc32(body), "shapes": shapes}
        line = json.dumps(head).encode() + b"\n"
        try:
            self._file.seek(self._end)
            self._file.write(line + body)
            self._sync()
        except OSError as error:
            self._cut()
            raise StudyError(f"cannot write {self.path}: {reason(error)}") from None
        self.entries.append(Entry(chunk.begin, chunk.end, self._end + len(line), len(body), shapes))
        self._end += len(line) + len(body)

    def _sync(self) -> None:
        self._file.flush()
        if self.path is not None:
            os.fsync(self._file.fileno())

    def _cut(self) -> None:
        """Cut away what was written of a chunk; where that cannot be done, it is done when the file is next opened."""
        if self.path is not None:
            with suppress(OSError):
                os.truncate(self.path, self._end)

    @property
    def done(self) -> int:
        """Points that are kept."""
        return sum(entry.end - entry.begin for entry in self.entries)

    def missing(self, count: int) -> Iterator[tuple[int, int]]:
        """The points of `count` that are not kept, as ranges."""
        reached = 0
        for entry in sorted(self.entries):
            if entry.begin > reached:
                yield reached, entry.begin
            reached = max(reached, entry.end)
        if reached < count:
            yield reached, count

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """The largest shape of a point of every column. Raises StudyError where one is a number here and a list there."""
        found: dict[str, tuple[int, ...]] = {}
        for entry in self.entries:
            for name, shape in entry.shapes.items():
                known = found.setdefault(name, shape)
                if len(known) != len(shape):
                    raise StudyError(f"measure {name!r} is a number at one point and a list at another")
                found[name] = tuple(map(max, known, shape))
        return found

    def rows(self, begin: int, end: int) -> Chunk:
        """The points from `begin` to `end`, all of which are kept."""
        parts = [self._part(entry, begin, end) for entry in self._sorted(begin, end)]
        names = dict.fromkeys(name for part in parts for name in part.columns)
        columns = {name: _joined(name, parts) for name in names}
        return Chunk(begin, end, columns, {k: text for part in parts for k, text in part.reasons.items()})

    def _sorted(self, begin: int, end: int) -> list[Entry]:
        return sorted(entry for entry in self.entries if entry.begin < end and entry.end > begin)

    def _part(self, entry: Entry, begin: int, end: int) -> Chunk:
        """What lies between `begin` and `end` of a chunk, the last of which stays in memory."""
        if self._loaded[0] is not entry:
            self._file.seek(entry.place)
            self._loaded = entry, _chunk(entry, self._file.read(entry.size))
        whole = self._loaded[1]
        assert whole is not None
        first, last = max(begin, entry.begin), min(end, entry.end)
        inside = slice(first - entry.begin, last - entry.begin)
        reasons = {k: text for k, text in whole.reasons.items() if first <= k < last}
        return Chunk(first, last, {name: column[inside] for name, column in whole.columns.items()}, reasons)

    def close(self) -> None:
        """Close the file."""
        with suppress(OSError):  # what a full disk did not take is cut away already
            self._file.close()

    def remove(self) -> None:
        """Close and delete the file."""
        self.close()
        if self.path is not None:
            self.path.unlink(missing_ok=True)


def _head(line: bytes) -> Any:
    """The head of a chunk; None where it was cut off."""
    if not line.endswith(b"\n"):
        return None
    try:
        return json.loads(line)
    except ValueError:
        return None


def _body(chunk: Chunk) -> bytes:
    """The arrays of a chunk as an .npz."""
    buffer = io.BytesIO()
    more: dict[str, Any] = {
        REASON_AT: np.array(list(chunk.reasons), dtype=np.int64),
        REASONS: np.array(list(chunk.reasons.values()), dtype=str),
    }
    columns: dict[str, Any] = {COLUMN + name: column for name, column in chunk.columns.items()}
    np.savez(buffer, **columns, **(more if chunk.reasons else {}))
    return buffer.getvalue()


def _chunk(entry: Entry, body: bytes) -> Chunk:
    with np.load(io.BytesIO(body), allow_pickle=False) as file:
        columns = {name: file[COLUMN + name] for name in entry.shapes}
        told = (file[REASON_AT].tolist(), file[REASONS].tolist()) if REASONS in file else ((), ())
    return Chunk(entry.begin, entry.end, columns, dict(zip(*told, strict=True)))


def _joined(name: str, parts: list[Chunk]) -> NDArray[Any]:
    """A column of all parts one after the other, in the largest shape among them."""
    columns = [part.columns[name] for part in parts if name in part.columns]
    if len(columns) == len(parts) and len({column.shape[1:] for column in columns}) == 1:
        return np.concatenate(columns)
    rows: list[Any] = []
    for part in parts:
        rows.extend(part.columns.get(name, [None] * (part.end - part.begin)))
    return stacked(rows)
