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
LEAST_LANE = 120.0  # design pixels of the beads, below which insets and energy bars go
LOW_LANE = 150.0  # design pixels of each of two lanes, below which bars of forces have no room and plots give way
LOWEST_LANE = 130.0  # design pixels of each of two lanes, for which there are fewer rows of plots
PLOTS_SHARE = {0: 0.0, 1: 0.44, 2: 0.53, 3: 0.6, 4: 0.66}  # of the height, for so many rows of plots
EXPLORED = 0.85  # of that share, where beads are more than plots
ROW_BESIDE_CARD = 96.0  # design pixels of a row of plots, to which it gives way for a card; then lanes do
LANE_BESIDE_CARD = {
    1: 190.0,
    2: 130.0,
}  # design pixels of a lane, by how many there are, to which it does; then rows of plots go
LEAST_PLOT_ROW = 66.0  # design pixels, the height of a row of plots
PLOT_ROW = 80.0  # design pixels of a row of plots, to which it gives way
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
        plots: rows of rectangles, one for each plot.
    """

    toolbar: Rect
    footer: Rect
    panel: Rect
    lanes: tuple[Rect, ...]
    insets: Rect
    energy_bars: Rect
    plots: tuple[tuple[Rect, ...], ...]

    @property
    def below_beads(self) -> Rect:
        """The rectangle from the foot of lanes, insets and energy bars to the footer."""
        left, bottom = self.lanes[0].left, self.energy_bars.bottom
        return Rect(left, bottom, self.lanes[0].width, self.footer.top - bottom)


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

    A `card` so high [pixels] has room between beads and plots, which give way to it.
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
    if lanes > 1 and rows:
        needed = len(rows) * PLOT_ROW * unit  # what is beyond, low lanes need more for their bars
        spare = main.height - lanes * LOW_LANE * unit
        most = main.height - lanes * LOWEST_LANE * unit
        share = min(share, max(needed, spare) / main.height, max(most, LEAST_PLOT_ROW * unit) / main.height)
    plots_height = main.height * share
    if card:
        plots_height = max(plots_height - card, min(plots_height, len(rows) * ROW_BESIDE_CARD * unit))
    above = Rect(main.left, main.top, main.width, round(main.height - plots_height - card))
    top = above.bottom + round(8 * unit) + card
    below = Rect(main.left, top, main.width, max(round(LEAST_PLOT_ROW * unit), main.bottom - top))
    beads, insets, bars = _beads(
        above, unit, lanes, len(rows) < 2 and not card, explore, LANE_BESIDE_CARD[1] if card else LEAST_LANE
    )
    return Geometry(toolbar, footer, right, beads, insets, bars, _plots(below, unit, rows))


def plots_width(size: tuple[int, int], unit: float, panel: bool) -> float:
    """Design pixels of a row of plots."""
    return size[0] / unit - (PANEL if panel else 0.0) - 2.0 * MARGIN


def most_plot_rows(size: tuple[int, int], unit: float, lanes: int, card: int = 0) -> int:
    """Rows of plots for which there is room beside so many lanes and a `card` so high [pixels]; others are scrolled to."""
    main = size[1] / unit - TOOLBAR - FOOTER - MARGIN
    if card:
        return max(0, int((main - card / unit - lanes * LANE_BESIDE_CARD[lanes]) / ROW_BESIDE_CARD))
    room = min(MOST_PLOTS_SHARE * main, main - lanes * LOWEST_LANE) if lanes > 1 else MOST_PLOTS_SHARE * main
    return max(1, int(room / LEAST_PLOT_ROW))


def _beads(
    rect: Rect, unit: float, lanes: int, roomy: bool, explore: bool, least: float
) -> tuple[tuple[Rect, ...], Rect, Rect]:
    """Rectangles of the lanes, the insets and the energy bars, which go where one lane would be lower than `least`."""
    if lanes > 1 or explore:
        none = Rect(rect.left, rect.bottom, rect.width, 0)
        pitch, gap = rect.height / lanes, round(4 * unit)
        rects = [Rect(rect.left, round(rect.top + k * pitch), rect.width, round(pitch) - gap) for k in range(lanes)]
        return tuple(rects), none, none
    bars = round(ENERGY_BARS * unit) if roomy and rect.height > (least + ENERGY_BARS) * unit else 0
    insets = round(INSETS * unit) if rect.height - bars > (least + INSETS) * unit else 0
    lane = Rect(rect.left, rect.top, rect.width, rect.height - insets - bars)
    below = Rect(rect.left, lane.bottom, rect.width, insets)
    return (lane,), below, Rect(rect.left, below.bottom, rect.width, bars)


def _plots(rect: Rect, unit: float, counts: Sequence[int]) -> tuple[tuple[Rect, ...], ...]:
    """Rows of rectangles of equal height and, in a row, of equal width."""
    rows = stack(rect, [0.0] * len(counts), unit, 2.0)
    return tuple(tuple(split(row, [0.0] * count, unit, GUTTER)) for row, count in zip(rows, counts, strict=True))
