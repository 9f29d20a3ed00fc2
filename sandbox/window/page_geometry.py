"""The geometry of the page on which a scene is played: rectangles in pixels, from sizes and what is shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pygame import Rect
from softcradle.sandbox.window.widgets import split, stack

TOOLBAR = 48.0  # design pixels, its height
FOOTER = 92.0  # design pixels, its height
PANEL = 288.0  # design pixels, its width
INSETS = 84.0  # design pixels, their height
ENERGY_BARS = 36.0  # design pixels, their height
GUTTER = 24.0  # design pixels between two plots
MARGIN = 14.0  # design pixels around beads and plots
LEAST_LANE = 120.0  # design pixels of a lane, the least: plots, a card, insets and energy bars give way
# Design pixels of a lane in which bars of forces can be compared, in the Lab and where beads are more than plots: what plots
# have beyond PLOT_ROW gives way to it.
LANE = {False: 150.0, True: 180.0}
LANE_GAP = 4.0  # design pixels between two lanes
PLOT_ROW = 96.0  # design pixels of a row of plots, the least: three labels below each other
PLOTS_SHARE = {0: 0.0, 1: 0.44, 2: 0.53, 3: 0.6, 4: 0.66}  # of the height, for so many rows of plots
EXPLORED = 0.85  # of that share, where beads are more than plots
MOST_PLOTS_SHARE = 0.7  # of the height, for more rows


@dataclass(frozen=True)
class Geometry:
    """Rectangles of a page.

    Attributes:
        toolbar, footer: above, and the time line and the time controls below.
        panel: on the right; empty where it is hidden.
        lanes: beads of each lane.
        insets: below the only lane; empty where there are more lanes or no room.
        energy_bars: of the only lane; empty likewise.
        card: at the end of a motion, between beads and plots; empty where there is none, or no room.
        plots: rows of rectangles, one for each plot.
    """

    toolbar: Rect
    footer: Rect
    panel: Rect
    lanes: tuple[Rect, ...]
    insets: Rect
    energy_bars: Rect
    card: Rect
    plots: tuple[tuple[Rect, ...], ...]


def geometry(
    size: tuple[int, int],
    unit: float,
    lanes: int,
    plots: Sequence[int],
    panel: bool,
    explore: bool = False,
    card: int = 0,
) -> Geometry:
    """The page for a window of `size`; `plots` is the number of plots in each row; to `explore` there is no more.

    A `card` so high [pixels] is between beads and plots, which give way to it. `fitting` says how many rows, and whether it fits.
    """
    width, height = size
    toolbar = Rect(0, 0, width, round(TOOLBAR * unit))
    foot = round(FOOTER * unit)
    footer = Rect(0, height - foot, width, foot)
    panel_width = round(PANEL * unit) if panel else 0
    right = Rect(width - panel_width, toolbar.bottom, panel_width, footer.top - toolbar.bottom)
    main = Rect(0, toolbar.bottom, width - panel_width, footer.top - toolbar.bottom)
    main = main.inflate(-2 * round(MARGIN * unit), -round(MARGIN * unit))
    rows = [count for count in plots if count]
    share = PLOTS_SHARE.get(len(rows), MOST_PLOTS_SHARE) * (EXPLORED if explore else 1.0)
    least = len(rows) * PLOT_ROW * unit
    high = max(least, min(share * main.height, main.height - _lanes_height(lanes, LANE[explore]) * unit))
    high = round(max(least, high - card))
    above = Rect(main.left, main.top, main.width, main.height - high - card)
    gap = round(8 * unit)
    below = Rect(main.left, main.bottom - high + gap, main.width, max(0, high - gap))
    beads, insets, bars = _beads(above, unit, lanes, len(rows) < 2 and not card, explore)
    between = Rect(main.left, above.bottom, main.width, card)
    return Geometry(toolbar, footer, right, beads, insets, bars, between, _plots(below, unit, rows))


def _lanes_height(lanes: int, each: float) -> float:
    """Design pixels of so many lanes, `each` so high."""
    return lanes * each + (lanes - 1) * LANE_GAP


def fitting(size: tuple[int, int], unit: float, lanes: int, explore: bool, card: int) -> tuple[int, int]:
    """How many rows of plots there is room for, others are scrolled to; and the height of the `card`, 0 where it has none."""
    main = size[1] - (TOOLBAR + FOOTER + MARGIN) * unit
    card = card if card <= main - _lanes_height(lanes, LEAST_LANE) * unit else 0
    low = LANE[True] if card else LANE[False] if explore else LEAST_LANE
    return max(0, int((main - card - _lanes_height(lanes, low) * unit) / (PLOT_ROW * unit))), card


def plots_width(size: tuple[int, int], unit: float, panel: bool) -> float:
    """Design pixels of a row of plots."""
    return size[0] / unit - (PANEL if panel else 0.0) - 2.0 * MARGIN


def _beads(rect: Rect, unit: float, lanes: int, roomy: bool, explore: bool) -> tuple[tuple[Rect, ...], Rect, Rect]:
    """Rectangles of the lanes, the insets and the energy bars, which go where the only lane would be too low."""
    if lanes > 1 or explore:
        none = Rect(rect.left, rect.bottom, rect.width, 0)
        return tuple(stack(rect, [0.0] * lanes, unit, LANE_GAP)), none, none
    bars = round(ENERGY_BARS * unit) if roomy and rect.height > (LEAST_LANE + ENERGY_BARS) * unit else 0
    insets = round(INSETS * unit) if rect.height - bars > (LEAST_LANE + INSETS) * unit else 0
    lane = Rect(rect.left, rect.top, rect.width, rect.height - insets - bars)
    below = Rect(rect.left, lane.bottom, rect.width, insets)
    return (lane,), below, Rect(rect.left, below.bottom, rect.width, bars)


def _plots(rect: Rect, unit: float, counts: Sequence[int]) -> tuple[tuple[Rect, ...], ...]:
    """Rows of rectangles of equal height and, in a row, of equal width."""
    rows = stack(rect, [0.0] * len(counts), unit, 2.0)
    return tuple(tuple(split(row, [0.0] * count, unit, GUTTER)) for row, count in zip(rows, counts, strict=True))
