"""Not shown in the paper: a steady force on a cluster at rest, and the evanescent mode that it excites.

The force acts on the first bead. The mode-coupling model of it is one overlap, for unit strength
``psi'' = F/m1 - (1/m1 + 1/M) psi**alpha``, whose energy gives amplitude and period in closed form: for n unit beads

    psi_max = ((1 + alpha) F (n-1)/n)**(1/alpha),   T = sqrt(2 psi_max / F) B(1/(2 alpha), 1/2) / alpha
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics import Chain, power_law
from softcradle.sandbox.studies.data_table import Array, Table, long_table, rows_where
from softcradle.sandbox.studies.figures.solved_cases import ALPHA, full_motion, model_motion
from softcradle.sandbox.studies.plot_style import (
    BLACK,
    BLUE,
    GREEN,
    MODEL_LINE,
    ORANGE,
    PAGE_WIDTH,
    PURPLE,
    RED,
    label_above,
    model_legend,
    new_figure,
    panel_title,
    zero_line,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORCE = 1.0
SHOWN_BEADS = 4  # cluster size of the figure over time
SIZES = (2, 3, 4)  # cluster sizes of the scan
ALPHAS = tuple(1.0 / k for k in (5, 7, 10, 14, 20))  # exponents of the scan
PERIODS = 5  # length of every run, in periods of the model
SAMPLES_PER_PERIOD = 200
STEPS_PER_SAMPLE = 20


def driven_chain(n: int, alpha: float) -> Chain:
    """`n` unit beads that just touch, the steady force on the first."""
    return Chain([1.0] * n, power_law(1.0, alpha), drive=[FORCE] + [0.0] * (n - 1))


def amplitude(n: int, alpha: float) -> float:
    """Largest psi of the model."""
    return float(((1.0 + alpha) * FORCE * (n - 1) / n) ** (1.0 / alpha))


def period(n: int, alpha: float) -> float:
    """Period of the model."""
    x = 0.5 / alpha
    beta = math.sqrt(math.pi) * math.exp(math.lgamma(x) - math.lgamma(x + 0.5))  # B(x, 1/2)
    return math.sqrt(2.0 * amplitude(n, alpha) / FORCE) * beta / alpha


def history() -> Table:
    """t, psi of the full equations and of the model, and the velocities against that of the centre of mass."""
    chain, end = driven_chain(SHOWN_BEADS, ALPHA), PERIODS * period(SHOWN_BEADS, ALPHA)
    arguments = chain, (0.0,) * SHOWN_BEADS, end, PERIODS * SAMPLES_PER_PERIOD + 1
    step = end / (PERIODS * SAMPLES_PER_PERIOD * STEPS_PER_SAMPLE)
    full, model = full_motion(*arguments, step=step), model_motion(*arguments, step=step)
    table = {"t": full.time, "psi full": full.overlap[:, 0], "psi model": model.trajectory.overlap[:, 0]}
    centre = full.momentum / SHOWN_BEADS
    table |= {f"v{i + 1} - V": full.velocity[:, i] - centre for i in range(SHOWN_BEADS)}
    return table | {"V": centre}


def measured(n: int, alpha: float) -> tuple[float, float, float]:
    """Period and amplitude of psi in the full equations, and how far it is from zero again after five periods.

    The period is that between the first and the last of the maxima; the last number is a part of the amplitude.
    """
    chain = driven_chain(n, alpha)
    end, count = PERIODS * period(n, alpha), PERIODS * SAMPLES_PER_PERIOD
    full = full_motion(chain, (0.0,) * n, end, count + 1, step=end / (count * STEPS_PER_SAMPLE))
    psi = full.overlap[:, 0]
    maxima = np.array([_maximum(full.time, psi, k) for k in range(PERIODS)])
    remainder = psi[-SAMPLES_PER_PERIOD // 4 :].min() / maxima[0, 1]
    return (maxima[-1, 0] - maxima[0, 0]) / (PERIODS - 1), maxima[0, 1], remainder


def _maximum(time: Array, psi: Array, k: int) -> tuple[float, float]:
    """Time and height of the k-th maximum, by a parabola through the three samples about it."""
    first = k * SAMPLES_PER_PERIOD
    i = first + 1 + int(np.argmax(psi[first + 1 : first + SAMPLES_PER_PERIOD]))
    left, middle, right = psi[i - 1 : i + 2]
    shift = 0.5 * (left - right) / (left - 2.0 * middle + right)
    return time[i] + shift * (time[1] - time[0]), middle - 0.25 * (left - right) * shift


def scan() -> Table:
    """Period and amplitude against n and alpha, full and model."""
    rows = [(n, alpha, *measured(n, alpha), period(n, alpha), amplitude(n, alpha)) for n in SIZES for alpha in ALPHAS]
    measures = ("period full", "amplitude full", "least psi after 5 periods", "period model", "amplitude model")
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
        velocity = table[f"v{i} - V"]
        lower.plot(table["t"], velocity, color=colour, linewidth=0.9)
        if i < 3:
            peak = int(np.argmax(velocity[:SAMPLES_PER_PERIOD]))
            label_above(lower, table["t"][peak], velocity[peak], "$v_1$" if i == 1 else "$v_{2,3,4}$", colour)
    lower.set(xlabel="$t$", ylabel="$v_i-V$", xlim=(0.0, table["t"][-1]), ylim=(-0.09, 0.11))
    return figure


def draw_scan(table: Table) -> Figure:
    """Period and amplitude against 1/alpha; lines are the closed forms."""
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.6, 1, 2)
    alphas = np.geomspace(1.0 / 22.0, 1.0 / 4.5, 60)
    for n, colour in zip(SIZES, (BLUE, ORANGE, GREEN), strict=True):
        points = rows_where(table, n=n)
        for axes, name, law in ((left, "period", period), (right, "amplitude", amplitude)):
            axes.semilogy(1.0 / alphas, [law(n, alpha) for alpha in alphas], color=colour, linewidth=0.8)
            axes.semilogy(
                1.0 / points["alpha"], points[f"{name} full"], "o", color=colour, markersize=3.5, label=f"$n={n}$"
            )
    left.set(xlabel=r"$1/\alpha$", ylabel="period")
    right.set(xlabel=r"$1/\alpha$", ylabel=r"$\max\,\psi$")
    left.legend(loc="lower left")
    panel_title(left, "(a)")
    panel_title(right, "(b)")
    return figure
