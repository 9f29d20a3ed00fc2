"""Where the chunks of a sweep are computed: executors of `concurrent.futures`, in this process, in others, on Dask."""

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
QUEUED = 2  # chunks for each worker that are handed out: one that is computed, one that waits
MANY = 256  # workers of an executor of the caller's that does not tell how many it has
CONNECT = 15.0  # s, for which a scheduler is waited for

Where = Literal["auto", "here", "threads", "processes"]


@dataclass
class Workplace:
    """An executor, and what it calls with (begin, end, seconds) for a chunk.

    Attributes:
        call: is handed to the executor.
        make: gives the executor, and another one after it broke; StudyError where there is none.
        room: gives how many chunks it takes at once.
        close: lets go of an executor; where the sweep was stopped, which the second argument says, of what is computed too.
        killed: errors of a chunk that killed its workers, where the executor lives on.
        gone: errors of a chunk whose executor is no longer there.
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
        """Begin anew after it broke."""
        self.executor.shutdown(wait=False, cancel_futures=True)
        self.executor = self.make()


class _Caller(Executor):
    """Computes in the thread that hands out."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **keywords: Any) -> Future[Any]:
        found: Future[Any] = Future()
        found.set_result(function(*args, **keywords))
        return found


def here(work: Work) -> Workplace:
    """This process and thread, one chunk at a time."""
    return Workplace(work.compute, _Caller, lambda: 1)


def threads(work: Work, workers: int) -> Workplace:
    """Threads of this process."""
    return Workplace(work.compute, partial(DaemonThreads, workers), lambda: QUEUED * workers)


def _of_caller(work: Work, executor: Executor, workers: int | None) -> Workplace:
    """An executor of the caller's, which stays open, and cannot be made anew."""
    given = [executor]
    count = workers or getattr(executor, "_max_workers", None) or MANY  # cores are those of this machine alone

    def make() -> Executor:
        if not given:
            raise StudyError("a worker of the executor died, and the executor takes no more work")
        return given.pop()

    return Workplace(partial(compute_checked, work), make, lambda: QUEUED * count, lambda *_: None)


def processes(work: Work, workers: int) -> Workplace:
    """Processes of this machine. Raises StudyError where the work cannot be sent to them."""
    why = unsendable(work)
    if why:
        raise StudyError(f"other processes cannot compute this: {why}")
    context = multiprocessing.get_context("spawn")  # a fork of a process with threads may stand still
    make = partial(_Processes, workers, context, _begin_worker)
    call = partial(_compute_sent, pickle.dumps(work))
    return Workplace(call, make, lambda: QUEUED * workers, _Processes.end)  # type: ignore[arg-type]


class _Processes(ProcessPoolExecutor):
    """Begins its processes in a thread that Ctrl+C does not reach, nor do they hear it: none is left half begun."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._beginner = ThreadPoolExecutor(1, initializer=_leave_interruptions)

    def submit(self, function: Callable[..., Any], /, *args: Any, **keywords: Any) -> Future[Any]:
        return self._beginner.submit(super().submit, function, *args, **keywords).result()

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        self._beginner.shutdown()
        super().shutdown(wait, cancel_futures=cancel_futures)

    def end(self, stopped: bool) -> None:
        """End the processes; at once where the sweep was stopped: they may be in a kernel, or wait for one."""
        self._beginner.shutdown()
        for process in list((self._processes or {}).values()) if stopped else ():
            process.terminate()  # what Executor.terminate_workers does from Python 3.14 on
        super().shutdown(wait=True, cancel_futures=True)


def _leave_interruptions() -> None:
    """Leave Ctrl+C to the main thread; what this thread begins does so from its first moment on."""
    if sys.platform != "win32":
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})


def _begin_worker() -> None:
    """Begin a process: leave Ctrl+C to the parent, and end when the parent has ended, which a kill may have done."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where it is not blocked

    def end_with_parent() -> None:
        multiprocessing.parent_process().join()  # type: ignore[union-attr]
        os._exit(0)

    threading.Thread(target=end_with_parent, daemon=True).start()


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
    script, name = getattr(main, "__file__", None), getattr(getattr(main, "__spec__", None), "name", "")
    of_package = name.endswith(".__main__")  # by `python -m`: multiprocessing does not import that in its processes
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
    with suppress(OSError, UnicodeDecodeError):  # a script that knows its name does not begin the sweep again
        if script is not None and "__name__" not in Path(script).read_text(encoding="utf-8"):
            below = "put what begins the sweep below `if __name__ == '__main__':`"
            return f"each would run all of {Path(script).name}, {below}"
    return ""


def dask(work: Work, scheduler: str | Client) -> Workplace:
    """Workers of a Dask scheduler, on this machine or many, through the executor that its Client is.

    Raises StudyError where no scheduler is at the address, such as "tcp://127.0.0.1:8786", and later where it has gone.
    """
    with needed_for("a sweep on Dask", "dask"):
        import cloudpickle
        import distributed
    client: Any = _connected(scheduler) if isinstance(scheduler, str) else scheduler
    address, gone = client.scheduler.address, (CancelledError, OSError, TimeoutError)

    def room() -> int:
        with suppress(*gone):
            if client.status == "running":
                return max(1, QUEUED * sum(client.nthreads().values()))  # workers come and go
        raise StudyError(f"lost the scheduler at {address}")

    def close(executor: Executor, _: bool) -> None:
        with suppress(Exception, CancelledError):  # where the scheduler has gone
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
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)  # what happens is said in our own sentences
    try:
        resolve_address(address)  # what is no address would be refused by a Client that is half made, and ends late
        return distributed.Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, TimeoutError):
        raise StudyError(f"no Dask scheduler answers at {address!r}") from None
    except (TypeError, ValueError, ImportError, RuntimeError) as error:
        told = str(error).partition("\n")[0]
        raise StudyError(f"no Dask scheduler at {address!r}: {told}") from None


def place_of(
    work: Work, executor: Executor | Where, scheduler: str | Client | None, workers: int | None
) -> Workplace | None:
    """The place that is asked for, before any work, so that a wrong address is told at once; None for "auto"."""
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
    """Processes of this machine; threads, said in a sentence, where these cannot compute the work."""
    why = unsendable(work)
    if not why:
        return processes(work, workers or cores())
    LOGGER.warning("computed in threads of this process, one at a time where that is Python: %s", why)
    return threads(work, workers or cores())


LOOK = 1.0  # s between two looks whether a scheduler is there, and how many workers it has
SILENCE = 60.0  # s without a chunk, after which that is said
LAST_SHARES = 4  # chunks at least in what is left, so that all workers end at about the same time
MOST_DEATHS = 3  # of the process of a point that was alone in it, until the point is given up

PointRange = tuple[int, int]


class ChunkSchedule:
    """What is left to do.

    Arguments:
        missing: ranges of points.
        take: takes the chunks as they are computed.
        seconds: after which a chunk comes back as it is, and the rest of it is handed out anew [s].
    """

    def __init__(self, missing: Iterable[PointRange], take: Callable[[Chunk], None], seconds: float) -> None:
        self._todo, self._suspects, self._broken = deque(missing), deque[PointRange](), list[PointRange]()
        self._take, self._seconds = take, seconds
        self._handed: dict[Future[Chunk], PointRange] = {}
        self._deaths = Counter[int]()  # of processes, by the point that was alone in them
        self._pace = float("inf")  # s a point, the least of a chunk: what else the machine does only adds to it
        self.left = sum(end - begin for begin, end in self._todo)

    @property
    def seconds_left(self) -> float:
        """What all that is left would take one process [s]."""
        return self.left * self._pace if self.left else 0.0

    def run(self, place: Workplace, budget: float = float("inf")) -> None:
        """Let a place compute all that is left, or what it can in about `budget` [s]."""
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
        """As many chunks as there is room for; suspects each alone, none while a broken place gives chunks back."""
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
        """Whether the place took a chunk."""
        try:
            future = place.executor.submit(place.call, begin, end, min(self._seconds, until - perf_counter()))
        except BrokenExecutor:  # a process died; of nothing that was handed out, or of what has not come back yet
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
        """Each chunk that a broken place had is computed again, alone; one that was alone is to blame."""
        place.renew()
        count = sum(end - begin for begin, end in self._broken)
        LOGGER.warning("a worker died: %d points that were handed out are computed again, each chunk alone", count)
        if len(self._broken) == 1:
            self._blame(*self._broken[0])
        else:
            self._suspects.extend(self._broken)
        self._broken.clear()

    def _keep(self, chunk: Chunk, end: int) -> None:
        """Let a chunk be kept; what it did not come to is handed out again."""
        self._take(chunk)
        if chunk.end < end:
            self._todo.appendleft((chunk.end, end))
        self._pace = min(self._pace, chunk.seconds / chunk.count)
        self.left -= chunk.count

    def _blame(self, begin: int, end: int) -> None:
        """Points of which a process died that had no others: halves of them are tried, and a single point three times."""
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
