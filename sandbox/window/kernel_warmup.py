"""Background thread of the window. It first loads or compiles the kernels, and then runs short jobs."""

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
LOOKING = 0.1  # Interval in seconds between two checks for finished machine code.
# Switch interval of the interpreter in seconds. A thread holds the interpreter at most this long while another thread
# waits. Drawing a frame releases the interpreter about ten times, so longer waits would add up.
INTERVAL = 2e-4
PLAIN_FRAME = 100  # Largest number of steps times contacts per frame for plain Python. This number takes about 3 ms.


class KernelWarmup:
    """A daemon thread that loads the kernels and then runs jobs. The window fetches the results itself.

    Attributes:
        complete: event that is set when every method is loaded.
        problem: reason why a method cannot be loaded, or None.
    """

    # The threads that are running. All of them share the switch interval of the interpreter.
    _begun: ClassVar[set[KernelWarmup]] = set()
    _usual: ClassVar[float] = 0.0  # Switch interval of the interpreter before the first thread started.

    def __init__(self) -> None:
        self.complete = threading.Event()
        self.problem: str | None = None
        self._jobs: queue.SimpleQueue[tuple[Callable[[Any], None], Callable[[], Any]] | None] = queue.SimpleQueue()
        self._results: queue.SimpleQueue[tuple[Callable[[Any], None], Any]] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="warm-up", daemon=True)

    def start(self) -> None:
        """Start the thread. It shortens the switch interval of the interpreter so that the drawing thread resumes
        quickly.
        """
        if not self._begun:
            KernelWarmup._usual = sys.getswitchinterval()
            sys.setswitchinterval(INTERVAL)
        self._begun.add(self)
        self._thread.start()

    def stop(self) -> None:
        """End the thread after its current job."""
        if self in self._begun:
            self._begun.remove(self)
            if not self._begun:
                sys.setswitchinterval(self._usual)
        self._jobs.put(None)

    def submit(self, take: Callable[[Any], None], job: Callable[[], Any]) -> None:
        """Queue `job`. After it has run, :meth:`deliver` calls `take` with its result or with the exception that it
        raised.
        """
        self._jobs.put((take, job))

    def deliver(self) -> bool:
        """Deliver the next finished result. Return False if no job has finished. This method never waits."""
        try:
            take, result = self._results.get_nowait()
        except queue.Empty:
            return False
        take(result)
        return True

    def is_warm(self, method: str) -> bool:
        """Return True if the machine code of `method` is in memory. A method without compiled kernels is always ready."""
        kernels = kernels_of(find_method(method))
        return kernels is None or kernels.in_memory

    def can_move(self, lanes: Iterable[LiveLane], frame_time: float, method: str | None = None) -> bool:
        """Return True if all `lanes` can be computed in real time, in frames of `frame_time` [s].

        All lanes use `method`. If `method` is None, each lane uses its own method. Plain Python runs while machine code
        is being compiled. It is fast enough for few contacts and few steps.
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
        """Load the kernels whose machine code exists. If there are none, compile two at a time and check again later."""
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
        """Run the next job, if there is one. Return False if the thread must end."""
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
    """Return True if plain Python can compute the motion of `lane` in real time."""
    step = lane.setup.step_for(frame_time)
    if step is None or find_method(method).family is not Family.FIXED_STEP:
        return False
    return frame_time / step * lane.chain.contacts <= PLAIN_FRAME
