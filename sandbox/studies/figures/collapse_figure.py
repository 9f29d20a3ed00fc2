"""Where rigid-like behaviour ends: spreads over n alpha, and their collapse on (n+1) exp(-1/(2 n alpha)). Sec. IV.

The paper's criterion is alpha << 1/n. At fixed n alpha the spread grows with n: the threshold of n alpha falls like
1/(2 ln((n+1)/c)), a logarithmic correction. c is the value of the scaling variable at which the spread is a half.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics import ensemble
from softcradle.physics.analysis.cluster_scaling import spread_variable
from softcradle.physics.analysis.measures import rigidity
from softcradle.sandbox.studies.data_table import Array, Table, long_table, rows_where
from softcradle.sandbox.studies.paper import soft_chain
from softcradle.sandbox.studies.plot_style import (
    BLACK,
    COLOUR_CYCLE,
    GREY,
    PAGE_WIDTH,
    curve_label,
    new_figure,
    panel_title,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZES = (3, 4, 6, 10, 18, 32)
PRODUCTS = tuple(np.geomspace(0.15, 1.0, 93).tolist())  # of n and alpha: steps of 2 %, since small spreads jag
THRESHOLD = 0.5  # spread at which a cluster is no longer rigid-like
TOLERANCE = 1e-5  # far below what is shown; chains that chatter give up at finer ones


def spreads() -> Table:
    """n, n alpha, the scaling variable, the spread (nan where a run gave up)."""
    rows = []
    for n in SIZES:
        chains = [soft_chain(n, product / n) for product in PRODUCTS]
        found = ensemble(chains, [[1.0] + [0.0] * n] * len(chains), tolerance=TOLERANCE)
        spread = [np.nan if one.status.gave_up else float(rigidity(one.final_velocity[1:])) for one in found]
        variable = [spread_variable(n, product / n) for product in PRODUCTS]
        rows.append((n, np.array(PRODUCTS), np.array(variable), np.array(spread)))
    return long_table(("n", "n alpha", "variable", "spread"), rows)


def threshold(table: Table, n: int, column: str) -> float:
    """Value of a column at which the spread of `n` targets passes THRESHOLD for the last time, between two samples; or nan."""
    points = rows_where(table, n=n)
    known = np.isfinite(points["spread"])
    place, logarithm = np.log(points[column][known]), np.log(points["spread"][known] / THRESHOLD)
    below = np.flatnonzero(logarithm[:-1] <= 0.0)
    if not below.size:
        return math.nan
    last = int(below[-1])
    part = -logarithm[last] / (logarithm[last + 1] - logarithm[last])
    return float(np.exp(place[last] + part * (place[last + 1] - place[last])))


def threshold_law(n: Array, variable: float) -> Array:
    """n alpha at which the scaling variable has that value: ``1 / (2 ln((n+1) / variable))``."""
    return np.asarray(0.5 / np.log((n + 1.0) / variable))


def draw_spreads(table: Table) -> Figure:
    """(a) the spread over n alpha, (b) over the scaling variable, (c) the threshold over n."""
    from matplotlib.ticker import NullFormatter

    figure, (left, middle, right) = new_figure(PAGE_WIDTH, 2.5, 1, 3)
    for n, colour in zip(SIZES, COLOUR_CYCLE, strict=False):
        points = rows_where(table, n=n)
        for axes, column in ((left, "n alpha"), (middle, "variable")):
            axes.loglog(points[column], points["spread"], color=colour, linewidth=0.9, label=f"$n={n}$")
        right.plot(n, threshold(table, n, "n alpha"), "o", color=colour, markersize=4)
    left.set_xticks([0.1, 0.3, 1.0], ["0.1", "0.3", "1"])
    for axes in (left, middle):
        axes.axhline(THRESHOLD, color=GREY, linewidth=0.6, linestyle="--")
        axes.set_ylim(4e-4, 20.0)
    left.legend(loc="lower right", fontsize=7)
    left.set(xlabel=r"$n\alpha$", ylabel="velocity spread of the targets")
    middle.set(xlabel=r"$(n+1)\,e^{-1/(2n\alpha)}$", xlim=(0.1, 30.0))
    variable = float(np.nanmedian([threshold(table, n, "variable") for n in SIZES]))
    sizes = np.geomspace(2.5, 40.0, 60)
    right.semilogx(sizes, threshold_law(sizes, variable), color=BLACK, linewidth=0.8)
    right.axhline(1.0, color=GREY, linewidth=0.6, linestyle=":")
    curve_label(right, 3.0, 0.95, r"$\alpha=1/n$", GREY)
    right.set(xlabel="$n$", ylabel=r"$n\alpha$ at a spread of 50 %", ylim=(0.0, 1.05))
    right.set_xticks([3, 10, 30], ["3", "10", "30"])
    for axes in (left, right):
        axes.xaxis.set_minor_formatter(NullFormatter())
    for axes, text in ((left, "(a)"), (middle, "(b)"), (right, rf"(c)  line: $1/(2\,\ln((n+1)/{variable:.2f}))$")):
        panel_title(axes, text)
    return figure
