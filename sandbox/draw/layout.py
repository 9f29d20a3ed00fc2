"""The layout of a picture: its rectangles in pixels, from its size and the number of lanes."""

from __future__ import annotations

from dataclasses import dataclass

from pygame import Rect

# Design pixels: pixels of a picture with the height DESIGN_HEIGHT, or with the width DESIGN_WIDTH if it is narrower. All
# lengths below are design pixels; `unit` scales them.
DESIGN_HEIGHT = 720.0
DESIGN_WIDTH = 1000.0
MARGIN = 28.0  # left and right of everything
HEADER = 82.0  # height, margin above included
FOOTER = 14.0  # free height below everything
GUTTER = 22.0  # between panels
INSETS_HEIGHT = 92.0  # of the row of magnified insets of a single lane
INSETS_HEIGHT_IN_ROW = 76.0  # of the row of magnified insets where there are several lanes
BARS_HEIGHT = 40.0  # of the row of energy and momentum bars


@dataclass(frozen=True)
class LaneLayout:
    """Rectangles of one lane: drawing of its beads, magnified insets, energy and momentum bars, a panel for each plot."""

    drawing: Rect
    insets: Rect
    bars: Rect
    panels: tuple[Rect, ...]


@dataclass(frozen=True)
class Layout:
    """Rectangles of a picture; `unit` is the length of a design pixel [pixels]."""

    unit: float
    header: Rect
    lanes: tuple[LaneLayout, ...]


def picture_layout(size: tuple[int, int], lanes: int) -> Layout:
    """The layout of a picture of `size` [pixels].

    A single lane has its beads above three panels; of several, each has a row, beads on the left and two panels on the right.
    """
    unit = min(size[1] / DESIGN_HEIGHT, size[0] / DESIGN_WIDTH)
    margin = MARGIN * unit
    inner = size[0] - 2 * margin
    header = _rect(margin, 16 * unit, inner, (HEADER - 16) * unit)
    top, height = HEADER * unit, size[1] - (HEADER + FOOTER) * unit
    if lanes == 1:
        return Layout(unit, header, (_single(margin, top, inner, height, unit),))
    row = height / lanes
    rows = tuple(_row(margin, top + k * row, inner, row - GUTTER * unit / 2, unit) for k in range(lanes))
    return Layout(unit, header, rows)


def _single(x: float, y: float, width: float, height: float, unit: float) -> LaneLayout:
    insets, bars, gutter = INSETS_HEIGHT * unit, BARS_HEIGHT * unit, GUTTER * unit
    drawing = 0.42 * height
    panels = y + drawing + insets + 0.5 * gutter
    panel_height = y + height - bars - 0.5 * gutter - panels
    panel_width = (width - 2 * gutter) / 3
    return LaneLayout(
        _rect(x, y, width, drawing),
        _rect(x, y + drawing, width, insets),
        _rect(x, y + height - bars, width, bars),
        tuple(_rect(x + k * (panel_width + gutter), panels, panel_width, panel_height) for k in range(3)),
    )


def _row(x: float, y: float, width: float, height: float, unit: float) -> LaneLayout:
    left = 0.61 * width
    bars = BARS_HEIGHT * unit
    insets = INSETS_HEIGHT_IN_ROW * unit if height > 220 * unit else 0.0
    side, side_width = x + left + GUTTER * unit, width - left - GUTTER * unit
    panel = (height - 8 * unit) / 2
    return LaneLayout(
        _rect(x, y, left, height - insets - bars),
        _rect(x, y + height - insets - bars, left, insets),
        _rect(x, y + height - bars, left, bars),
        tuple(_rect(side, y + k * (panel + 8 * unit), side_width, panel) for k in range(2)),
    )


def _rect(x: float, y: float, width: float, height: float) -> Rect:
    return Rect(round(x), round(y), round(x + width) - round(x), round(y + height) - round(y))
