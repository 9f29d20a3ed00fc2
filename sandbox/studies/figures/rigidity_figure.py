"""How rigid a struck cluster is: Fig. 3 of the letter that the paper cites, and where rigid-like behaviour ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics.analysis.measures import rigidity
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.figures.solved_cases import Array, Table, long_table, pick, soft, solved, start

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SOFT = tuple(np.geomspace(1.0 / 24.0, 1.0 / 3.0, 91).tolist())  # exponents of the spread
SPREAD_SIZES = (2, 3, 4)
FINE = 1e-11  # tolerance: spreads are smaller than the error of a usual run
EXPONENTS = tuple(np.geomspace(1.0 / 30.0, 2.0, 81).tolist())  # of one on four, from rigid-like to cradle
LONG_ALPHA, LONG_SIZES = 1.0 / 10.0, (4, 10, 30)  # alpha below, at and above 1/n, and small in all


def outcome(n: int, alpha: float) -> Array:
    """(n+1,) velocities after the collision."""
    chain = soft(n, alpha)
    return solved(chain, start(chain), samples=2, tolerance=FINE).final_velocity


def rigid(n: int) -> tuple[float, float]:
    """Velocities of striker and cluster if it were one rigid body struck elastically."""
    return (1.0 - n) / (1.0 + n), 2.0 / (1.0 + n)


def spreads() -> Table:
    """n, alpha, velocities of the striker, of the first and the last target, and the spread of all targets."""
    rows = []
    for n in SPREAD_SIZES:
        for alpha in SOFT:
            velocity = outcome(n, alpha)
            rows.append((n, alpha, velocity[0], velocity[1], velocity[-1], float(rigidity(velocity[1:]))))
    return long_table(("n", "alpha", "v striker", "v first", "v last", "spread"), rows)


def draw_spreads(table: Table) -> Figure:
    """Velocities for two targets, and the spread for two to four."""
    figure, (axes, right) = style.page(style.PAGE, 2.6, 1, 2)
    two = pick(table, n=2)
    for name, colour, symbol in (
        ("v striker", style.BLUE, "$v_0$"),
        ("v first", style.ORANGE, "$v_1$"),
        ("v last", "black", "$v_2$"),
    ):
        axes.plot(1.0 / two["alpha"], two[name], color=colour, label=symbol)
    for velocity in rigid(2):
        axes.axhline(velocity, color=style.GREY, linewidth=0.6, linestyle="--")
    axes.set(xlabel=r"$1/\alpha$", ylabel="velocity after the collision")
    axes.legend(loc="center right")
    style.title(axes, "(a)  $n=2$")
    for n, colour in zip(SPREAD_SIZES, (style.BLUE, style.ORANGE, style.GREEN), strict=True):
        some = pick(table, n=n)
        right.semilogy(1.0 / some["alpha"], some["spread"], color=colour, label=f"$n={n}$")
    right.set(xlabel=r"$1/\alpha$", ylabel=r"$(v_{\max}-v_{\min})/\langle v\rangle$ of the targets")
    right.legend(loc="upper right")
    style.title(right, "(b)")
    return figure


def losses() -> Table:
    """The end of rigid-like behaviour: a row a bead, its velocity as a part of that of a rigid cluster."""
    cases = [(4, alpha) for alpha in EXPONENTS] + [(n, LONG_ALPHA) for n in LONG_SIZES]
    rows = [(n, alpha, np.arange(n + 1), outcome(n, alpha), outcome(n, alpha) / rigid(n)[1]) for n, alpha in cases]
    return long_table(("n", "alpha", "bead", "v", "v over rigid"), rows)


def draw_losses(table: Table) -> Figure:
    """Left: one on four, all velocities against the exponent. Right: long clusters at one small exponent."""
    figure, (axes, right) = style.page(style.PAGE, 2.7, 1, 2)
    four = pick(table, n=4)
    for bead in range(5):
        some = pick(four, bead=bead)
        order = np.argsort(some["alpha"])
        axes.semilogx(some["alpha"][order], some["v"][order], color=style.ORDER[bead], label=f"$v_{bead}$")
    axes.axvline(0.25, color=style.GREY, linewidth=0.7, linestyle=":")
    axes.annotate(r"$\alpha=1/n$", (0.25, 0.93), xytext=(-3, 0), textcoords="offset points", ha="right", fontsize=8)
    axes.axvline(1.0, color=style.GREY, linewidth=0.7, linestyle=":")
    axes.set(xlabel=r"$\alpha$", ylabel="velocity after the collision", xlim=(1.0 / 30.0, 2.0))
    axes.legend(loc="lower left", ncols=2, bbox_to_anchor=(0.0, 0.13), columnspacing=0.8, handlelength=1.2)
    style.title(axes, "(a)  $n=4$")
    for n, colour in zip(LONG_SIZES, (style.BLUE, style.ORANGE, style.RED), strict=True):
        some = pick(table, n=n, alpha=LONG_ALPHA)
        right.plot(
            some["bead"][1:] / n, some["v over rigid"][1:], color=colour, marker="o", markersize=3, label=f"$n={n}$"
        )
    right.axhline(1.0, color=style.GREY, linewidth=0.6, linestyle="--")
    right.set(xlabel="$i/n$", ylabel=r"$v_i\,/\,\frac{2}{n+1}$", xlim=(0.0, 1.04))
    right.legend(loc="lower right")
    style.title(right, r"(b)  $\alpha=1/10$")
    return figure
