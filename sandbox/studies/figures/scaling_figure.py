"""The limit alpha -> 0: which quantities vanish, how, and which stay. Sec. IV, before the discussion."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics.analysis.measures import response_times
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.figures.solved_cases import SAMPLES, Table, long_table, pick, soft, solved, start

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZES = (2, 3, 4, 5)
ALPHAS = tuple(1.0 / k for k in (5, 7, 10, 14, 20, 30, 50, 70, 100, 140, 200))
COLOURS = (style.BLUE, style.ORANGE, style.GREEN, style.PURPLE)


def scan() -> Table:
    """n, alpha, max psi, contact time of the striker, response time of the inner contact at max psi."""
    rows = []
    for n in SIZES:
        for alpha in ALPHAS:
            found = solved(soft(n, alpha), start(soft(n, alpha)), 1.25 * limit_of_contact(n), SAMPLES)
            contact = found.contact_intervals[0][0][1]
            rows.append((n, alpha, found.overlap[:, 1].max(), contact, response_times(found)[1]))
    return long_table(("n", "alpha", "max psi", "contact time", "response time"), rows)


def limit_of_psi(n: int, alpha: float) -> float:
    """``((n-1)/n)**(1/alpha)``: what f12 = (n-1)/n f01 and f01 -> 1 make of max psi; exp(-1/(n alpha)) for large n."""
    return float(((n - 1) / n) ** (1.0 / alpha))


def limit_of_response(n: int, alpha: float) -> float:
    """``sqrt(psi**(1-alpha) / (2 alpha))`` for psi in the limit: 1/2 is the reduced mass of two unit beads."""
    return math.sqrt(limit_of_psi(n, alpha) ** (1.0 - alpha) / (2.0 * alpha))


def limit_of_contact(n: int) -> float:
    """``2n/(n+1)``: a unit force stops and returns the reduced mass n/(n+1)."""
    return 2.0 * n / (n + 1.0)


def draw_scan(table: Table) -> Figure:
    """(a) max psi, (b) the two times."""
    figure, (axes, right) = style.page(style.PAGE, 2.9, 1, 2)
    fine = np.geomspace(1.0 / 200.0, 1.0 / 5.0, 100)
    for n, colour in zip(SIZES, COLOURS, strict=True):
        some = pick(table, n=n)
        axes.semilogy(1.0 / some["alpha"], some["max psi"], "o", color=colour, markersize=3, label=f"$n={n}$")
        axes.semilogy(1.0 / fine, [limit_of_psi(n, a) for a in fine], color=colour, linewidth=0.8)
        axes.semilogy(1.0 / fine, np.exp(-1.0 / (n * fine)), color=colour, linewidth=0.7, linestyle=":")
        right.loglog(some["alpha"], some["contact time"], "o", color=colour, markersize=3)
        right.axhline(limit_of_contact(n), color=colour, linewidth=0.6, linestyle="--")
        right.loglog(some["alpha"], some["response time"], "s", color=colour, markersize=3, markerfacecolor="none")
        right.loglog(fine, [limit_of_response(n, a) for a in fine], color=colour, linewidth=0.8)
    axes.set(xlabel=r"$1/\alpha$", ylabel=r"$\max\,\psi$", ylim=(1e-45, 3.0))
    axes.plot([], [], color=style.GREY, linewidth=0.8, label=r"$((n-1)/n)^{1/\alpha}$")
    axes.plot([], [], color=style.GREY, linewidth=0.7, linestyle=":", label=r"$e^{-1/(n\alpha)}$")
    axes.legend(loc="lower left")
    right.plot([], [], "o", color=style.GREY, markersize=3, label="contact of the striker")
    right.plot(
        [], [], "s", color=style.GREY, markersize=3, markerfacecolor="none", label="response of the inner contact"
    )
    right.set(xlabel=r"$\alpha$", ylabel="time", ylim=(1e-10, 30.0))
    right.legend(loc="lower right")
    style.title(axes, "(a)")
    style.title(right, "(b)")
    return figure
