"""Layout of the page on which a scene is played. It computes rectangles in pixels from the window size and the visible
parts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pygame import Rect
from softcradle.sandbox.window.widgets import split, stack

TOOLBAR = 48.0  # Height of the toolbar in design pixels.
FOOTER = 92.0  # Height of the footer in design pixels.
PANEL = 288.0  # Width of the panel in design pixels.
INSETS = 84.0  # Height of the insets in design pixels.
ENERGY_BARS = 36.0  # Height of the energy bars in design pixels.
GUTTER = 24.0  # Distance between two plots in design pixels.
MARGIN = 14.0  # Margin around beads and plots in design pixels.
# Smallest height of a lane in design pixels. Plots, insets and energy bars are made smaller before a lane becomes
# lower.
LEAST_LANE = 120.0
# Preferred height of a lane in design pixels: in the Lab (False), and in Explore (True). At this height, the bars of
# two forces can be compared. Explore shows more of the beads. To reach this height, plots are reduced down to PLOT_ROW.
LANE = {False: 150.0, True: 180.0}
LANE_GAP = 4.0  # Distance between two lanes in design pixels.
# Smallest height of a row of plots in design pixels. It leaves space for three labels below each other.
PLOT_ROW = 96.0
# Height of the plots as a fraction of the main area. The keys are numbers of rows.
PLOTS_SHARE = {0: 0.0, 1: 0.44, 2: 0.53, 3: 0.6, 4: 0.66}
EXPLORED = 0.85  # Factor by which PLOTS_SHARE is reduced in Explore, where the beads get more space.
MOST_PLOTS_SHARE = 0.7  # Height of the plots as a fraction of the main area, for more than four rows.


@dataclass(frozen=True)
class Geometry:
    """Rectangles of a page, in pixels.

    Attributes:
        toolbar, footer: the bar at the top, and the area with timeline and time controls at the bottom.
        panel: the panel on the right; empty if it is hidden.
        lanes: for each lane, the rectangle in which its beads are drawn.
        insets: the area below a single lane; empty if there are more lanes or too little space.
        energy_bars: the energy bars of a single lane; empty if there are more lanes or too little space.
        plots: rows of rectangles, one rectangle for each plot.
    """

    toolbar: Rect
    footer: Rect
    panel: Rect
    lanes: tuple[Rect, ...]
    insets: Rect
    energy_bars: Rect
    plots: tuple[tuple[Rect, ...], ...]


def geometry(
    size: tuple[int, int],
    unit: float,
    lanes: int,
    plots: Sequence[int],
    panel: bool,
    explore: bool = False,
) -> Geometry:
    """Return the layout for a window of `size`. `plots` contains the number of plots in each row.

    If `explore`, the page has neither insets nor energy bars. The function `fitting` returns how many rows of plots
    fit.
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
    if lanes == 1 and not explore:
        high = max(least, min(high, main.height - (LANE[False] + INSETS) * unit))
    high = round(high)
    above = Rect(main.left, main.top, main.width, main.height - high)
    gap = round(8 * unit)
    below = Rect(main.left, main.bottom - high + gap, main.width, max(0, high - gap))
    beads, insets, bars = _beads(above, unit, lanes, len(rows) < 2, explore)
    return Geometry(toolbar, footer, right, beads, insets, bars, _plots(below, unit, rows))


def least_height(lanes: int) -> float:
    """Return the smallest height of a window [design pixels] in which all lanes and a row of plots fit in Explore."""
    beads = LANE[False] if lanes == 1 else _lanes_height(lanes, LEAST_LANE)
    return TOOLBAR + FOOTER + MARGIN + beads + PLOT_ROW + 1.0  # Add one pixel for rounding.


def _lanes_height(lanes: int, each: float) -> float:
    """Return the total height of `lanes` lanes in design pixels, if each has the height `each`."""
    return lanes * each + (lanes - 1) * LANE_GAP


def fitting(size: tuple[int, int], unit: float, lanes: int, explore: bool) -> int:
    """Return the number of rows of plots that fit. The user can scroll to the other rows.

    A single lane in the Lab always keeps its insets, because such a scene is meant to show its smallest overlap.
    """
    main = size[1] - (TOOLBAR + FOOTER + MARGIN) * unit
    low = LEAST_LANE if lanes > 1 else LANE[False] + (0.0 if explore else INSETS)
    return max(0, int((main - _lanes_height(lanes, low) * unit) / (PLOT_ROW * unit)))


def plots_width(size: tuple[int, int], unit: float, panel: bool) -> float:
    """Return the width of a row of plots in design pixels."""
    return size[0] / unit - (PANEL if panel else 0.0) - 2.0 * MARGIN


def _beads(rect: Rect, unit: float, lanes: int, roomy: bool, explore: bool) -> tuple[tuple[Rect, ...], Rect, Rect]:
    """Return the rectangles of the lanes, the insets and the energy bars.

    Insets and energy bars are empty if the lanes would otherwise become too low.
    """
    if lanes > 1 or explore:
        none = Rect(rect.left, rect.bottom, rect.width, 0)
        return tuple(stack(rect, [0.0] * lanes, unit, LANE_GAP)), none, none
    insets = round(INSETS * unit) if rect.height >= (LEAST_LANE + INSETS) * unit else 0
    bars = round(ENERGY_BARS * unit) if roomy and rect.height - insets > (LEAST_LANE + ENERGY_BARS) * unit else 0
    lane = Rect(rect.left, rect.top, rect.width, rect.height - insets - bars)
    below = Rect(rect.left, lane.bottom, rect.width, insets)
    return (lane,), below, Rect(rect.left, below.bottom, rect.width, bars)


def _plots(rect: Rect, unit: float, counts: Sequence[int]) -> tuple[tuple[Rect, ...], ...]:
    """Return the rectangles of the plots, row by row. All rows have the same height. Plots in the same row have the
    same width.
    """
    rows = stack(rect, [0.0] * len(counts), unit, 2.0)
    return tuple(tuple(split(row, [0.0] * count, unit, GUTTER)) for row, count in zip(rows, counts, strict=True))
