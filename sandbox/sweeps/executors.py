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
from collections.abc import Callable
from concurrent.futures import CancelledError, Executor, Future, ProcessPoolExecutor
from contextlib import suppress
from functools import lru_cache, partial
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from softcradle.physics.ensemble_runs import DaemonThreads, cores
from softcradle.physics.extras import needed_for
from softcradle.sandbox.sweeps.chunk_work import Chunk, Work, compute_checked
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


class Place:
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


class Here(Place):
    """This process and thread, one chunk at a time."""

    def __init__(self, work: Work) -> None:
        super().__init__(work.compute, _Caller(), 1)

    def room(self) -> int:
        """One: a chunk is computed as it is handed out."""
        return 1


def threads(work: Work, workers: int | None) -> Place:
    """Threads of this process."""
    count = workers or cores()
    return Place(work.compute, DaemonThreads(count), count)


class Callers(Place):
    """An executor of the caller's, which stays open."""

    def __init__(self, work: Work, executor: Executor, workers: int | None) -> None:
        super().__init__(partial(compute_checked, work), executor, workers or cores())

    def close(self, stopped: bool) -> None:
        """Leave it open."""


# ---- processes of this machine


class Processes(Place):
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


class Dask(Place):
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


def processes_or_threads(work: Work, workers: int | None) -> Place:
    """Processes of this machine; threads, said in a sentence, where these cannot compute the work."""
    why = unsendable(work)
    if not why:
        return Processes(work, workers)
    LOGGER.warning("computed in threads of this process, one at a time where that is Python: %s", why)
    return threads(work, workers)
