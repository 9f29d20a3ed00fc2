"""Where the chunks of a sweep are computed: executors of `concurrent.futures`, in this process, in others, on Dask."""

from __future__ import annotations

import asyncio
import logging
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import suppress
from functools import lru_cache, partial
from multiprocessing.process import BaseProcess
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal

from softcradle.physics.ensemble_runs import DaemonThreads, cores
from softcradle.physics.extras import needed_for
from softcradle.sandbox.sweeps.chunk_work import Chunk, Work, compute_checked, lost
from softcradle.sandbox.user_error import StudyError

if TYPE_CHECKING:
    from distributed import Client

LOGGER = logging.getLogger("softcradle")
QUEUED = 2  # chunks for each worker that are handed out: one that is computed, one that waits
CONNECT = 15.0  # s, for which a scheduler is waited for at the start
PATIENCE = 60.0  # s, for which a scheduler may be away later
COUNT_WORKERS = 1.0  # s between two looks how many workers a scheduler has

Where = Literal["auto", "here", "threads", "processes"]
ALL_OF_WHERE = ("auto", "here", "threads", "processes")


class Pool:
    """An executor, and what it calls with (begin, end, seconds) for a chunk.

    Attributes:
        call: what is handed to the executor.
        executor: takes it.
        killed: errors of a chunk that killed every worker that computed it, where the executor lives on.
        gone: errors of a chunk that is no longer there, through no doing of its own.
    """

    killed: tuple[type[BaseException], ...] = ()
    gone: tuple[type[BaseException], ...] = ()

    def __init__(self, call: Callable[[int, int, float], Chunk], executor: Executor, workers: int) -> None:
        self.call, self.executor, self._workers = call, executor, workers

    def room(self) -> int:
        """How many chunks it takes."""
        return QUEUED * self._workers

    def lost(self) -> bool:
        """Whether it has gone away with all that was handed out, which is no chunk's doing."""
        return False

    def renew(self) -> None:
        """Begin anew after it broke."""
        raise StudyError("a worker of the executor died, and the executor takes no more work")

    def close(self, stopped: bool) -> None:
        """Let go of the executor; where the sweep was `stopped`, of what is being computed too."""
        self.executor.shutdown(wait=False, cancel_futures=True)


# ---- this process


class _Caller(Executor):
    """Computes in the thread that hands out."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **keywords: Any) -> Future[Any]:
        found: Future[Any] = Future()
        found.set_result(function(*args, **keywords))
        return found


class Here(Pool):
    """This process and thread, one chunk at a time."""

    def __init__(self, work: Work) -> None:
        super().__init__(work.compute, _Caller(), 1)

    def room(self) -> int:
        """One: a chunk is computed as it is handed out."""
        return 1


def threads(work: Work, workers: int | None) -> Pool:
    """Threads of this process."""
    count = workers or cores()
    return Pool(work.compute, DaemonThreads(count), count)


class Callers(Pool):
    """An executor of the caller's, which stays open."""

    def __init__(self, work: Work, executor: Executor, workers: int | None) -> None:
        super().__init__(partial(compute_checked, work), executor, workers or cores())

    def close(self, stopped: bool) -> None:
        """Leave it open."""


# ---- processes of this machine


class Processes(Pool):
    """Processes of this machine. Raises StudyError where the work cannot be sent to them."""

    def __init__(self, work: Work, workers: int | None) -> None:
        why = unsendable(work)
        if why:
            raise StudyError(f"other processes cannot compute this: {why}")
        self._context = multiprocessing.get_context("spawn")  # a fork of a process with threads may stand still
        count = workers or cores()
        super().__init__(partial(_compute_sent, pickle.dumps(work)), self._made(count), count)

    def _made(self, count: int) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(count, self._context, _begin_worker)

    def renew(self) -> None:
        """New processes in place of those that died."""
        self.executor.shutdown(wait=False, cancel_futures=True)
        self.executor = self._made(self._workers)

    def close(self, stopped: bool) -> None:
        """End the processes; at once where the sweep was stopped: they may be in a kernel, or wait for one."""
        if stopped:
            for process in list((self.executor._processes or {}).values()):  # type: ignore[attr-defined]
                process.terminate()  # what Executor.terminate_workers does from Python 3.14 on
        self.executor.shutdown(wait=True, cancel_futures=True)


def _begin_worker() -> None:
    """Begin a process: leave Ctrl+C to the parent, and end when the parent has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: BaseProcess) -> None:
    """End this process when its parent has ended, which a kill may have done without a word."""
    parent.join()
    os._exit(0)


def _compute_sent(sent: bytes, begin: int, end: int, seconds: float) -> Chunk:
    return compute_checked(_received(sent), begin, end, seconds)


@lru_cache(maxsize=4)
def _received(sent: bytes) -> Work:
    """The Work, once in a process: it keeps what it has found out of its scene."""
    work: Work = pickle.loads(sent)
    return work


def unsendable(work: Work) -> str:
    """Why other processes of this machine cannot compute it; empty where they can."""
    main = sys.modules.get("__main__")
    script = getattr(main, "__file__", None)
    function = work.source
    while isinstance(function, partial):
        function = function.func
    if getattr(function, "__module__", "") == "__main__" and script is None:
        return "the function is of a prompt or a notebook, put it into a module"
    try:
        pickle.dumps(work)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        return f"put the function into a module ({error})"
    if script is not None and not _is_guarded(Path(script)):
        return (
            f"each would run all of {Path(script).name}, put what begins the sweep below `if __name__ == '__main__':`"
        )
    return ""


def _is_guarded(script: Path) -> bool:
    """Whether a script knows its name, so that a process that imports it does not begin the sweep again."""
    try:
        return "__name__" in script.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return True


# ---- Dask


class Dask(Pool):
    """Workers of a Dask scheduler, on this machine or many; where it goes away it is waited for.

    Arguments:
        scheduler: its address, such as "tcp://127.0.0.1:8786", or a Client.
        patience: for how long a scheduler that is lost may stay away [s].

    Raises:
        StudyError: there is no scheduler at the address.
    """

    gone = (CancelledError, OSError, TimeoutError)

    def __init__(self, work: Work, scheduler: str | Client, patience: float) -> None:
        with needed_for("a sweep on Dask", "dask"):
            import cloudpickle
            import distributed
        self._dask, self._patience = distributed, patience
        self._own = isinstance(scheduler, str)
        self._address = scheduler if isinstance(scheduler, str) else scheduler.scheduler.address
        self._levels = {name: logging.getLogger(name).level for name in TALKATIVE}
        self._client: Any = scheduler
        if self._own:
            self._client = self._connected(CONNECT)
        self.killed = (distributed.KilledWorker,)
        super().__init__(partial(_compute_sent, cloudpickle.dumps(work)), self._client.get_executor(pure=False), 1)
        self._counted = -COUNT_WORKERS

    def _connected(self, timeout: float) -> Any:
        for name in self._levels:  # of Dask's: what happens is said in our own sentences
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
        try:
            return self._dask.Client(self._address, timeout=timeout, set_as_default=False)
        except (OSError, TimeoutError):
            raise StudyError(f"no Dask scheduler answers at {self._address!r}") from None
        except (ValueError, ImportError, RuntimeError) as error:
            told = str(error).partition("\n")[0]
            raise StudyError(f"no Dask scheduler at {self._address!r}: {told}") from None

    def room(self) -> int:
        """How many chunks the workers take; they come and go."""
        if time.monotonic() - self._counted > COUNT_WORKERS and not self.lost():
            self._counted = time.monotonic()
            found = sum(self._client.nthreads().values())
            if found == 0 < self._workers:
                LOGGER.warning("the scheduler at %s has no workers: waiting for one", self._address)
            elif found < self._workers:
                LOGGER.warning(
                    "workers have left the scheduler at %s: others compute their chunks again", self._address
                )
            self._workers = found
        return max(QUEUED * self._workers, 1)

    def lost(self) -> bool:
        """Whether the scheduler has gone."""
        return bool(self._client.status != "running")

    def renew(self) -> None:
        """Wait for the scheduler."""
        if not self._own:
            raise StudyError(f"lost the scheduler at {self._address}")
        LOGGER.warning(
            "lost the scheduler at %s: waiting for it for up to %g s; its workers may have to be started again, too",
            self._address, self._patience,
        )  # fmt: skip
        self._disconnect()
        until = time.monotonic() + self._patience
        while True:
            try:
                self._client = self._connected(max(0.1, until - time.monotonic()))
                break
            except StudyError:
                if time.monotonic() > until:
                    raise StudyError(f"the scheduler at {self._address} is gone") from None
                time.sleep(0.1)
        self.executor = self._client.get_executor(pure=False)
        LOGGER.warning("the scheduler at %s is back: its chunks are handed out again", self._address)

    def _disconnect(self) -> None:
        # A client that is closed while it tries to find its scheduler again raises what it happens to wait for.
        with suppress(Exception, asyncio.CancelledError):
            self._client.close(timeout=COUNT_WORKERS)

    def close(self, stopped: bool) -> None:
        """Cancel what is handed out, and close the connection if it is our own."""
        if not self.lost():
            self.executor.shutdown(wait=False)
        if self._own:
            self._disconnect()
        for name, level in self._levels.items():
            logging.getLogger(name).setLevel(level)


TALKATIVE = ("distributed", "distributed.client", "tornado.application", "asyncio")


# ---- the choice


def check_places(executor: Executor | Where, scheduler: str | Client | None, workers: int | None) -> None:
    """Raise StudyError where these arguments of `sweep` do not fit."""
    if scheduler is not None and not (isinstance(executor, str) and executor == "auto"):
        raise StudyError("a sweep takes an executor or a scheduler, not both")
    if isinstance(executor, str) and executor not in ALL_OF_WHERE:
        raise StudyError(f"executor must be auto, here, threads, processes or an Executor, not {executor!r}")
    if workers is not None and workers < 1:
        raise StudyError(f"workers must be at least 1, not {workers}")


def processes_or_threads(work: Work, workers: int | None) -> Pool:
    """Processes of this machine; threads, said in a sentence, where these cannot compute the work."""
    why = unsendable(work)
    if not why:
        return Processes(work, workers)
    LOGGER.warning("computed in threads of this process, one at a time where that is Python: %s", why)
    return threads(work, workers)


LOOK = 1.0  # s between two looks whether a scheduler is there, and how many workers it has
SILENCE = 60.0  # s without a chunk, after which that is said
MOST_SECONDS = 2.0  # times as long, after which a chunk comes back as it is, and the rest of it is handed out anew
GROWTH = 4.0  # of chunks at most, from one to the next: the first ones tell little of what a point costs
LAST_SHARES = 4  # chunks at least in what is left, so that all workers end at about the same time
MOST_DEATHS = 3  # of the process of a point that was alone in it, until the point is given up

Range = tuple[int, int]


class ChunkSchedule:
    """What is left to do.

    Arguments:
        missing: ranges of points.
        keep: takes the chunks as they are computed.
        progress: called with the number of points after each chunk.
        seconds: what a chunk should take [s].
    """

    def __init__(
        self, missing: Iterable[Range], keep: Callable[[Chunk], None], progress: Callable[[int], None], seconds: float
    ) -> None:
        self._todo, self._suspects = deque(missing), deque[Range]()
        self._take, self._progress, self._seconds = keep, progress, seconds
        self._handed: dict[Future[Chunk], Range] = {}
        self._deaths: dict[int, int] = {}  # of processes, by the point that was alone in them
        self._size = 1.0  # points that are thought to take `seconds`
        self.left = sum(end - begin for begin, end in self._todo)

    @property
    def seconds_left(self) -> float:
        """What all that is left would take one process [s]."""
        return self.left * self._seconds / self._size

    def run(self, place: Pool, budget: float = float("inf")) -> None:
        """Let a place compute all that is left, or what it can in about `budget` [s]."""
        until, heard = perf_counter() + budget, perf_counter()
        while self._handed or ((self._todo or self._suspects) and perf_counter() < until):
            self._hand_out(place, until - perf_counter())
            done, _ = wait(self._handed, LOOK, FIRST_COMPLETED)
            if done or perf_counter() - heard > SILENCE:
                if not done:
                    LOGGER.warning("no chunk came back for %g s: kernels are compiled, or points take long", SILENCE)
                heard = perf_counter()
            alone = len(self._handed) == 1
            broken = [self._came_back(place, future, alone) for future in done]
            if any(broken) or place.lost():
                self._begin_anew(place, suspect=not place.lost())

    def _hand_out(self, place: Pool, left: float) -> None:
        """As many chunks as there is room for; suspects one by one, each alone."""
        if self._suspects:
            if not self._handed:
                self._submit(place, *self._suspects.popleft(), left)
            return
        room = max(place.room() - len(self._handed), 0)
        for _ in range(room):
            if self._todo:
                self._submit(place, *self._next(1 if isinstance(place, Here) else room + len(self._handed)), left)

    def _submit(self, place: Pool, begin: int, end: int, left: float) -> None:
        seconds = min(MOST_SECONDS * self._seconds, left)
        try:
            future = place.executor.submit(place.call, begin, end, seconds)
        except BrokenExecutor:  # its process died while nothing was handed out
            place.renew()
            future = place.executor.submit(place.call, begin, end, seconds)
        self._handed[future] = begin, end

    def _next(self, places: int) -> Range:
        """The next points to hand out, so that there are some for all places to the last."""
        begin, end = self._todo.popleft()
        share = self.left // (LAST_SHARES * places) if places > 1 else self.left
        last = begin + max(1, min(int(self._size), share))
        if end > last:
            self._todo.appendleft((last, end))
        return begin, min(end, last)

    def _came_back(self, place: Pool, future: Future[Chunk], alone: bool) -> bool:
        """Take what came back; whether the place broke. It was handed out `alone`, or with others."""
        begin, end = self._handed.pop(future)
        try:
            self._keep(future.result(), end)
        except place.killed:
            self._blame(begin, end)
        except BrokenExecutor:
            if alone:
                self._blame(begin, end)
            else:
                self._suspects.append((begin, end))
            return True
        except place.gone:
            self._todo.appendleft((begin, end))
        return False

    def _begin_anew(self, place: Pool, suspect: bool) -> None:
        """Take what is done of all that was handed out; the rest is lost with its place, and one of them may have done it."""
        for future, (begin, end) in self._handed.items():
            if future.done() and not future.cancelled() and future.exception() is None:
                self._keep(future.result(), end)
            elif suspect:
                self._suspects.append((begin, end))
            else:
                self._todo.appendleft((begin, end))
        self._handed.clear()
        if self._suspects:
            count = sum(end - begin for begin, end in self._suspects)
            LOGGER.warning("a worker died: %d points that were handed out are computed again, each chunk alone", count)
        place.renew()

    def _keep(self, chunk: Chunk, end: int) -> None:
        """Let a chunk be kept; what it did not come to is handed out again."""
        self._take(chunk)
        if chunk.end < end:
            self._todo.appendleft((chunk.end, end))
        count = chunk.end - chunk.begin
        thought = count * self._seconds / max(chunk.seconds, 1e-9)
        if count >= self._size / GROWTH or thought < self._size:
            self._size = max(1.0, min(thought, GROWTH * self._size))
        self.left -= count
        self._progress(count)

    def _blame(self, begin: int, end: int) -> None:
        """Points of which a process died that had no others: halves of them are tried, and a single point three times."""
        if end - begin > 1:
            middle = (begin + end) // 2
            self._suspects.extendleft([(middle, end), (begin, middle)])
            return
        self._deaths[begin] = self._deaths.get(begin, 0) + 1
        if self._deaths[begin] < MOST_DEATHS:
            self._suspects.appendleft((begin, end))
        else:
            LOGGER.warning("point %d is lost: the process that computed it died, %d times", begin, MOST_DEATHS)
            self._keep(lost(begin, MOST_DEATHS), end)
