"""`sweep`: a scene or a function over many points, on this machine or many; what is on disk is not computed again."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from softcradle.physics.extras import needed_for
from softcradle.sandbox.sweeps.dataset_files import KINDS, MemorySink, file_sink, fill, open_dataset
from softcradle.sandbox.sweeps.dataset_layout import layout_of
from softcradle.sandbox.sweeps.journal import Journal
from softcradle.sandbox.sweeps.measure_table import Measure
from softcradle.sandbox.sweeps.sample_points import Axis, Points, grid
from softcradle.sandbox.sweeps.study_error import StudyError
from softcradle.sandbox.sweeps.study_text import lanes_of, study_text, sweep_work
from softcradle.sandbox.sweeps.sweep_places import Places, Progress, Where, compute_missing, telling

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client
    from softcradle.scenes import Scene

LOGGER = logging.getLogger("softcradle")


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
    fresh: bool = False,
    progress: Progress | None = None,
    chunk_seconds: float = 1.0,
) -> xr.Dataset:
    """Compute a scene or a function at many points, and return its measures as an xarray Dataset. Extra [sweep].

    A point that cannot be, or whose run gives up, is marked in `status` with its `reason`. The Dataset does not depend on where
    its points were computed, in which chunks, or how often the sweep was stopped.

    Parameters
    ----------
    what : Scene, str or callable
        A Scene, its name or the path of its file; or a function of the parameters by name, which returns numbers
        by name, or a motion to be measured: a Trajectory, (chain, velocity) or (chain, velocity, keywords of
        `simulate`).
    over : Points, mapping or sequence of Axis
        The points: ``{path: values}`` is a grid; else `grid`, `listed`, `sobol` or `latin_hypercube` of
        `softcradle.sandbox.sweeps`. The path of a scene's number is as in its file, ``lanes.0.contact.alpha``; ``*``
        is every item of a list.
    measures : sequence of str or Measure, optional
        Names of the table of measures, or a Measure of one's own; of a function that returns numbers, none.
    output : path, optional
        A .zarr folder or a .nc file; beside it a journal keeps what is computed until all is. A sweep that was
        stopped goes on from there, and one that is complete is only opened. None: in memory.
    executor : str or Executor, optional
        "threads" or "processes" of this machine, "here", or any `concurrent.futures` executor; "auto" takes
        processes where the work is worth them.
    scheduler : str or Client, optional
        A Dask scheduler instead: its address, such as `tcp://127.0.0.1:8786`, or a Client. Extra [dask].
    workers : int, optional
        How many threads or processes; None: one for each core.
    units : mapping, optional
        Units of the numbers that a function returns, by name.
    title : str, optional
        Title of the Dataset.
    fresh : bool, optional
        Whether to begin anew, whatever is at `output`.
    progress : callable, optional
        Called with ("points" or "writing", done, all).
    chunk_seconds : float, optional
        Wanted work of one chunk [s].

    Returns
    -------
    xarray.Dataset
        A variable for each measure, with unit, meaning and versions as attributes.

    Raises
    ------
    ValueError
        Something that is asked for cannot be; one sentence.
    """
    with needed_for("sweep", "sweep"):
        import xarray  # noqa: F401  # before the work, not after it
    points = over if isinstance(over, Points) else grid(over)
    work = sweep_work(what, points, measures)
    path, study = _checked_output(output), study_text(work, title)
    if path is not None and path.exists() and not fresh:
        return _complete(path, study)
    with open_journal(path, study, fresh) as journal:
        pools = Places(work, executor, scheduler, workers)
        compute_missing(work, journal, pools, progress, chunk_seconds)
        attributes = {"title": title or lanes_of(work)[1], **work.versions, "study": study, "digest": _digest(study)}
        own = [measure for measure in work.measures if isinstance(measure, Measure)]
        layout = layout_of(journal, points, lanes_of(work)[0], own, units or {}, attributes)
        told = telling(progress, "writing", points.count, 0)
        if path is None:
            found: xr.Dataset = fill(MemorySink(), layout, journal, told)
            return found
        if fresh:
            _remove(path)
        try:
            with file_sink(path) as sink:
                fill(sink, layout, journal, told)
        except OSError as error:
            raise StudyError(
                f"cannot write {path}: {error.strerror or error}; the points are kept in {journal.path}"
            ) from None
        journal.remove()
    return open_dataset(path)


def _digest(study: str) -> str:
    return hashlib.sha256(study.encode()).hexdigest()[:16]


def _checked_output(output: str | Path | None) -> Path | None:
    """The path of the output. Raises StudyError where nothing can be written there."""
    if output is None:
        return None
    path = Path(output)
    if path.suffix not in KINDS:
        raise StudyError(f"the output of a sweep must end in {' or '.join(KINDS)}, not {str(output)!r}")
    if not path.absolute().parent.is_dir():
        raise StudyError(f"cannot write {path}: there is no folder {path.absolute().parent}")
    with needed_for(f"a sweep that is kept as {path.suffix}", "sweep"):
        if path.suffix == ".zarr":
            import zarr  # noqa: F401
        else:
            import h5netcdf  # noqa: F401
    return path


def _complete(path: Path, study: str) -> xr.Dataset:
    """The Dataset that is there already. Raises StudyError where it is another."""
    try:
        found = open_dataset(path)
        same = found.attrs.get("study") == study
    except (OSError, ValueError, KeyError) as error:
        raise StudyError(
            f"{path} is there and cannot be read ({type(error).__name__}): give another output, or begin afresh"
        ) from None
    if not same:
        found.close()
        raise StudyError(f"{path} holds another study, or one by another version: give another output, or begin afresh")
    LOGGER.info("%s is complete: nothing to compute", path)
    return found


def _remove(path: Path) -> None:
    import shutil

    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def journal_path(path: Path) -> Path:
    """Where the points of a sweep are kept until all are computed."""
    return path.with_name(f"{path.name}.partial")


@contextmanager
def open_journal(path: Path | None, study: str, fresh: bool) -> Iterator[Journal]:
    """The journal; where the sweep ends early, how much is kept is said."""
    journal = Journal(None if path is None else journal_path(path), study, fresh)
    try:
        yield journal
    except BaseException as error:
        if not journal.done:
            journal.remove()
        if journal.path is not None and journal.done:
            kept = f"{journal.done} points are kept in {journal.path}; the same sweep goes on from there"
            if isinstance(error, StudyError):
                raise StudyError(f"{error}; {kept}") from None
            LOGGER.warning("%s", kept)
        raise
    finally:
        journal.close()
