"""Appendix A, i to iii: striker and target exchanged, cluster on cluster, a Hooke interface."""

from __future__ import annotations

from typing import TYPE_CHECKING

from softcradle.physics import Chain, cluster_on_cluster, hooke, one_on, power_law
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.figures.solved_cases import ALPHA, SOFTER, N, Table, coupled, soft, solved, start

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INTERFACE = one_on(N, (hooke(1.0), *(power_law(1.0, ALPHA),) * (N - 1)))
STRIKERS, TARGETS = 3, 5
CLUSTERS = cluster_on_cluster(STRIKERS, TARGETS, power_law(1.0, SOFTER))


def forces(chain: Chain, strikers: int, until: float) -> Table:
    """t, the forces of the full equations and of the model, and the velocities."""
    full = solved(chain, start(chain, strikers), until)
    model = coupled(chain, start(chain, strikers), until).trajectory
    names = [f"f{i}{i + 1}" for i in range(chain.contacts)]
    table = {"t": full.time}
    for i, name in enumerate(names):
        table |= {f"{name} full": full.force[:, i], f"{name} model": model.force[:, i]}
    return table | {f"v{i}": full.velocity[:, i] for i in range(chain.contacts + 1)}


def interface() -> Table:
    """One on four with a linear spring between striker and target."""
    return forces(INTERFACE, 1, 3.2)


def clusters() -> Table:
    """Three on five: two evanescent modes."""
    return forces(CLUSTERS, STRIKERS, 4.6)


def exchange() -> Table:
    """One on four, and four on one seen by an observer who moves along with the strikers, from right to left."""
    one, four = soft(N, ALPHA), cluster_on_cluster(N, 1, power_law(1.0, ALPHA))
    there, back = solved(one, start(one), 3.0), solved(four, start(four, N), 3.0)
    table = {"t": there.time}
    table |= {f"v{i}": there.velocity[:, i] for i in range(N + 1)}
    table |= {f"v{i} exchanged": back.velocity[:, i] for i in range(N + 1)}
    return table | {f"v{i} seen": 1.0 - back.velocity[:, N - i] for i in range(N + 1)}


def _draw_forces(axes: Axes, table: Table, contacts: int, struck: int) -> None:
    for i in range(contacts):
        colour = style.ORDER[(i - struck) % len(style.ORDER)]
        axes.plot(
            table["t"], table[f"f{i}{i + 1} model"], color=colour, linestyle=(0, (4, 2)), linewidth=2.0, alpha=0.5
        )
        axes.plot(table["t"], table[f"f{i}{i + 1} full"], color=colour, linewidth=0.8, label=f"$f_{{{i},{i + 1}}}$")
    axes.set(xlabel="$t$", ylabel="force", xlim=(0.0, table["t"][-1]), ylim=(0.0, None))


def _draw_velocities(axes: Axes, table: Table, beads: int, strikers: int) -> None:
    style.zero(axes)
    for i in range(beads):
        axes.plot(
            table["t"],
            table[f"v{i}"],
            color=style.BLUE if i < strikers else style.ORANGE if i == strikers else "black",
            linewidth=0.9,
        )
    axes.set(xlabel="$t$", ylabel="velocity", xlim=(0.0, table["t"][-1]))


def draw_interface(table: Table) -> Figure:
    """Forces and velocities with the Hooke interface."""
    figure, (axes, right) = style.page(style.PAGE, 2.6, 1, 2)
    _draw_forces(axes, table, N, 0)
    axes.legend(loc="upper right")
    _draw_velocities(right, table, N + 1, 1)
    style.title(axes, r"(a)  $\alpha_{0,1}=1$, inner $\alpha=1/10$")
    style.title(right, "(b)")
    return figure


def draw_clusters(table: Table) -> Figure:
    """Forces and velocities of three on five."""
    figure, (axes, right) = style.page(style.PAGE, 2.8, 1, 2)
    _draw_forces(axes, table, STRIKERS + TARGETS - 1, STRIKERS - 1)
    axes.set_ylim(0.0, 1.3)
    axes.legend(loc="upper right", ncols=4, columnspacing=1.0)
    _draw_velocities(right, table, STRIKERS + TARGETS, STRIKERS)
    style.title(axes, r"(a)  3 on 5, $\alpha=1/14$")
    style.title(right, "(b)")
    return figure


def draw_exchange(table: Table) -> Figure:
    """Left: four on one as it is. Right: seen from the strikers and mirrored, on top of one on four."""
    figure, (axes, right) = style.page(style.PAGE, 2.6, 1, 2, sharey=True)
    style.zero(axes)
    style.zero(right)
    for i in range(N + 1):
        colour = style.BLUE if i == 0 else style.ORANGE if i == 1 else "black"
        axes.plot(table["t"], table[f"v{N - i} exchanged"], color=colour)
        right.plot(table["t"], table[f"v{i} seen"], color=colour, linestyle=(0, (4, 2)), linewidth=2.2, alpha=0.5)
        right.plot(table["t"], table[f"v{i}"], color=colour, linewidth=0.8)
    axes.set(xlabel="$t$", ylabel="velocity", xlim=(0.0, 3.0))
    right.set(xlabel="$t$", xlim=(0.0, 3.0))
    style.title(axes, "(a)  four on one")
    style.title(right, "(b)  its mirror image, seen by the strikers, and one on four")
    return figure
