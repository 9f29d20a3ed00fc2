"""Figures of alternatives to the evanescent mode, and of the evanescent mode under a steady force.

The alternatives are springs that also pull, contacts under prestress, and the pulse of the usual cradle.

The contact law only pushes. Linear contacts can have a prestress that they never lose. Around their rest position they
then act like springs that push and pull. The prestress is a steady force on both ends, which are free. The scenes
stiff-springs and prestressed show the same motions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from softcradle.physics import Contact, State, advance, hertz, hooke, one_on, power_law
from softcradle.physics.analysis.ringing import returns
from softcradle.sandbox.scene_runs import KEEPING
from softcradle.sandbox.studies.data_table import Table, long_table, rows_where
from softcradle.sandbox.studies.paper import (
    ALPHA,
    SPRING_PRESTRESS,
    N,
    driven_amplitude,
    driven_chain,
    driven_period,
    full_motion,
    model_motion,
    pressed_cluster,
    start,
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
    inner_label,
    label_above,
    model_legend,
    new_figure,
    panel_title,
    zero_line,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SPRING = hooke(400.0)
SOFT = power_law(1.0, ALPHA)
SOFT_PRESTRESS = 0.75  # Prestress of the soft cluster, a force. The contacts of this cluster stay closed all the time.
STEP = 1e-4  # Time step in units of time.
SAMPLES = 1000
PULSE_TARGETS = 30
PULSE_UNTIL = 40.0  # End of the simulation of the pulse in units of time.


@dataclass(frozen=True)
class StruckCluster:
    """A cluster of beads that a striker hits, with its contacts and prestress.

    Attributes:
        title: title of the panel.
        inner: contact law inside the cluster.
        prestress: force that presses the cluster together at rest.
        until: end of the simulation.
        speed: speed of the striker.
    """

    title: str
    inner: Contact
    prestress: float
    until: float
    speed: float


STRUCK_CLUSTERS = {
    "soft": StruckCluster("(a) inner $\\alpha=1/10$, evanescent", SOFT, 0.0, 3.0, 1.0),
    "springs": StruckCluster("(b) stiff springs", SPRING, SPRING_PRESTRESS, 3.0, 1.0),
    # The striker is so slow that no contact opens.
    "prestressed": StruckCluster("(c) inner $\\alpha=1/10$, prestressed", SOFT, SOFT_PRESTRESS, 24.0, 0.1),
}


def roads() -> Table:
    """Compute collisions with three clusters: with evanescent mode, with stiff springs, and soft under prestress."""
    return {
        f"{key} {name}": column for name, cluster in STRUCK_CLUSTERS.items() for key, column in _motion(cluster).items()
    }


def _motion(cluster: StruckCluster) -> Table:
    """Compute the motion of a cluster that starts at rest under its prestress.

    The columns are t, the velocities relative to the speed of the striker, and the inner forces minus the prestress.
    """
    chain, speed = pressed_cluster(N, cluster.inner, cluster.prestress), cluster.speed
    state = State.at_start(chain, speed * np.array(start(chain)))
    rows = []
    for _ in range(SAMPLES):
        force = [float(law.force(d)) for law, d in zip(chain.contact, state.overlap.tolist(), strict=True)]
        rows.append((state.time, *(state.velocity(chain) / speed), *(np.array(force[1:]) - cluster.prestress)))
        advance(chain, state, cluster.until / SAMPLES, KEEPING, STEP)
    names = ("t", *(f"v{i}" for i in range(N + 1)), *(f"f{i}{i + 1}" for i in range(1, N)))
    return dict(zip(names, np.array(rows).T, strict=True))


def pulse() -> Table:
    """Compute the time t and the velocities when one Hertz bead hits thirty."""
    chain = one_on(PULSE_TARGETS, hertz(1.0))
    found = full_motion(chain, start(chain), PULSE_UNTIL)
    return {"t": found.time, **{f"v{i}": found.velocity[:, i] for i in range(PULSE_TARGETS + 1)}}


def draw_roads(table: Table) -> Figure:
    """Draw velocities of the targets in the upper row, and forces of the inner contacts in the lower row."""
    figure, grid = new_figure(PAGE_WIDTH, 3.8, 2, 3, sharex="col")
    for (upper, lower), name in zip(grid.T, STRUCK_CLUSTERS, strict=True):
        for i, colour in zip(range(N, 0, -1), (PURPLE, GREEN, BLACK, ORANGE), strict=True):
            upper.plot(table[f"t {name}"], table[f"v{i} {name}"], color=colour, linewidth=0.8, label=f"$v_{i}$")
        for i, colour in zip(range(1, N), (ORANGE, GREEN, PURPLE), strict=True):
            symbol, force = f"$f_{{{i},{i + 1}}}$", table[f"f{i}{i + 1} {name}"]
            lower.plot(table[f"t {name}"], force, color=colour, linewidth=0.8, label=symbol)
        zero_line(lower)
        lower.set(xlabel="$t$", xlim=(0.0, STRUCK_CLUSTERS[name].until))
        panel_title(upper, STRUCK_CLUSTERS[name].title)
    for axes in grid[0, :2]:
        axes.set_ylim(-0.02, 0.7)
    inner_label(grid[0, 0], "striker's $\\alpha=1/30$ in all", 0.06, 0.94, fontsize=7.5)
    grid[0, 0].set_ylabel("velocity / striker's")
    grid[1, 0].set_ylabel("force less prestress")
    coloured: dict[str, Any] = {"handlelength": 0.0, "handletextpad": 0.0, "labelcolor": "linecolor"}
    grid[0, 1].legend(loc="lower right", ncols=2, columnspacing=1.0, **coloured)
    grid[1, 0].legend(loc="upper right", **coloured)
    return figure


def draw_pulse(table: Table) -> Figure:
    """Draw the velocities of all beads, each shifted by the number of the bead.

    One pulse of constant shape moves along the chain, and the last bead leaves.
    """
    figure, axes = new_figure(height=3.2)
    for i in range(0, PULSE_TARGETS + 1, 2):
        axes.plot(table["t"], table[f"v{i}"] * 3.0 + i, color=BLUE if i == 0 else BLACK, linewidth=0.8)
    label_above(axes, 0.5 * PULSE_UNTIL, 3.0 * table["v0"][-1], "striker", BLUE, 2.5, fontsize=8.6)
    axes.set(xlabel="$t$", ylabel=r"bead $i$, lifted by $3\,v_i$", xlim=(0.0, PULSE_UNTIL))
    inner_label(axes, r"$\alpha=3/2,\ n=30$", 0.03, 0.985)
    return figure


SHOWN_BEADS = 4  # Number of beads in the figure over time.
SIZES = (2, 3, 4)  # Numbers of beads in the scan.
ALPHAS = tuple(1.0 / k for k in (5, 7, 10, 14, 20))  # Exponents in the scan.
PERIODS = 5  # Length of each simulation in periods of the model.
SAMPLES_PER_PERIOD = 200
STEPS_PER_SAMPLE = 20


def history() -> Table:
    """Compute t, psi of the full equations and of the model, and the velocities relative to the centre of mass."""
    chain, end = driven_chain(SHOWN_BEADS, ALPHA), PERIODS * driven_period(SHOWN_BEADS, ALPHA)
    arguments = chain, (0.0,) * SHOWN_BEADS, end, PERIODS * SAMPLES_PER_PERIOD + 1
    step = end / (PERIODS * SAMPLES_PER_PERIOD * STEPS_PER_SAMPLE)
    full, model = full_motion(*arguments, step=step), model_motion(*arguments, step=step)
    table = {"t": full.time, "psi full": full.overlap[:, 0], "psi model": model.trajectory.overlap[:, 0]}
    centre = full.momentum / SHOWN_BEADS
    table |= {f"v{i + 1} - V": full.velocity[:, i] - centre for i in range(SHOWN_BEADS)}
    return table | {"V": centre}


def measured(n: int, alpha: float) -> tuple[float, float, float]:
    """Return the period and the amplitude of psi in the full equations, and psi at its fifth return to zero.

    The third number is relative to the amplitude. The fifth return is an event of the full motion. The period is a
    fifth of its time.
    """
    chain = driven_chain(n, alpha)
    end, count = (PERIODS + 0.5) * driven_period(n, alpha), (PERIODS + 1) * SAMPLES_PER_PERIOD
    full = full_motion(chain, (0.0,) * n, end, count + 1, step=end / (count * STEPS_PER_SAMPLE))
    times, least = returns(full, 0)
    largest = float(full.overlap[:, 0].max())
    return times[PERIODS - 1] / PERIODS, largest, abs(least[PERIODS - 1]) / largest


def scan() -> Table:
    """Compute period and amplitude of psi over n and alpha, from the full equations and from the model."""
    rows = [
        (n, alpha, *measured(n, alpha), driven_period(n, alpha), driven_amplitude(n, alpha))
        for n in SIZES
        for alpha in ALPHAS
    ]
    measures = ("period full", "amplitude full", "psi at the fifth return", "period model", "amplitude model")
    return long_table(("n", "alpha", *measures), rows)


def draw_history(table: Table) -> Figure:
    """Draw the periodic mode psi on top of the uniform acceleration of the cluster."""
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
    """Draw period and amplitude over 1/alpha. Lines show the closed formulas."""
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.6, 1, 2, ("(a)", "(b)"))
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
    return figure
