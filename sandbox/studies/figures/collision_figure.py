"""Fig. 1: positions and velocities of one on four."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.figures.solved_cases import ALPHA, SOFTER, N, Table, soft, solved, start

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BEFORE, AFTER = 1.0, 4.0  # of Fig. 1b, in units of time
VELOCITIES_UNTIL = 3.0


def positions() -> Table:
    """t and the positions x0 ... x4, bead i starting at height i; before the collision the striker flies freely."""
    chain = soft(N, ALPHA)
    velocity = start(chain)
    found = solved(chain, velocity, AFTER)
    ahead = np.linspace(-BEFORE, 0.0, 100, endpoint=False)
    time = np.concatenate((ahead, found.time))
    moved = np.concatenate((ahead[:, None] * np.array(velocity), found.position)) + np.arange(N + 1.0)
    return {"t": time, **{f"x{i}": moved[:, i] for i in range(N + 1)}}


def velocities(alpha: float) -> Table:
    """t and the velocities v0 ... v4 for that exponent, from the first touch on."""
    chain = soft(N, alpha)
    found = solved(chain, start(chain), VELOCITIES_UNTIL)
    return {"t": found.time, **{f"v{i}": found.velocity[:, i] for i in range(N + 1)}}


def draw_positions(table: Table) -> Figure:
    """Fig. 1b."""
    figure, axes = style.page(height=2.6)
    axes.axvline(0.0, color=style.GREY, linewidth=0.5, linestyle=":")
    for i in range(N + 1):
        colour = style.BLUE if i == 0 else style.ORANGE if i == 1 else "black"
        axes.plot(table["t"], table[f"x{i}"], color=colour)
        style.beside(axes, table["t"][-1], table[f"x{i}"][-1], f"$x_{i}$", colour)
    axes.set(xlabel="$t$", ylabel="position", xlim=(-BEFORE, AFTER), yticks=range(-2, 7, 2))
    style.label(axes, r"$n=4,\ \alpha=1/10$")
    return figure


def draw_1c(table: Table) -> Figure:
    """Fig. 1c."""
    return _draw_velocities(table, r"$n=4,\ \alpha=1/10$")


def draw_1d(table: Table) -> Figure:
    """Fig. 1d."""
    return _draw_velocities(table, r"$n=4,\ \alpha=1/14$")


def _draw_velocities(table: Table, text: str) -> Figure:
    figure, axes = style.page(height=2.5)
    style.zero(axes)
    for i in range(N, -1, -1):
        colour = style.BLUE if i == 0 else style.ORANGE if i == 1 else "black"
        axes.plot(table["t"], table[f"v{i}"], color=colour, linewidth=1.4 if i < 2 else 0.9)
    last = table["t"][-1]
    style.beside(axes, last, table["v0"][-1], "$v_0$", style.BLUE)
    style.beside(axes, last, table["v1"][-1] - 0.03, "$v_1$", style.ORANGE)
    style.beside(axes, last, table["v4"][-1] + 0.03, "$v_{2,3,4}$", "black")
    style.label(axes, text, 0.6)
    axes.set(xlabel="$t$", ylabel="velocity", xlim=(0.0, VELOCITIES_UNTIL), ylim=(-0.75, 1.05))
    return figure


def figure_1c() -> Table:
    """Velocities for alpha = 1/10."""
    return velocities(ALPHA)


def figure_1d() -> Table:
    """Velocities for alpha = 1/14."""
    return velocities(SOFTER)
