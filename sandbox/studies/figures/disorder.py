"""Collisions of random chains, which the paper mentions without showing data.

A soft cluster stays rigid-like as long as every contact is strong enough. The required strength is computed by
`softcradle.physics.analysis.measures.loads`. The pulse of the usual cradle always breaks up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics import Chain
from softcradle.physics.analysis.measures import loads
from softcradle.sandbox.studies.data_table import Array, Table, long_table, rows_where
from softcradle.sandbox.studies.paper import full_motion, power_laws, random_beads, spread_by_mass, start
from softcradle.sandbox.studies.plot_style import BLUE, GREY, ORANGE, PAGE_WIDTH, RED, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TARGETS = 6
CHAINS = 40  # Number of random chains of each kind, in addition to the homogeneous chain.
SEED = 20100324
# Masses and strengths lie between 1/WIDTH and WIDTH. The logarithms of these numbers have a uniform distribution.
WIDTH = 2.0
SOFT = 0.0  # Value of the column "kind" for soft chains.
CRADLE = 1.0  # Value of the column "kind" for the usual cradle.
SOFT_EXPONENTS = (1.0 / 50.0, 1.0 / 30.0)  # Range of the exponents in a soft chain.
CRADLE_EXPONENT = 1.5  # Exponent of the Hertz contacts in the usual cradle.

# Time step of the conserving method [s]. Contacts deep inside a random soft chain chatter for a long time. An adaptive
# method would resolve every closing, without any visible effect.
STEP = 2e-4


def chains(kind: float) -> list[Chain]:
    """Return the homogeneous chain and then the random chains of the given kind.

    The chains of both kinds have the same masses and strengths.
    """
    random = np.random.default_rng(SEED)
    found = [_chain(kind, np.ones(TARGETS + 1), np.ones(TARGETS), np.full(TARGETS, 0.5))]
    for _ in range(CHAINS):
        masses, strengths = random_beads(random, TARGETS, WIDTH)
        found.append(_chain(kind, masses, strengths, random.uniform(0.0, 1.0, TARGETS)))
    return found


def _chain(kind: float, masses: Array, strengths: Array, place: Array) -> Chain:
    low, high = SOFT_EXPONENTS if kind == SOFT else (CRADLE_EXPONENT, CRADLE_EXPONENT)
    return Chain(masses, power_laws(strengths, low + (high - low) * place))


def outcomes() -> Table:
    """Compute the velocity of each bead relative to a rigid target cluster of the same masses.

    There is one row for each bead. Chain 0 is homogeneous.
    """
    rows = []
    for kind in (SOFT, CRADLE):
        for k, chain in enumerate(chains(kind)):
            velocity = full_motion(chain, start(chain), samples=2, step=STEP).final_velocity
            rigid_velocity = 2.0 * chain.mass[0] / sum(chain.mass)
            load = loads(chain)[1:].max()
            rows.append(
                (kind, k, load, np.arange(TARGETS + 1), np.array(chain.mass), velocity, velocity / rigid_velocity)
            )
    return long_table(("kind", "chain", "load", "bead", "mass", "v", "v over rigid"), rows)


def spread(table: Table, kind: float, chain: int) -> float:
    """Return the spread of the velocities of the targets of a chain, weighted by mass."""
    beads = rows_where(table, kind=kind, chain=chain)
    return spread_by_mass(beads["mass"][1:], beads["v"][1:])


def loads_and_spreads(table: Table, kind: float) -> tuple[Array, Array]:
    """Return two values for each chain: the largest load of an inner contact, and the spread of the target velocities."""
    numbers = range(CHAINS + 1)
    load = np.array([rows_where(table, kind=kind, chain=k)["load"][0] for k in numbers])
    return load, np.array([spread(table, kind, k) for k in numbers])


def draw_outcomes(table: Table) -> Figure:
    """Draw the velocities of all targets in both kinds of chain.

    A panel between them shows the spread in soft chains over their load.
    """
    titles = r"(a)  $\alpha_{i,i+1}$ from 1/50 to 1/30", "(b)  the chains of (a)", r"(c)  $\alpha=3/2$, usual cradle"
    figure, (left, middle, right) = new_figure(PAGE_WIDTH, 2.6, 1, 3, titles)
    _draw_velocities(left, table, SOFT)
    _draw_velocities(right, table, CRADLE)
    for colour, text in ((RED, "all alike"), (BLUE, "loads < 1"), (ORANGE, "a load > 1")):
        left.plot([], [], color=colour, label=text)
    left.legend(loc="lower right")
    load, spreads = loads_and_spreads(table, SOFT)
    for rows, colour in ((load < 1.0, BLUE), (load >= 1.0, ORANGE), (slice(1), RED)):
        middle.semilogy(load[rows], spreads[rows], "o", color=colour, markersize=3.5)
    middle.axvline(1.0, color=GREY, linewidth=0.7, linestyle=":")
    middle.set(xlabel="greatest load of an inner contact", ylabel="spread of the targets")
    return figure


def _draw_velocities(axes: Axes, table: Table, kind: float) -> None:
    """Draw one curve for each chain.

    The homogeneous chain is red and on top. Soft chains with an overloaded contact are orange.
    """
    for k in range(CHAINS, -1, -1):
        beads = rows_where(table, kind=kind, chain=k)
        overloaded = kind == SOFT and beads["load"][0] >= 1.0
        axes.plot(
            beads["bead"][1:], beads["v over rigid"][1:], marker="o", markersize=2.0,
            color=RED if k == 0 else ORANGE if overloaded else BLUE,
            linewidth=1.6 if k == 0 else 0.5, alpha=1.0 if k == 0 else 0.6, zorder=3 if k == 0 else 2,
        )  # fmt: skip
    axes.axhline(1.0, color=GREY, linewidth=0.6, linestyle="--")
    axes.set(xlabel="bead $i$", ylabel="$v_i$ / velocity of a rigid target", xticks=range(1, TARGETS + 1))
