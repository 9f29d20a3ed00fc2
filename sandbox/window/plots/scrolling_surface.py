"""A sheet: what a live plot has inked, in columns of pixels that scroll with time; new columns come first.

Columns are counted from t = 0, so scrolling moves pixels and never redraws them. After a change of scale they are inked
again from the newest backwards, a few in each frame: no frame is late because of a plot.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pygame

MARGIN = 4  # columns inked again at the newest end, where the line goes on


class Sheet:
    """The inked area of one plot.

    Arguments:
        ground: what it looks like without ink; the same in every column.
        ink: draws columns `first` to `last` (not included) of it: `ink(first, last) -> surface` that wide.
    """

    def __init__(self, ground: pygame.Surface, ink: Callable[[int, int], pygame.Surface]) -> None:
        self.ground, self.surface, self.ink = ground, ground.copy(), ink
        self.left = 0  # column at the left edge
        self.low = self.high = 0  # columns inked: low to high, not included

    @property
    def width(self) -> int:
        """Pixels."""
        return self.surface.get_width()

    def forget(self) -> None:
        """What is inked is stale."""
        self.low = self.high = 0

    def cut(self, column: int) -> None:
        """Columns from `column` on are stale."""
        self.high = max(self.low, min(self.high, column))

    def scroll(self, left: int) -> None:
        """Put column `left` at the left edge."""
        by, self.left = left - self.left, left
        if abs(by) >= self.width:
            self.forget()
        elif by:
            self.surface.scroll(-by, 0)
            self._clear(0 if by < 0 else self.width - by, abs(by))
            self.low, self.high = max(self.low, left), min(self.high, left + self.width)

    def update(self, first: float, last: float, grown: bool, budget: int) -> int:
        """Ink towards all columns from `first` to `last`, those of the history; returns how many columns it did.

        `grown` says whether the newest column has changed since the last call.
        """
        oldest, newest = max(self.left, math.floor(first)), min(self.left + self.width, math.floor(last) + 1)
        if newest <= oldest:
            self._clear(0, self.width)
            self.forget()
            return 0
        if self.high <= self.low or self.low >= newest or self.high <= oldest:
            self.low = self.high = newest
            self._clear(0, self.width)
        done = self._newer(newest, oldest, budget) if grown or newest != self.high else 0
        if done < budget and self.low > oldest:
            done += self._older(oldest, budget - done)
        return done

    def _newer(self, newest: int, oldest: int, budget: int) -> int:
        start = max(self.low, oldest, min(self.high, newest) - MARGIN)
        if newest - start > max(budget, 3 * MARGIN):
            self.low = start = newest - budget
        self._do(start, newest)
        self.low, self.high = min(self.low, start), newest
        self._clear(newest - self.left, self.width)
        return newest - start

    def _older(self, oldest: int, budget: int) -> int:
        start = max(oldest, self.low - budget)
        self._do(start, self.low)
        done, self.low = self.low - start, start
        return done

    def _do(self, first: int, last: int) -> None:
        if last > first:
            self.surface.blit(self.ink(first, last), (first - self.left, 0))

    def _clear(self, x: int, width: int) -> None:
        place = pygame.Rect(x, 0, width, self.surface.get_height())
        self.surface.blit(self.ground, place, place)
