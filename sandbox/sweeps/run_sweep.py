"""The function `sweep`, which computes a scene or a function at many points on one machine or on many.

Points that are stored on disk are not computed again.
"""

from __future__ import annotations

import hashlib
import logging
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from softcradle.physics.extras import needed_for
from softcradle.physics.source_digest import digest_of
from softcradle.sandbox.sweeps.dataset import (
    checked_output,
    dataset_of,
    lost_points,
    opened_dataset,
    write_dataset,
)
from softcradle.sandbox.sweeps.executors import ChunkSchedule, Where, Workplace, here, place_of, processes_or_threads
from softcradle.sandbox.sweeps.measure_table import Measure
from softcradle.sandbox.sweeps.sample_points import Axis, Points, grid
from softcradle.sandbox.sweeps.store import (
    Store,
    begun_afresh,
    is_locked,
    kept_count,
    partial_folder,
    study_in,
    study_text,
)
from softcradle.sandbox.sweeps.work import (
    REASON,
    STATUS,
    WARNED,
    Chunk,
    Outcome,
    PointStatus,
    Work,
    check_columns,
    merged,
    sweep_work,
)
from softcradle.sandbox.user_error import StudyError, reason

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client
    from softcradle.scenes import Scene

LOGGER = logging.getLogger("softcradle")
TRIED_HERE = 0.3  # Time for which "auto" first computes points in this process to measure the time per point [s].
# Remaining computing time from which on "auto" starts other processes [s]. With less work, the start of processes takes
# longer than the work.
WORTH_PROCESSES = 3.0
# Folder that contains all studies. If one of its files changes, stored points count as points of another study.
SANDBOX = Path(__file__).parent.parent

Progress = Callable[[str, int, int], None]


def sweep(
    what: Scene | str | Callable[..., Any],
    over: Points | Mapping[str, Any] | Sequence[Axis],
    measures: Sequence[str | Measure] = (),
    *,
    output: str | Path | None = None,
    executor: Executor | Where = "auto",
    scheduler: str | Client | None = None,
    workers: int | None = None,
    units: Mapping[str, str] | None = None,
    title: str = "",
    version: str | int = "",
    fresh: bool = False,
    progress: Progress | None = None,
    chunk_seconds: float = 1.0,
) -> xr.Dataset:
    """Compute a scene or a function at many points, and return its measures as an xarray Dataset.

    The function requires the optional dependencies [sweep]. If a point is invalid, or if its simulation gives up, the
    variable `status` marks the point and `reason` contains the cause. The Dataset does not depend on the executor, the
    chunks and the interruptions of the sweep.

    Parameters
    ----------
    what : Scene, str or callable
        A Scene, its name or the path of its file, or a function of the parameters by name. The function returns a
        mapping of names to numbers, or a motion to be measured. Such a motion is a Trajectory, (chain, velocity) or
        (chain, velocity, keywords of `simulate`).
    over : Points, mapping or sequence of Axis
        The points. ``{path: values}`` is a grid. The functions `grid`, `listed`, `sobol` and `latin_hypercube` of
        `softcradle.sandbox.sweeps` make other designs. The path of a number of a scene is as in its file, such as
        ``lanes.0.contact.alpha``. The key ``*`` stands for every item of a list.
    measures : sequence of str or Measure, optional
        Names from the table of measures, or Measure objects. Leave it empty for a function that returns numbers.
    output : path, optional
        A .zarr folder or a .nc file. While the sweep runs, a folder next to it stores the computed points. An
        interrupted sweep continues from these points. A complete sweep is only opened. None keeps everything in memory.
    executor : str or Executor, optional
        "threads" or "processes" of this machine, "here" (this thread), or any `concurrent.futures` executor. "auto"
        computes the first points in this thread, and the others in processes if that saves time.
    scheduler : str or Client, optional
        A Dask scheduler instead of an executor: its address, such as `tcp://127.0.0.1:8786`, or a Client. It requires
        the optional dependencies [dask].
    workers : int, optional
        Number of threads or processes. The default is one for each core of this machine, or the number of workers of
        the given executor.
    units : mapping, optional
        Units of the numbers that a function returns, by name.
    title : str, optional
        Title of the Dataset.
    version : str or int, optional
        Version of the function. Change it if other functions or values that the function uses change. Points of the
        old version are then not used again. A change of the text of the function itself is noticed automatically.
    fresh : bool, optional
        If True, start again and ignore the content of `output`. The old output stays until the new output is complete.
        If such a sweep is interrupted, the same call continues it, with or without `fresh`.
    progress : callable, optional
        Called with ("points" or "writing", done, all).
    chunk_seconds : float, optional
        Wanted computing time of one chunk [s].

    Returns
    -------
    xarray.Dataset
        A variable for each measure, with unit and meaning as attributes. The versions are attributes of the Dataset.

    Raises
    ------
    ValueError
        If an argument is invalid. The message is one sentence.
    """
    with needed_for("sweep", "sweep"):
        import xarray  # noqa: F401  # before the work, not after it
    points = over if isinstance(over, Points) else grid(over)
    work = sweep_work(what, points, measures)
    path = None if output is None else checked_output(output, points)
    study = study_text(work, title, units, version)
    if path is not None and path.exists() and not (fresh or begun_afresh(partial_folder(path), study)):
        LOGGER.info("%s is complete: nothing to compute", path)
        return opened_dataset(path, study)
    with opened(path, study, points.count, fresh) as store:
        tell = progress or _untold
        place = place_of(work, executor, scheduler, workers)
        check = partial(check_columns, work=work, known={})
        _compute_missing(work, store, place, workers, tell, chunk_seconds, take=check)
        tell("writing", 0, points.count)
        digest = hashlib.sha256(study.encode()).hexdigest()[:16]
        attributes = {"title": title or work.title, **work.versions, "study": study, "digest": digest}
        found = dataset_of(merged(store.chunks(), points.count), work, units or {}, attributes)
        if path is not None:
            try:
                write_dataset(found, path)
            except OSError as error:
                raise StudyError(
                    f"cannot write {path}: {reason(error)}; the points are kept in {store.folder}"
                ) from None
        tell("writing", points.count, points.count)
        store.remove()
    return found if path is None else opened_dataset(path, study)


def sweep_status(
    what: Scene | str | Callable[..., Any],
    over: Points | Mapping[str, Any] | Sequence[Axis],
    measures: Sequence[str | Measure],
    output: str | Path,
    title: str = "",
) -> tuple[int, str]:
    """Return the number of lost points of a complete sweep, and a sentence about the progress of the sweep.

    A point is lost if the process that computed it died in every attempt. This function does not compute any point. The
    arguments are those of `sweep`. Raise StudyError if they are invalid.
    """
    points = over if isinstance(over, Points) else grid(over)
    path = checked_output(output, points)
    study, folder, count = study_text(sweep_work(what, points, measures), title), partial_folder(path), points.count
    if path.exists() and not begun_afresh(folder, study):
        with opened_dataset(path, study) as found:
            lost = lost_points(found)
        told = f", {lost} of them lost: every process that computed them died" if lost else ""
        return lost, f"complete, {count} points are in {path}{told}"
    known = study_in(folder)
    if known is None:
        return 0, f"not begun, none of {count} points is computed"
    if known != study:
        raise StudyError(f"{folder} was begun for another study, or by another version")
    busy = "a sweep is at it" if is_locked(folder) else "no sweep is at it, the same command goes on"
    return 0, f"{kept_count(folder)} of {count} points are in {folder}, and {busy}"


def map_points(
    function: Callable[..., Mapping[str, Any] | Outcome],
    points: Points,
    kept: Path | None = None,
    progress: Progress | None = None,
    workers: int | None = None,
    *,
    executor: Where = "auto",
    alike: bool = True,
    each: Callable[[int, dict[str, Any]], None] | None = None,
    chunk_seconds: float = 1.0,
) -> list[dict[str, Any]]:
    """Return the results of `function` at all points in their order, as a list of rows.

    Processes are used if that saves time. xarray is not needed. Each row contains the numbers and the "reason" of an
    Outcome. Lists become arrays that are padded with NaN to a common length.

    Arguments:
        function: returns a mapping of names to numbers, or an Outcome with such a mapping and a reason.
        points: the sample points.
        kept: path whose name plus ``.partial`` is a folder that stores finished points. An interrupted call continues
            from these points. `drop_kept` deletes the folder. Points of another study in it are deleted.
        progress: called with ("points", done, all).
        workers: number of threads or processes.
        executor: as for `sweep`.
        alike: True if all points take about the same time. The first points then predict the total time. If it is
            False, the points that take longest must come first.
        each: called with the number and the row of each finished point.
        chunk_seconds: wanted computing time of one chunk [s].

    Raises:
        StudyError: the function raised an error at a point, or the processes that computed it died.
    """
    work = sweep_work(function, points, ())
    study = study_text(work, digest_of(SANDBOX.rglob("*.py")))
    fresh = kept is not None and study_in(partial_folder(kept)) not in (None, study)
    with opened(kept, study, points.count, fresh) as store:

        def take(chunk: Chunk) -> None:
            _refuse_broken(chunk, points)
            for k, row in enumerate(_rows(chunk) if each is not None else (), chunk.begin):
                each(k, row)  # type: ignore[misc]

        place = place_of(work, executor, None, workers)
        _compute_missing(work, store, place, workers, progress or _untold, chunk_seconds, alike, take)
        return [row for chunk in store.chunks() for row in _rows(chunk)]


def drop_kept(kept: Path) -> None:
    """Delete the points that `map_points` has stored in the folder of `kept`."""
    shutil.rmtree(partial_folder(kept), ignore_errors=True)


def _rows(chunk: Chunk) -> list[dict[str, Any]]:
    columns = {name: column for name, column in chunk.columns.items() if name not in (STATUS, WARNED, REASON)}
    told = [{"reason": str(text)} if text else {} for text in chunk.columns[REASON]]
    return [{name: column[k] for name, column in columns.items()} | reason for k, reason in enumerate(told)]


def _refuse_broken(chunk: Chunk, points: Points) -> None:
    broken = np.flatnonzero(chunk.columns[STATUS] >= PointStatus.REFUSED)
    if broken.size:
        row = int(broken[0])
        values = points.columns(chunk.begin + row, chunk.begin + row + 1)
        point = ", ".join(f"{name} {column[0]}" for name, column in values.items())
        raise StudyError(f"{point}: {chunk.columns[REASON][row]}")


def _untold(what: str, done: int, count: int) -> None:
    """Do nothing. This function replaces a missing `progress`."""


def _compute_missing(
    work: Work,
    store: Store,
    place: Workplace | None,
    workers: int | None,
    tell: Progress,
    chunk_seconds: float,
    alike: bool = True,
    take: Callable[[Chunk], None] = lambda _: None,
) -> None:
    """Compute all points that are not stored.

    If `place` is None and all points take about the same time, the first points are computed in this thread. The time
    of these points predicts the total time.
    """
    count = work.points.count

    def keep(chunk: Chunk) -> None:
        take(chunk)
        store.keep(chunk)
        tell("points", store.done, count)

    if store.done and store.folder is not None:
        LOGGER.warning("%d of %d points are in %s and not computed again", store.done, count, store.folder)
    tell("points", store.done, count)
    schedule = ChunkSchedule(store.missing(), keep, chunk_seconds)
    stopped = True
    try:
        # If an earlier process was killed, the first point may be the cause. The first point is therefore not computed
        # in this process.
        if place is None and alike and not store.begun:
            schedule.run(here(work), TRIED_HERE)
            if schedule.seconds_left < WORTH_PROCESSES:
                schedule.run(here(work))
        if schedule.left:
            place = place or processes_or_threads(work, workers)
            schedule.run(place)
        stopped = False
    finally:
        if place is not None:
            place.close(place.executor, stopped)


@contextmanager
def opened(path: Path | None, study: str, count: int, fresh: bool) -> Iterator[Store]:
    """Open the store of an output. If the sweep ends early, report how many points are stored."""
    store = Store(None if path is None else partial_folder(path), study, count, fresh)
    try:
        yield store
    except BaseException as error:
        done = kept_count(store.folder) if store.folder is not None else 0
        if not done and not store.begun:
            store.remove()
        if done:
            points = "1 point is" if done == 1 else f"{done} points are"
            kept = f"{points} kept in {store.folder}; the same sweep goes on from there"
            if isinstance(error, StudyError):
                raise StudyError(f"{error}; {kept}") from None
            LOGGER.warning("%s", kept)
        raise
    finally:
        store.close()
