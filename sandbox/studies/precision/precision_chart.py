"""The chart: error against wall time and against force evaluations, a row of panels a case, every curve named beside it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.studies.plot_style import BLUE, GREEN, GREY, ORANGE, PURPLE, RED, SKY, new_figure
from softcradle.sandbox.studies.precision.curve_labels import apart
from softcradle.sandbox.studies.precision.precision_table import Measured, ratio_sentence, rows
from softcradle.sandbox.studies.precision.work_precision import SHOWN, Point, Series, by_name, fitted_order, frontier

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 13.0, 4.3  # of a row [inches]
LOWEST = 1e-12  # error at the foot of a panel
FOOT = 1.3 * LOWEST
LABEL = 0.042  # height of a label, as part of a panel
COLUMN = 1.06  # where labels begin, as part of a panel's width
COSTS = (("seconds", "wall time of the solver [s]"), ("evaluations", "evaluations of all contact forces"))
ERRORS = {
    "velocities": "error of final velocities / closing speed",
    "forces": "error of forces / largest force, r.m.s.",
    "overlaps": "relative error of overlaps (App. B), r.m.s.",
}
# Ours are filled and drawn through, peers hollow and broken: told apart without colour.
MARKERS = "osD^vPX*p<>hd8H"
OURS = (
    BLUE, ORANGE, GREEN, PURPLE, RED, SKY, "#000000", "#8c6d31", GREY, "#6a0dad",
)  # fmt: skip
PEERS = ("#3b3b3b", "#7a5195", "#ef5675", "#b8860b", "#2f7f7f", "#7f7f7f", "#a05195", "#5a7d2a", "#444499", "#aa5500")
BROKEN = ("--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))


def draw(measured: Sequence[Measured]) -> Figure:
    """The picture; call it inside `softcradle.sandbox.studies.plot_style.styled`."""
    import matplotlib as mpl

    with mpl.rc_context({"figure.constrained_layout.use": False}):  # labels stand outside the panels
        figure, panels = new_figure(WIDTH, HEIGHT * len(measured), len(measured), 2, squeeze=False)
    top, foot = 0.35 / (HEIGHT * len(measured)), 0.65 / (HEIGHT * len(measured))
    figure.subplots_adjust(left=0.055, right=0.865, bottom=foot, top=1.0 - top, wspace=0.44, hspace=0.31)
    styles = _styles(measured)
    for found, row in zip(measured, panels, strict=True):
        for axes, (cost, name) in zip(row, COSTS, strict=True):
            _panel(axes, found, cost, styles)
            axes.set_xlabel(name)
        row[0].set_ylabel(ERRORS[found.quantity])
        row[0].set_title(found.case.label, loc="left", fontsize=11, pad=5)
        row[1].set_title(f"truth: {found.case.origin}", loc="left", fontsize=7.5, pad=5, color=GREY)
        if found.quantity == "velocities":
            _note(row[0], ratio_sentence(rows(found)))
    return figure


def _note(axes: Axes, text: str) -> None:
    axes.annotate(
        text, (0.0, 0.0), xycoords="axes fraction", xytext=(0, -36), textcoords="offset points", fontsize=7.5, va="top"
    )


def _styles(measured: Sequence[Measured]) -> dict[str, dict[str, Any]]:
    """Marker, line and colour of every name in the picture."""
    names = {one.solver.name: one.solver.ours for found in measured for one in found.series}
    mine, others = [name for name in names if names[name]], [name for name in names if not names[name]]
    found: dict[str, dict[str, Any]] = {}
    for k, name in enumerate(mine):
        found[name] = {"marker": MARKERS[k % len(MARKERS)], "color": OURS[k % len(OURS)], "linewidth": 1.4}
    for k, name in enumerate(others):
        colour = PEERS[k % len(PEERS)]
        found[name] = {
            "marker": MARKERS[k % len(MARKERS)], "color": colour, "linewidth": 0.8, "linestyle": BROKEN[k % len(BROKEN)],
            "markerfacecolor": "white",
        }  # fmt: skip
    return found


def _panel(axes: Axes, found: Measured, cost: str, styles: dict[str, dict[str, Any]]) -> None:
    axes.set(xscale="log", yscale="log", ylim=(LOWEST, SHOWN))
    axes.grid(alpha=0.25, linewidth=0.4)
    ends: list[tuple[str, Point, float | None]] = []
    for name, series in by_name(found.series).items():
        best = frontier(series, cost)
        if not best:
            continue
        _scatter(axes, series, cost, styles[name]["color"])
        axes.plot(*_xy(best, cost), **styles[name], markersize=4.0, markeredgewidth=0.8)
        ends.append(
            (
                name,
                next((point for point in best if point.error < FOOT), best[-1]),
                fitted_order(_best(series), found.case.doubt or 1e-14),
            )
        )
    if found.case.doubt > LOWEST:
        axes.axhspan(LOWEST, found.case.doubt, color=GREY, alpha=0.18, linewidth=0)
        axes.text(
            0.01,
            found.case.doubt,
            "truth unsure below",
            fontsize=6.5,
            va="bottom",
            transform=axes.get_yaxis_transform(),
        )
    _name(axes, ends, cost, styles)


def _xy(points: Sequence[Point], cost: str) -> tuple[list[float], list[float]]:
    """Costs and errors; what is exact stands at the foot of the panel."""
    return [getattr(point, cost) for point in points], [max(point.error, FOOT) for point in points]


def _scatter(axes: Axes, series: Sequence[Series], cost: str, colour: str) -> None:
    """All points, faint: the curve shows the best of them alone."""
    points = [point for one in series for point in one.points if math.isfinite(getattr(point, cost))]
    axes.plot(*_xy(points, cost), ".", color=colour, markersize=1.5, alpha=0.35)


def _best(series: Sequence[Series]) -> Series:
    """The most exact series of a name: the order printed is its own."""
    return min(series, key=lambda one: min(point.error for point in one.points))


def _name(
    axes: Axes, ends: list[tuple[str, Point, float | None]], cost: str, styles: dict[str, dict[str, Any]]
) -> None:
    """Labels in a column beside the panel, each tied to the most exact point of its curve."""
    depth = math.log10(LOWEST / SHOWN)
    heights = [1.0 - min(max(math.log10(max(point.error, FOOT) / SHOWN) / depth, 0.0), 1.0) for _, point, _ in ends]
    for (name, point, order), height in zip(ends, apart(heights, LABEL, 0.01, 0.985), strict=True):
        look = styles[name]
        axes.annotate(
            "",
            (getattr(point, cost), max(point.error, FOOT)),
            xytext=(COLUMN - 0.02, height),
            textcoords="axes fraction",
            annotation_clip=False,
            arrowprops={
                "arrowstyle": "-",
                "color": look["color"],
                "linewidth": 0.4,
                "alpha": 0.55,
                "shrinkA": 0,
                "shrinkB": 3,
            },
        )
        axes.plot(
            [COLUMN],
            [height],
            transform=axes.transAxes,
            clip_on=False,
            markersize=4.5,
            **{**look, "linestyle": "none"},
        )
        axes.text(
            COLUMN + 0.025, height, f"{name}{_order(point, order)}", transform=axes.transAxes, va="center", fontsize=7.5,
            color=look["color"], gid="label",
        )  # fmt: skip


def _order(point: Point, order: float | None) -> str:
    if order is None:
        return ""
    return f"  $h^{{{order:.2f}}}$" if point.solver.steps else f"  $tol^{{\\,{order:.2f}}}$"
