"""Frame pacing: convert wall time into whole frames within a budget. Frames beyond it are dropped, so the clock slows
down.
"""

from collections.abc import Callable
from time import perf_counter

from softcradle.sandbox.story.live_rules import FRAME_RATE

BUDGET = 0.010  # wall seconds of physics in one tick; the rest of a 60th of a second is for drawing
LONGEST_TICK = 0.25  # longest tick in wall seconds; the model does not catch up after a pause of the whole program
AVERAGED = 0.5  # wall seconds over which clock ratio and milliseconds are averaged


class FramePacer:
    """Counter of due frames, and measure of the accuracy of the clock.

    Attributes:
        clock_ratio: elapsed model time relative to the set slow motion; 1.0 is on time; averaged over half a second.
        milliseconds: wall time of a frame, averaged in the same way.
        due: frames not yet computed, within half a frame of the wall clock.
    """

    def __init__(self, budget: float = BUDGET, clock: Callable[[], float] = perf_counter) -> None:
        self.budget, self.clock = budget, clock
        self.due = 0.0
        self.clock_ratio, self.milliseconds = 1.0, 0.0

    def run(self, wall_seconds: float, frame: Callable[[], bool], rate: float = FRAME_RATE) -> int:
        """Call `frame` for every frame due in `wall_seconds` that fits the budget, at least once; return how many ran.

        There are `rate` frames in a wall second. If `frame` returns False, it did not run, and no more frames are due.
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
        """Reset after a pause: no frame is due, and the clock is on time."""
        self.due, self.clock_ratio = 0.0, 1.0
