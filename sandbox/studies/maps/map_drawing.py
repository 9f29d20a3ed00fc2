"""Drawing of a map: rigidity in decades of grey-safe colour, the sizes as rows, lines where behaviour changes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.figures.solved_cases import Array, Table
from softcradle.sandbox.studies.maps.rigidity_scan import TOLERANCE, Map

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMNS = ("rigidity at detachment", "rigidity at the end")
TITLES = ("(a) when the striker leaves", "(b) at the end")
RIGID = 100.0 * TOLERANCE  # spreads below are not told from 0
LEVELS = {"alpha": (1e-1, 1.0), "speed / critical speed": (1.0,)}  # contours that are smooth enough to read
ABSCISSAE = {"alpha": r"$\alpha$", "speed / critical speed": "speed / critical speed"}


def draw(wanted: Map, table: Table) -> Figure:
    """Both moments side by side under one scale of colours."""
    figure, row = style.page(style.PAGE, 3.1, 1, 2, sharex=True, sharey=True)
    shape = len(wanted.sizes), len(wanted.values)
    mesh: Any = None
    for axes, column, title in zip(row, COLUMNS, TITLES, strict=True):
        mesh = _panel(axes, wanted, table[column].reshape(shape))
        style.title(axes, f"{title}: {wanted.title}")
        axes.set_xlabel(ABSCISSAE[wanted.across])
    row[0].set_ylabel("targets $n$")
    bar = figure.colorbar(mesh, ax=row, extend="min", pad=0.01, aspect=30)
    bar.set_label("velocity spread of the targets / their mean")
    return figure


def _panel(axes: Axes, wanted: Map, values: Array) -> Any:
    from matplotlib import colormaps
    from matplotlib.colors import LogNorm
    from matplotlib.ticker import MaxNLocator

    colours = colormaps["viridis"].with_extremes(under="white")
    shown = np.where(np.isfinite(values) & (values > 0.0), values, RIGID / 10.0)
    mesh = axes.pcolormesh(
        _edges(np.log(wanted.values)), np.arange(len(wanted.sizes) + 1) + wanted.sizes[0] - 0.5, shown,
        norm=LogNorm(RIGID, 10.0), cmap=colours, rasterized=True,
    )  # fmt: skip
    axes.set_xscale("log")
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    _contours(axes, wanted, shown)
    if wanted.across == "alpha":
        _guide(axes, 1.0 / np.array(wanted.sizes), wanted.sizes, r"$\alpha = 1/n$", {"ha": "left", "color": "black"})
        style.label(axes, f"below {100.0 * RIGID:g} %", 0.02, 0.06, fontsize=8.0)
    else:
        _guide(axes, np.ones(len(wanted.sizes)), wanted.sizes, "critical speed", {"ha": "right", "rotation": 90})
        style.label(axes, "exactly\nrigid", 0.03, 0.55, fontsize=8.0)
    axes.set_xlim(wanted.values[0], wanted.values[-1])
    return mesh


def _edges(logarithms: Array) -> Array:
    """(X+1,) borders of cells around (X,) evenly spaced logarithms, no longer logarithms."""
    half = 0.5 * (logarithms[1] - logarithms[0])
    edges: Array = np.exp(np.append(logarithms - half, logarithms[-1] + half))
    return edges


def _contours(axes: Axes, wanted: Map, values: Array) -> None:
    if min(values.shape) < 2:
        return
    lines = axes.contour(
        wanted.values, list(wanted.sizes), np.log10(values), levels=np.log10(LEVELS[wanted.across]), colors="black",
        linewidths=0.7, linestyles="solid",
    )  # fmt: skip
    axes.clabel(lines, fmt=lambda level: f"{100.0 * 10.0**level:.0f} %", fontsize=7.0, inline_spacing=2)


def _guide(axes: Axes, places: Array, sizes: Any, name: str, look: dict[str, Any]) -> None:
    """A dashed line through the cells of all sizes, with its name beside the top."""
    rows = np.array(sizes, dtype=np.float64)
    ends = np.concatenate(([rows[0] - 0.5], rows, [rows[-1] + 0.5]))
    line = np.interp(ends, rows, places)
    for colour, width, dashes in (("black", 2.0, "-"), ("white", 1.2, (0, (4, 3)))):
        axes.plot(line, ends, color=colour, linewidth=width, linestyle=dashes)
    aside = (4 if look["ha"] == "left" else -4, -5)
    axes.annotate(name, (line[-1], ends[-1]), xytext=aside, textcoords="offset points", va="top", fontsize=8.0, **look)
