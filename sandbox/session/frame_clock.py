"""A clock that is set, in place of the wall clock: for pictures and tests that do not depend on load."""

from __future__ import annotations


class FrameClock:
    """A clock that moves only when `now` is set.

    Attributes:
        now: the time that it tells [s].
    """

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        """The time [s]."""
        return self.now
