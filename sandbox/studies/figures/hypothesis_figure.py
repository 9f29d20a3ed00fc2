"""Appendix B: how well the evanescent hypothesis, Eq. (6), holds inside the full solution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.figures.solved_cases import (
    TOLERANCE,
    Array,
    Table,
    contact_time,
    long_table,
    pick,
    soft,
    solved,
    start,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ALPHAS, SIZES = (1.0 / 7.0, 1.0 / 10.0, 1.0 / 14.0), (5, 4, 3)  # columns and rows
COLOURS = {2: style.BLUE, 3: style.ORANGE, 4: style.GREEN}
MIDDLE = np.concatenate(
    (np.linspace(0.001, 0.01, 40), np.linspace(0.01, 0.99, 400)[1:-1], np.linspace(0.99, 0.999, 40))
)


def discrepancy(n: int, alpha: float, fractions: Array = MIDDLE, tolerance: float = TOLERANCE) -> tuple[Array, Array]:
    """(T,) times and (T, n-2) values of ``[(n-1)/(n-i)]**(1/alpha) * d_i / d_1 - 1``, i = 2 ... n-1.

    At `fractions` (T,) of the time for which the striker is in contact; nan once the first inner contact is open.
    """
    chain = soft(n, alpha)
    times = fractions * contact_time(chain, start(chain))
    found = solved(chain, start(chain), None, tuple(times.tolist()), tolerance)
    depth = np.arange(2, n)
    scaled = ((n - 1) / (n - depth)) ** (1.0 / alpha) * found.overlap[:, 2:]
    first = found.overlap[:, 1:2]
    return times, np.where(first > 0.0, scaled, np.nan) / first - 1.0


def panels() -> Table:
    """All nine panels, a row a curve and a time."""
    rows = []
    for n in SIZES:
        for alpha in ALPHAS:
            times, off = discrepancy(n, alpha)
            rows += [(n, alpha, i, times, MIDDLE, off[:, i - 2]) for i in range(2, n)]
    return long_table(("n", "alpha", "i", "t", "fraction of contact", "discrepancy"), rows)


def draw_panels(table: Table) -> Figure:
    """Nine panels; inset in that of five beads at 1/10: the curves set apart, which else cover each other."""
    figure, grid = style.page(style.PAGE, 5.2, 3, 3, sharex=True)
    for row, n in zip(grid, SIZES, strict=True):
        for axes, alpha in zip(row, ALPHAS, strict=True):
            _panel(axes, pick(table, n=n, alpha=alpha), n)
            style.label(axes, rf"$\alpha=1/{1 / alpha:.0f},\ n={n}$", 0.05, 0.95)
    for axes in grid[-1]:
        axes.set_xlabel("$t$ / contact time")
    for axes in grid[:, 0]:
        axes.set_ylabel(r"$\Delta_{i,i+1}/\delta_{1,2}-1$")
    _inset(grid[0, 1], pick(table, n=5, alpha=ALPHAS[1]))
    grid[0, 0].legend(loc="lower right")
    return figure


def _panel(axes: Axes, table: Table, n: int) -> None:
    style.zero(axes)
    for i in range(2, n):
        curve = pick(table, i=i)
        axes.plot(
            curve["fraction of contact"], curve["discrepancy"], color=COLOURS[i],
            linewidth=(2.6, 1.7, 0.8)[i - 2], label=rf"$\Delta_{{{i},{i + 1}}}$",
        )  # fmt: skip
    largest = np.nanmax(np.abs(table["discrepancy"][np.abs(table["fraction of contact"] - 0.5) < 0.46]))
    axes.set(xlim=(0.0, 1.0), ylim=(-1.6 * largest, 1.6 * largest))


def _inset(axes: Axes, table: Table) -> None:
    inside = axes.inset_axes((0.5, 0.1, 0.46, 0.36))
    for i in (2, 3, 4):
        curve = pick(table, i=i)
        inside.plot(
            curve["fraction of contact"], curve["discrepancy"] + 0.08 * (i - 2), color=COLOURS[i], linewidth=0.9
        )
    inside.set(xlim=(0.0, 1.0), ylim=(-0.2, 0.4), xticks=[], yticks=[])
