"""Executors that compute the chunks of a sweep in this thread, in threads, in processes, or with a Dask scheduler."""

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
# Number of chunks that are submitted at once for each worker. One chunk is being computed, and one waits.
QUEUED = 2
# Number of workers that is assumed if the executor of a caller does not report it.
MANY = 256
# Longest time to wait for an answer of the scheduler [s].
CONNECT = 15.0
# Time between two checks that the scheduler and the parent process still exist [s].
LOOK = 1.0
# Time without a finished chunk after which a warning is logged [s].
SILENCE = 60.0
# At the end of a sweep, the remaining points are divided into this number of chunks per worker. All workers then end at
# about the same time.
LAST_SHARES = 4
# Smallest computing time of the chunks at the end of a sweep, as a fraction of the wanted time of a chunk. Writing a
# chunk takes 10 ms.
LEAST_SHARE = 0.1
# Number of processes that may die while they compute a single point. Then the point is given up.
MOST_DEATHS = 3

Where = Literal["auto", "here", "threads", "processes"]
PointRange = tuple[int, int]


@dataclass
class Workplace:
    """Executor with a function that computes a chunk from the arguments begin, end and seconds.

    Attributes:
        call: function that the executor runs.
        make: creates the executor, also after a failure. It raises StudyError if that is impossible.
        room: returns the number of chunks that the executor can hold at once. It raises StudyError if the executor is
            lost.
        close: shuts the executor down. If the second argument `stopped` is True, it also ends running work.
        killed: errors that mean that the process of a chunk died.
        gone: errors that mean that the executor of a chunk no longer exists.
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
    """Return a workplace that computes one chunk at a time in this thread."""
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
    # This thread starts the processes. The processes inherit its blocked signals, so Ctrl+C cannot interrupt a
    # half-started process.
    starter = ThreadPoolExecutor(1, initializer=_block_interruptions)

    class Processes(loky.ProcessPoolExecutor):  # type: ignore[misc]
        """Pool of processes that are started only by the thread `starter`."""

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
    """Prepare a worker process. The process ignores Ctrl+C, and exits when the parent process ends, even if the parent
    was killed.
    """
    from loky import process_executor

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # This call is needed on platforms that do not block the signal.
    # Without this setting, loky would replace a process whose memory grows by 100 MB. The first use of compiled kernels
    # does that.
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
    """Unpickle the work once in each process. The work caches data that it derives from its scene."""
    work: Work = pickle.loads(sent)
    return work


def _of_caller(work: Work, executor: Executor, workers: int | None) -> Workplace:
    """Return a workplace with an executor that the caller provides.

    The executor stays open at the end, and cannot be replaced if it breaks.
    """
    given = [executor]
    # The executor may use other machines, so the cores of this machine do not matter.
    count = workers or getattr(executor, "_max_workers", None) or MANY

    def make() -> Executor:
        if not given:
            raise StudyError("a worker of the executor died, and the executor takes no more work")
        return given.pop()

    return Workplace(partial(compute_checked, work), make, lambda: QUEUED * count, lambda *_: None)


def dask(work: Work, scheduler: str | Client) -> Workplace:
    """Return a workplace of the workers of a Dask scheduler, on this machine or on many machines.

    Raise StudyError if no scheduler answers at the address, such as "tcp://127.0.0.1:8786". The `room` of the workplace
    raises StudyError if the scheduler is lost later.
    """
    with needed_for("a sweep on Dask", "dask"):
        import cloudpickle
        import distributed
    client: Any = _connected(scheduler) if isinstance(scheduler, str) else scheduler
    address, gone = client.scheduler.address, (CancelledError, OSError, TimeoutError)

    def room() -> int:
        with suppress(*gone):
            if client.status == "running":
                # The number is read again because workers can join and leave.
                return max(1, QUEUED * sum(client.nthreads().values()))
        raise StudyError(f"lost the scheduler at {address}")

    def close(executor: Executor, _: bool) -> None:
        with suppress(Exception, CancelledError):  # The scheduler may no longer exist.
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
        # Dask's messages are suppressed because failures are reported in our own messages.
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        # The address is checked before Client uses it. Client would reject an invalid address only when half
        # constructed, and end late.
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
    """Return the requested workplace, or None for "auto".

    The workplace is created before any work starts, so a wrong address is reported at once.
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
    """Return a workplace of processes on this machine.

    If the work cannot be sent to processes, return a workplace of threads and log the reason.
    """
    try:
        return processes(work, workers or cores())
    except StudyError as error:
        LOGGER.warning("computed in threads of this process: %s", error)
        return threads(work, workers or cores())


class ChunkSchedule:
    """Schedule of the points that remain to be computed.

    If a process dies, all of its chunks become suspects. Suspects are computed one after the other. If a suspect kills
    its process again, it is halved until the deadly point is found.

    Arguments:
        missing: ranges of points to compute.
        take: called with each computed chunk.
        seconds: time limit of a chunk [s]. After this time the chunk is returned incomplete, and its remaining points
            are submitted again.
    """

    def __init__(self, missing: Iterable[PointRange], take: Callable[[Chunk], None], seconds: float) -> None:
        self._todo, self._suspects, self._killed = deque(missing), deque[PointRange](), list[PointRange]()
        self._take, self._seconds = take, seconds
        self._handed: dict[Future[Chunk], PointRange] = {}
        self._deaths, self._broken = Counter[int](), False
        # Time per point in the fastest chunk [s]. The minimum is used because other load on the machine only increases
        # the time.
        self._pace = float("inf")
        self.left = sum(end - begin for begin, end in self._todo)

    @property
    def seconds_left(self) -> float:
        """Estimated time [s] that one process would need for all remaining points."""
        return self.left * self._pace if self.left else 0.0

    def run(self, place: Workplace, budget: float = float("inf")) -> None:
        """Compute all remaining points in `place`, or the points that take about `budget` seconds."""
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
        """Submit chunks until the executor has no room for more, or submit a single suspect."""
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
        """Pass a computed chunk on, and schedule the points that the chunk does not contain."""
        self._take(chunk)
        if chunk.end < end:
            self._todo.appendleft((chunk.end, end))
        self._pace = min(self._pace, chunk.seconds / chunk.count or self._pace)
        self.left -= chunk.count

    def _suspect(self) -> None:
        """Schedule the chunks whose process died.

        A chunk that was computed alone is halved. A single point is tried up to three times.
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
