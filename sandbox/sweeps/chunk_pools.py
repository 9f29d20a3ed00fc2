"""Where chunks are computed: threads, processes, any executor of `concurrent.futures`; they come back, or are lost."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from typing import Protocol

from softcradle.physics.ensemble_runs import cores
from softcradle.sandbox.sweeps.chunk_work import Chunk, Work, compute_checked
from softcradle.sandbox.sweeps.study_error import StudyError

QUEUED = 2  # chunks for each worker that are handed out: one that is computed, one that waits


@dataclass(frozen=True)
class Lost:
    """Points that were handed out and did not come back.

    Attributes:
        begin, end: their numbers.
        suspect: whether their process died, which may be their doing; else the connection was lost.
        guilty: whether they were alone in it, so that it was.
    """

    begin: int
    end: int
    suspect: bool = True
    guilty: bool = False


class Pool(Protocol):
    """Where chunks are computed."""

    def room(self) -> int:
        """How many more chunks it takes now."""

    def submit(self, begin: int, end: int, seconds: float) -> None:
        """Hand out the points from `begin` to `end`; after `seconds` what is done comes back."""

    def wait(self) -> Iterator[Chunk | Lost]:
        """Wait until something comes back."""

    def busy(self) -> bool:
        """Whether something is handed out."""

    def close(self) -> None:
        """Let go of what is handed out."""


class FuturesPool:
    """Chunks in a `concurrent.futures` executor.

    Arguments:
        make: makes the executor; called again where its processes died, if it may be.
        call: what a worker calls with (begin, end, seconds).
        workers: how many there are.
        again: whether `make` gives a new executor; else one that broke ends the sweep.
        own: whether the executor is shut down at the end.
    """

    def __init__(
        self,
        make: Callable[[], Executor],
        call: Callable[[int, int, float], Chunk],
        workers: int,
        again: bool = True,
        own: bool = True,
    ) -> None:
        self._make, self._call, self._again, self._own = make, call, again, own
        self._executor = make()
        self._places = QUEUED * workers
        self._handed: dict[Future[Chunk], tuple[int, int]] = {}

    def room(self) -> int:
        """How many more chunks it takes now."""
        return self._places - len(self._handed)

    def submit(self, begin: int, end: int, seconds: float) -> None:
        """Hand out the points."""
        try:
            future = self._executor.submit(self._call, begin, end, seconds)
        except BrokenExecutor:  # its process died while nothing was handed out
            self._renew()
            future = self._executor.submit(self._call, begin, end, seconds)
        self._handed[future] = begin, end

    def wait(self) -> Iterator[Chunk | Lost]:
        """The chunks that come back next; where a process died, all that was handed out is lost with it."""
        done, _ = wait(self._handed, return_when=FIRST_COMPLETED)
        broken = False
        alone = len(self._handed) == 1
        for future in done:
            begin, end = self._handed.pop(future)
            try:
                yield future.result()
            except BrokenExecutor:
                broken = True
                yield Lost(begin, end, guilty=alone)
        if broken:
            for future, (begin, end) in self._handed.items():
                finished = future.done() and not future.cancelled() and future.exception() is None
                yield future.result() if finished else Lost(begin, end)
            self._handed.clear()
            self._renew()

    def busy(self) -> bool:
        """Whether something is handed out."""
        return bool(self._handed)

    def close(self) -> None:
        """Let go of what is handed out, and of the executor if it is our own."""
        for future in self._handed:
            future.cancel()
        if self._own:
            self._executor.shutdown(wait=True, cancel_futures=True)

    def _renew(self) -> None:
        if not self._again:
            raise StudyError("a worker of the executor died, and the executor takes no more work")
        self._executor.shutdown(wait=False, cancel_futures=True)
        self._executor = self._make()


class _Adopted:
    """The Work of this process, which it was given when it began."""

    work: Work | None = None


def _adopt(work: bytes) -> None:
    """Begin a worker process: keep the work, leave Ctrl-C to the parent, and end when the parent has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()
    _Adopted.work = pickle.loads(work)


def _end_with(parent: BaseProcess) -> None:
    """End this process when its parent has ended, which a kill may have done without a word."""
    parent.join()
    os._exit(0)


def _compute_adopted(begin: int, end: int, seconds: float) -> Chunk:
    assert _Adopted.work is not None
    return _Adopted.work.compute(begin, end, seconds)


def process_pool(work: Work, workers: int | None = None) -> FuturesPool:
    """Chunks in processes of this machine. Raises StudyError where the work cannot be sent to them."""
    count, sent = workers or cores(), sendable(work)
    context = multiprocessing.get_context("spawn")  # a fork of a process with threads may stand still
    return FuturesPool(lambda: ProcessPoolExecutor(count, context, _adopt, (sent,)), _compute_adopted, count)


def thread_pool(work: Work, workers: int | None = None) -> FuturesPool:
    """Chunks in threads of this process."""
    count = workers or cores()
    return FuturesPool(lambda: ThreadPoolExecutor(count), work.compute, count, again=False)


def executor_pool(work: Work, executor: Executor, workers: int | None = None) -> FuturesPool:
    """Chunks in an executor of the caller's, which stays open."""
    call = _Call(work)
    return FuturesPool(lambda: executor, call, workers or cores(), again=False, own=False)


@dataclass(frozen=True)
class _Call:
    """`compute_checked` with its work, to be sent to wherever an executor computes."""

    work: Work

    def __call__(self, begin: int, end: int, seconds: float) -> Chunk:
        return compute_checked(self.work, begin, end, seconds)


def sendable(work: Work) -> bytes:
    """The work as bytes. Raises StudyError where another process could not read them."""
    try:
        found = pickle.dumps(work)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise StudyError(f"the function cannot be sent to another process: put it into a module ({error})") from None
    if getattr(work.source, "__module__", "") == "__main__":
        raise StudyError(
            "the function cannot be sent to another process: put it into a module that can be imported there"
        )
    return found
