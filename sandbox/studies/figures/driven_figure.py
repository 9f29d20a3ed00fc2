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
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.figures.solved_cases import ALPHA, Array, Table, coupled, long_table, pick, solved

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORCE = 1.0
PERIODS = 5
SHOWN_SIZE = 4
SIZES, ALPHAS = (2, 3, 4), tuple(1.0 / k for k in (5, 7, 10, 14, 20))
PER_PERIOD = 200  # samples
STEPS = 20  # a sample


def driven(n: int, alpha: float) -> Chain:
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
    chain, end = driven(SHOWN_SIZE, ALPHA), PERIODS * period(SHOWN_SIZE, ALPHA)
    rest, count = (0.0,) * SHOWN_SIZE, PERIODS * PER_PERIOD + 1
    step = end / ((count - 1) * STEPS)
    full, model = solved(chain, rest, end, count, step=step), coupled(chain, rest, end, count, step=step)
    table = {"t": full.time, "psi full": full.overlap[:, 0], "psi model": model.trajectory.overlap[:, 0]}
    centre = full.momentum / SHOWN_SIZE
    table |= {f"v{i + 1} - V": full.velocity[:, i] - centre for i in range(SHOWN_SIZE)}
    return table | {"V": centre}


def measured(n: int, alpha: float) -> tuple[float, float, float]:
    """Period and amplitude of psi in the full equations, and how far it is from zero again after five periods.

    The period is that between the first and the last of the maxima; the last number is a part of the amplitude.
    """
    chain = driven(n, alpha)
    end, count = PERIODS * period(n, alpha), PERIODS * PER_PERIOD
    full = solved(chain, (0.0,) * n, end, count + 1, step=end / (count * STEPS))
    psi = full.overlap[:, 0]
    tops = np.array([_top(full.time, psi, k) for k in range(PERIODS)])
    return (tops[-1, 0] - tops[0, 0]) / (PERIODS - 1), tops[0, 1], psi[-PER_PERIOD // 4 :].min() / tops[0, 1]


def _top(time: Array, psi: Array, k: int) -> tuple[float, float]:
    """Time and height of the k-th maximum, by a parabola through the three samples about it."""
    first = k * PER_PERIOD
    i = first + 1 + int(np.argmax(psi[first + 1 : first + PER_PERIOD]))
    left, middle, right = psi[i - 1 : i + 2]
    shift = 0.5 * (left - right) / (left - 2.0 * middle + right)
    return time[i] + shift * (time[1] - time[0]), middle - 0.25 * (left - right) * shift


def scan() -> Table:
    """Period and amplitude against n and alpha, full and model."""
    rows = [(n, alpha, *measured(n, alpha), period(n, alpha), amplitude(n, alpha)) for n in SIZES for alpha in ALPHAS]
    names = (
        "n",
        "alpha",
        "period full",
        "amplitude full",
        "least psi after 5 periods",
        "period model",
        "amplitude model",
    )
    return long_table(names, rows)


def draw_history(table: Table) -> Figure:
    """The periodic mode on top of the uniform acceleration."""
    figure, (axes, lower) = style.page(height=3.6, rows=2, sharex=True)
    axes.plot(table["t"], table["psi model"], color=style.RED, linestyle=(0, (4, 2)), linewidth=2.0, alpha=0.5)
    axes.plot(table["t"], table["psi full"], color=style.RED, linewidth=0.9)
    axes.set(ylabel=r"$\psi$", ylim=(-0.012, 0.2))
    axes.plot([], [], color=style.GREY, linestyle=(0, (4, 2)), linewidth=2.0, alpha=0.5, label="mode coupling")
    axes.plot([], [], color=style.GREY, linewidth=0.9, label="full")
    axes.legend(loc="upper right", ncols=2)
    style.zero(axes)
    style.zero(lower)
    for i, colour in zip(range(SHOWN_SIZE, 0, -1), (style.PURPLE, style.GREEN, "black", style.ORANGE), strict=True):
        lower.plot(table["t"], table[f"v{i} - V"], color=colour, linewidth=0.9)
        if i < 3:
            top = int(np.argmax(table[f"v{i} - V"][:PER_PERIOD]))
            text = "$v_1$" if i == 1 else "$v_{2,3,4}$"
            lower.annotate(
                text, (table["t"][top], table[f"v{i} - V"][top]), xytext=(0, 5), textcoords="offset points",
                color=colour, ha="center",
            )  # fmt: skip
    lower.set(xlabel="$t$", ylabel="$v_i-V$", xlim=(0.0, table["t"][-1]), ylim=(-0.09, 0.11))
    return figure


def draw_scan(table: Table) -> Figure:
    """Period and amplitude against 1/alpha; lines are the closed forms."""
    figure, (axes, right) = style.page(style.PAGE, 2.6, 1, 2)
    fine = np.geomspace(1.0 / 22.0, 1.0 / 4.5, 60)
    for n, colour in zip(SIZES, (style.BLUE, style.ORANGE, style.GREEN), strict=True):
        some = pick(table, n=n)
        for where, name, law in ((axes, "period", period), (right, "amplitude", amplitude)):
            where.semilogy(1.0 / fine, [law(n, a) for a in fine], color=colour, linewidth=0.8)
            where.semilogy(
                1.0 / some["alpha"], some[f"{name} full"], "o", color=colour, markersize=3.5, label=f"$n={n}$"
            )
    axes.set(xlabel=r"$1/\alpha$", ylabel="period")
    right.set(xlabel=r"$1/\alpha$", ylabel=r"$\max\,\psi$")
    axes.legend(loc="lower left")
    style.title(axes, "(a)")
    style.title(right, "(b)")
    return figure
