"""Where the chunks of a sweep are computed, chosen by what is asked for and what they cost; and their way there."""

from __future__ import annotations

import logging
from collections.abc import Callable
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Literal

from softcradle.physics.ensemble_runs import cores
from softcradle.sandbox.sweeps.chunk_pools import Pool, executor_pool, process_pool, sendable, thread_pool
from softcradle.sandbox.sweeps.chunk_schedule import ChunkSchedule
from softcradle.sandbox.sweeps.chunk_work import Chunk, Work
from softcradle.sandbox.sweeps.journal import Journal
from softcradle.sandbox.sweeps.study_error import StudyError

if TYPE_CHECKING:
    from distributed import Client

LOGGER = logging.getLogger("softcradle")
TRIED_HERE = 0.3  # s that points are computed in this process first: kernels are then compiled, and the cost is known
WORTH_PROCESSES = 3.0  # s of work below which other processes begin too late to be of use
Where = Literal["auto", "here", "threads", "processes"]
Progress = Callable[[str, int, int], None]


def telling(progress: Progress | None, what: str, count: int, begin: int) -> Callable[[int], None]:
    """A function that counts points on, for the caller's."""
    done = [begin]

    def tell(more: int) -> None:
        done[0] += more
        if progress is not None:
            progress(what, done[0], count)

    tell(0)
    return tell


class Places:
    """Where the chunks of a sweep are computed, once it is known what they cost."""

    def __init__(
        self, work: Work, executor: Executor | Where, scheduler: str | Client | None, workers: int | None
    ) -> None:
        if scheduler is not None and not (isinstance(executor, str) and executor == "auto"):
            raise StudyError("a sweep takes an executor or a scheduler, not both")
        if isinstance(executor, str) and executor not in ("auto", "here", "threads", "processes"):
            raise StudyError(f"executor must be auto, here, threads, processes or an Executor, not {executor!r}")
        if workers is not None and workers < 1:
            raise StudyError(f"workers must be at least 1, not {workers}")
        if executor == "processes":
            sendable(work)
        self._work, self._executor, self._scheduler, self._workers = work, executor, scheduler, workers
        self.remote = scheduler is not None or not isinstance(executor, str)
        # before any work, so that a wrong address is told at once
        self._dask = self._dask_pool() if scheduler is not None else None

    def _dask_pool(self) -> Pool:
        from softcradle.sandbox.sweeps.dask_pool import DaskPool

        assert self._scheduler is not None
        return DaskPool(self._work, self._scheduler)

    def pool(self, seconds_left: float) -> Pool | None:
        """The pool for so much work; None: this process alone."""
        if self._dask is not None or not isinstance(self._executor, str):
            return self._dask or executor_pool(self._work, self._executor, self._workers)  # type: ignore[arg-type]
        if self._executor == "threads":
            return thread_pool(self._work, self._workers)
        if self._executor == "processes":
            return process_pool(self._work, self._workers)
        many = (self._workers or cores()) > 1
        if self._executor == "here" or seconds_left < WORTH_PROCESSES or not many:
            return None
        try:
            return process_pool(self._work, self._workers)
        except StudyError:  # a function of a notebook: other processes cannot read it
            return thread_pool(self._work, self._workers)


def compute_missing(
    work: Work,
    journal: Journal,
    places: Places,
    progress: Progress | None,
    chunk_seconds: float,
    alike: bool = True,
    keep: Callable[[Chunk], None] | None = None,
) -> None:
    """Compute all points that the journal does not have.

    Arguments:
        alike: whether the first points tell what all cost; else none is tried in this process first.
        keep: what takes the chunks, in place of the journal.
    """
    missing, kept = list(journal.missing(work.points.count)), journal.done
    if kept and journal.path is not None:
        LOGGER.warning("%d of %d points are in %s and not computed again", kept, work.points.count, journal.path)
    told = telling(progress, "points", work.points.count, kept)
    schedule = ChunkSchedule(missing, keep or journal.append, told, chunk_seconds)
    if alike and not places.remote:
        schedule.run_here(work, TRIED_HERE)
    if not schedule.left:
        return
    pool = places.pool(schedule.seconds_left)
    if pool is None:
        schedule.run_here(work, float("inf"))
        return
    try:
        schedule.run(pool)
    finally:
        pool.close()
