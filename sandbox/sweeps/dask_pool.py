"""Chunks on the workers of a Dask scheduler, on this machine or many; a worker or the scheduler may die on the way."""

from __future__ import annotations

import logging
import queue
import time
from collections.abc import Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from softcradle.physics.extras import needed_for
from softcradle.sandbox.sweeps.chunk_pools import QUEUED, Lost
from softcradle.sandbox.sweeps.chunk_work import Chunk, Work, compute_checked
from softcradle.sandbox.sweeps.study_error import StudyError

if TYPE_CHECKING:
    from distributed import Client, Future

LOGGER = logging.getLogger("softcradle")
LOOK_AGAIN = 1.0  # s, after which a wait looks whether the scheduler is there, and how many workers it has
CONNECT = 15.0  # s, for which a scheduler is waited for at the start
PATIENCE = 60.0  # s, for which a scheduler may be away
UNHEARD = 10.0  # s without a worker, after which that is said


class DaskPool:
    """Chunks on a Dask scheduler.

    Arguments:
        work: what is computed.
        scheduler: its address, such as "tcp://127.0.0.1:8786", or a Client.
        patience: for how long a scheduler that is lost may stay away [s].

    Raises:
        StudyError: there is no scheduler at the address.
    """

    def __init__(self, work: Work, scheduler: str | Client, patience: float = PATIENCE) -> None:
        with needed_for("a sweep on Dask", "dask"):
            import distributed
        self._dask, self._work, self._patience = distributed, work, patience
        self._own = isinstance(scheduler, str)
        self._address = scheduler if isinstance(scheduler, str) else scheduler.scheduler.address
        self._handed: dict[Future, tuple[int, int]] = {}
        self._client: Any = self._connected(CONNECT) if self._own else scheduler
        self._adopt()

    def _connected(self, timeout: float) -> Any:
        try:
            return self._dask.Client(self._address, timeout=timeout, set_as_default=False)
        except (OSError, TimeoutError, ValueError, ImportError, RuntimeError) as error:
            if self._handed or not isinstance(error, (OSError, TimeoutError)):
                raise StudyError(f"no Dask scheduler at {self._address!r}: {_first_line(error)}") from None
            raise StudyError(f"no Dask scheduler answers at {self._address!r}") from None

    def _adopt(self) -> None:
        """Bring the work to the scheduler once, as a task: workers fetch it from each other; where it is lost it is made anew."""
        self._shared = self._client.submit(_same, self._work, pure=False)
        self._ready: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self._places, self._counted, self._heard = 0, 0.0, time.monotonic()
        self._count_workers()

    def _count_workers(self) -> None:
        """How many chunks the workers take; asked for once in a while, because workers come and go."""
        now = time.monotonic()
        if now - self._counted < LOOK_AGAIN:
            return
        self._counted = now
        threads = sum(self._client.nthreads().values()) if self._client.status == "running" else 0
        if QUEUED * threads < self._places:
            LOGGER.warning("workers have left the scheduler at %s: others compute their chunks again", self._address)
        self._places = QUEUED * threads
        if threads:
            self._heard = now
        elif now - self._heard > UNHEARD:
            LOGGER.warning("the scheduler at %s has no workers: waiting for one", self._address)
            self._heard = now + 1e9  # said once

    def room(self) -> int:
        """How many more chunks it takes now."""
        self._count_workers()
        return max(self._places, 1) - len(self._handed)

    def submit(self, begin: int, end: int, seconds: float) -> None:
        """Hand out the points."""
        future = self._client.submit(compute_checked, self._shared, begin, end, seconds, pure=False)
        self._handed[future] = begin, end
        future.add_done_callback(self._ready.put)  # finished, failed, cancelled or lost

    def wait(self) -> Iterator[Chunk | Lost]:
        """The chunks that come back next."""
        ready: list[Future] = []
        while self._handed and not ready:
            with suppress(queue.Empty):
                ready.append(self._ready.get(timeout=LOOK_AGAIN))
            if self._client.status != "running":
                yield from self._reconnected()
                return
            self._count_workers()
        while not self._ready.empty():
            ready.append(self._ready.get())
        yield from (self._taken(future) for future in ready if future in self._handed)

    def _taken(self, future: Future) -> Chunk | Lost:
        begin, end = self._handed.pop(future)
        try:
            chunk: Chunk = future.result()
        except self._dask.KilledWorker:
            return Lost(begin, end, guilty=True)  # several workers died of it, says Dask
        except (self._dask.CancelledError, OSError, TimeoutError):
            return Lost(begin, end, suspect=False)
        return chunk

    def _reconnected(self) -> Iterator[Lost]:
        """Wait for the scheduler; what was handed out to the one before is lost."""
        handed = sorted(self._handed.values())
        LOGGER.warning("lost the scheduler at %s: waiting for it for up to %g s", self._address, self._patience)
        until = time.monotonic() + self._patience
        if not self._own:
            raise StudyError(f"lost the scheduler at {self._address}")
        self._client.close(timeout=LOOK_AGAIN)
        while True:
            try:
                self._client = self._connected(max(LOOK_AGAIN, 0.1 * self._patience))
                break
            except StudyError:
                if time.monotonic() > until:
                    raise StudyError(f"the scheduler at {self._address} is gone") from None
        self._handed.clear()
        self._adopt()
        LOGGER.warning("the scheduler at %s is back: %d chunks are handed out again", self._address, len(handed))
        yield from (Lost(begin, end, suspect=False) for begin, end in handed)

    def busy(self) -> bool:
        """Whether something is handed out."""
        return bool(self._handed)

    def close(self) -> None:
        """Cancel what is handed out, and close the connection if it is our own."""
        if self._client.status == "running" and self._handed:
            self._client.cancel(list(self._handed))
        self._handed.clear()
        del self._shared
        if self._own:
            self._client.close(timeout=LOOK_AGAIN)


def _same(work: Work) -> Work:
    """The work itself."""
    return work


def _first_line(error: Exception) -> str:
    return str(error).partition("\n")[0]
