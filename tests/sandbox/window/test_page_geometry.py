"""The geometry of the scene page."""

from __future__ import annotations

from itertools import product

import pygame
import pytest
from softcradle.sandbox.window.page_geometry import geometry


@pytest.mark.parametrize("size", [(800, 480), (1280, 720), (2560, 1440)])
def test_nothing_on_the_page_overlaps_or_leaves_the_window(size):
    for rows, lanes, panel in product(([], [3], [3, 2], [4, 4]), (1, 2), (True, False)):
        boxes_are_apart(size, rows, lanes, panel)


def boxes_are_apart(size, rows, lanes, panel):
    places = geometry(size, size[1] / 720, lanes, rows, panel)
    boxes = [places.toolbar, places.footer, *places.lanes, *(rect for row in places.plots for rect in row)]
    boxes += [places.insets] * bool(places.insets.height) + [places.panel] * bool(places.panel.width)
    for k, box in enumerate(boxes):
        assert pygame.Rect((0, 0), size).contains(box)
        assert box.collidelist(boxes[k + 1 :]) == -1
