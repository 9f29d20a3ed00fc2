"""The warm-up of kernels behind the window: on one thread they are loaded or compiled, then small jobs are done."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from softcradle.physics.warm_up import WITHOUT_KERNELS, call_kernels
from softcradle.sandbox.languages import _
from softcradle.sandbox.window import look_ahead

if TYPE_CHECKING:
    from softcradle.physics.methods import Method
    from softcradle.sandbox.session.live_lane import LiveLane


class KernelWarmup:
    """A daemon thread that loads the physics and then does jobs; results are fetched, never pushed.

    Attributes:
        ready: set when scenes without friction and loss can be played at once.
        complete: set when every method is loaded.
        problem: why a method cannot be loaded, or None.
    """

    def __init__(self) -> None:
        self.ready = threading.Event()
        self.complete = threading.Event()
        self.problem: str | None = None
        self._warm: set[tuple[str, bool]] = set()
        self._jobs: queue.SimpleQueue[tuple[Callable[[Any], None], Callable[[], Any]] | None] = queue.SimpleQueue()
        self._results: queue.SimpleQueue[tuple[Callable[[Any], None], Any]] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="warm-up", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread after its present job."""
        self._jobs.put(None)

    def submit(self, take: Callable[[Any], None], job: Callable[[], Any]) -> None:
        """Queue `job`; :meth:`deliver` hands its result, or the exception that it raised, to `take`."""
        self._jobs.put((take, job))

    def deliver(self) -> bool:
        """Hand over the next result where one is finished; whether there was one. It never waits."""
        try:
            take, result = self._results.get_nowait()
        except queue.Empty:
            return False
        take(result)
        return True

    def is_warm(self, method: str, dissipative: bool = False) -> bool:
        """Whether that method runs at once, on a chain with friction or loss if `dissipative`: it has kernels of its own.

        A method without kernels always does.
        """
        return (method, dissipative) in self._warm or method in WITHOUT_KERNELS

    def can_move(self, lanes: Iterable[LiveLane], method: str | None = None) -> bool:
        """Whether all `lanes` can be moved at once, by `method`; None: by their own methods and that of the look ahead."""
        return self.ready.is_set() and all(
            self.is_warm(name, lane.chain.dissipative)
            for lane in lanes
            for name in ((lane.setup.method, look_ahead.METHOD) if method is None else (method,))
        )

    def _run(self) -> None:
        from softcradle.physics.methods import METHODS, Family

        own = [method for method in METHODS if method.name not in WITHOUT_KERNELS]
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
        take, job = task
        try:
            self._results.put((take, job()))
        except Exception as error:
            self._results.put((take, error))
        return True

    def _load(self, method: Method, dissipative: bool) -> None:
        try:
            if method.dissipative or not dissipative:  # a chain that the method refuses needs no kernels
                call_kernels(method.name, dissipative)
        except Exception as error:
            self.problem = _("method {method} cannot be loaded: {error}", method=method.name, error=error)
        self._warm.add((method.name, dissipative))
