"""Fig. 2: the mode-coupling model against the full equations, one on four, alpha = 1/10."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.figures.solved_cases import (
    ALPHA,
    N,
    Table,
    contact_time,
    coupled,
    moments,
    soft,
    solved,
    start,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CHAIN = soft(N, ALPHA)
START = start(CHAIN)
FORCES = (style.BLUE, style.ORANGE, style.GREEN, style.PURPLE)
NAMES = tuple(f"$f_{{{i},{i + 1}}}$" for i in range(N))
APART = (1.35, 1.0, 0.87, 1.0)  # factors that set the names beside the curves of Fig. 2d apart
FIRST = -16.0  # decade of time at which Fig. 2d begins


def modes() -> Table:
    """Fig. 2a: t, Phi, psi until psi is back at zero and a little beyond."""
    found = coupled(CHAIN, START, 2.5)
    assert found.phi is not None
    assert found.psi is not None
    return {"t": found.time, "Phi": found.phi, "psi": found.psi}


def forces() -> Table:
    """Fig. 2b: t, all four forces of the model and of the full equations."""
    full, model = solved(CHAIN, START, 2.5), coupled(CHAIN, START, 2.5)
    return {"t": full.time, **_columns("full", full.force), **_columns("model", model.trajectory.force)}


def discrepancies() -> Table:
    """Fig. 2c: t, and (full - model) / full for f01 and f12 while the striker is in contact.

    The times crowd at both ends, where the discrepancies do what they do.
    """
    end = contact_time(CHAIN, START)
    edge = np.logspace(-8.0, -2.0, 121) * end
    times = moments(edge, end - edge, np.linspace(0.01, 0.99, 491) * end)
    full = solved(CHAIN, START, None, times)
    model = coupled(CHAIN, START, None, times).trajectory
    off = (full.force[:, :2] - model.force[:, :2]) / full.force[:, :2]
    return {"t": full.time, "f01": off[:, 0], "f12": off[:, 1], "time to separation": end - full.time}


def rise() -> Table:
    """Fig. 2d: t from 1e-16 to 1, all four forces of the model and of the full equations."""
    times = tuple(np.logspace(FIRST, 0.0, 321).tolist())
    full, model = solved(CHAIN, START, 1.0, times), coupled(CHAIN, START, 1.0, times)
    return {"t": full.time, **_columns("full", full.force), **_columns("model", model.trajectory.force)}


def _columns(kind: str, force: np.ndarray) -> Table:
    return {f"f{i}{i + 1} {kind}": force[:, i] for i in range(N)}


def draw_modes(table: Table) -> Figure:
    """Fig. 2a."""
    figure, axes = style.page()
    style.zero(axes)
    for name, colour, symbol in (("Phi", style.BLUE, r"$\Phi$"), ("psi", style.RED, r"$\psi$")):
        shown = table[name] >= -0.12
        axes.plot(table["t"][shown], table[name][shown], color=colour)
        peak = int(np.argmax(table[name]))
        axes.annotate(
            symbol, (table["t"][peak], table[name][peak]), xytext=(0, 4), textcoords="offset points", color=colour,
            ha="center", fontsize=11,
        )  # fmt: skip
    axes.set(xlabel="$t$", ylabel=r"$\Phi,\ \psi$", xlim=(0.0, 2.5), ylim=(-0.1, 0.53))
    return figure


def draw_forces(table: Table) -> Figure:
    """Fig. 2b."""
    figure, axes = style.page(height=2.7)
    _both(axes, table)
    middle = int(np.searchsorted(table["t"], 0.9))
    for i, name in enumerate(NAMES):
        axes.annotate(
            name, (0.9, table[f"f{i}{i + 1} full"][middle]), xytext=(0, 5), textcoords="offset points",
            color=FORCES[i], ha="center",
        )  # fmt: skip
    axes.set(xlabel="$t$", ylabel="force", xlim=(0.0, 2.3), ylim=(0.0, 1.12))
    return figure


def _both(axes: Axes, table: Table) -> None:
    """Model dashed and thick, full solution solid and thin."""
    for i, colour in enumerate(FORCES):
        axes.plot(
            table["t"], table[f"f{i}{i + 1} model"], color=colour, linestyle=(0, (4, 2)), linewidth=2.2, alpha=0.55
        )
        axes.plot(table["t"], table[f"f{i}{i + 1} full"], color=colour, linewidth=0.8)
    axes.plot([], [], color=style.GREY, linestyle=(0, (4, 2)), linewidth=2.2, alpha=0.55, label="mode coupling")
    axes.plot([], [], color=style.GREY, linewidth=0.8, label="full")
    axes.legend(loc="upper right", ncols=2)


def draw_discrepancies(table: Table) -> Figure:
    """Fig. 2c, and beside it the last stretch before the striker leaves."""
    figure, (axes, end) = style.page(style.PAGE * 0.72, 2.5, 1, 2, width_ratios=(3, 2))
    axes.axhspan(-1.0, 1.0, color="0.93", zorder=0)
    style.zero(axes)
    for name, colour, symbol in (("f01", style.BLUE, "$f_{0,1}$"), ("f12", style.ORANGE, "$f_{1,2}$")):
        axes.plot(table["t"], 1e3 * table[name], color=colour, label=symbol)
        end.plot(table["time to separation"], np.abs(table[name]), color=colour, label=symbol)
    axes.set(
        xlabel="$t$", ylabel=r"relative discrepancy $/\,10^{-3}$", xlim=(0.0, table["t"][-1] * 1.02), ylim=(-1.4, 1.4)
    )
    axes.legend(loc="lower center", ncols=2)
    end.axhspan(1e-9, 1e-3, color="0.93", zorder=0)
    end.set(xlabel="time to separation", ylabel="|relative discrepancy|", xscale="log", yscale="log")
    end.set(xlim=(table["t"][-1], 1e-6), ylim=(1e-6, 1.0))
    return figure


def draw_rise(table: Table) -> Figure:
    """Fig. 2d."""
    figure, axes = style.page(height=2.8)
    for i, colour in enumerate(FORCES):
        axes.loglog(table["t"], table[f"f{i}{i + 1} full"], color=colour, linewidth=0.9)
        style.beside(axes, table["t"][-1], APART[i] * table[f"f{i}{i + 1} full"][-1], NAMES[i], colour)
    for i in range(2):
        axes.loglog(
            table["t"], table[f"f{i}{i + 1} model"], color=FORCES[i], linestyle=(0, (4, 2)), linewidth=2.4, alpha=0.5
        )
    first = table["t"] < 1e-6
    for i, (power, text) in enumerate(((ALPHA, r"$t^{\,\alpha}$"), (ALPHA * (2 + ALPHA), r"$t^{\,\alpha(2+\alpha)}$"))):
        line = 1.5 * table[f"f{i}{i + 1} full"][0] * (table["t"][first] / table["t"][0]) ** power
        axes.loglog(table["t"][first], line, color=style.GREY, linewidth=0.7, linestyle=":")
        axes.annotate(
            text, (1e-11, line[len(line) // 2]), xytext=(0, 3), textcoords="offset points", ha="center", fontsize=8
        )
    axes.set(xlabel="$t$", ylabel="force", xlim=(10.0**FIRST, 1.0))
    return figure
