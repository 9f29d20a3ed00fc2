"""Figs. 1 and 2 of the paper, in which one bead hits four.

The figures show positions and velocities, the comparison with the mode-coupling model, and oscillations of the inner
contact.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from softcradle.physics.analysis.measures import response_times
from softcradle.physics.analysis.ringing import ringing
from softcradle.sandbox.studies.data_table import Table, long_table
from softcradle.sandbox.studies.paper import ALPHA, N, full_motion, merged_times, model_motion, opening_time, soft_start
from softcradle.sandbox.studies.plot_style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    MODEL_LINE,
    ORANGE,
    PAGE_WIDTH,
    PURPLE,
    RED,
    bead_colour,
    curve_label,
    inner_label,
    label_above,
    model_legend,
    new_figure,
    zero_line,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

POSITIONS_FROM = -1.0  # Start of Fig. 1b in units of time. The striker arrives at time 0.
POSITIONS_UNTIL = 4.0
VELOCITIES_UNTIL = 3.0  # End of Figs. 1c and 1d in units of time.


def positions() -> Table:
    """Compute the time t and the positions x0 ... x4.

    Bead i starts at height i. The striker moves freely before the collision.
    """
    found = full_motion(*soft_start(N, ALPHA), POSITIONS_UNTIL)
    before = np.linspace(POSITIONS_FROM, 0.0, 100, endpoint=False)
    time = np.concatenate((before, found.time))
    position = np.concatenate((before[:, None] * found.velocity[0], found.position)) + np.arange(N + 1.0)
    return {"t": time, **{f"x{i}": position[:, i] for i in range(N + 1)}}


def velocities(alpha: float) -> Table:
    """Compute the time t and the velocities v0 ... v4 for the exponent `alpha`, starting at the first touch."""
    found = full_motion(*soft_start(N, alpha), VELOCITIES_UNTIL)
    return {"t": found.time, **{f"v{i}": found.velocity[:, i] for i in range(N + 1)}}


def draw_positions(table: Table) -> Figure:
    """Draw Fig. 1b of the paper, the positions of the beads."""
    figure, axes = new_figure(height=2.6)
    axes.axvline(0.0, color=GREY, linewidth=0.5, linestyle=":")
    for i in range(N + 1):
        axes.plot(table["t"], table[f"x{i}"], color=bead_colour(i))
        curve_label(axes, table["t"][-1], table[f"x{i}"][-1], f"$x_{i}$", bead_colour(i))
    axes.set(xlabel="$t$", ylabel="position", xlim=(POSITIONS_FROM, POSITIONS_UNTIL), yticks=range(-2, 7, 2))
    inner_label(axes, r"$n=4,\ \alpha=1/10$", 0.24)
    return figure


def draw_velocities(table: Table, alpha: float) -> Figure:
    """Draw Figs. 1c and 1d of the paper, the velocities of the beads."""
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


SIZE = 2  # Number of targets in the figure of the inner oscillations.
SHOWN = 1.0 / 17.0  # Exponent of the curve that is shown over time.
INVERSE = tuple(np.arange(16.0, 26.1, 0.5).tolist())  # Values of 1/alpha for which periods are computed.
SAMPLES = 20_001


def _while_struck(alpha: float) -> tuple[float, float]:
    return min(opening_time(SIZE, alpha), opening_time(SIZE, alpha, 1)), alpha


def history() -> Table:
    """Compute the oscillations of the inner contact.

    The first rows contain t, the force f12 and the slow solution (n-1)/n f01. Then there is one row for each exponent.
    Such a row contains 1/alpha, the number of turning points, the period, and the period of small oscillations about
    the slow solution.
    """
    end, alpha = _while_struck(SHOWN)
    found = full_motion(*soft_start(SIZE, alpha), end, 4001, 1e-10)
    branch = (SIZE - 1.0) / SIZE * found.force[:, 0]
    rows: list[tuple[ArrayLike, ...]] = [(found.time, found.force[:, 1], branch, np.nan, np.nan, np.nan, np.nan)]
    for inverse in INVERSE:
        end, alpha = _while_struck(1.0 / inverse)
        found = full_motion(*soft_start(SIZE, alpha), end, SAMPLES, 1e-10)
        heard = ringing(found.time, found.force[:, 1])
        local = 2.0 * math.pi * float(response_times(found)[1])
        rows.append((np.nan, np.nan, np.nan, inverse, heard.turns, heard.period or np.nan, local))
    return long_table(("t", "f12", "branch", "1/alpha", "turns", "period", "period of the branch"), rows)


def draw_history(table: Table) -> Figure:
    """Draw (a) the difference between f12 and its slow solution over time, and (b) the periods over 1/alpha."""
    titles = rf"(a)  $n={SIZE}$, $\alpha=1/{1 / SHOWN:.0f}$", f"(b)  $n={SIZE}$"
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.5, 1, 2, titles)
    shown = np.isfinite(table["t"]) & (table["t"] > 0.1) & (table["t"] < 1.35)
    left.plot(table["t"][shown], 1e3 * (table["f12"] - table["branch"])[shown], color=ORANGE, linewidth=0.9)
    left.axhline(0.0, color=GREY, linewidth=0.5)
    left.set(xlabel="$t$", ylabel=r"$(f_{1,2}-f_{0,1}/2)\,/\,10^{-3}$")
    inverse = table["1/alpha"]
    right.semilogy(
        inverse, table["period of the branch"], color=BLUE, linewidth=0.9, label=r"$2\pi/\omega$, largest overlap"
    )
    right.semilogy(inverse, table["period"], "o", color=ORANGE, markersize=3.5, label="measured")
    right.set(xlabel=r"$1/\alpha$", ylabel="period of $f_{1,2}$")
    right.legend(loc="upper right")
    return figure


UNTIL = 2.5  # End of Figs. 2a and 2b in units of time. The mode psi has returned to zero at 2.1.
FIRST_TIME = 1e-16  # Left end of Fig. 2d in units of time.
# Tolerance for Fig. 2d. The logarithmic axes of the figure show all overlaps. A tolerance of 1e-8 would make the
# deepest forces jump by 0.8 %.
RISE_TOLERANCE = 1e-12
FORCE_COLOURS = (BLUE, ORANGE, GREEN, PURPLE)
FORCE_SYMBOLS = tuple(f"$f_{{{i},{i + 1}}}$" for i in range(N))
# Positions of the labels of Fig. 2d relative to the forces. These positions avoid overlapping labels.
LABEL_FACTORS = (1.35, 1.0, 0.87, 1.0)
# Style of the grey band in Fig. 2c. The band marks discrepancies below 1e-3, the accuracy that the paper states.
ACCURACY_BAND = {"color": "0.93", "zorder": 0}


def modes() -> Table:
    """Compute the data of Fig. 2a: t, Phi and psi until shortly after psi has returned to zero."""
    found = model_motion(*soft_start(N, ALPHA), UNTIL)
    assert found.phi is not None
    assert found.psi is not None
    return {"t": found.time, "Phi": found.phi, "psi": found.psi}


def forces() -> Table:
    """Compute the data of Fig. 2b: t, and all four forces of the model and of the full equations."""
    full, model = full_motion(*soft_start(N, ALPHA), UNTIL), model_motion(*soft_start(N, ALPHA), UNTIL)
    return {"t": full.time, **_force_columns("full", full.force), **_force_columns("model", model.trajectory.force)}


def discrepancies() -> Table:
    """Compute the data of Fig. 2c: t, and (full - model) / full for f01 and f12 while the striker is in contact.

    The sample times are dense at both ends, where the discrepancies change most.
    """
    end = opening_time(N, ALPHA)
    edge = np.logspace(-8.0, -2.0, 121) * end
    times = merged_times(edge, end - edge, np.linspace(0.01, 0.99, 491) * end)
    full = full_motion(*soft_start(N, ALPHA), None, times)
    model = model_motion(*soft_start(N, ALPHA), None, times).trajectory
    relative = (full.force[:, :2] - model.force[:, :2]) / full.force[:, :2]
    return {"t": full.time, "f01": relative[:, 0], "f12": relative[:, 1], "time to separation": end - full.time}


def rise() -> Table:
    """Compute the data of Fig. 2d: t from 1e-16 to 1, and all four forces of the model and of the full equations."""
    times = tuple(np.logspace(np.log10(FIRST_TIME), 0.0, 321).tolist())
    full = full_motion(*soft_start(N, ALPHA), 1.0, times, RISE_TOLERANCE)
    model = model_motion(*soft_start(N, ALPHA), 1.0, times, RISE_TOLERANCE)
    return {"t": full.time, **_force_columns("full", full.force), **_force_columns("model", model.trajectory.force)}


def _force_columns(kind: str, force: np.ndarray) -> Table:
    return {f"f{i}{i + 1} {kind}": force[:, i] for i in range(N)}


def draw_modes(table: Table) -> Figure:
    """Draw Fig. 2a of the paper, the two modes Phi and psi."""
    figure, axes = new_figure()
    zero_line(axes)
    for name, colour, symbol in (("Phi", BLUE, r"$\Phi$"), ("psi", RED, r"$\psi$")):
        shown = table[name] >= -0.12
        axes.plot(table["t"][shown], table[name][shown], color=colour)
        peak = int(np.argmax(table[name]))
        label_above(axes, table["t"][peak], table[name][peak], symbol, colour, 4.0, fontsize=11)
    axes.set(xlabel="$t$", ylabel=r"$\Phi,\ \psi$", xlim=(0.0, UNTIL), ylim=(-0.1, 0.53))
    return figure


def draw_forces(table: Table) -> Figure:
    """Draw Fig. 2b of the paper, the forces of the model and of the full equations."""
    figure, axes = new_figure(height=2.7)
    for i, colour in enumerate(FORCE_COLOURS):
        axes.plot(table["t"], table[f"f{i}{i + 1} model"], color=colour, **MODEL_LINE)
        axes.plot(table["t"], table[f"f{i}{i + 1} full"], color=colour, linewidth=0.8)
    model_legend(axes)
    middle = int(np.searchsorted(table["t"], 0.9))
    for i, symbol in enumerate(FORCE_SYMBOLS):
        label_above(axes, 0.9, table[f"f{i}{i + 1} full"][middle], symbol, FORCE_COLOURS[i])
    axes.set(xlabel="$t$", ylabel="force", xlim=(0.0, 2.3), ylim=(0.0, 1.12))
    return figure


def draw_discrepancies(table: Table) -> Figure:
    """Draw Fig. 2c of the paper, the discrepancies of the forces.

    A second panel shows the end of the contact, over the remaining time until the striker separates.
    """
    titles = "(a)  while the striker pushes", "(b)  at the end"
    figure, (axes, end) = new_figure(PAGE_WIDTH * 0.72, 2.5, 1, 2, titles, width_ratios=(3, 2))
    axes.axhspan(-1.0, 1.0, **ACCURACY_BAND)
    zero_line(axes)
    for name, colour, symbol in (("f01", BLUE, "$f_{0,1}$"), ("f12", ORANGE, "$f_{1,2}$")):
        axes.plot(table["t"], 1e3 * table[name], color=colour, label=symbol)
        end.plot(table["time to separation"], np.abs(table[name]), color=colour, label=symbol)
    axes.set(xlabel="$t$", ylabel=r"relative discrepancy $/\,10^{-3}$")
    axes.set(xlim=(0.0, table["t"][-1] * 1.02), ylim=(-1.4, 1.4))
    axes.legend(loc="lower center", ncols=2)
    end.axhspan(1e-9, 1e-3, **ACCURACY_BAND)
    end.set(xlabel="time to separation", ylabel="|relative discrepancy|", xscale="log", yscale="log")
    end.set(xlim=(1e-6, table["t"][-1]), ylim=(3e-7, 1.0))
    return figure


def draw_rise(table: Table) -> Figure:
    """Draw Fig. 2d of the paper, the initial rise of the forces."""
    figure, axes = new_figure(height=2.8)
    for i, colour in enumerate(FORCE_COLOURS):
        full = table[f"f{i}{i + 1} full"]
        axes.loglog(table["t"], full, color=colour, linewidth=0.9)
        curve_label(axes, table["t"][-1], LABEL_FACTORS[i] * full[-1], FORCE_SYMBOLS[i], colour)
    for i in range(2):
        axes.loglog(table["t"], table[f"f{i}{i + 1} model"], color=FORCE_COLOURS[i], **MODEL_LINE)
    _draw_power(axes, table, "f01 full", ALPHA, r"$t^{\,\alpha}$")
    _draw_power(axes, table, "f12 full", ALPHA * (2 + ALPHA), r"$t^{\,\alpha(2+\alpha)}$")
    model_legend(axes, 1, loc="lower right")
    axes.set(xlabel="$t$", ylabel="force", xlim=(FIRST_TIME, 1.0))
    return figure


def _draw_power(axes: Axes, table: Table, name: str, power: float, text: str) -> None:
    """Draw the expected initial power of t as a dotted line slightly above the force `name`."""
    time = table["t"][table["t"] < 1e-6]
    line = 1.5 * table[name][0] * (time / time[0]) ** power
    axes.loglog(time, line, color=GREY, linewidth=0.7, linestyle=":")
    middle = len(line) // 2
    axes.annotate(
        text, (time[middle], line[middle]), xytext=(-2, 3), textcoords="offset points", ha="right", fontsize=8.6
    )
