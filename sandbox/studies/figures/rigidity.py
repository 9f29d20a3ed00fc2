"""Figures about the rigidity of a struck cluster, its limits, and the accuracy of Eq. (7).

The first figure is Fig. 3 of the letter that the paper cites.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics.analysis.closed_forms import rigid_collision
from softcradle.physics.analysis.measures import rigidity
from softcradle.physics.simulation import solve
from softcradle.physics.trajectory import Trajectory
from softcradle.sandbox.studies.data_table import Array, Table, long_table, rows_where
from softcradle.sandbox.studies.paper import full_motion, opening_time, soft_start
from softcradle.sandbox.studies.plot_style import (
    BLUE,
    COLOUR_CYCLE,
    GREEN,
    GREY,
    ORANGE,
    PAGE_WIDTH,
    RED,
    bead_colour,
    inner_label,
    new_figure,
    zero_line,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Exponents at which the spread is computed. The exponents are close together because the curve is jagged.
SPREAD_ALPHAS = tuple((1.0 / np.arange(24.0, 2.95, -0.1)).tolist())
SPREAD_SIZES = (2, 3, 4)  # Numbers of targets for which the spread is computed.
# Exponents for one on four, from rigid-like behaviour to the usual cradle. Steps of 0.1 in 1/alpha resolve the jagged
# parts of the curves.
LOSS_ALPHAS = (*(1.0 / np.arange(30.0, 4.0, -0.1).round(1)).tolist(), *np.geomspace(0.25, 2.0, 41).tolist())
LONG_SIZES = (4, 10, 30)  # Numbers of targets for which LONG_ALPHA is below, at and above 1/n.
LONG_ALPHA = 1.0 / 10.0
FINE_TOLERANCE = 1e-11  # The smallest visible spreads are below the error of a simulation with the usual tolerance.


def outcome(n: int, alpha: float) -> Array:
    """Return the (n+1,) velocities after the collision, or NaN if the simulation gave up."""
    found = _solved(n, alpha)
    return np.full(n + 1, np.nan) if found.status.gave_up else found.final_velocity


@lru_cache(maxsize=2048)
def _solved(n: int, alpha: float) -> Trajectory:
    return solve(*soft_start(n, alpha), samples=2, tolerance=FINE_TOLERANCE)


def rigid_outcome(n: int) -> tuple[float, float]:
    """Return the velocities of striker and cluster after a collision in which the cluster is one rigid body."""
    striker, target = rigid_collision(np.ones(n + 1), 1)[:2]
    return float(striker), float(target)


def spreads() -> Table:
    """Compute the velocities of the striker and the targets for each n and alpha.

    The columns are n, alpha, the velocities of striker, first and last target, the spread of all targets, and the
    velocity error.
    """
    rows = []
    for n in SPREAD_SIZES:
        for alpha in SPREAD_ALPHAS:
            velocity, error = outcome(n, alpha), _solved(n, alpha).velocity_error.max()
            rows.append((n, alpha, velocity[0], velocity[1], velocity[-1], rigidity(velocity[1:]), error))
    return long_table(("n", "alpha", "v striker", "v first", "v last", "spread", "velocity error"), rows)


def draw_spreads(table: Table) -> Figure:
    """Draw the velocities for two targets, and the spread of velocities for two to four targets."""
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.6, 1, 2, ("(a)  $n=2$", "(b)"))
    pair = rows_where(table, n=2)
    for bead, name in enumerate(("v striker", "v first", "v last")):
        left.plot(1.0 / pair["alpha"], pair[name], color=bead_colour(bead), label=f"$v_{bead}$")
    for velocity in rigid_outcome(2):
        left.axhline(velocity, color=GREY, linewidth=0.6, linestyle="--")
    left.set(xlabel=r"$1/\alpha$", ylabel="velocity after the collision")
    left.legend(loc="center right")
    for n, colour in zip(SPREAD_SIZES, (BLUE, ORANGE, GREEN), strict=True):
        points = rows_where(table, n=n)
        right.semilogy(1.0 / points["alpha"], points["spread"], color=colour, label=f"$n={n}$")
    right.set(xlabel=r"$1/\alpha$", ylabel=r"$(v_{\max}-v_{\min})/\langle v\rangle$ of the targets")
    right.legend(loc="lower left")
    return figure


def losses() -> Table:
    """Compute the velocity of each bead relative to a rigid cluster, up to the end of rigid-like behaviour.

    There is one row for each bead.
    """
    cases = dict.fromkeys([(4, alpha) for alpha in LOSS_ALPHAS] + [(n, LONG_ALPHA) for n in LONG_SIZES])
    rows = [
        (n, alpha, np.arange(n + 1), outcome(n, alpha), outcome(n, alpha) / rigid_outcome(n)[1]) for n, alpha in cases
    ]
    return long_table(("n", "alpha", "bead", "v", "v over rigid"), rows)


def draw_losses(table: Table) -> Figure:
    """Draw the velocities of beads beyond the limit of rigid-like behaviour.

    The left panel shows one on four over the exponent. The right panel shows long clusters at one small exponent.
    """
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.7, 1, 2, ("(a)  $n=4$", r"(b)  $\alpha=1/10$"))
    _draw_exponents(left, rows_where(table, n=4))
    for n, colour in zip(LONG_SIZES, (BLUE, ORANGE, RED), strict=True):
        beads = rows_where(table, n=n, alpha=LONG_ALPHA)
        right.plot(
            beads["bead"][1:] / n, beads["v over rigid"][1:], color=colour, marker="o", markersize=3, label=f"$n={n}$"
        )
    right.axhline(1.0, color=GREY, linewidth=0.6, linestyle="--")
    right.set(xlabel="$i/n$", ylabel=r"$v_i\,/\,\frac{2}{n+1}$", xlim=(0.0, 1.04))
    right.legend(loc="lower right")
    return figure


def _draw_exponents(axes: Axes, table: Table) -> None:
    for bead in range(5):
        points = rows_where(table, bead=bead)
        order = np.argsort(points["alpha"])
        axes.semilogx(points["alpha"][order], points["v"][order], color=COLOUR_CYCLE[bead], label=f"$v_{bead}$")
    axes.axvline(0.25, color=GREY, linewidth=0.7, linestyle=":")
    axes.annotate(r"$\alpha=1/n$", (0.25, 0.93), xytext=(-3, 0), textcoords="offset points", ha="right", fontsize=8)
    axes.axvline(1.0, color=GREY, linewidth=0.7, linestyle=":")
    axes.set(xlabel=r"$\alpha$", ylabel="velocity after the collision", xlim=(1.0 / 30.0, 2.0))
    axes.legend(loc="lower left", ncols=2, bbox_to_anchor=(0.0, 0.13), columnspacing=0.8, handlelength=1.2)


ALPHAS = (1.0 / 7.0, 1.0 / 10.0, 1.0 / 14.0)  # Exponents; each has a column of panels.
SIZES = (5, 4, 3)  # Numbers of targets; each has a row of panels.
CURVE_COLOURS = {2: BLUE, 3: ORANGE, 4: GREEN}  # Colour of the curve of each contact i.
# Line width of the curve of each contact i. Curves of deeper contacts are thinner, which makes coinciding curves
# visible.
CURVE_WIDTHS = {2: 2.6, 3: 1.7, 4: 0.8}

INSET_LIFT = 0.08  # Vertical distance between two curves in the inset.

# Sample times as fractions of the striker's contact time. The times are dense at both ends.
FRACTIONS = np.concatenate(
    (np.linspace(0.001, 0.01, 40), np.linspace(0.01, 0.99, 400)[1:-1], np.linspace(0.99, 0.999, 40))
)


def discrepancy(n: int, alpha: float) -> tuple[Array, Array]:
    """Return (T,) times and (T, n-2) values of ``[(n-1)/(n-i)]**(1/alpha) * d_i / d_1 - 1``, i = 2 ... n-1.

    The times are the FRACTIONS of the striker's contact time. Values are NaN after the first inner contact has opened.
    """
    times = FRACTIONS * opening_time(n, alpha)
    found = full_motion(*soft_start(n, alpha), None, tuple(times.tolist()))
    depth = np.arange(2, n)
    scaled = ((n - 1) / (n - depth)) ** (1.0 / alpha) * found.overlap[:, 2:]
    first = found.overlap[:, 1:2]
    return times, np.where(first > 0.0, scaled, np.nan) / first - 1.0


def panels() -> Table:
    """Compute the data of all nine panels, with one row for each curve and time."""
    rows = []
    for n in SIZES:
        for alpha in ALPHAS:
            times, values = discrepancy(n, alpha)
            rows += [(n, alpha, i, times, FRACTIONS, values[:, i - 2]) for i in range(2, n)]
    return long_table(("n", "alpha", "i", "t", "fraction of contact", "discrepancy"), rows)


def draw_panels(table: Table) -> Figure:
    """Draw nine panels with the discrepancies of Eq. (7).

    The curves for five beads at alpha = 1/10 coincide. An inset in their panel shows them shifted apart.
    """
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
