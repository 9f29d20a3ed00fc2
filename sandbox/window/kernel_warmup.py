"""The warm-up of kernels behind the window: on one thread they are loaded or compiled, then small jobs are done."""

from __future__ import annotations

import queue
import sys
import threading
from collections.abc import Callable, Iterable
from time import sleep
from typing import TYPE_CHECKING, Any, ClassVar

from softcradle.physics.kernel_tiers import YIELDING, KernelTiers
from softcradle.physics.methods import METHODS, Family, find_method
from softcradle.physics.warm_up import kernels_of
from softcradle.sandbox.languages import _

if TYPE_CHECKING:
    from softcradle.sandbox.session.live_lane import LiveLane

COMPILED_AT_ONCE = 2
LOOKING = 0.1  # seconds between two looks whether machine code has been made
# seconds for which a thread of Python keeps another waiting; drawing lets Python go some ten times a frame
INTERVAL = 2e-4
PLAIN_FRAME = 100  # steps times contacts of a frame that plain Python computes in some three milliseconds


class KernelWarmup:
    """A daemon thread that loads the physics and then does jobs; results are fetched, never pushed.

    Attributes:
        complete: set when every method is loaded.
        problem: why a method cannot be loaded, or None.
    """

    _begun: ClassVar[set[KernelWarmup]] = set()  # and not ended: they share the interval of Python
    _usual: ClassVar[float] = 0.0  # the interval before the first of them

    def __init__(self) -> None:
        self.complete = threading.Event()
        self.problem: str | None = None
        self._jobs: queue.SimpleQueue[tuple[Callable[[Any], None], Callable[[], Any]] | None] = queue.SimpleQueue()
        self._results: queue.SimpleQueue[tuple[Callable[[Any], None], Any]] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="warm-up", daemon=True)

    def start(self) -> None:
        """Begin; the thread that draws does not wait for this one for long whenever it has let Python go."""
        if not self._begun:
            KernelWarmup._usual = sys.getswitchinterval()
            sys.setswitchinterval(INTERVAL)
        self._begun.add(self)
        self._thread.start()

    def stop(self) -> None:
        """End the thread after its present job."""
        if self in self._begun:
            self._begun.remove(self)
            if not self._begun:
                sys.setswitchinterval(self._usual)
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

    def is_warm(self, method: str) -> bool:
        """Whether machine code of that method is in memory; a method without kernels is always warm."""
        kernels = kernels_of(find_method(method))
        return kernels is None or kernels.in_memory

    def can_move(self, lanes: Iterable[LiveLane], frame_time: float, method: str | None = None) -> bool:
        """Whether frames of `frame_time` [s] of all `lanes` can be computed in time, by `method`; None: by their own methods.

        Where machine code is still being made, plain Python does for few contacts in few steps.
        """
        return all(
            self.is_warm(name) or _is_light(lane, name, frame_time)
            for lane in lanes
            for name in (lane.setup.method if method is None else method,)
        )

    def _run(self) -> None:
        found = dict.fromkeys(kernels_of(method) for method in METHODS)
        waiting = sorted((kernels for kernels in found if kernels), key=lambda kernels: not kernels.on_disk)
        while self._work(wait=not waiting):
            if waiting and self._jobs.empty():
                self._load(waiting)
            if not waiting:
                self.complete.set()

    def _load(self, waiting: list[KernelTiers]) -> None:
        """Load kernels whose machine code has been made; begin to make what has not, two at a time, and look again later."""
        made = next((kernels for kernels in waiting if kernels.in_memory or kernels.on_disk), None)
        first = waiting[:COMPILED_AT_ONCE] if made is None else []
        compiling = [kernels for kernels in first if kernels.compile_behind(YIELDING)]
        if compiling:
            sleep(LOOKING)
            return
        chosen = made or waiting[0]
        waiting.remove(chosen)
        try:
            chosen.load()
        except Exception as error:
            self.problem = _("method {method} cannot be loaded: {error}", method=chosen.name, error=error)

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


def _is_light(lane: LiveLane, method: str, frame_time: float) -> bool:
    """Whether plain Python moves a lane in time."""
    step = lane.setup.step_for(frame_time)
    if step is None or find_method(method).family is not Family.FIXED_STEP:
        return False
    return frame_time / step * lane.chain.contacts <= PLAIN_FRAME
