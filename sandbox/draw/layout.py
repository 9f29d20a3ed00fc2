"""Where things are: rectangles in pixels from the size of the picture and the number of lanes, nothing else."""

from __future__ import annotations

from dataclasses import dataclass

from pygame import Rect

DESIGN_HEIGHT = 720.0  # all lengths below are pixels of a picture that high; `unit` scales them
DESIGN_WIDTH = 1000.0  # narrower pictures shrink too
MARGIN, HEADER, FOOT, GUTTER = 28.0, 82.0, 14.0, 22.0
LOUPE_ROW, LOUPE_ROW_NARROW, SHARE_ROW = 92.0, 76.0, 40.0


@dataclass(frozen=True)
class LaneLayout:
    """Rectangles of one lane: beads, loupes below them, energy and momentum bars, and one panel a plot."""

    stage: Rect
    loupes: Rect
    shares: Rect
    panels: tuple[Rect, ...]


@dataclass(frozen=True)
class Layout:
    """Rectangles of a picture; `unit` is how many pixels a pixel of the 720-pixel design is."""

    unit: float
    header: Rect
    lanes: tuple[LaneLayout, ...]


def layout(size: tuple[int, int], lanes: int) -> Layout:
    """One lane: beads above three panels. More: a row each, beads on the left, two panels on the right."""
    unit = min(size[1] / DESIGN_HEIGHT, size[0] / DESIGN_WIDTH)
    margin = MARGIN * unit
    inner = size[0] - 2 * margin
    header = _rect(margin, 16 * unit, inner, (HEADER - 16) * unit)
    top, height = HEADER * unit, size[1] - (HEADER + FOOT) * unit
    if lanes == 1:
        return Layout(unit, header, (_single(margin, top, inner, height, unit),))
    row = height / lanes
    rows = tuple(_row(margin, top + k * row, inner, row - GUTTER * unit / 2, unit) for k in range(lanes))
    return Layout(unit, header, rows)


def _single(x: float, y: float, width: float, height: float, unit: float) -> LaneLayout:
    loupes, shares, gutter = LOUPE_ROW * unit, SHARE_ROW * unit, GUTTER * unit
    stage = 0.42 * height
    panels = y + stage + loupes + 0.5 * gutter
    panel_height = y + height - shares - 0.5 * gutter - panels
    panel_width = (width - 2 * gutter) / 3
    return LaneLayout(
        _rect(x, y, width, stage),
        _rect(x, y + stage, width, loupes),
        _rect(x, y + height - shares, width, shares),
        tuple(_rect(x + k * (panel_width + gutter), panels, panel_width, panel_height) for k in range(3)),
    )


def _row(x: float, y: float, width: float, height: float, unit: float) -> LaneLayout:
    left = 0.61 * width
    shares = SHARE_ROW * unit
    loupes = LOUPE_ROW_NARROW * unit if height > 220 * unit else 0.0
    side, side_width = x + left + GUTTER * unit, width - left - GUTTER * unit
    panel = (height - 8 * unit) / 2
    return LaneLayout(
        _rect(x, y, left, height - loupes - shares),
        _rect(x, y + height - loupes - shares, left, loupes),
        _rect(x, y + height - shares, left, shares),
        tuple(_rect(side, y + k * (panel + 8 * unit), side_width, panel) for k in range(2)),
    )


def _rect(x: float, y: float, width: float, height: float) -> Rect:
    return Rect(round(x), round(y), round(x + width) - round(x), round(y + height) - round(y))
