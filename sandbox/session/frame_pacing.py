"""Frame pacing: the conversion of wall time into whole frames within a time budget.

Frames beyond the budget are dropped, which slows the model clock down.
"""

from collections.abc import Callable
from time import perf_counter

from softcradle.sandbox.story.live_rules import FRAME_RATE

BUDGET = 0.010  # Wall time in seconds for the physics in one tick. The rest of 1/60 s is for drawing.
# Longest tick in seconds of wall time. The model does not make up for a longer pause of the whole program.
LONGEST_TICK = 0.25
AVERAGED = 0.5  # Wall time in seconds over which clock ratio and milliseconds are averaged.


class FramePacer:
    """Counts the frames that are due, and measures the accuracy of the model clock.

    Attributes:
        clock_ratio: elapsed model time relative to the set slow motion; 1.0 if the clock is on time. It is averaged
            over
            half a second.
        milliseconds: wall time of a frame, averaged over half a second.
        due: number of frames that are due but not yet computed, accurate to half a frame.
    """

    def __init__(self, budget: float = BUDGET, clock: Callable[[], float] = perf_counter) -> None:
        self.budget, self.clock = budget, clock
        self.due = 0.0
        self.clock_ratio, self.milliseconds = 1.0, 0.0

    def run(self, wall_seconds: float, frame: Callable[[], bool], rate: float = FRAME_RATE) -> int:
        """Call `frame` for every frame that is due after `wall_seconds`, and return the number of computed frames.

        At least one due frame is computed, and more while the time budget lasts. `rate` is the number of frames per
        second of wall time. If `frame` returns False, no frame was computed, and no further frame is due.
        """
        wanted = min(max(wall_seconds, 0.0), LONGEST_TICK) * rate
        self.due += wanted
        count = done = round(self.due)
        self.due -= count
        began = now = self.clock()
        for k in range(count):
            if k > 0 and now - began + (now - began) / k > self.budget:
                done = k
                break
            going_on = frame()
            now = self.clock()
            if not going_on:
                self.due, count, done = 0.0, k, k
                break
        dropped = count - done
        self._average(wall_seconds, wanted, dropped, 1e3 * (now - began) / done if done else None)
        return done

    def _average(self, wall_seconds: float, wanted: float, dropped: int, milliseconds: float | None) -> None:
        share = min(1.0, max(wall_seconds, 1e-3) / AVERAGED)
        if wanted > 0.0:
            ratio = min(1.0, max(0.0, 1.0 - dropped / max(wanted, 1.0)))
            self.clock_ratio += share * (ratio - self.clock_ratio)
        if milliseconds is not None:
            self.milliseconds += share * (milliseconds - self.milliseconds) if self.milliseconds else milliseconds

    def restart(self) -> None:
        """Reset the pacer after a pause. No frame is due, and the clock is on time."""
        self.due, self.clock_ratio = 0.0, 1.0
