"""Warming up behind the window: load (or compile) the kernels, then run a queue of small jobs, on one thread."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.window.gallery.thumbnails import QUICK as AHEAD

if TYPE_CHECKING:
    from softcradle.physics.methods import Method
    from softcradle.sandbox.session.live_lane import LiveLane

LOADED_LATER = ("pymunk", "scipy")  # no kernels of their own: they load when they are chosen


class Warmer:
    """A daemon thread that first readies the physics and then works off jobs; results are fetched, never pushed.

    Attributes:
        ready: set when scenes in which nothing rubs can be played without a wait.
        complete: set when every method is loaded.
        problem: why a method cannot be loaded, or None.
    """

    def __init__(self) -> None:
        self.ready = threading.Event()
        self.complete = threading.Event()
        self.problem: str | None = None
        self._warm: set[tuple[str, bool]] = set()
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

    def has(self, method: str, dissipative: bool = False) -> bool:
        """Whether that method can run without a wait, on a chain that rubs if `dissipative`, which takes kernels of its own.

        Methods without any always can.
        """
        return (method, dissipative) in self._warm or method in LOADED_LATER

    def can_move(self, lanes: Iterable[LiveLane], method: str | None = None) -> bool:
        """Whether all `lanes` can be moved without a wait, by `method`; None: by their own, and by that of a look ahead."""
        return self.ready.is_set() and all(
            self.has(name, lane.chain.dissipative)
            for lane in lanes
            for name in ((lane.setup.method, AHEAD) if method is None else (method,))
        )

    def _run(self) -> None:
        from softcradle.physics.methods import METHODS, Family

        own = [method for method in METHODS if method.name not in LOADED_LATER]
        first = [method for method in own if method.family is Family.FIXED_STEP]  # scenes are played with these
        rest = [method for method in own if method not in first]
        for method in first:
            self._load(method, dissipative=False)
        self.ready.set()
        later = [(method, True) for method in first] + [
            (method, dissipative) for method in rest for dissipative in (False, True)
        ]
        while self._work(wait=not later):
            if later and self._jobs.empty():
                self._load(*later.pop(0))
            if not later:
                self.complete.set()

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

    def _load(self, method: Method, dissipative: bool) -> None:
        try:
            if method.dissipative or not dissipative:  # where it is refused, nobody has to wait for that
                warm(method.name, dissipative)
        except Exception as error:
            self.problem = f"method {method.name} cannot be loaded: {error}"
        self._warm.add((method.name, dissipative))


def warm(method: str, dissipative: bool) -> None:
    """Call every compiled kernel of a method once, with the types that the window calls it with; see :meth:`Warmer.has`."""
    from softcradle.physics import Chain, State, advance, power_law, simulate

    chain, velocity = Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1), friction=0.1 if dissipative else 0.0), [1.0, 0.0, 0.0]
    advance(chain, State.at_start(chain, velocity), 1e-3, method=method)
    simulate(chain, velocity, duration=1e-3, method=method, samples=2)
