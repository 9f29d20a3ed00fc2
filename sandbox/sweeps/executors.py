"""Executors that compute the chunks of a sweep: this thread, threads, processes, or workers of a Dask scheduler."""

from __future__ import annotations

import logging
import multiprocessing
import os
import pickle
import signal
import sys
import threading
from collections import Counter, deque
from collections.abc import Callable, Iterable
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal, get_args

from softcradle.physics.ensemble_runs import DaemonThreads, cores
from softcradle.physics.extras import needed_for
from softcradle.sandbox.sweeps.work import Chunk, Work, compute_checked, lost
from softcradle.sandbox.user_error import StudyError

if TYPE_CHECKING:
    from distributed import Client

LOGGER = logging.getLogger("softcradle")
QUEUED = 2  # Chunks per worker that are submitted at once: one is being computed, one waits.
MANY = 256  # Assumed number of workers of a caller's executor that does not report its number.
CONNECT = 15.0  # Time to wait for the scheduler [s].

Where = Literal["auto", "here", "threads", "processes"]


@dataclass
class Workplace:
    """Executor with the function that computes a chunk from (begin, end, seconds).

    Attributes:
        call: function that the executor runs.
        make: creates the executor, also after it broke. It raises StudyError if that is impossible.
        room: returns the number of chunks that the executor can hold at once.
        close: shuts the executor down. Its second argument is True if the sweep was stopped; then running work ends as
            well.
        killed: exceptions of a chunk that killed its workers while the executor survives.
        gone: exceptions of a chunk whose executor no longer exists.
    """

    call: Callable[[int, int, float], Chunk]
    make: Callable[[], Executor]
    room: Callable[[], int]
    close: Callable[[Executor, bool], None] = lambda executor, _: executor.shutdown(wait=False, cancel_futures=True)
    killed: tuple[type[BaseException], ...] = ()
    gone: tuple[type[BaseException], ...] = ()

    def __post_init__(self) -> None:
        self.executor = self.make()

    def renew(self) -> None:
        """Replace the executor after it broke."""
        self.executor.shutdown(wait=False, cancel_futures=True)
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


def processes(work: Work, workers: int) -> Workplace:
    """Return a workplace of `workers` processes on this machine. Raise StudyError if the work cannot be sent to them."""
    why = unsendable(work)
    if why:
        raise StudyError(f"other processes cannot compute this: {why}")
    context = multiprocessing.get_context("spawn")  # A forked copy of a process with threads can deadlock.
    make = partial(_Processes, workers, context, _begin_worker)
    call = partial(_compute_sent, pickle.dumps(work))
    return Workplace(call, make, lambda: QUEUED * workers, _Processes.end)  # type: ignore[arg-type]


class _Processes(ProcessPoolExecutor):
    """Process pool that ignores Ctrl+C.

    A separate thread with blocked signals starts the processes, so an interrupt cannot leave a half-started process.
    """

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._beginner = ThreadPoolExecutor(1, initializer=_leave_interruptions)

    def submit(self, function: Callable[..., Any], /, *args: Any, **keywords: Any) -> Future[Any]:
        return self._beginner.submit(super().submit, function, *args, **keywords).result()

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        self._beginner.shutdown()
        super().shutdown(wait, cancel_futures=cancel_futures)

    def end(self, stopped: bool) -> None:
        """End the processes. If the sweep was `stopped`, terminate them at once, because they may run a kernel or wait
        for one.
        """
        self._beginner.shutdown()
        for process in list((self._processes or {}).values()) if stopped else ():
            process.terminate()  # Executor.terminate_workers does the same from Python 3.14 on.
        super().shutdown(wait=True, cancel_futures=True)


def _leave_interruptions() -> None:
    """Block SIGINT in this thread. The processes that it starts inherit the blocked signal."""
    if sys.platform != "win32":
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})


def _begin_worker() -> None:
    """Initialise a worker process: ignore Ctrl+C, and exit when the parent process ends, even if it was killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # for platforms that do not block the signal

    def end_with_parent() -> None:
        multiprocessing.parent_process().join()  # type: ignore[union-attr]
        os._exit(0)

    threading.Thread(target=end_with_parent, daemon=True).start()


def _compute_sent(sent: bytes, begin: int, end: int, seconds: float) -> Chunk:
    return compute_checked(_received(sent), begin, end, seconds)


@lru_cache(maxsize=4)
def _received(sent: bytes) -> Work:
    """Unpickle the work once per process, because it caches what it derives from its scene."""
    work: Work = pickle.loads(sent)
    return work


def unsendable(work: Work) -> str:
    """Return the reason why other processes on this machine cannot compute the work, or an empty string if they can."""
    main = sys.modules.get("__main__")
    script, name = getattr(main, "__file__", None), getattr(getattr(main, "__spec__", None), "name", "")
    # Started by `python -m`: multiprocessing does not import this module in its processes.
    of_package = name.endswith(".__main__")
    function = work.source
    while isinstance(function, partial):
        function = function.func
    if getattr(function, "__module__", "") == "__main__" and script is None:
        return "the function is of a prompt or a notebook, put it into a module"
    try:
        sent = pickle.dumps(work)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        return f"put the function into a module ({error})"
    if of_package:
        return "what is of `__main__` cannot be imported there, put it into a module" if b"__main__" in sent else ""
    # A script that checks its name does not start the sweep again in a worker.
    with suppress(OSError, UnicodeDecodeError):
        if script is not None and "__name__" not in Path(script).read_text(encoding="utf-8"):
            below = "put what begins the sweep below `if __name__ == '__main__':`"
            return f"each would run all of {Path(script).name}, {below}"
    return ""


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
        told = str(error).partition("\n")[0]
        raise StudyError(f"no Dask scheduler at {address!r}: {told}") from None


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
    """Return processes on this machine, or threads with a logged reason if processes cannot compute the work."""
    why = unsendable(work)
    if not why:
        return processes(work, workers or cores())
    LOGGER.warning("computed in threads of this process, one at a time where that is Python: %s", why)
    return threads(work, workers or cores())


LOOK = 1.0  # Time between two checks of the scheduler and its number of workers [s].
SILENCE = 60.0  # Time without a finished chunk after which a warning is logged [s].
# Smallest number of chunks per worker into which the remaining points are cut, so that all workers end at about the
# same time.
LAST_SHARES = 4
MOST_DEATHS = 3  # Number of processes that may die while computing a single point, until the point is given up.

PointRange = tuple[int, int]


class ChunkSchedule:
    """Chunks that remain to be computed.

    Arguments:
        missing: ranges of points to compute.
        take: called with each computed chunk.
        seconds: time limit of a chunk [s]. After it, the chunk comes back incomplete and its remaining points are
            submitted again.
    """

    def __init__(self, missing: Iterable[PointRange], take: Callable[[Chunk], None], seconds: float) -> None:
        self._todo, self._suspects, self._broken = deque(missing), deque[PointRange](), list[PointRange]()
        self._take, self._seconds = take, seconds
        self._handed: dict[Future[Chunk], PointRange] = {}
        self._deaths = Counter[int]()  # deaths of processes by the only point that they were computing
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
        while self._handed or ((self._todo or self._suspects) and perf_counter() < until):
            self._hand_out(place, until)
            done, _ = wait(self._handed, LOOK, FIRST_COMPLETED)
            if not done and perf_counter() - heard > SILENCE:
                told = "kernels are compiled, points take long, or there is no worker"
                LOGGER.warning("no chunk came back for %g s: %s", SILENCE, told)
            if done or perf_counter() - heard > SILENCE:
                heard = perf_counter()
            for future in done:
                self._came_back(place, future)
            if self._broken and not self._handed:
                self._begin_anew(place)

    def _hand_out(self, place: Workplace, until: float) -> None:
        """Submit as many chunks as there is room for.

        Suspect chunks (see `_blame`) are submitted one at a time. No chunk is submitted while a broken executor still
        returns chunks.
        """
        room = place.room()
        share = self.left // (LAST_SHARES * room if room > 1 else 2)
        while self._todo and not (self._suspects or self._broken) and len(self._handed) < room:
            begin, end = self._todo.popleft()
            last = min(begin + max(1, share), end)
            if last < end:
                self._todo.appendleft((last, end))
            if not self._submit(place, begin, last, until):
                return
        if self._suspects and not self._handed:
            self._submit(place, *self._suspects.popleft(), until)

    def _submit(self, place: Workplace, begin: int, end: int, until: float) -> bool:
        """Submit a chunk. Return True if the executor accepted it."""
        try:
            future = place.executor.submit(place.call, begin, end, min(self._seconds, until - perf_counter()))
        except BrokenExecutor:  # A process died, either idle or in a chunk that has not come back yet.
            self._todo.appendleft((begin, end))
            if not self._handed:
                place.renew()
            return False
        self._handed[future] = begin, end
        return True

    def _came_back(self, place: Workplace, future: Future[Chunk]) -> None:
        begin, end = self._handed.pop(future)
        try:
            self._keep(future.result(), end)
        except place.killed:
            self._blame(begin, end)
        except BrokenExecutor:
            self._broken.append((begin, end))
        except place.gone:
            self._todo.appendleft((begin, end))

    def _begin_anew(self, place: Workplace) -> None:
        """Replace a broken executor. Each of its chunks is computed again separately. A chunk that was already separate
        caused the failure.
        """
        place.renew()
        count = sum(end - begin for begin, end in self._broken)
        LOGGER.warning("a worker died: %d points that were handed out are computed again, each chunk alone", count)
        if len(self._broken) == 1:
            self._blame(*self._broken[0])
        else:
            self._suspects.extend(self._broken)
        self._broken.clear()

    def _keep(self, chunk: Chunk, end: int) -> None:
        """Pass on a computed chunk, and schedule the points that it did not reach."""
        self._take(chunk)
        if chunk.end < end:
            self._todo.appendleft((chunk.end, end))
        self._pace = min(self._pace, chunk.seconds / chunk.count)
        self.left -= chunk.count

    def _blame(self, begin: int, end: int) -> None:
        """Handle points whose process died while it had no other points. Try the halves separately, and a single point
        up to three times.
        """
        if end - begin > 1:
            middle = (begin + end) // 2
            self._suspects.extendleft([(middle, end), (begin, middle)])
            return
        self._deaths[begin] += 1
        if self._deaths[begin] < MOST_DEATHS:
            self._suspects.appendleft((begin, end))
        else:
            LOGGER.warning("point %d is lost: the process that computed it died, %d times", begin, MOST_DEATHS)
            self._keep(lost(begin, MOST_DEATHS), end)
