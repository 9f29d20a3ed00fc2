"""The schedule of a sweep: chunks of about a second, handed out until every point is in the journal, once."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Iterable
from time import perf_counter

from softcradle.sandbox.sweeps.chunk_pools import Lost, Pool
from softcradle.sandbox.sweeps.chunk_work import Chunk, Work, lost

LOGGER = logging.getLogger("softcradle")
# so that what goes between processes is little beside the work, and what a kill costs is little too
CHUNK_SECONDS = 1.0
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
        self,
        missing: Iterable[Range],
        keep: Callable[[Chunk], None],
        progress: Callable[[int], None],
        seconds: float = CHUNK_SECONDS,
    ) -> None:
        self._todo, self._suspects = deque(missing), deque[Range]()
        self._append, self._progress, self._seconds = keep, progress, seconds
        self._handed: dict[int, int] = {}  # the ends of what is handed out, by where it begins
        self._deaths: dict[int, int] = {}  # of processes, by the point that was alone in them
        self._size = 1.0  # points that are thought to take `seconds`
        self.left = sum(end - begin for begin, end in self._todo)

    def run(self, pool: Pool) -> None:
        """Let `pool` compute all that is left."""
        while self._todo or self._suspects or pool.busy():
            self._hand_out(pool)
            for back in pool.wait():
                if isinstance(back, Lost):
                    self._missed(back)
                else:
                    self._keep(back)

    def run_here(self, work: Work, budget: float) -> None:
        """Compute what is left in this process, for at most `budget` [s]: what a point costs is then known."""
        until = perf_counter() + budget
        while self._todo and perf_counter() < until:
            begin, end = self._next(1)
            self._handed[begin] = end
            self._keep(work.compute(begin, end, min(self._seconds, until - perf_counter())))

    @property
    def seconds_left(self) -> float:
        """What all that is left would take one process [s]."""
        return self.left * self._seconds / self._size

    def _hand_out(self, pool: Pool) -> None:
        """As many chunks as there is room for; suspects one by one, each alone."""
        if self._suspects:
            if not pool.busy():
                self._submit(pool, *self._suspects.popleft())
            return
        for _ in range(room := max(pool.room(), 0)):
            if self._todo:
                self._submit(pool, *self._next(room + len(self._handed)))

    def _submit(self, pool: Pool, begin: int, end: int) -> None:
        self._handed[begin] = end
        pool.submit(begin, end, MOST_SECONDS * self._seconds)

    def _next(self, places: int) -> Range:
        """The next points to hand out, so that there are some for all places of the pool to the last."""
        begin, end = self._todo.popleft()
        share = self.left // (LAST_SHARES * places) if places > 1 else self.left
        last = begin + max(1, min(int(self._size), share))
        if end > last:
            self._todo.appendleft((last, end))
        return begin, min(end, last)

    def _keep(self, chunk: Chunk) -> None:
        """Let a chunk be kept; what it did not come to is handed out again."""
        self._append(chunk)
        end, count = self._handed.pop(chunk.begin), chunk.end - chunk.begin
        if chunk.end < end:
            self._todo.appendleft((chunk.end, end))
        thought = count * self._seconds / max(chunk.seconds, 1e-9)
        self._size = (
            max(1.0, min(thought, GROWTH * self._size))
            if count >= self._size / GROWTH or thought < self._size
            else self._size
        )
        self.left -= count
        self._progress(count)

    def _missed(self, back: Lost) -> None:
        """Points that did not come back are computed again: alone, because one of them may be what their process died of."""
        begin, end = back.begin, self._handed.pop(back.begin)
        if not back.suspect:
            self._todo.appendleft((begin, end))
            return
        LOGGER.warning("a worker died: points %d to %d are computed again", begin, end - 1)
        if not back.guilty:
            self._suspects.append((begin, end))
        elif end - begin > 1:
            middle = (begin + end) // 2
            self._suspects.extendleft([(middle, end), (begin, middle)])
        else:
            self._deaths[begin] = self._deaths.get(begin, 0) + 1
            if self._deaths[begin] < MOST_DEATHS:
                self._suspects.appendleft((begin, end))
            else:
                self._handed[begin] = end
                self._keep(lost(begin, MOST_DEATHS))
