"""Drawing of the work-precision chart.

The error is plotted against wall time and against force evaluations. Each case has a row of panels, and each curve has
a label.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.story.numbers import spread
from softcradle.sandbox.studies.plot_style import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, RED, SKY, new_figure
from softcradle.sandbox.studies.precision.measurement import ChartPoint, Series
from softcradle.sandbox.studies.precision.table import (
    LARGEST_ERROR,
    MeasuredCase,
    curve_rows,
    fitted_order,
    frontier,
    most_exact,
    ratio_sentence,
    series_by_name,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 13.0  # Width of the chart [inches].
ROW_HEIGHT = 4.3  # Height of the row of panels of one case [inches].
SMALLEST_ERROR = 1e-12  # Error at the lower edge of a panel.
EXACT = 1.3 * SMALLEST_ERROR  # Points with an error below SMALLEST_ERROR are drawn at this error.
# Assumed uncertainty of a true result that is known exactly. The uncertainty is used for fitted orders.
ROUND_OFF = 1e-14
LABEL_HEIGHT = 0.042  # Height of a label as a fraction of the height of a panel.
LABEL_COLUMN = 1.06  # Left end of the labels as a fraction of the width of a panel.
COSTS = (("seconds", "wall time of the solver [s]"), ("evaluations", "evaluations of all contact forces"))
ERROR_LABELS = {
    "velocities": "error of final velocities / closing speed",
    "forces": "error of forces / largest force, r.m.s.",
    "overlaps": "relative error of overlaps (App. B), r.m.s.",
}

# Markers of the curves. Our methods have filled markers and solid lines. Other integrators have hollow markers and
# broken lines. The two groups can therefore be distinguished without colour.
MARKERS = "osD^vPX*p<>hd8H"
OUR_COLOURS = (BLUE, ORANGE, GREEN, PURPLE, RED, SKY, BLACK, "#8c6d31", GREY, "#6a0dad")
PEER_COLOURS = (
    "#3b3b3b", "#7a5195", "#ef5675", "#b8860b", "#2f7f7f", "#7f7f7f", "#a05195", "#5a7d2a", "#444499", "#aa5500",
)  # fmt: skip
BROKEN_LINES = ("--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))

Style = dict[str, Any]


def draw_chart(measured: Sequence[MeasuredCase], stamp: str = "") -> Figure:
    """Draw the chart, with the text `stamp` about the machine below. Call it inside `plot_style.styled`."""
    import matplotlib as mpl

    height = ROW_HEIGHT * len(measured)
    # Constrained layout is off because the labels lie outside the panels.
    with mpl.rc_context({"figure.constrained_layout.use": False}):
        figure, panels = new_figure(WIDTH, height, len(measured), 2, squeeze=False)
    figure.subplots_adjust(
        left=0.055, right=0.865, bottom=0.8 / height, top=1.0 - 0.35 / height, wspace=0.44, hspace=0.31
    )
    figure.text(0.055, 0.1 / height, stamp, fontsize=6.5, color=GREY, gid="stamp")
    styles = _styles(measured)
    for found, row in zip(measured, panels, strict=True):
        for axes, (cost, label) in zip(row, COSTS, strict=True):
            _draw_panel(axes, found, cost, styles)
            axes.set_xlabel(label)
        row[0].set_ylabel(ERROR_LABELS[found.quantity])
        row[0].set_title(found.case.label, loc="left", fontsize=11, pad=5)
        row[1].set_title(f"truth: {found.case.source}", loc="left", fontsize=7.5, pad=5, color=GREY)
        if found.quantity == "velocities":
            _draw_note(row[0], ratio_sentence(curve_rows(found)))
    return figure


def _draw_note(axes: Axes, text: str) -> None:
    axes.annotate(
        text, (0.0, 0.0), xycoords="axes fraction", xytext=(0, -36), textcoords="offset points", fontsize=7.5, va="top"
    )


def _styles(measured: Sequence[MeasuredCase]) -> dict[str, Style]:
    """Return marker, line style and colour of each solver name in the chart."""
    is_ours = {one.solver.name: one.solver.ours for found in measured for one in found.series}
    found: dict[str, Style] = {}
    for k, name in enumerate(name for name, ours in is_ours.items() if ours):
        colour = OUR_COLOURS[k % len(OUR_COLOURS)]
        found[name] = {"marker": MARKERS[k % len(MARKERS)], "color": colour, "linewidth": 1.4}
    for k, name in enumerate(name for name, ours in is_ours.items() if not ours):
        found[name] = {
            "marker": MARKERS[k % len(MARKERS)], "color": PEER_COLOURS[k % len(PEER_COLOURS)], "linewidth": 0.8,
            "linestyle": BROKEN_LINES[k % len(BROKEN_LINES)], "markerfacecolor": "white",
        }  # fmt: skip
    return found


def _draw_panel(axes: Axes, measured: MeasuredCase, cost: str, styles: dict[str, Style]) -> None:
    axes.set(xscale="log", yscale="log", ylim=(SMALLEST_ERROR, LARGEST_ERROR))
    axes.grid(alpha=0.25, linewidth=0.4)
    uncertainty = measured.case.uncertainty
    ends: dict[str, ChartPoint] = {}  # The most accurate visible point of each curve.
    orders: dict[str, float | None] = {}
    for name, series in series_by_name(measured.series).items():
        best = frontier(series, cost)
        if not best:
            continue
        _draw_all_points(axes, series, cost, styles[name]["color"])
        axes.plot(*_coordinates(best, cost), **styles[name], markersize=4.0, markeredgewidth=0.8)
        ends[name] = next((point for point in best if point.error < EXACT), best[-1])
        orders[name] = fitted_order(most_exact(series), uncertainty or ROUND_OFF)
    if uncertainty > SMALLEST_ERROR:
        _draw_uncertainty(axes, uncertainty)
    _draw_labels(axes, ends, orders, cost, styles)


def _draw_uncertainty(axes: Axes, uncertainty: float) -> None:
    axes.axhspan(SMALLEST_ERROR, uncertainty, color=GREY, alpha=0.18, linewidth=0)
    place = axes.get_yaxis_transform()
    axes.text(0.01, uncertainty, "uncertainty of the truth", fontsize=6.5, va="bottom", transform=place)


def _coordinates(points: Sequence[ChartPoint], cost: str) -> tuple[list[float], list[float]]:
    """Return costs and errors of the points. A point with a negligible error lies at the lower edge of the panel."""
    return [getattr(point, cost) for point in points], [max(point.error, EXACT) for point in points]


def _draw_all_points(axes: Axes, series: Sequence[Series], cost: str, colour: str) -> None:
    """Draw all points in a pale colour. The curve itself connects only the points of its frontier."""
    points = [point for one in series for point in one.points if math.isfinite(getattr(point, cost))]
    axes.plot(*_coordinates(points, cost), ".", color=colour, markersize=1.5, alpha=0.35)


def _draw_labels(
    axes: Axes, ends: dict[str, ChartPoint], orders: dict[str, float | None], cost: str, styles: dict[str, Style]
) -> None:
    """Draw the labels in a column to the right of the panel.

    A line joins each label to the most accurate point of its curve.
    """
    decades = math.log10(LARGEST_ERROR / SMALLEST_ERROR)
    wanted = [
        math.log10(min(max(point.error, EXACT), LARGEST_ERROR) / SMALLEST_ERROR) / decades for point in ends.values()
    ]
    heights = spread(wanted, LABEL_HEIGHT, 0.01, 0.985)
    for (name, point), height in zip(ends.items(), heights, strict=True):
        style = styles[name]
        axes.annotate(
            "", (getattr(point, cost), max(point.error, EXACT)), xytext=(LABEL_COLUMN - 0.02, height),
            textcoords="axes fraction", annotation_clip=False,
            arrowprops={
                "arrowstyle": "-", "color": style["color"], "linewidth": 0.4, "alpha": 0.55, "shrinkA": 0, "shrinkB": 3,
            },
        )  # fmt: skip
        marker = {**style, "linestyle": "none"}
        axes.plot([LABEL_COLUMN], [height], transform=axes.transAxes, clip_on=False, markersize=4.5, **marker)
        axes.text(
            LABEL_COLUMN + 0.025, height, f"{name}{_order_text(point, orders[name])}", transform=axes.transAxes,
            va="center", fontsize=7.5, color=style["color"], gid="label",
        )  # fmt: skip


def _order_text(point: ChartPoint, order: float | None) -> str:
    if order is None:
        return ""
    return f"  $h^{{{order:.2f}}}$" if point.solver.steps else f"  $tol^{{\\,{order:.2f}}}$"
