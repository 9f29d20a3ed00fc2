"""The limit alpha -> 0: which quantities vanish, how, and which stay. Sec. IV, before the discussion."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from softcradle.physics.analysis.measures import response_times
from softcradle.physics.simulation import solve
from softcradle.sandbox.studies.data_table import Table, long_table, rows_where
from softcradle.sandbox.studies.paper import SAMPLES, soft_chain, start
from softcradle.sandbox.studies.plot_style import BLUE, GREEN, GREY, ORANGE, PAGE_WIDTH, PURPLE, new_figure, panel_title

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZES = (2, 3, 4, 5)
SIZE_COLOURS = (BLUE, ORANGE, GREEN, PURPLE)
ALPHAS = tuple(1.0 / k for k in (5, 7, 10, 14, 20, 30, 50, 70, 100, 140, 200))


def scalings() -> Table:
    """n, alpha, max psi, contact time of the striker, response time of the inner contact at max psi."""
    rows = []
    for n in SIZES:
        for alpha in ALPHAS:
            chain = soft_chain(n, alpha)
            # what may be sensitive is the end, where beads chatter: it is not read
            contact_time = solve(chain, start(chain), samples=2).contact_intervals[0][0][1]
            found = solve(chain, start(chain), contact_time, samples=SAMPLES)
            rows.append((n, alpha, found.overlap[:, 1].max(), contact_time, response_times(found)[1]))
    return long_table(("n", "alpha", "max psi", "contact time", "response time"), rows)


def psi_limit(n: int, alpha: float) -> float:
    """``n/(2(n+1)) ((n-1)/n)**(1/alpha)``: the limit of max psi; the paper's exp(-1/(n alpha)) has its rate for large n.

    The overlap Phi reaches n/(2(n+1)) against a force of 1, of which f12 is (n-1)/n.
    """
    return float(n / (2.0 * (n + 1.0)) * ((n - 1) / n) ** (1.0 / alpha))


def stated_duration(n: int, alpha: float) -> float:
    """``exp(-1/(2 n alpha)) / sqrt(alpha)``, as Sec. IV (ii) has it: our contact time stays, the inner response vanishes so."""
    return math.exp(-0.5 / (n * alpha)) / math.sqrt(alpha)


def contact_time_limit(n: int) -> float:
    """``2n/(n+1)``: a unit force stops and returns the reduced mass n/(n+1)."""
    return 2.0 * n / (n + 1.0)


def draw_scalings(table: Table) -> Figure:
    """(a) max psi, (b) the two times; solid and dashed lines are limits for alpha -> 0, dotted ones what Sec. IV states."""
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.9, 1, 2)
    _draw_psi(left, table)
    _draw_times(right, table)
    panel_title(left, "(a)")
    panel_title(right, "(b)")
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
