"""The pace: wall time into whole frames, within a budget. What does not fit is dropped: the clock slows."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from softcradle.sandbox.session.lane_setup import FRAME_RATE

BUDGET = 0.010  # wall seconds of physics in one tick: the rest of a 60th of a second belongs to drawing
LONGEST_TICK = 0.25  # wall seconds: after a pause of the whole program the model does not catch up
MEMORY = 0.5  # wall seconds over which the clock ratio is averaged


class Pace:
    """How many frames are due, and how well the clock is kept.

    Attributes:
        clock_ratio: model time gone by over what the slow motion promised; 1.0 on time, averaged over half a second.
        milliseconds: wall time a frame takes, averaged likewise.
    """

    def __init__(self, budget: float = BUDGET, clock: Callable[[], float] = perf_counter) -> None:
        self.budget, self.clock = budget, clock
        self.due = 0.0  # frames, within half of one of what the wall clock says
        self.clock_ratio, self.milliseconds = 1.0, 0.0

    def run(self, wall_seconds: float, frame: Callable[[], bool]) -> int:
        """Call `frame` as often as `wall_seconds` ask for and the budget allows, but once if due; returns how often.

        A `frame` that returns False was the last.
        """
        wanted = min(max(wall_seconds, 0.0), LONGEST_TICK)
        self.due += wanted * FRAME_RATE
        count = done = round(self.due)
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
        self.due -= count
        self._average(wall_seconds, wanted * FRAME_RATE, dropped, 1e3 * (now - began) / done if done else None)
        return done

    def _average(self, wall_seconds: float, wanted: float, dropped: int, milliseconds: float | None) -> None:
        share = min(1.0, max(wall_seconds, 1e-3) / MEMORY)
        if wanted > 0.0:
            ratio = min(1.0, max(0.0, 1.0 - dropped / max(wanted, 1.0)))
            self.clock_ratio += share * (ratio - self.clock_ratio)
        if milliseconds is not None:
            self.milliseconds += share * (milliseconds - self.milliseconds) if self.milliseconds else milliseconds

    def forget(self) -> None:
        """Begin anew, after a pause: nothing is due, nothing is late."""
        self.due, self.clock_ratio = 0.0, 1.0
