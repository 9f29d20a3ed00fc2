"""Simulation of many chains on all cores.

Compiled kernels release Python's global interpreter lock, so threads can use all cores.
"""

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

# Number of parts of the work for each core. The chains differ in cost. Small parts keep all cores busy until the end.
PARTS = 8
MOST_AT_ONCE = 64  # Largest number of chains in a part. A small number makes progress reports frequent.

Item = TypeVar("Item")
Found = TypeVar("Found")
Each = float | Sequence[float | None] | None  # One value for all chains, or one value for each chain


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
    """Simulate many chains in parallel. The results are bitwise equal to the results of `simulate`.

    Each Trajectory contains its warnings. No Python warnings are issued.

    Parameters
    ----------
    chains : sequence of Chain, length C
    velocities : sequence of array_like, length C
        ``velocities[k]``, shape (n+1,), are the start velocities of ``chains[k]`` [m/s].
    duration, method, step, samples, tolerance : optional
        As for `simulate`. Duration and step [s] are one number for all chains, or C numbers. With `samples=2`, the
        samples are the start and the end.
    workers : int, optional
        Number of threads; None means one for each core that this process may use.
    progress : callable, optional
        Called in the calling thread with the number of chains finished since the last call.

    Returns
    -------
    list of Trajectory
        One for each chain, in the order of `chains`.

    Raises
    ------
    ValueError
        If the lists have different lengths, or if `simulate` would raise it for one of the chains.

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
    # Run the first chain before all others, which loads the kernels. Otherwise all threads would wait for the kernels.
    found = part(range(min(1, count)))
    if found:
        tell(1)
    # Divide the other chains into small parts, which run in threads.
    blocks = parts(len(found), count, threads)
    done: list[list[Trajectory]] = [[] for _ in blocks]
    for k, runs in in_threads(part, blocks, threads):
        done[k] = runs
        tell(len(runs))
    return found + [run for runs in done for run in runs]


class DaemonThreads(Executor):
    """Pool of `count` daemon threads. Kernels do not react to signals, but daemon threads do not keep a stopped program
    alive.
    """

    def __init__(self, count: int) -> None:
        self._waiting: SimpleQueue[tuple[Future[Any], Callable[[], Any]] | None] = SimpleQueue()
        self._count = count
        for _ in range(count):
            threading.Thread(target=self._work, name="softcradle", daemon=True).start()

    def submit(self, function: Callable[..., Any], /, *args: Any, **keywords: Any) -> Future[Any]:
        """Schedule a call of `function` in one of the threads."""
        future: Future[Any] = Future()
        self._waiting.put((future, partial(function, *args, **keywords)))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the threads after their current calls, without waiting for them. Futures are always cancelled."""
        # Cancel the calls that have not begun.
        with suppress(Empty):
            while (task := self._waiting.get_nowait()) is not None:
                task[0].cancel()
        for _ in range(self._count):
            self._waiting.put(None)

    def _work(self) -> None:
        while (task := self._waiting.get()) is not None:
            future, call = task
            # Skip a cancelled future. An exception is stored in the future and does not end the thread.
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(call())
            except BaseException as error:
                future.set_exception(error)


def in_threads(function: Callable[[Item], Found], items: Sequence[Item], count: int) -> Iterator[tuple[int, Found]]:
    """Call `function` for all items in threads. Yield the index and the result of each call in order of completion.

    The first error of a call is raised.
    """
    with DaemonThreads(min(count, len(items))) as pool:
        numbers = {pool.submit(function, item): k for k, item in enumerate(items)}
        for future in as_completed(numbers):
            yield numbers[future], future.result()


def cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def threads_of(workers: int | None) -> int:
    """Return the number of threads: `workers`, or one for each core if `workers` is None.

    Raise ValueError if `workers` is less than 1.
    """
    if workers is not None and whole_number("workers", workers) < 1:
        raise ValueError(f"workers must be at least 1, not {shown(workers)}")
    return workers or cores()


def parts(begin: int, end: int, threads: int, least: int = 1) -> list[range]:
    """Divide the chain indices from `begin` to `end` into ranges of nearly equal size.

    Each range contains at least `least` chains.
    """
    size = max(least, min(MOST_AT_ONCE, (end - begin) // (threads * PARTS)))
    return [range(first, min(end, first + size)) for first in range(begin, end, size)]


def _spread(name: str, value: Any, count: int) -> Sequence[float | None]:
    if value is None or np.ndim(value) == 0:
        return [value] * count
    if len(value) != count:
        raise ValueError(f"{count} chains need {count} {name} or one for all, not {len(value)}")
    return value
