"""Not shown in the paper: a steady force on a cluster at rest, and the evanescent mode that it excites.

The force acts on the first bead; the model's period and amplitude are closed forms.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics.analysis.ringing import returns
from softcradle.sandbox.studies.data_table import Table, long_table, rows_where
from softcradle.sandbox.studies.paper import (
    ALPHA,
    driven_amplitude,
    driven_chain,
    driven_period,
    full_motion,
    model_motion,
)
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
    model_legend,
    new_figure,
    panel_title,
    zero_line,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN_BEADS = 4  # cluster size of the figure over time
SIZES = (2, 3, 4)  # cluster sizes of the scan
ALPHAS = tuple(1.0 / k for k in (5, 7, 10, 14, 20))  # exponents of the scan
PERIODS = 5  # length of every run, in periods of the model
SAMPLES_PER_PERIOD = 200
STEPS_PER_SAMPLE = 20


def history() -> Table:
    """t, psi of the full equations and of the model, and the velocities against that of the centre of mass."""
    chain, end = driven_chain(SHOWN_BEADS, ALPHA), PERIODS * driven_period(SHOWN_BEADS, ALPHA)
    arguments = chain, (0.0,) * SHOWN_BEADS, end, PERIODS * SAMPLES_PER_PERIOD + 1
    step = end / (PERIODS * SAMPLES_PER_PERIOD * STEPS_PER_SAMPLE)
    full, model = full_motion(*arguments, step=step), model_motion(*arguments, step=step)
    table = {"t": full.time, "psi full": full.overlap[:, 0], "psi model": model.trajectory.overlap[:, 0]}
    centre = full.momentum / SHOWN_BEADS
    table |= {f"v{i + 1} - V": full.velocity[:, i] - centre for i in range(SHOWN_BEADS)}
    return table | {"V": centre}


def measured(n: int, alpha: float) -> tuple[float, float, float]:
    """Period and amplitude of psi in the full equations, and how far it is from zero at its fifth return.

    The period is a fifth of the time of that return, an event of the full motion; the last number is a part of the amplitude.
    """
    chain = driven_chain(n, alpha)
    end, count = (PERIODS + 0.5) * driven_period(n, alpha), (PERIODS + 1) * SAMPLES_PER_PERIOD
    full = full_motion(chain, (0.0,) * n, end, count + 1, step=end / (count * STEPS_PER_SAMPLE))
    times, least = returns(full, 0)
    largest = float(full.overlap[:, 0].max())
    return times[PERIODS - 1] / PERIODS, largest, abs(least[PERIODS - 1]) / largest


def scan() -> Table:
    """Period and amplitude against n and alpha, full and model."""
    rows = [
        (n, alpha, *measured(n, alpha), driven_period(n, alpha), driven_amplitude(n, alpha))
        for n in SIZES
        for alpha in ALPHAS
    ]
    measures = ("period full", "amplitude full", "psi at the fifth return", "period model", "amplitude model")
    return long_table(("n", "alpha", *measures), rows)


def draw_history(table: Table) -> Figure:
    """The periodic mode on top of the uniform acceleration."""
    figure, (upper, lower) = new_figure(height=3.6, rows=2, sharex=True)
    upper.plot(table["t"], table["psi model"], color=RED, **MODEL_LINE)
    upper.plot(table["t"], table["psi full"], color=RED, linewidth=0.9)
    upper.set(ylabel=r"$\psi$", ylim=(-0.012, 0.2))
    model_legend(upper)
    zero_line(upper)
    zero_line(lower)
    for i, colour in zip(range(SHOWN_BEADS, 0, -1), (PURPLE, GREEN, BLACK, ORANGE), strict=True):
        lower.plot(table["t"], table[f"v{i} - V"], color=colour, linewidth=0.9, label=f"$v_{i}$")
    lower.legend(loc="upper right", ncols=4, columnspacing=1.2, reverse=True)
    lower.set(xlabel="$t$", ylabel="$v_i-V$", xlim=(0.0, table["t"][-1]), ylim=(-0.09, 0.13))
    return figure


def draw_scan(table: Table) -> Figure:
    """Period and amplitude against 1/alpha; lines are the closed forms."""
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.6, 1, 2)
    alphas = np.geomspace(1.0 / 22.0, 1.0 / 4.5, 60)
    for n, colour in zip(SIZES, (BLUE, ORANGE, GREEN), strict=True):
        points = rows_where(table, n=n)
        for axes, name, law in ((left, "period", driven_period), (right, "amplitude", driven_amplitude)):
            axes.semilogy(1.0 / alphas, [law(n, alpha) for alpha in alphas], color=colour, linewidth=0.8)
            axes.semilogy(
                1.0 / points["alpha"], points[f"{name} full"], "o", color=colour, markersize=3.5, label=f"$n={n}$"
            )
    left.set(xlabel=r"$1/\alpha$", ylabel="period")
    right.set(xlabel=r"$1/\alpha$", ylabel=r"$\max\,\psi$")
    left.plot([], [], color=GREY, linewidth=0.8, label="mode coupling")
    left.legend(loc="lower left")
    panel_title(left, "(a)")
    panel_title(right, "(b)")
    return figure
