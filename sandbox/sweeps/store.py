"""Store for the finished points of a sweep. The store is a Zarr group from which an interrupted sweep continues.

The folder `NAME.partial` contains a lock and a group. The group has an array for each column of the chunks, with a row
for each point. The study is an attribute of the group. The status of a point is written last, so a point with a status
is complete.
"""

import inspect
import json
import math
import pickle
import shutil
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict
from functools import partial
from hashlib import sha256
from os import fsync
from pathlib import Path
from types import MethodType
from typing import Any
from urllib.parse import quote

import numpy as np
from filelock import FileLock, Timeout
from softcradle.physics.extras import needed_for
from softcradle.sandbox.sweeps.scene_points import ScenePoints
from softcradle.sandbox.sweeps.work import REASON, STATUS, UNLIKE, WARNED, Chunk, Work, function_name
from softcradle.sandbox.user_error import StudyError, reason

# Status of a point that is not stored.
MISSING = -1
# Largest number of rows of an array, and largest number of values, in one file. Each chunk of a sweep rewrites its
# files.
MOST_ROWS, MOST_NUMBERS = 4096, 2**18
# Values by column for points that are not stored. All other columns contain NaN.
FILL: dict[str, Any] = {STATUS: MISSING, WARNED: 0, REASON: ""}
# Largest number of values of an axis that the text of the study lists.
MOST_VALUES = 100
# Names of the lock and of the group in the folder.
LOCK, GROUP = "lock", "points"


def partial_folder(path: Path) -> Path:
    """Return the folder that stores the points of a sweep until all points are computed."""
    return path.with_name(f"{path.name}.partial")


class Store:
    """Chunks of a sweep, in memory and in a folder. Only one process can open the folder at a time.

    Attributes:
        begun: True if an earlier process started to compute these points and was stopped or killed.

    Arguments:
        folder: folder of the points, created if necessary; None keeps them only in memory.
        study: description of the study as text. A folder that belongs to another study is rejected.
        count: number of points.
        fresh: True to start again and ignore the content of the folder. The content is used if it was itself started
            with `fresh` for this study.

    Raises:
        StudyError: the folder belongs to another study, is in use, cannot be written or cannot be read.
    """

    def __init__(self, folder: Path | None, study: str, count: int, fresh: bool = False) -> None:
        self.folder, self.begun, self._count, self._chunks = folder, False, count, list[Chunk]()
        self._arrays: dict[str, Any] = {}
        self._lock: FileLock | None = None
        if folder is None:
            return
        try:
            self._open(folder, study, fresh)
        except BaseException as error:
            self.close()
            if isinstance(error, OSError):
                raise StudyError(f"cannot write {folder}: {reason(error)}") from None
            raise

    def _open(self, folder: Path, study: str, fresh: bool) -> None:
        with needed_for("a sweep that continues after an interruption", "sweep"):
            import zarr
        folder.mkdir(exist_ok=True)
        self._lock = FileLock(folder / LOCK)
        try:
            self._lock.acquire(timeout=0)
        except Timeout:
            raise StudyError(f"{folder} is being written by another sweep") from None
        known = study_in(folder)
        if known not in (None, study) and not fresh:
            raise StudyError(
                f"{folder} was begun for another study, or by another version: give another output, or begin afresh"
            )
        self.begun = begun_afresh(folder, study) if fresh else known is not None
        self._group = zarr.open_group(folder / GROUP, mode="a" if self.begun else "w", zarr_format=2)
        if not self.begun:
            self._group.attrs.put({"study": study, "fresh": fresh, "columns": []})
        self._arrays = {name: self._group[quote(name, safe="")] for name in self._group.attrs["columns"]}
        if STATUS in self._arrays:
            self._chunks = list(self._stored())

    def _stored(self) -> Iterator[Chunk]:
        """Yield the stored points as chunks."""
        try:
            columns = {name: array[:] for name, array in self._arrays.items()}
            columns = {name: np.full(self._count, FILL[name]) for name in (WARNED, REASON)} | columns
        except Exception as error:  # For a damaged file, Zarr raises errors of many kinds.
            raise StudyError(f"cannot read {self.folder} ({error}): delete it to compute its points again") from None
        there = np.concatenate([[False], columns[STATUS] != MISSING, [False]])
        for begin, end in np.flatnonzero(there[1:] != there[:-1]).reshape(-1, 2).tolist():
            yield Chunk(begin, end, {name: column[begin:end] for name, column in columns.items()})

    def keep(self, chunk: Chunk) -> None:
        """Store a chunk. Raise StudyError if the disk is full. Chunks that were stored before stay intact."""
        if self.folder is not None:
            try:
                files = [file for name in chunk.columns if name != STATUS for file in self._written(name, chunk)]
                _sync(files)  # The status must not reach the disk before the numbers.
                _sync(self._written(STATUS, chunk))
            except OSError as error:
                raise StudyError(f"cannot write {self.folder}: {reason(error)}") from None
        self._chunks.append(chunk)

    def _written(self, name: str, chunk: Chunk) -> Iterator[Path]:
        """Write one column of a chunk, and yield the files that contain it."""
        values, key = chunk.columns[name], quote(name, safe="")
        inner = values.shape[1:]
        if name in (WARNED, REASON) and not values.any():
            return  # Zarr fills in these values by default.
        if name not in self._arrays:
            rows = max(1, min(MOST_ROWS, MOST_NUMBERS // max(1, math.prod(inner))))
            self._arrays[name] = self._group.create_array(
                key, shape=(self._count, *inner), chunks=(rows, *(max(1, length) for length in inner)),
                dtype=str if name == REASON else values.dtype, fill_value=FILL.get(name, math.nan),
                chunk_key_encoding={"name": "v2", "separator": "/"}, overwrite=True,
            )  # fmt: skip
            self._group.attrs["columns"] = list(self._arrays)
        array = self._arrays[name]
        if array.ndim != values.ndim:
            raise StudyError(UNLIKE)
        shape = (self._count, *map(max, array.shape[1:], inner))
        if array.shape != shape:
            array.resize(shape)
        array[(slice(chunk.begin, chunk.end), *map(slice, inner))] = values
        for block in range(chunk.begin // array.chunks[0], (chunk.end - 1) // array.chunks[0] + 1):
            path = self.folder / GROUP / key / str(block)  # type: ignore[operator]
            yield from [path] if path.is_file() else filter(Path.is_file, path.rglob("*"))

    @property
    def done(self) -> int:
        """Number of stored points."""
        return sum(chunk.count for chunk in self._chunks)

    def chunks(self) -> list[Chunk]:
        """Return all chunks in the order of their points."""
        return sorted(self._chunks, key=lambda chunk: chunk.begin)

    def missing(self) -> Iterator[tuple[int, int]]:
        """Yield the ranges of points that are not stored."""
        reached = 0
        for begin, end in [*((chunk.begin, chunk.end) for chunk in self.chunks()), (self._count, self._count)]:
            if begin > reached:
                yield reached, begin
            reached = end

    def close(self) -> None:
        """Release the lock, after which another sweep can open the folder."""
        if self._lock is not None:
            self._lock.release()

    def remove(self) -> None:
        """Delete the folder with the stored points."""
        self.close()
        if self.folder is not None:
            shutil.rmtree(self.folder, ignore_errors=True)


def _sync(files: Iterable[Path]) -> None:
    """Wait until the content of the files is on the disk."""
    for path in files:
        with path.open("r+b") as file:
            fsync(file.fileno())


def is_locked(folder: Path) -> bool:
    """Return True if a sweep is currently writing into the folder."""
    lock = FileLock(folder / LOCK)
    with suppress(Timeout):
        lock.acquire(timeout=0)
        lock.release()
        return False
    return True


def kept_count(folder: Path) -> int:
    """Return the number of points that the folder contains."""
    import zarr

    path = folder / GROUP / quote(STATUS, safe="")
    return int((zarr.open_array(path, mode="r")[:] != MISSING).sum()) if path.exists() else 0


def _attributes(folder: Path) -> dict[str, Any]:
    with suppress(OSError, ValueError):
        return dict(json.loads((folder / GROUP / ".zattrs").read_text(encoding="utf-8")))
    return {}


def study_in(folder: Path) -> str | None:
    """Return the text of the study to which the folder belongs, or None if the folder does not contain it."""
    return _attributes(folder).get("study")


def begun_afresh(folder: Path, study: str) -> bool:
    """Return True if a sweep with `fresh` has started this folder for this study.

    The folder then takes precedence over the existing output.
    """
    known = _attributes(folder)
    return known.get("study") == study and known["fresh"]


def study_text(work: Work, title: str, units: Mapping[str, str] | None = None, version: str | int = "") -> str:
    """Return a line of JSON with everything that determines the Dataset of a sweep.

    Long lists of values are replaced by digests.
    """
    axes = [asdict(axis) | {"values": _shortened(axis.values)} for axis in work.points.axes]
    measures = [
        item if isinstance(item, str) else [item.name, item.unit, item.meaning, item.each, *identity(item.function)]
        for item in work.measures
    ]
    if isinstance(work.source, ScenePoints):
        source: Any = work.source.scene.model_dump(mode="json", exclude={"view", "text", "question", "source"})
    else:
        source = identity(work.source)
    found = {
        "title": title, "units": dict(units or {}), "version": version, "design": work.points.design,
        "count": work.points.count, "seed": work.points.seed, "axes": axes, "of": source, "measures": measures,
        "versions": dict(work.versions),
    }  # fmt: skip
    return json.dumps(found)


def identity(function: Any) -> tuple[str, str]:
    """Return the name of a function and a digest.

    The digest depends on the source text of the function and on the values that are bound to it. The digest does not
    depend on other functions that the function calls, or on values that it closes over. The argument `version` of a
    sweep represents these.
    """
    bound: list[Any] = []
    name = function_name(function)
    while isinstance(function, (partial, MethodType)):
        bound.append((function.args, function.keywords) if isinstance(function, partial) else function.__self__)
        function = function.func if isinstance(function, partial) else function.__func__
    function = inspect.unwrap(function)
    code = getattr(function, "__code__", None)
    source = b"" if code is None else code.co_code + repr(code.co_names).encode()
    # The source text is missing for a function typed at a prompt, or for an instance of a class.
    with suppress(OSError, TypeError):
        source = inspect.getsource(function).encode()
    with suppress(pickle.PicklingError, AttributeError, TypeError):
        source += pickle.dumps(bound if source else [function, *bound])
    return name, sha256(source).hexdigest()[:16]


def _shortened(values: tuple[Any, ...]) -> Any:
    if len(values) <= MOST_VALUES:
        return list(values)
    return {"number": len(values), "digest": sha256(repr(values).encode()).hexdigest()[:16]}
