"""The scrolling surface: every column in its place, within the budget, none of a dropped branch."""

from __future__ import annotations

import pygame
from softcradle.sandbox.window.plots.curves import ScrollingSurface


class Columns:
    """Draws the number of each column into its pixels, and records which it drew."""

    def __init__(self):
        self.drawn = []

    def __call__(self, first, last):
        self.drawn += range(first, last)
        made = pygame.Surface((last - first, 4), 0, 32)
        for x in range(last - first):
            made.fill(((first + x) % 256, 1, 0), (x, 0, 1, 4))
        return made


def pixels(surface):
    return [tuple(surface.surface.get_at((x, 0)))[:2] for x in range(surface.width)]


def test_every_column_is_in_its_place_after_any_scrolling():
    ground = pygame.Surface((50, 4), 0, 32)
    columns = Columns()
    surface = ScrollingSurface(ground, columns)
    for left, first, last in ((0, 0.0, 20.5), (0, 0.0, 49.9), (30, 0.0, 70.0), (10, 5.0, 70.0), (200, 150.0, 240.0)):
        surface.scroll(left)
        for _ in range(20):
            surface.update(first, last, True, 10)
        for x, pixel in enumerate(pixels(surface)):
            column = left + x
            assert pixel == ((column % 256, 1) if int(first) <= column <= int(last) else (0, 0))


def test_an_update_stays_within_its_budget_and_draws_nothing_twice():
    columns = Columns()
    surface = ScrollingSurface(pygame.Surface((50, 4), 0, 32), columns)
    surface.update(0.0, 49.0, True, 10)
    assert len(columns.drawn) <= 12
    for _ in range(10):
        surface.update(0.0, 49.0, False, 10)
    columns.drawn.clear()
    surface.update(0.0, 49.0, False, 10)
    assert columns.drawn == []


def test_columns_of_a_dropped_branch_are_cleared():
    columns = Columns()
    surface = ScrollingSurface(pygame.Surface((50, 4), 0, 32), columns)
    for _ in range(10):
        surface.update(0.0, 40.0, True, 10)
    surface.invalidate_from(20)
    surface.update(0.0, 21.0, True, 10)
    assert pixels(surface)[22:] == [(0, 0)] * 28
