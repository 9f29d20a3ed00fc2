"""The geometry of the scene page."""

from __future__ import annotations

import pygame
import pytest
from softcradle.sandbox.window.page_geometry import geometry


@pytest.mark.parametrize("size", [(800, 480), (1280, 720), (2560, 1440)])
@pytest.mark.parametrize("rows", [[], [3], [3, 2], [4, 4]])
@pytest.mark.parametrize("lanes", [1, 2])
@pytest.mark.parametrize("panel", [True, False])
def test_nothing_on_the_page_overlaps_or_leaves_the_window(size, rows, lanes, panel):
    places = geometry(size, size[1] / 720, lanes, rows, panel)
    boxes = [places.toolbar, places.footer, *places.lanes, *(rect for row in places.plots for rect in row)]
    boxes += [places.insets] * bool(places.insets.height) + [places.panel] * bool(places.panel.width)
    for k, box in enumerate(boxes):
        assert pygame.Rect((0, 0), size).contains(box)
        assert box.collidelist(boxes[k + 1 :]) == -1
