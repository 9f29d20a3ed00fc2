"""Many chains at once, on all cores. Kernels run outside Python's lock, so threads share the cores."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, as_completed
from contextlib import suppress
from functools import partial
from queue import Empty, SimpleQueue
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from softcradle.physics.chain import Chain
from softcradle.physics.checked_input import shown, whole_number
from softcradle.physics.simulation import solve
from softcradle.physics.trajectory import Trajectory

PARTS = 8  # of the work for each core: chains differ in cost, so the last core to finish should not have much left
MOST_AT_ONCE = 64  # chains in a part, so that progress is told often

Item = TypeVar("Item")
Found = TypeVar("Found")
Each = float | Sequence[float | None] | None  # one for all chains, or one for each


def ensemble(
    chains: Sequence[Chain],
    velocities: Sequence[ArrayLike],
    duration: Each = None,
    method: str = "accurate",
    step: Each = None,
    samples: int = 2,
    tolerance: float = 1e-8,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> list[Trajectory]:
    """Let many chains move, each as `simulate` would, to the last digit and in any order.

    Warnings stand on each Trajectory; no Python warning is given.

    Parameters
    ----------
    chains : sequence of Chain, length C
    velocities : sequence of array_like, length C
        ``velocities[k]``, shape (n+1,), are the start velocities of ``chains[k]`` [m/s].
    duration, method, step, samples, tolerance : optional
        As for `simulate`, duration and step [s] one for all or C of them; two samples are the start and the end.
    workers : int, optional
        Number of threads; None takes one for each core that this process may use.
    progress : callable, optional
        Called from the calling thread with the number of chains that have been done since the last call.

    Returns
    -------
    list of Trajectory
        One for each chain, in their order.

    Raises
    ------
    ValueError
        Lists of different length, or what `simulate` raises for one of the chains.

    Examples
    --------
    >>> from softcradle import ensemble, one_on, power_law
    >>> chains = [one_on(2, power_law(1.0, 1.0 / k)) for k in (1, 2, 10)]
    >>> found = ensemble(chains, [[1, 0, 0]] * 3)
    >>> [float(run.final_velocity[0].round(3)) for run in found]
    [-0.13, -0.238, -0.333]
    """
    if isinstance(chains, Chain):
        raise ValueError("ensemble takes a list of chains and a list of velocities for each; simulate takes one chain")
    threads, count = threads_of(workers), len(chains)
    durations, steps = _spread("durations", duration, count), _spread("steps", step, count)
    if len(velocities) != count:
        raise ValueError(f"{count} chains need {count} lists of velocities, not {len(velocities)}")

    def part(indices: range) -> list[Trajectory]:
        return [solve(chains[k], velocities[k], durations[k], method, steps[k], samples, tolerance) for k in indices]

    tell = progress or (lambda count: None)
    found = part(range(min(1, count)))  # loads the kernels once, before threads would all wait for it
    if found:
        tell(1)
    blocks = parts(len(found), count, threads)
    done: list[list[Trajectory]] = [[] for _ in blocks]
    for k, runs in in_threads(part, blocks, threads):
        done[k] = runs
        tell(len(runs))
    return found + [run for runs in done for run in runs]


class DaemonThreads(Executor):
    """`count` threads that nobody waits for: kernels hear no signal, and a program that is stopped ends without them."""

    def __init__(self, count: int) -> None:
        self._waiting: SimpleQueue[tuple[Future[Any], Callable[[], Any]] | None] = SimpleQueue()
        self._count = count
        for _ in range(count):
            threading.Thread(target=self._work, name="softcradle", daemon=True).start()

    def submit(self, function: Callable[..., Any], /, *args: Any, **keywords: Any) -> Future[Any]:
        """Let a thread call a function."""
        future: Future[Any] = Future()
        self._waiting.put((future, partial(function, *args, **keywords)))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the threads after what they are at; `cancel_futures` is meant in any case, and none is waited for."""
        with suppress(Empty):
            while (task := self._waiting.get_nowait()) is not None:
                task[0].cancel()
        for _ in range(self._count):
            self._waiting.put(None)

    def _work(self) -> None:
        while (task := self._waiting.get()) is not None:
            future, call = task
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(call())
            except BaseException as error:
                future.set_exception(error)


def in_threads(function: Callable[[Item], Found], items: Sequence[Item], count: int) -> Iterator[tuple[int, Found]]:
    """Number and result of `function` for all items, as they come; the first error is raised."""
    with DaemonThreads(min(count, len(items))) as pool:
        numbers = {pool.submit(function, item): k for k, item in enumerate(items)}
        for future in as_completed(numbers):
            yield numbers[future], future.result()


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def threads_of(workers: int | None) -> int:
    """Number of threads: `workers`, or one for each core. ValueError where they are none."""
    if workers is not None and whole_number("workers", workers) < 1:
        raise ValueError(f"workers must be at least 1, not {shown(workers)}")
    return workers or cores()


def parts(begin: int, end: int, threads: int, least: int = 1) -> list[range]:
    """The chains from `begin` to `end` in parts of nearly the same number, `least` of them or more."""
    size = max(least, min(MOST_AT_ONCE, (end - begin) // (threads * PARTS)))
    return [range(first, min(end, first + size)) for first in range(begin, end, size)]


def _spread(name: str, value: Any, count: int) -> Sequence[float | None]:
    if value is None or np.ndim(value) == 0:
        return [value] * count
    if len(value) != count:
        raise ValueError(f"{count} chains need {count} {name} or one for all, not {len(value)}")
    return value
