"""Executors that compute the chunks of a sweep: this thread, threads, processes, or workers of a Dask scheduler."""

from __future__ import annotations

import logging
import os
import pickle
import signal
import sys
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache, partial
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal, get_args

from softcradle.physics.ensemble_runs import DaemonThreads, cores
from softcradle.physics.extras import needed_for
from softcradle.sandbox.sweeps.work import Chunk, Work, compute_checked, lost
from softcradle.sandbox.user_error import StudyError

if TYPE_CHECKING:
    from distributed import Client

LOGGER = logging.getLogger("softcradle")
# Chunks per worker that are submitted at once: one is being computed, one waits.
QUEUED = 2
# Assumed number of workers of a caller's executor that does not report its number.
MANY = 256
# Time to wait for the scheduler [s].
CONNECT = 15.0
# Time between two checks of the scheduler and of the parent process [s].
LOOK = 1.0
# Time without a finished chunk after which a warning is logged [s].
SILENCE = 60.0
# Chunks per worker into which the remaining points are cut, so that all workers end at about the same time.
LAST_SHARES = 4
# Smallest computing time of these chunks, as a fraction of the wanted time of a chunk. Writing a chunk takes 10 ms.
LEAST_SHARE = 0.1
# Number of processes that may die while they compute a single point, until the point is given up.
MOST_DEATHS = 3

Where = Literal["auto", "here", "threads", "processes"]
PointRange = tuple[int, int]


@dataclass
class Workplace:
    """Executor with the function that computes a chunk from (begin, end, seconds).

    Attributes:
        call: function that the executor runs.
        make: creates the executor, also after it broke. It raises StudyError if that is impossible.
        room: returns the number of chunks that the executor can hold at once. It raises StudyError if the executor is
            lost.
        close: shuts the executor down and ends running work if the second argument, `stopped`, is True.
        killed: errors of a chunk whose process died.
        gone: errors of a chunk whose executor no longer exists.
    """

    call: Callable[[int, int, float], Chunk]
    make: Callable[[], Executor]
    room: Callable[[], int]
    close: Callable[[Executor, bool], None] = lambda executor, _: executor.shutdown(wait=False, cancel_futures=True)
    killed: tuple[type[BaseException], ...] = (BrokenExecutor,)
    gone: tuple[type[BaseException], ...] = ()

    def __post_init__(self) -> None:
        self.executor = self.make()


class _Caller(Executor):
    """Executor that runs each call immediately in the calling thread."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **keywords: Any) -> Future[Any]:
        found: Future[Any] = Future()
        found.set_result(function(*args, **keywords))
        return found


def here(work: Work) -> Workplace:
    """Return a workplace in this process and thread, which computes one chunk at a time."""
    return Workplace(work.compute, _Caller, lambda: 1)


def threads(work: Work, workers: int) -> Workplace:
    """Return a workplace of `workers` threads in this process."""
    return Workplace(work.compute, partial(DaemonThreads, workers), lambda: QUEUED * workers)


def processes(work: Work, workers: int) -> Workplace:
    """Return a workplace of `workers` processes on this machine. Raise StudyError if the work cannot be pickled."""
    import cloudpickle
    import loky

    try:
        sent = cloudpickle.dumps(work)
    except (pickle.PicklingError, AttributeError, TypeError, ValueError) as error:
        raise StudyError(f"other processes cannot compute this: {error}") from None
    # This thread starts the processes. They inherit its blocked signals, so Ctrl+C cannot interrupt a half-started one.
    starter = ThreadPoolExecutor(1, initializer=_block_interruptions)

    class Processes(loky.ProcessPoolExecutor):  # type: ignore[misc]
        """Processes that only the thread `starter` starts."""

        def submit(self, function: Callable[..., Any], /, *args: Any, **keywords: Any) -> Future[Any]:
            return starter.submit(super().submit, function, *args, **keywords).result()

    def close(executor: Any, stopped: bool) -> None:
        starter.shutdown()
        executor.shutdown(wait=True, kill_workers=stopped)

    make = partial(Processes, workers, initializer=_begin_worker, initargs=(os.getpid(),))
    return Workplace(partial(_compute_sent, sent), make, lambda: QUEUED * workers, close)


def _block_interruptions() -> None:
    """Block SIGINT in this thread."""
    if sys.platform != "win32":
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})


def _begin_worker(parent: int) -> None:
    """Initialise a worker process: ignore Ctrl+C, and exit when the parent process ends, even if it was killed."""
    from loky import process_executor

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # for platforms that do not block the signal
    # loky would replace a process whose memory grows by 100 MB, which the first use of compiled kernels does.
    process_executor._MEMORY_LEAK_CHECK_DELAY = float("inf")

    def end_with_parent() -> None:
        while os.getppid() == parent:
            time.sleep(LOOK)
        os._exit(0)

    threading.Thread(target=end_with_parent, daemon=True).start()


def _compute_sent(sent: bytes, begin: int, end: int, seconds: float) -> Chunk:
    return compute_checked(_received(sent), begin, end, seconds)


@lru_cache(maxsize=4)
def _received(sent: bytes) -> Work:
    """Unpickle the work once per process, because it caches what it derives from its scene."""
    work: Work = pickle.loads(sent)
    return work


def _of_caller(work: Work, executor: Executor, workers: int | None) -> Workplace:
    """Return a workplace with an executor of the caller. It stays open at the end and cannot be replaced if it breaks."""
    given = [executor]
    # The executor may use other machines, so the cores of this machine do not matter.
    count = workers or getattr(executor, "_max_workers", None) or MANY

    def make() -> Executor:
        if not given:
            raise StudyError("a worker of the executor died, and the executor takes no more work")
        return given.pop()

    return Workplace(partial(compute_checked, work), make, lambda: QUEUED * count, lambda *_: None)


def dask(work: Work, scheduler: str | Client) -> Workplace:
    """Return a workplace of the workers of a Dask scheduler, on this machine or on many.

    Raise StudyError if no scheduler answers at the address, such as "tcp://127.0.0.1:8786". Its `room` raises
    StudyError if the scheduler is lost later.
    """
    with needed_for("a sweep on Dask", "dask"):
        import cloudpickle
        import distributed
    client: Any = _connected(scheduler) if isinstance(scheduler, str) else scheduler
    address, gone = client.scheduler.address, (CancelledError, OSError, TimeoutError)

    def room() -> int:
        with suppress(*gone):
            if client.status == "running":
                return max(1, QUEUED * sum(client.nthreads().values()))  # The number of workers may change.
        raise StudyError(f"lost the scheduler at {address}")

    def close(executor: Executor, _: bool) -> None:
        with suppress(Exception, CancelledError):  # The scheduler may be gone.
            if client.status == "running":
                executor.shutdown(wait=False)
            if client is not scheduler:
                client.close(timeout=1.0)

    call, make = partial(_compute_sent, cloudpickle.dumps(work)), partial(client.get_executor, pure=False)
    return Workplace(call, make, room, close, (distributed.KilledWorker,), gone)


def _connected(address: str) -> Any:
    import distributed
    from distributed.comm.addressing import resolve_address

    for name in ("distributed", "distributed.client", "tornado.application", "asyncio"):
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)  # Failures are reported in our own messages.
    try:
        # Checked here, because Client would reject an invalid address only when half constructed, and end late.
        resolve_address(address)
        return distributed.Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, TimeoutError):
        raise StudyError(f"no Dask scheduler answers at {address!r}") from None
    except (TypeError, ValueError, ImportError, RuntimeError) as error:
        first_line = str(error).partition("\n")[0]
        raise StudyError(f"no Dask scheduler at {address!r}: {first_line}") from None


def place_of(
    work: Work, executor: Executor | Where, scheduler: str | Client | None, workers: int | None
) -> Workplace | None:
    """Return the requested workplace, or None for "auto". It is made before any work, so that a wrong address is
    reported at once.
    """
    if scheduler is not None and executor != "auto":
        raise StudyError("a sweep takes an executor or a scheduler, not both")
    if isinstance(executor, str) and executor not in get_args(Where):
        raise StudyError(f"executor must be auto, here, threads, processes or an Executor, not {executor!r}")
    if workers is not None and workers < 1:
        raise StudyError(f"workers must be at least 1, not {workers}")
    count = workers or cores()
    if scheduler is not None:
        return dask(work, scheduler)
    if not isinstance(executor, str):
        return _of_caller(work, executor, workers)
    if executor == "processes":
        return processes(work, count)
    if executor == "threads":
        return threads(work, count)
    return here(work) if executor == "here" or count == 1 else None


def processes_or_threads(work: Work, workers: int | None) -> Workplace:
    """Return processes on this machine, or threads with a logged reason if the work cannot be sent to processes."""
    try:
        return processes(work, workers or cores())
    except StudyError as error:
        LOGGER.warning("computed in threads of this process: %s", error)
        return threads(work, workers or cores())


class ChunkSchedule:
    """Points that remain to be computed.

    If a process dies, each of its chunks becomes a suspect. Suspects run one after the other, and a deadly one is halved
    until its deadly point is found.

    Arguments:
        missing: ranges of points to compute.
        take: called with each computed chunk.
        seconds: time limit of a chunk [s]. After it, the chunk comes back incomplete and its remaining points are
            submitted again.
    """

    def __init__(self, missing: Iterable[PointRange], take: Callable[[Chunk], None], seconds: float) -> None:
        self._todo, self._suspects, self._killed = deque(missing), deque[PointRange](), list[PointRange]()
        self._take, self._seconds = take, seconds
        self._handed: dict[Future[Chunk], PointRange] = {}
        self._deaths, self._broken = Counter[int](), False
        # Time per point of the fastest chunk [s]. Other load on the machine can only increase the time.
        self._pace = float("inf")
        self.left = sum(end - begin for begin, end in self._todo)

    @property
    def seconds_left(self) -> float:
        """Estimated time [s] that one process would need for all remaining points."""
        return self.left * self._pace if self.left else 0.0

    def run(self, place: Workplace, budget: float = float("inf")) -> None:
        """Compute all remaining points in `place`, or as many as fit into about `budget` seconds."""
        until, heard = perf_counter() + budget, perf_counter()
        while self._handed or self._killed or ((self._todo or self._suspects) and perf_counter() < until):
            if not self._handed:
                self._suspect()
                if self._broken:
                    place.executor.shutdown(wait=False)
                    place.executor, self._broken = place.make(), False
            self._hand_out(place, until)
            done, _ = wait(self._handed, LOOK, FIRST_COMPLETED)
            if not done and perf_counter() - heard > SILENCE:
                cause = "kernels are compiled, points take long, or there is no worker"
                LOGGER.warning("no chunk came back for %g s: %s", SILENCE, cause)
            if done or perf_counter() - heard > SILENCE:
                heard = perf_counter()
            for future in done:
                begin, end = self._handed.pop(future)
                try:
                    self._keep(future.result(), end)
                except place.killed as error:
                    self._broken |= isinstance(error, BrokenExecutor)
                    self._killed.append((begin, end))
                except place.gone:
                    self._todo.appendleft((begin, end))

    def _hand_out(self, place: Workplace, until: float) -> None:
        """Submit as many chunks as there is room for, or one suspect."""
        room, waiting, share = place.room(), self._todo, self.left
        if self._suspects:
            room, waiting = 1, self._suspects
        elif room > 1:
            share = max(1, share // (LAST_SHARES * room), int(LEAST_SHARE * self._seconds / self._pace))
        while waiting and not (self._killed or self._broken) and len(self._handed) < room:
            begin, end = waiting.popleft()
            last = min(begin + share, end)
            try:
                future = place.executor.submit(place.call, begin, last, min(self._seconds, until - perf_counter()))
                self._handed[future] = begin, last
            except BrokenExecutor:  # A process died, either idle or in a chunk that has not come back yet.
                last, self._broken = begin, True
            if last < end:
                waiting.appendleft((last, end))

    def _keep(self, chunk: Chunk, end: int) -> None:
        """Pass on a computed chunk, and schedule the points that it did not reach."""
        self._take(chunk)
        if chunk.end < end:
            self._todo.appendleft((chunk.end, end))
        self._pace = min(self._pace, chunk.seconds / chunk.count or self._pace)
        self.left -= chunk.count

    def _suspect(self) -> None:
        """Schedule the chunks whose process died. A chunk that was computed alone is halved, and a single point is tried
        up to three times.
        """
        alone = len(self._killed) == 1
        if len(self._killed) > 1:
            count = sum(end - begin for begin, end in self._killed)
            LOGGER.warning("a worker died: %d points that were handed out are computed again, each chunk alone", count)
        for begin, end in self._killed:
            if not alone:
                self._suspects.append((begin, end))
            elif end - begin > 1:
                middle = (begin + end) // 2
                self._suspects.extendleft([(middle, end), (begin, middle)])
            else:
                self._deaths[begin] += 1
                if self._deaths[begin] < MOST_DEATHS:
                    self._suspects.appendleft((begin, end))
                else:
                    LOGGER.warning("point %d is lost: the process that computed it died, %d times", begin, MOST_DEATHS)
                    self._keep(lost(begin, MOST_DEATHS), end)
        self._killed.clear()
