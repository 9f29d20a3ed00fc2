"""Warming up behind the window: load (or compile) the kernels, then run a queue of small jobs, on one thread."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import Any

LOADED_LATER = ("pymunk", "scipy")  # no kernels of their own: they load when they are chosen


class Warmer:
    """A daemon thread that first readies the physics and then works off jobs; results are fetched, never pushed.

    Attributes:
        ready: set when the physics can run without a wait.
        problem: why it cannot, or None.
    """

    def __init__(self) -> None:
        self.ready = threading.Event()
        self.problem: str | None = None
        self._jobs: queue.SimpleQueue[tuple[Any, Callable[[], Any]] | None] = queue.SimpleQueue()
        self._done: queue.SimpleQueue[tuple[Any, Any]] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="warm", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """Let the thread end after the job it is at."""
        self._jobs.put(None)

    def ask(self, key: Any, job: Callable[[], Any]) -> None:
        """Queue `job`; its result, or the exception it raised, comes out of :meth:`finished` under `key`."""
        self._jobs.put((key, job))

    def finished(self) -> tuple[Any, Any] | None:
        """One (key, result) that is ready, or None; never waits."""
        try:
            return self._done.get_nowait()
        except queue.Empty:
            return None

    def _run(self) -> None:
        try:
            warm_physics()
        except Exception as error:
            self.problem = f"the physics cannot be loaded: {error}"
        self.ready.set()
        while (task := self._jobs.get()) is not None:
            key, job = task
            try:
                self._done.put((key, job()))
            except Exception as error:
                self._done.put((key, error))


def warm_physics() -> None:
    """Call every compiled kernel once, with the types that the window calls it with."""
    from physics import METHODS, Chain, State, advance, power_law, simulate

    chain, velocity = Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1)), [1.0, 0.0, 0.0]
    for method in METHODS:
        if method.name in LOADED_LATER:
            continue
        advance(chain, State.at_start(chain, velocity), 1e-3, method=method.name)
        simulate(chain, velocity, duration=1e-3, method=method.name, samples=2)
