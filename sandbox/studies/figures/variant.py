"""Figures of Appendix A, (i) to (iii).

The figures show a collision with striker and target exchanged, a cluster that hits a cluster, and a Hooke contact.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from softcradle.physics import Chain, cluster_on_cluster, hooke, one_on, power_law
from softcradle.sandbox.studies.data_table import Table
from softcradle.sandbox.studies.paper import ALPHA, SOFTER_ALPHA, N, full_motion, model_motion, soft_chain, start
from softcradle.sandbox.studies.plot_style import (
    BLACK,
    BLUE,
    COLOUR_CYCLE,
    MODEL_LINE,
    ORANGE,
    PAGE_WIDTH,
    bead_colour,
    model_legend,
    new_figure,
    zero_line,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INTERFACE_CHAIN = one_on(N, (hooke(1.0), *(power_law(1.0, ALPHA),) * (N - 1)))
STRIKERS = 3  # Number of strikers in the collision of two clusters.
TARGETS = 5
CLUSTERS_CHAIN = cluster_on_cluster(STRIKERS, TARGETS, power_law(1.0, SOFTER_ALPHA))


def interface() -> Table:
    """Compute a collision of one bead with four, with a linear spring between striker and target."""
    return _forces_and_velocities(INTERFACE_CHAIN, 1, 3.2)


def clusters() -> Table:
    """Compute a collision of three beads with five, which has two evanescent modes."""
    return _forces_and_velocities(CLUSTERS_CHAIN, STRIKERS, 4.6)


def _forces_and_velocities(chain: Chain, strikers: int, until: float) -> Table:
    """Compute t, the forces of the full equations and of the model, and the velocities."""
    full = full_motion(chain, start(chain, strikers), until)
    model = model_motion(chain, start(chain, strikers), until).trajectory
    table = {"t": full.time}
    for i in range(chain.contacts):
        table |= {f"f{i}{i + 1} full": full.force[:, i], f"f{i}{i + 1} model": model.force[:, i]}
    return table | {f"v{i}": full.velocity[:, i] for i in range(chain.contacts + 1)}


def exchange() -> Table:
    """Compute the collisions of one bead with four, and of four beads with one.

    The second collision is seen by an observer who moves with the strikers, and runs from right to left.
    """
    one_on_four, four_on_one = soft_chain(N, ALPHA), cluster_on_cluster(N, 1, power_law(1.0, ALPHA))
    usual = full_motion(one_on_four, start(one_on_four), 3.0)
    exchanged = full_motion(four_on_one, start(four_on_one, N), 3.0)
    table = {"t": usual.time}
    table |= {f"v{i}": usual.velocity[:, i] for i in range(N + 1)}
    table |= {f"v{i} exchanged": exchanged.velocity[:, i] for i in range(N + 1)}
    return table | {f"v{i} seen": 1.0 - exchanged.velocity[:, N - i] for i in range(N + 1)}


def draw_interface(table: Table) -> Figure:
    """Draw forces and velocities of the collision with a Hooke contact."""
    return _draw_forces_and_velocities(table, 1, N, r"(a)  $\alpha_{0,1}=1$, inner $\alpha=1/10$", 2.6, 1.3)


def draw_clusters(table: Table) -> Figure:
    """Draw forces and velocities of the collision of three beads with five."""
    return _draw_forces_and_velocities(table, STRIKERS, TARGETS, r"(a)  3 on 5, $\alpha=1/14$", 2.8, 1.45)


def _draw_forces_and_velocities(
    table: Table, strikers: int, targets: int, title: str, height: float, most: float
) -> Figure:
    """Draw forces up to `most` in the left panel, and velocities in the right panel."""
    figure, (left, right) = new_figure(PAGE_WIDTH, height, 1, 2, (title, "(b)"))
    _draw_forces(left, table, strikers + targets - 1, strikers - 1)
    left.set_ylim(0.0, most)
    model_legend(left, 3, columnspacing=1.0)
    _draw_velocities(right, table, strikers + targets, strikers)
    return figure


def draw_exchange(table: Table) -> Figure:
    """Draw the collision of four beads with one.

    The left panel shows it as it is. The right panel shows it mirrored and as seen from the strikers, on top of the
    collision of one bead with four.
    """
    titles = "(a)  four on one", "(b)  mirrored, seen by the strikers"
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.6, 1, 2, titles, sharey=True)
    zero_line(left)
    zero_line(right)
    for i in range(N + 1):
        left.plot(table["t"], table[f"v{N - i} exchanged"], color=bead_colour(i))
        right.plot(table["t"], table[f"v{i} seen"], color=bead_colour(i), **MODEL_LINE)
        right.plot(table["t"], table[f"v{i}"], color=bead_colour(i), linewidth=0.8)
    for colour, text in ((BLUE, "the single bead"), (ORANGE, "its neighbour"), (BLACK, "the other three")):
        left.plot([], [], color=colour, label=text)
    left.legend(loc="upper left", fontsize=7.5)
    right.plot([], [], color=BLACK, label="four on one, mirrored", **MODEL_LINE)
    right.plot([], [], color=BLACK, linewidth=0.8, label="one on four")
    right.legend(loc="upper right", fontsize=7.5)
    left.set(xlabel="$t$", ylabel="velocity", xlim=(0.0, 3.0))
    right.set(xlabel="$t$", xlim=(0.0, 3.0))
    return figure


def _draw_forces(axes: Axes, table: Table, contacts: int, struck: int) -> None:
    for i in range(contacts):
        colour = COLOUR_CYCLE[(i - struck) % len(COLOUR_CYCLE)]
        axes.plot(table["t"], table[f"f{i}{i + 1} model"], color=colour, **MODEL_LINE)
        axes.plot(table["t"], table[f"f{i}{i + 1} full"], color=colour, linewidth=0.8, label=f"$f_{{{i},{i + 1}}}$")
    axes.set(xlabel="$t$", ylabel="force", xlim=(0.0, table["t"][-1]), ylim=(0.0, None))


def _draw_velocities(axes: Axes, table: Table, beads: int, strikers: int) -> None:
    zero_line(axes)
    for i in range(beads):
        colour = bead_colour(i, strikers)
        axes.plot(table["t"], table[f"v{i}"], color=colour, linewidth=0.9)
    labels = (
        (BLUE, "strikers" if strikers > 1 else "striker"),
        (ORANGE, f"$v_{{{strikers}}}$"),
        (BLACK, "other targets"),
    )
    for colour, text in labels:
        axes.plot([], [], color=colour, label=text)
    axes.legend(loc="best")
    axes.set(xlabel="$t$", ylabel="velocity", xlim=(0.0, table["t"][-1]))
