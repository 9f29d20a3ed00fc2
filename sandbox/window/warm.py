"""Warming up behind the window: load (or compile) the kernels, then run a queue of small jobs, on one thread."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import Any

FIRST = "physics.fixed_step"  # module of the methods that scenes are played and looked ahead with
LOADED_LATER = ("pymunk", "scipy")  # no kernels of their own: they load when they are chosen


class Warmer:
    """A daemon thread that first readies the physics and then works off jobs; results are fetched, never pushed.

    Attributes:
        ready: set when scenes can be played without a wait.
        problem: why a method cannot be loaded, or None.
    """

    def __init__(self) -> None:
        self.ready = threading.Event()
        self.problem: str | None = None
        self._warm: set[str] = set()
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

    def has(self, method: str) -> bool:
        """Whether that method can run without a wait; those without kernels of their own always can."""
        return method in self._warm or method in LOADED_LATER

    def _run(self) -> None:
        from physics import METHODS

        first = [method.name for method in METHODS if method.module == FIRST]
        later = [method.name for method in METHODS if method.name not in (*first, *LOADED_LATER)]
        for name in first:
            self._load(name)
        self.ready.set()
        while self._work(wait=not later):
            if later and self._jobs.empty():
                self._load(later.pop(0))

    def _work(self, wait: bool) -> bool:
        """Do the next job, if there is one; False at the end of all."""
        try:
            task = self._jobs.get(block=wait)
        except queue.Empty:
            return True
        if task is None:
            return False
        key, job = task
        try:
            self._done.put((key, job()))
        except Exception as error:
            self._done.put((key, error))
        return True

    def _load(self, method: str) -> None:
        try:
            warm(method)
        except Exception as error:
            self.problem = f"method {method} cannot be loaded: {error}"
        self._warm.add(method)


def warm(method: str) -> None:
    """Call every compiled kernel of a method once, with the types that the window calls it with."""
    from physics import Chain, State, advance, power_law, simulate

    chain, velocity = Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1)), [1.0, 0.0, 0.0]
    advance(chain, State.at_start(chain, velocity), 1e-3, method=method)
    simulate(chain, velocity, duration=1e-3, method=method, samples=2)
