"""Figures about the limit alpha -> 0 of Sec. IV.

The figures show which quantities vanish, and the spread of velocities over n alpha. The spreads collapse on one curve.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from softcradle.physics import ensemble
from softcradle.physics.analysis.measures import response_times, rigidity, spread_variable
from softcradle.physics.simulation import solve
from softcradle.sandbox.studies.data_table import Array, Table, long_table, rows_where
from softcradle.sandbox.studies.paper import SAMPLES, psi_limit, soft_chain, start
from softcradle.sandbox.studies.plot_style import (
    BLACK,
    BLUE,
    COLOUR_CYCLE,
    GREEN,
    GREY,
    ORANGE,
    PAGE_WIDTH,
    PURPLE,
    curve_label,
    new_figure,
    panel_title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZES = (2, 3, 4, 5)
SIZE_COLOURS = (BLUE, ORANGE, GREEN, PURPLE)
ALPHAS = tuple(1.0 / k for k in (5, 7, 10, 14, 20, 30, 50, 70, 100, 140, 200))


def scalings() -> Table:
    """Compute n, alpha, the largest psi, the contact time of the striker, and a response time.

    The response time is that of the inner contact at the largest psi.
    """
    rows = []
    for n in SIZES:
        for alpha in ALPHAS:
            chain = soft_chain(n, alpha)
            # Beads chatter only near the end of the motion. The sensitive end is not used.
            contact_time = solve(chain, start(chain), samples=2).contact_intervals[0][0][1]
            found = solve(chain, start(chain), contact_time, samples=SAMPLES)
            rows.append((n, alpha, found.overlap[:, 1].max(), contact_time, response_times(found)[1]))
    return long_table(("n", "alpha", "max psi", "contact time", "response time"), rows)


def stated_duration(n: int, alpha: float) -> float:
    """Return ``exp(-1/(2 n alpha)) / sqrt(alpha)``, the time stated in Sec. IV (ii).

    The response time of the inner contact vanishes like this expression. The contact time that we measure does not.
    """
    return math.exp(-0.5 / (n * alpha)) / math.sqrt(alpha)


def contact_time_limit(n: int) -> float:
    """Return ``2n/(n+1)``, the time in which a unit force stops and returns the reduced mass n/(n+1)."""
    return 2.0 * n / (n + 1.0)


def draw_scalings(table: Table) -> Figure:
    """Draw (a) the largest psi, and (b) the contact time and the response time.

    Solid and dashed lines are limits for alpha -> 0. Dotted lines show the statement of Sec. IV.
    """
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.9, 1, 2, ("(a)", "(b)"))
    _draw_psi(left, table)
    _draw_times(right, table)
    return figure


def _draw_psi(axes: Axes, table: Table) -> None:
    alphas = np.geomspace(ALPHAS[-1], ALPHAS[0], 100)
    for n, colour in zip(SIZES, SIZE_COLOURS, strict=True):
        points = rows_where(table, n=n)
        axes.semilogy(1.0 / points["alpha"], points["max psi"], "o", color=colour, markersize=3, label=f"$n={n}$")
        axes.semilogy(1.0 / alphas, [psi_limit(n, alpha) for alpha in alphas], color=colour, linewidth=0.8)
        axes.semilogy(1.0 / alphas, np.exp(-1.0 / (n * alphas)), color=colour, linewidth=0.7, linestyle=":")
    axes.set(xlabel=r"$1/\alpha$", ylabel=r"$\max\,\psi$", ylim=(1e-45, 3.0))
    axes.plot([], [], color=GREY, linewidth=0.8, label=r"$\frac{n}{2(n+1)}\left(\frac{n-1}{n}\right)^{1/\alpha}$")
    axes.plot([], [], color=GREY, linewidth=0.7, linestyle=":", label=r"$e^{-1/(n\alpha)}$")
    axes.legend(loc="lower left")


def _draw_times(axes: Axes, table: Table) -> None:
    alphas = np.geomspace(ALPHAS[-1], ALPHAS[0], 100)
    hollow: dict[str, Any] = {"marker": "s", "markersize": 3, "markerfacecolor": "none", "linestyle": "none"}
    for n, colour in zip(SIZES, SIZE_COLOURS, strict=True):
        points = rows_where(table, n=n)
        axes.loglog(points["alpha"], points["contact time"], "o", color=colour, markersize=3)
        axes.axhline(contact_time_limit(n), color=colour, linewidth=0.6, linestyle="--")
        axes.loglog(points["alpha"], points["response time"], color=colour, **hollow)
        axes.loglog(alphas, [stated_duration(n, alpha) for alpha in alphas], color=colour, linewidth=0.7, linestyle=":")
    axes.plot([], [], "o", color=GREY, markersize=3, label="contact of the striker")
    axes.plot([], [], color=GREY, linewidth=0.6, linestyle="--", label=r"$2n/(n+1)$")
    axes.plot([], [], color=GREY, label=r"response of the inner contact at $\max\,\psi$", **hollow)
    axes.plot([], [], color=GREY, linewidth=0.7, linestyle=":", label=r"$e^{-1/(2n\alpha)}/\sqrt{\alpha}$")
    axes.set(xlabel=r"$\alpha$", ylabel="time", ylim=(1e-22, 30.0))
    axes.legend(loc="lower right")


COLLAPSE_SIZES = (3, 4, 6, 10, 18, 32)
# Values of n alpha in steps of 2 %. The steps are small because small spreads form a jagged curve.
PRODUCTS = tuple(np.geomspace(0.15, 1.0, 93).tolist())
THRESHOLD = 0.5  # Spread from which on a cluster is no longer rigid-like.
TOLERANCE = 1e-5  # Tolerance, far below the visible differences. Chattering chains give up at smaller tolerances.


def spreads() -> Table:
    """Compute n, n alpha, the scaling variable and the spread. The spread is NaN if a simulation gave up."""
    rows = []
    for n in COLLAPSE_SIZES:
        chains = [soft_chain(n, product / n) for product in PRODUCTS]
        found = ensemble(chains, [[1.0] + [0.0] * n] * len(chains), tolerance=TOLERANCE)
        spread = [np.nan if one.status.gave_up else float(rigidity(one.final_velocity[1:])) for one in found]
        variable = [spread_variable(n, product / n) for product in PRODUCTS]
        rows.append((n, np.array(PRODUCTS), np.array(variable), np.array(spread)))
    return long_table(("n", "n alpha", "variable", "spread"), rows)


def threshold(table: Table, n: int, column: str) -> float:
    """Return the value of `column` at which the spread of `n` targets last crosses THRESHOLD.

    The value is interpolated between two samples. The result is NaN without a crossing.
    """
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
    """Return the n alpha at which the scaling variable equals `variable`: ``1 / (2 ln((n+1) / variable))``."""
    return np.asarray(0.5 / np.log((n + 1.0) / variable))


def draw_spreads(table: Table) -> Figure:
    """Draw the spread (a) over n alpha and (b) over the scaling variable, and (c) the threshold over n."""
    from matplotlib.ticker import NullFormatter

    figure, (left, middle, right) = new_figure(PAGE_WIDTH, 2.5, 1, 3)
    for n, colour in zip(COLLAPSE_SIZES, COLOUR_CYCLE, strict=False):
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
    variable = float(np.nanmedian([threshold(table, n, "variable") for n in COLLAPSE_SIZES]))
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
