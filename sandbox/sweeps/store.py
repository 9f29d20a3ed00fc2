"""Store for the finished points of a sweep: one file for each chunk, from which an interrupted sweep continues.

The folder `NAME.partial` contains the study and the chunks, which are .npz files. A file name consists of the first
point of the chunk and the point after its last one. A file is renamed into place when it is complete and on the disk,
so a listing of the folder shows which points are finished.
"""

import json
import shutil
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict
from os import fsync
from pathlib import Path
from typing import IO, Any
from zipfile import BadZipFile

import numpy as np
from softcradle.physics.atomic_files import output_file
from softcradle.sandbox.sweeps.code_digest import code_digest
from softcradle.sandbox.sweeps.scene_points import ScenePoints
from softcradle.sandbox.sweeps.work import REASON, Chunk, Work, function_name
from softcradle.sandbox.user_error import StudyError, reason

STUDY, LOCK, AFRESH = "study.json", "lock", "afresh"  # Names of files in the folder of the chunks.
# Prefix of column names in an .npz file. Without it, the name of a measure could be that of an argument of np.savez.
COLUMN = "column "
MOST_VALUES = 100  # Largest number of values of an axis that are written out.


def partial_folder(path: Path) -> Path:
    """Return the folder that keeps the points of a sweep until all are computed."""
    return path.with_name(f"{path.name}.partial")


class Store:
    """Chunks of a sweep. Only one process can open the store at a time.

    `begun` is True if an earlier process started to compute these chunks and was stopped or killed.

    Arguments:
        folder: folder of the chunks, created if necessary; None keeps them only in memory.
        study: the study as text. The folder of another study is rejected.
        fresh: start over, whatever the folder contains. Only a folder of this study that was itself started with
            `fresh`
            is continued.

    Raises:
        StudyError: the folder belongs to another study, is in use or cannot be written, or one of its files cannot be
            read.
    """

    def __init__(self, folder: Path | None, study: str, fresh: bool = False) -> None:
        self.folder, self.begun, self._chunks = folder, False, list[Chunk]()
        self._lock: IO[bytes] | None = None
        try:
            if folder is not None:
                self._open(folder, study, fresh)
        except BaseException as error:
            self.close()
            if isinstance(error, OSError):
                raise StudyError(f"cannot write {folder}: {reason(error)}") from None
            raise

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
            raise StudyError(
                f"{folder} was begun for another study, or by another version: give another output, or begin afresh"
            )
        self.begun = begun_afresh(folder, study) if fresh else known is not None
        if not self.begun:
            for file in folder.glob("*.npz"):
                file.unlink()
            with output_file(folder / STUDY) as temporary:
                temporary.write_text(study, encoding="utf-8")
            if fresh:
                (folder / AFRESH).touch()
        self._chunks = [_read(folder, *kept) for kept in kept_ranges(folder)]

    def keep(self, chunk: Chunk) -> None:
        """Add a chunk. Raise StudyError if the disk is full; chunks stored before stay intact."""
        if self.folder is not None:
            columns = {COLUMN + name: column for name, column in chunk.columns.items()}
            try:
                with output_file(_file_of(self.folder, chunk.begin, chunk.end)) as path, path.open("wb") as file:
                    np.savez(file, **columns)  # type: ignore[arg-type]
                    file.flush()
                    fsync(file.fileno())
            except OSError as error:
                raise StudyError(f"cannot write {self.folder}: {reason(error)}") from None
        self._chunks.append(chunk)

    @property
    def done(self) -> int:
        """Number of stored points."""
        return sum(chunk.count for chunk in self._chunks)

    def chunks(self) -> list[Chunk]:
        """Return all chunks in the order of their points."""
        return sorted(self._chunks, key=lambda chunk: chunk.begin)

    def missing(self, count: int) -> Iterator[tuple[int, int]]:
        """Yield the ranges of points below `count` that are not stored."""
        reached = 0
        for chunk in self.chunks():
            if chunk.begin > reached:
                yield reached, chunk.begin
            reached = chunk.end
        if reached < count:
            yield reached, count

    def close(self) -> None:
        """Release the lock, so that another sweep can open the store."""
        if self._lock is not None:
            self._lock.close()

    def remove(self) -> None:
        """Delete the folder."""
        self.close()
        if self.folder is not None:
            shutil.rmtree(self.folder, ignore_errors=True)


def locked(folder: Path) -> IO[bytes] | None:
    """Return the lock file of the folder, locked, or None if another process has locked it."""
    file = (folder / LOCK).open("ab")
    with suppress(ImportError):  # On Windows, two sweeps that write into one folder are not detected.
        import fcntl

        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.close()
            return None
    return file


def study_in(folder: Path) -> str | None:
    """Return the study of the folder, or None if it does not contain one."""
    with suppress(OSError, UnicodeDecodeError):
        return (folder / STUDY).read_text(encoding="utf-8")
    return None


def begun_afresh(folder: Path, study: str) -> bool:
    """Return True if a sweep with `fresh` started this folder for this study. It then takes precedence over the
    existing output.
    """
    return (folder / AFRESH).exists() and study_in(folder) == study


def kept_ranges(folder: Path) -> list[tuple[int, int]]:
    """Return the stored points of the folder as ranges (begin, end)."""
    names = [path.stem.split("-") for path in folder.glob("[0-9]*-[0-9]*.npz")]
    return sorted((int(begin), int(end)) for begin, end in names)


def _file_of(folder: Path, begin: int, end: int) -> Path:
    return folder / f"{begin}-{end}.npz"


def _read(folder: Path, begin: int, end: int) -> Chunk:
    path = _file_of(folder, begin, end)
    try:
        with np.load(path, allow_pickle=False) as file:
            columns = {name.removeprefix(COLUMN): file[name] for name in (COLUMN + REASON, *file.files)}
    except (OSError, ValueError, EOFError, KeyError, BadZipFile):
        raise StudyError(f"cannot read {path}: delete it, and the same sweep computes its points again") from None
    return Chunk(begin, end, columns)


def study_text(work: Work, title: str, units: Mapping[str, str] | None = None) -> str:
    """Return everything that determines the Dataset of a sweep, as one line of JSON. Long lists of values are replaced
    by digests.
    """
    axes = [asdict(axis) | {"values": _shortened(axis.values)} for axis in work.points.axes]
    if isinstance(work.source, ScenePoints):
        source = work.source.scene.model_dump(mode="json", exclude={"view", "text", "question", "source"})
    else:
        source = {"function": function_name(work.source), "code": code_digest(work.source)}
    found = {
        "title": title,
        "units": dict(units or {}),
        "design": work.points.design,
        "count": work.points.count,
        "seed": work.points.seed,
        "axes": axes,
        "of": source,
        "measures": [
            item
            if isinstance(item, str)
            else [item.name, item.unit, item.meaning, item.each, code_digest(item.function)]
            for item in work.measures
        ],
        "versions": dict(work.versions),
    }
    return json.dumps(found, default=code_digest)


def _shortened(values: tuple[Any, ...]) -> Any:
    if len(values) <= MOST_VALUES:
        return list(values)
    return {"number": len(values), "digest": code_digest(values)}
