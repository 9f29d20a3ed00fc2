"""Alternatives to the evanescent mode: springs that also pull, contacts under prestress, the pulse of the usual cradle.

The contact law only pushes. Linear contacts under a prestress that they never lose act, about their rest, like springs
that push and pull. The prestress is a steady force on both ends, so the ends are free; the scenes stiff-springs and
prestressed show the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from softcradle.physics import Chain, Contact, State, advance, hertz, hooke, one_on, power_law
from softcradle.sandbox.studies.data_table import Table
from softcradle.sandbox.studies.paper import ALPHA, N, full_motion, start
from softcradle.sandbox.studies.plot_style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PAGE_WIDTH,
    PURPLE,
    inner_label,
    label_above,
    new_figure,
    panel_title,
    zero_line,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STRIKER_CONTACT = power_law(1.0, 1.0 / 30.0)
SPRING = hooke(400.0)
SPRING_PRESTRESS = 20.0  # force; the springs stay compressed all along
SOFT = power_law(1.0, ALPHA)
SOFT_PRESTRESS = 0.75  # force; the soft contacts stay closed all along
STEP = 1e-4  # units of time
SAMPLES = 1000
PULSE_TARGETS = 30
PULSE_UNTIL = 40.0  # units of time


@dataclass(frozen=True)
class StruckCluster:
    """A cluster that is struck, with its contacts and prestress.

    Attributes:
        title: of its panel.
        inner: its contacts.
        prestress: the force that presses it together at rest.
        until: end of the run.
        speed: of the striker.
    """

    title: str
    inner: Contact
    prestress: float
    until: float
    speed: float


STRUCK_CLUSTERS = {
    "soft": StruckCluster("(a) inner $\\alpha=1/10$, evanescent", SOFT, 0.0, 3.0, 1.0),
    "springs": StruckCluster("(b) stiff springs", SPRING, SPRING_PRESTRESS, 3.0, 1.0),
    # struck so slowly that no contact opens
    "prestressed": StruckCluster("(c) inner $\\alpha=1/10$, prestressed", SOFT, SOFT_PRESTRESS, 24.0, 0.1),
}


def roads() -> Table:
    """Evanescent cluster, stiff springs, and a soft cluster under prestress, side by side."""
    return {
        f"{key} {name}": column for name, cluster in STRUCK_CLUSTERS.items() for key, column in _motion(cluster).items()
    }


def _motion(cluster: StruckCluster) -> Table:
    """t, velocities over the striker's, and the inner forces less the prestress, from rest under the prestress."""
    chain, speed = _chain(cluster.inner, cluster.prestress), cluster.speed
    state = State.at_start(chain, speed * np.array(start(chain)))
    rows = []
    for _ in range(SAMPLES):
        force = [float(law.force(d)) for law, d in zip(chain.contact, state.overlap.tolist(), strict=True)]
        rows.append((state.time, *(state.velocity(chain) / speed), *(np.array(force[1:]) - cluster.prestress)))
        advance(chain, state, cluster.until / SAMPLES, "conserving", STEP)
    names = ("t", *(f"v{i}" for i in range(N + 1)), *(f"f{i}{i + 1}" for i in range(1, N)))
    return dict(zip(names, np.array(rows).T, strict=True))


def _chain(inner: Contact, prestress: float) -> Chain:
    """A striker and N targets at rest whose ends are pressed together by the force `prestress`."""
    contacts = (STRIKER_CONTACT, *(inner,) * (N - 1))
    if not prestress:
        return one_on(N, contacts)
    drive = [0.0, prestress, *[0.0] * (N - 2), -prestress]
    gap = [0.0, *[-float(inner.overlap(prestress))] * (N - 1)]
    return Chain([1.0] * (N + 1), contacts, gap, drive)


def pulse() -> Table:
    """t and the velocities of one Hertz bead on thirty."""
    chain = one_on(PULSE_TARGETS, hertz(1.0))
    found = full_motion(chain, start(chain), PULSE_UNTIL)
    return {"t": found.time, **{f"v{i}": found.velocity[:, i] for i in range(PULSE_TARGETS + 1)}}


def draw_roads(table: Table) -> Figure:
    """Velocities of the targets in the upper row, forces of the inner contacts in the lower one."""
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
    """Velocities of all beads, each lifted by its number: one pulse of unchanging shape, and the last bead leaves."""
    figure, axes = new_figure(height=3.2)
    for i in range(0, PULSE_TARGETS + 1, 2):
        axes.plot(table["t"], table[f"v{i}"] * 3.0 + i, color=BLUE if i == 0 else BLACK, linewidth=0.8)
    label_above(axes, 0.5 * PULSE_UNTIL, 3.0 * table["v0"][-1], "striker", BLUE, 2.5, fontsize=8.6)
    axes.set(xlabel="$t$", ylabel=r"bead $i$, lifted by $3\,v_i$", xlim=(0.0, PULSE_UNTIL))
    inner_label(axes, r"$\alpha=3/2,\ n=30$", 0.03, 0.985)
    return figure
