"""A scrolling surface: the drawn curves of a live plot, in columns of pixels that move with time; new columns come first.

Columns are counted from t = 0, so scrolling moves pixels and never draws them again. After a change of scale they are drawn
again from the newest backwards, a few in each frame: no frame is late because of a plot.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pygame

MARGIN = 4  # columns drawn again at the newest end, where the curve goes on


class ScrollingSurface:
    """The curves of one plot.

    Arguments:
        background: what it looks like without curves; the same in every column.
        draw: gives columns `first` to `last` (not included): `draw(first, last) -> surface` that wide.

    Attributes:
        surface: what is drawn.
        left: the column at its left edge.
        low, high: the columns that are drawn: low to high, not included.
    """

    def __init__(self, background: pygame.Surface, draw: Callable[[int, int], pygame.Surface]) -> None:
        self.background, self.surface, self.draw = background, background.copy(), draw
        self.left = 0
        self.low = self.high = 0

    @property
    def width(self) -> int:
        """Pixels."""
        return self.surface.get_width()

    def invalidate(self) -> None:
        """All columns are stale."""
        self.low = self.high = 0

    def invalidate_from(self, column: int) -> None:
        """Columns from `column` on are stale."""
        self.high = max(self.low, min(self.high, column))

    def scroll(self, left: int) -> None:
        """Put column `left` at the left edge."""
        by, self.left = left - self.left, left
        if abs(by) >= self.width:
            self.invalidate()
        elif by:
            self.surface.scroll(-by, 0)
            self._clear(0 if by < 0 else self.width - by, abs(by))
            self.low, self.high = max(self.low, left), min(self.high, left + self.width)

    def update(self, first: float, last: float, grown: bool, budget: int) -> int:
        """Draw about `budget` missing columns of `first` to `last`, those of the history; returns how many it drew.

        `grown` says whether the newest column has changed since the last call.
        """
        oldest, newest = max(self.left, math.floor(first)), min(self.left + self.width, math.floor(last) + 1)
        if newest <= oldest:
            self._clear(0, self.width)
            self.invalidate()
            return 0
        if self.high <= self.low or self.low >= newest or self.high <= oldest:
            self.low = self.high = newest
            self._clear(0, self.width)
        done = self._draw_newer(newest, oldest, budget) if grown or newest != self.high else 0
        if done < budget and self.low > oldest:
            done += self._draw_older(oldest, budget - done)
        return done

    def _draw_newer(self, newest: int, oldest: int, budget: int) -> int:
        start = max(self.low, oldest, min(self.high, newest) - MARGIN)
        if newest - start > max(budget, 3 * MARGIN):
            self.low = start = newest - budget
        self._draw(start, newest)
        self.low, self.high = min(self.low, start), newest
        self._clear(newest - self.left, self.width)
        return newest - start

    def _draw_older(self, oldest: int, budget: int) -> int:
        start = max(oldest, self.low - budget)
        self._draw(start, self.low)
        done, self.low = self.low - start, start
        return done

    def _draw(self, first: int, last: int) -> None:
        if last > first:
            self.surface.blit(self.draw(first, last), (first - self.left, 0))

    def _clear(self, x: int, width: int) -> None:
        place = pygame.Rect(x, 0, width, self.surface.get_height())
        self.surface.blit(self.background, place, place)
