"""Checkpoints of a run in Python: what it keeps on its way, from which samples are taken when its end is known."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

Kept = TypeVar("Kept")

MOST = 512  # checkpoints of a run


class CheckpointList(Generic[Kept]):
    """What a run keeps every few steps; where it is full, every second one goes and the steps between them double.

    Attributes:
        items: what is kept, in order.
        due: steps after which the next one is kept.
    """

    def __init__(self, spacing: int) -> None:
        """With `spacing` steps between two at first."""
        self.items: list[Kept] = []
        self.due = 0
        self._spacing = spacing

    def offer(self, steps: int, make: Callable[[], Kept]) -> None:
        """Keep what `make` gives, if it is due after so many `steps` of the run."""
        if steps < self.due:
            return
        if len(self.items) == MOST:
            self.items = self.items[::2]
            self._spacing *= 2
        self.items.append(make())
        self.due = steps + self._spacing
