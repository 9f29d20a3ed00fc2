"""A function at many points for a study: its numbers point by point or as plain columns, without xarray."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.source_digest import digest_of
from softcradle.sandbox.sweeps.chunk_work import Chunk, Outcome, PointStatus
from softcradle.sandbox.sweeps.journal import Journal
from softcradle.sandbox.sweeps.run_sweep import journal_path, open_journal
from softcradle.sandbox.sweeps.sample_points import Points
from softcradle.sandbox.sweeps.study_error import StudyError
from softcradle.sandbox.sweeps.study_text import study_text, sweep_work
from softcradle.sandbox.sweeps.sweep_places import Places, Progress, Where, compute_missing

SANDBOX = Path(
    __file__
).parent.parent  # all studies are in it: where a file of it changes, kept points are of another study


@contextmanager
def swept(
    function: Callable[..., Mapping[str, Any] | Outcome],
    points: Points,
    kept: Path | None = None,
    progress: Progress | None = None,
    workers: int | None = None,
    *,
    executor: Where = "auto",
    alike: bool = True,
    each: Callable[[Chunk], None] | None = None,
    chunk_seconds: float = 1.0,
) -> Iterator[Journal]:
    """Compute `function` at all points, in processes where that pays; the journal that has them all.

    Arguments:
        function: gives numbers by name, or an Outcome of them with a reason.
        kept: the points are in the file of this name and ``.partial`` as they are done, and a sweep that was stopped goes on
            from there; it stays until the caller removes it. Points of another study in it are dropped.
        alike: whether points cost alike, so that the first ones tell what all will take; else the longest come first.
        each: is called with every chunk as it comes back.

    Raises:
        StudyError: the function raised an error at a point, or the processes that computed it died.
    """
    work = sweep_work(function, points, ())
    study = study_text(work, digest_of(SANDBOX.rglob("*.py")))
    with open_journal(kept, study, kept is not None and _is_of_another(journal_path(kept), study)) as journal:

        def keep(chunk: Chunk) -> None:
            _refuse_broken(chunk, points)
            journal.append(chunk)
            if each is not None:
                each(chunk)

        compute_missing(work, journal, Places(work, executor, None, workers), progress, chunk_seconds, alike, keep)
        yield journal


def swept_columns(
    function: Callable[..., Mapping[str, Any]],
    points: Points,
    kept: Path | None = None,
    progress: Progress | None = None,
    workers: int | None = None,
    chunk_seconds: float = 1.0,
) -> dict[str, NDArray[Any]]:
    """(N, ...) columns of the numbers that `function` gives at all points, by name; arguments as for `swept`."""
    with swept(function, points, kept, progress, workers, chunk_seconds=chunk_seconds) as journal:
        found = journal.rows(0, points.count).columns
    return {name: column for name, column in found.items() if name not in ("status", "warned")}


def _refuse_broken(chunk: Chunk, points: Points) -> None:
    broken = np.flatnonzero(chunk.columns["status"] >= PointStatus.REFUSED)
    if broken.size:
        number = chunk.begin + int(broken[0])
        values = {name: column[0] for name, column in points.columns(number, number + 1).items()}
        raise StudyError(f"{', '.join(f'{name} {value}' for name, value in values.items())}: {chunk.reasons[number]}")


def _is_of_another(path: Path, study: str) -> bool:
    """Whether a journal is there and was begun for another study."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.readline() != study.encode() + b"\n"
