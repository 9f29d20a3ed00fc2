"""The schedule of a sweep: chunks of about a second, handed out until every point is kept, once; deadly points are found."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from time import perf_counter

from softcradle.sandbox.sweeps.chunk_work import Chunk, lost
from softcradle.sandbox.sweeps.executors import Here, Place

LOGGER = logging.getLogger("softcradle")
LOOK = 1.0  # s between two looks whether a scheduler is there, and how many workers it has
SILENCE = 60.0  # s without a chunk, after which that is said
MOST_SECONDS = 2.0  # times as long, after which a chunk comes back as it is, and the rest of it is handed out anew
GROWTH = 4.0  # of chunks at most, from one to the next: the first ones tell little of what a point costs
LAST_SHARES = 4  # chunks at least in what is left, so that all workers end at about the same time
MOST_DEATHS = 3  # of the process of a point that was alone in it, until the point is given up

Range = tuple[int, int]


class ChunkSchedule:
    """What is left to do.

    Arguments:
        missing: ranges of points.
        keep: takes the chunks as they are computed.
        progress: called with the number of points after each chunk.
        seconds: what a chunk should take [s].
    """

    def __init__(
        self, missing: Iterable[Range], keep: Callable[[Chunk], None], progress: Callable[[int], None], seconds: float
    ) -> None:
        self._todo, self._suspects = deque(missing), deque[Range]()
        self._take, self._progress, self._seconds = keep, progress, seconds
        self._handed: dict[Future[Chunk], Range] = {}
        self._deaths: dict[int, int] = {}  # of processes, by the point that was alone in them
        self._size = 1.0  # points that are thought to take `seconds`
        self.left = sum(end - begin for begin, end in self._todo)

    @property
    def seconds_left(self) -> float:
        """What all that is left would take one process [s]."""
        return self.left * self._seconds / self._size

    def run(self, place: Place, budget: float = float("inf")) -> None:
        """Let a place compute all that is left, or what it can in about `budget` [s]."""
        until, heard = perf_counter() + budget, perf_counter()
        while self._handed or ((self._todo or self._suspects) and perf_counter() < until):
            self._hand_out(place, until - perf_counter())
            done, _ = wait(self._handed, LOOK, FIRST_COMPLETED)
            if done or perf_counter() - heard > SILENCE:
                if not done:
                    LOGGER.warning("no chunk came back for %g s: kernels are compiled, or points take long", SILENCE)
                heard = perf_counter()
            alone = len(self._handed) == 1
            broken = [self._came_back(place, future, alone) for future in done]
            if any(broken) or place.lost():
                self._begin_anew(place, suspect=not place.lost())

    def _hand_out(self, place: Place, left: float) -> None:
        """As many chunks as there is room for; suspects one by one, each alone."""
        if self._suspects:
            if not self._handed:
                self._submit(place, *self._suspects.popleft(), left)
            return
        room = max(place.room() - len(self._handed), 0)
        for _ in range(room):
            if self._todo:
                self._submit(place, *self._next(1 if isinstance(place, Here) else room + len(self._handed)), left)

    def _submit(self, place: Place, begin: int, end: int, left: float) -> None:
        seconds = min(MOST_SECONDS * self._seconds, left)
        try:
            future = place.executor.submit(place.call, begin, end, seconds)
        except BrokenExecutor:  # its process died while nothing was handed out
            place.renew()
            future = place.executor.submit(place.call, begin, end, seconds)
        self._handed[future] = begin, end

    def _next(self, places: int) -> Range:
        """The next points to hand out, so that there are some for all places to the last."""
        begin, end = self._todo.popleft()
        share = self.left // (LAST_SHARES * places) if places > 1 else self.left
        last = begin + max(1, min(int(self._size), share))
        if end > last:
            self._todo.appendleft((last, end))
        return begin, min(end, last)

    def _came_back(self, place: Place, future: Future[Chunk], alone: bool) -> bool:
        """Take what came back; whether the place broke. It was handed out `alone`, or with others."""
        begin, end = self._handed.pop(future)
        try:
            self._keep(future.result(), end)
        except place.killed:
            self._blame(begin, end)
        except BrokenExecutor:
            if alone:
                self._blame(begin, end)
            else:
                self._suspects.append((begin, end))
            return True
        except place.gone:
            self._todo.appendleft((begin, end))
        return False

    def _begin_anew(self, place: Place, suspect: bool) -> None:
        """Take what is done of all that was handed out; the rest is lost with its place, and one of them may have done it."""
        for future, (begin, end) in self._handed.items():
            if future.done() and not future.cancelled() and future.exception() is None:
                self._keep(future.result(), end)
            elif suspect:
                self._suspects.append((begin, end))
            else:
                self._todo.appendleft((begin, end))
        self._handed.clear()
        if self._suspects:
            count = sum(end - begin for begin, end in self._suspects)
            LOGGER.warning("a worker died: %d points that were handed out are computed again, each chunk alone", count)
        place.renew()

    def _keep(self, chunk: Chunk, end: int) -> None:
        """Let a chunk be kept; what it did not come to is handed out again."""
        self._take(chunk)
        if chunk.end < end:
            self._todo.appendleft((chunk.end, end))
        count = chunk.end - chunk.begin
        thought = count * self._seconds / max(chunk.seconds, 1e-9)
        if count >= self._size / GROWTH or thought < self._size:
            self._size = max(1.0, min(thought, GROWTH * self._size))
        self.left -= count
        self._progress(count)

    def _blame(self, begin: int, end: int) -> None:
        """Points of which a process died that had no others: halves of them are tried, and a single point three times."""
        if end - begin > 1:
            middle = (begin + end) // 2
            self._suspects.extendleft([(middle, end), (begin, middle)])
            return
        self._deaths[begin] = self._deaths.get(begin, 0) + 1
        if self._deaths[begin] < MOST_DEATHS:
            self._suspects.appendleft((begin, end))
        else:
            LOGGER.warning("point %d is lost: the process that computed it died, %d times", begin, MOST_DEATHS)
            self._keep(lost(begin, MOST_DEATHS), end)
