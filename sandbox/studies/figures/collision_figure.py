"""Fig. 1: positions and velocities of one on four."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.sandbox.studies.data_table import Table
from softcradle.sandbox.studies.paper import ALPHA, N, full_one_on
from softcradle.sandbox.studies.plot_style import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    bead_colour,
    curve_label,
    inner_label,
    new_figure,
    zero_line,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

POSITIONS_FROM = -1.0  # units of time, of Fig. 1b; the striker arrives at 0
POSITIONS_UNTIL = 4.0
VELOCITIES_UNTIL = 3.0  # units of time, of Figs. 1c and 1d


def positions() -> Table:
    """t and the positions x0 ... x4, bead i starting at height i; before the collision the striker flies freely."""
    found = full_one_on(N, ALPHA, POSITIONS_UNTIL)
    before = np.linspace(POSITIONS_FROM, 0.0, 100, endpoint=False)
    time = np.concatenate((before, found.time))
    position = np.concatenate((before[:, None] * found.velocity[0], found.position)) + np.arange(N + 1.0)
    return {"t": time, **{f"x{i}": position[:, i] for i in range(N + 1)}}


def velocities(alpha: float) -> Table:
    """t and the velocities v0 ... v4 for that exponent, from the first touch on."""
    found = full_one_on(N, alpha, VELOCITIES_UNTIL)
    return {"t": found.time, **{f"v{i}": found.velocity[:, i] for i in range(N + 1)}}


def draw_positions(table: Table) -> Figure:
    """Fig. 1b."""
    figure, axes = new_figure(height=2.6)
    axes.axvline(0.0, color=GREY, linewidth=0.5, linestyle=":")
    for i in range(N + 1):
        axes.plot(table["t"], table[f"x{i}"], color=bead_colour(i))
        curve_label(axes, table["t"][-1], table[f"x{i}"][-1], f"$x_{i}$", bead_colour(i))
    axes.set(xlabel="$t$", ylabel="position", xlim=(POSITIONS_FROM, POSITIONS_UNTIL), yticks=range(-2, 7, 2))
    inner_label(axes, r"$n=4,\ \alpha=1/10$", 0.24)
    return figure


def draw_velocities(table: Table, alpha: float) -> Figure:
    """Figs. 1c and 1d."""
    figure, axes = new_figure(height=2.5)
    zero_line(axes)
    for i in range(N, -1, -1):
        axes.plot(table["t"], table[f"v{i}"], color=bead_colour(i), linewidth=1.4 if i < 2 else 0.9)
    end = table["t"][-1]
    curve_label(axes, end, table["v0"][-1], "$v_0$", BLUE)
    curve_label(axes, end, table["v1"][-1] - 0.03, "$v_1$", ORANGE)
    curve_label(axes, end, table["v4"][-1] + 0.03, "$v_{2,3,4}$", BLACK)
    inner_label(axes, rf"$n=4,\ \alpha=1/{1.0 / alpha:.0f}$", 0.6)
    axes.set(xlabel="$t$", ylabel="velocity", xlim=(0.0, VELOCITIES_UNTIL), ylim=(-0.75, 1.05))
    return figure
