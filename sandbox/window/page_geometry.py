"""Where things are on the page on which a scene is played; rectangles in pixels, from sizes and what is shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pygame import Rect

TOP, FOOT, SIDE = 48.0, 92.0, 288.0  # design pixels: bar above, time below, panel on the right
LOUPES, SHARES, GUTTER, MARGIN = 84.0, 36.0, 12.0, 14.0
LEAST_STAGE = 120.0


@dataclass(frozen=True)
class Geometry:
    """Rectangles of a page.

    Attributes:
        top, foot: the bar above and the two rows of time controls below.
        side: the panel on the right, or an empty rectangle.
        stages: beads, one a lane.
        loupes: below the only lane; empty where there are more or no room.
        shares: energy and momentum bars of the only lane; empty likewise.
        plots: one row a lane, one rectangle a plot.
    """

    top: Rect
    foot: Rect
    side: Rect
    stages: tuple[Rect, ...]
    loupes: Rect
    shares: Rect
    plots: tuple[tuple[Rect, ...], ...]


def geometry(size: tuple[int, int], unit: float, lanes: int, plots: Sequence[int], side: bool) -> Geometry:
    """`plots` is the number of plots in each row."""
    width, height = size
    top = Rect(0, 0, width, round(TOP * unit))
    foot = Rect(0, height - round(FOOT * unit), width, round(FOOT * unit))
    side_width = round(SIDE * unit) if side else 0
    panel = Rect(width - side_width, top.bottom, side_width, foot.top - top.bottom)
    main = Rect(0, top.bottom, width - side_width, foot.top - top.bottom)
    main = main.inflate(-2 * round(MARGIN * unit), -round(MARGIN * unit))
    rows = sum(1 for count in plots if count)
    share = {0: 0.0, 1: 0.44, 2: 0.53, 3: 0.6}.get(rows, 0.62)
    beads = Rect(main.left, main.top, main.width, round(main.height * (1.0 - share)))
    stages, loupes, shares = _beads(beads, unit, lanes, rows < 2)
    below = Rect(main.left, beads.bottom + round(8 * unit), main.width, main.bottom - beads.bottom - round(8 * unit))
    return Geometry(top, foot, panel, stages, loupes, shares, _plots(below, unit, [n for n in plots if n]))


def _beads(rect: Rect, unit: float, lanes: int, roomy: bool) -> tuple[tuple[Rect, ...], Rect, Rect]:
    none = Rect(rect.left, rect.bottom, rect.width, 0)
    if lanes > 1:
        pitch = rect.height / lanes
        gap = round(4 * unit)
        stages = [Rect(rect.left, round(rect.top + k * pitch), rect.width, round(pitch) - gap) for k in range(lanes)]
        return tuple(stages), none, none
    shares = round(SHARES * unit) if roomy and rect.height > (LEAST_STAGE + SHARES) * unit else 0
    loupes = round(LOUPES * unit) if rect.height - shares > (LEAST_STAGE + LOUPES) * unit else 0
    stage = Rect(rect.left, rect.top, rect.width, rect.height - loupes - shares)
    return (
        (stage,),
        Rect(rect.left, stage.bottom, rect.width, loupes),
        Rect(rect.left, stage.bottom + loupes, rect.width, shares),
    )


def _plots(rect: Rect, unit: float, counts: Sequence[int]) -> tuple[tuple[Rect, ...], ...]:
    if not counts:
        return ()
    gutter = GUTTER * unit
    high = (rect.height - (len(counts) - 1) * 2 * unit) / len(counts)
    rows = []
    for k, count in enumerate(counts):
        wide = (rect.width - (count - 1) * gutter) / count
        y = rect.top + k * (high + 2 * unit)
        rows.append(
            tuple(
                Rect(round(rect.left + i * (wide + gutter)), round(y), round(wide), round(high)) for i in range(count)
            )
        )
    return tuple(rows)
