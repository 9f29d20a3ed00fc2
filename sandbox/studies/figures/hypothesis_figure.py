"""Appendix B: how well the evanescent hypothesis, Eq. (7), holds inside the full solution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.sandbox.studies.data_table import Array, Table, long_table, rows_where
from softcradle.sandbox.studies.paper import TOLERANCE, full_one_on, opening_time
from softcradle.sandbox.studies.plot_style import BLUE, GREEN, ORANGE, PAGE_WIDTH, inner_label, new_figure, zero_line

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ALPHAS = (1.0 / 7.0, 1.0 / 10.0, 1.0 / 14.0)  # a column of panels each
SIZES = (5, 4, 3)  # a row of panels each
CURVE_COLOURS = {2: BLUE, 3: ORANGE, 4: GREEN}  # by depth i
CURVE_WIDTHS = {2: 2.6, 3: 1.7, 4: 0.8}  # by depth i: deeper ones are thinner, so that all are seen where they coincide

INSET_LIFT = 0.08  # distance of two curves in the inset

# Sample times as fractions of the time for which the striker is in contact, dense at both ends.
FRACTIONS = np.concatenate(
    (np.linspace(0.001, 0.01, 40), np.linspace(0.01, 0.99, 400)[1:-1], np.linspace(0.99, 0.999, 40))
)


def discrepancy(
    n: int, alpha: float, fractions: Array = FRACTIONS, tolerance: float = TOLERANCE
) -> tuple[Array, Array]:
    """(T,) times and (T, n-2) values of ``[(n-1)/(n-i)]**(1/alpha) * d_i / d_1 - 1``, i = 2 ... n-1.

    At `fractions` (T,) of the time for which the striker is in contact; nan once the first inner contact is open.
    """
    times = fractions * opening_time(n, alpha)
    found = full_one_on(n, alpha, None, tuple(times.tolist()), tolerance)
    depth = np.arange(2, n)
    scaled = ((n - 1) / (n - depth)) ** (1.0 / alpha) * found.overlap[:, 2:]
    first = found.overlap[:, 1:2]
    return times, np.where(first > 0.0, scaled, np.nan) / first - 1.0


def panels() -> Table:
    """All nine panels, a row a curve and a time."""
    rows = []
    for n in SIZES:
        for alpha in ALPHAS:
            times, values = discrepancy(n, alpha)
            rows += [(n, alpha, i, times, FRACTIONS, values[:, i - 2]) for i in range(2, n)]
    return long_table(("n", "alpha", "i", "t", "fraction of contact", "discrepancy"), rows)


def draw_panels(table: Table) -> Figure:
    """Nine panels; an inset in that of five beads at 1/10 shows its curves, which coincide, shifted apart."""
    figure, grid = new_figure(PAGE_WIDTH, 5.2, 3, 3, sharex=True)
    for row, n in zip(grid, SIZES, strict=True):
        for axes, alpha in zip(row, ALPHAS, strict=True):
            _draw_panel(axes, rows_where(table, n=n, alpha=alpha), n)
            inner_label(axes, rf"$\alpha=1/{1 / alpha:.0f},\ n={n}$", 0.05, 0.95)
    for axes in grid[-1]:
        axes.set_xlabel("$t$ / contact time")
    for axes in grid[:, 0]:
        axes.set_ylabel(r"$\Delta_{i,i+1}/\delta_{1,2}-1$")
    _draw_inset(grid[0, 1], rows_where(table, n=5, alpha=ALPHAS[1]))
    grid[0, 0].legend(loc="lower right", handlelength=0.9, borderaxespad=0.2)
    return figure


def _draw_panel(axes: Axes, table: Table, n: int) -> None:
    zero_line(axes)
    for i in range(2, n):
        curve = rows_where(table, i=i)
        axes.plot(
            curve["fraction of contact"], curve["discrepancy"], color=CURVE_COLOURS[i], linewidth=CURVE_WIDTHS[i],
            label=rf"$\Delta_{{{i},{i + 1}}}$",
        )  # fmt: skip
    largest = np.nanmax(np.abs(table["discrepancy"][np.abs(table["fraction of contact"] - 0.5) < 0.46]))
    axes.set(xlim=(0.0, 1.0), ylim=(-1.6 * largest, 1.6 * largest))


def _draw_inset(axes: Axes, table: Table) -> None:
    inset = axes.inset_axes((0.48, 0.05, 0.48, 0.4))
    for i, colour in CURVE_COLOURS.items():
        curve = rows_where(table, i=i)
        inset.plot(
            curve["fraction of contact"], curve["discrepancy"] + INSET_LIFT * (i - 2), color=colour, linewidth=0.9
        )
    inset.set(xlim=(0.0, 1.0), ylim=(-0.85, 0.4), xticks=[], yticks=[])
    inset.text(
        0.97, 0.04, f"each lifted\nby {INSET_LIFT:g}", transform=inset.transAxes, ha="right", va="bottom", fontsize=6.0
    )
