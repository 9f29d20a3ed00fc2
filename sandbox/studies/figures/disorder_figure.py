"""Not shown in the paper: random chains. Soft clusters stay whole as long as every contact is strong enough.

How strong is said by `softcradle.physics.analysis.measures.loads`; the pulse of the usual cradle breaks up in any case.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics import Chain, Contact
from softcradle.physics.analysis.measures import loads
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.figures.solved_cases import Array, Table, long_table, pick, solved, start

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TARGETS, CHAINS, SEED = 6, 40, 20100324
SOFT, CRADLE = 0.0, 1.0  # in the column "kind"
SOFT_EXPONENTS, CRADLE_EXPONENT = (1.0 / 50.0, 1.0 / 30.0), 1.5
STEP = 2e-4  # deep inside, contacts of any exponents rattle on for long: the conserving method passes over that
WIDTH = 2.0  # masses and strengths lie between 1/WIDTH and WIDTH


def chains(kind: float) -> list[Chain]:
    """The homogeneous chain first, then the random ones; both kinds get the same masses and strengths."""
    random = np.random.default_rng(SEED)
    found = [_chain(kind, np.ones(TARGETS + 1), np.ones(TARGETS), np.full(TARGETS, 0.5))]
    for _ in range(CHAINS):
        masses, strengths = (WIDTH ** random.uniform(-1.0, 1.0, count) for count in (TARGETS + 1, TARGETS))
        found.append(_chain(kind, masses, strengths, random.uniform(0.0, 1.0, TARGETS)))
    return found


def _chain(kind: float, masses: Array, strengths: Array, place: Array) -> Chain:
    low, high = SOFT_EXPONENTS if kind == SOFT else (CRADLE_EXPONENT, CRADLE_EXPONENT)
    exponents = low + (high - low) * place
    return Chain(masses, [Contact(0.0, f0, a) for f0, a in zip(strengths, exponents, strict=True)])


def outcomes() -> Table:
    """A row a bead: its velocity over that of a rigid target of the same masses; chain 0 is the homogeneous one."""
    rows = []
    for kind in (SOFT, CRADLE):
        for k, chain in enumerate(chains(kind)):
            velocity = solved(chain, start(chain), samples=2, step=STEP).final_velocity
            whole = 2.0 * chain.mass[0] / sum(chain.mass)
            load = loads(chain)[1:].max()
            rows.append((kind, k, load, np.arange(TARGETS + 1), np.array(chain.mass), velocity, velocity / whole))
    return long_table(("kind", "chain", "load", "bead", "mass", "v", "v over rigid"), rows)


def spread(table: Table, kind: float, chain: int) -> float:
    """Root mean square of the targets' velocities about their mean, by mass, as a part of that mean."""
    some = pick(table, kind=kind, chain=chain)
    mass, velocity = some["mass"][1:], some["v"][1:]
    mean = np.average(velocity, weights=mass)
    return float(np.sqrt(np.average((velocity - mean) ** 2, weights=mass)) / mean)


def loads_and_spreads(table: Table, kind: float) -> tuple[Array, Array]:
    """Per chain the greatest load of an inner contact, and the spread of the targets."""
    count = range(CHAINS + 1)
    load = np.array([pick(table, kind=kind, chain=k)["load"][0] for k in count])
    return load, np.array([spread(table, kind, k) for k in count])


def draw(table: Table) -> Figure:
    """Velocities of all targets in both kinds of chain, and between them what decides on the soft ones."""
    figure, axes = style.page(style.PAGE, 2.6, 1, 3)
    titles = (r"(a)  $\alpha_{i,i+1}$ from 1/50 to 1/30", r"(c)  $\alpha=3/2$, usual cradle")
    for kind, where, title in zip((SOFT, CRADLE), axes[::2], titles, strict=True):
        for k in range(CHAINS, -1, -1):
            some = pick(table, kind=kind, chain=k)
            colour = style.RED if k == 0 else style.ORANGE if kind == SOFT and some["load"][0] >= 1.0 else style.BLUE
            where.plot(
                some["bead"][1:], some["v over rigid"][1:], color=colour, marker="o", markersize=2.0,
                linewidth=1.6 if k == 0 else 0.5, alpha=1.0 if k == 0 else 0.6, zorder=3 if k == 0 else 2,
            )  # fmt: skip
        where.axhline(1.0, color=style.GREY, linewidth=0.6, linestyle="--")
        where.set(xlabel="bead $i$", ylabel="$v_i$ / velocity of a rigid target", xticks=range(1, TARGETS + 1))
        style.title(where, title)
    for colour, text in ((style.RED, "all alike"), (style.BLUE, "loads < 1"), (style.ORANGE, "a load > 1")):
        axes[0].plot([], [], color=colour, label=text)
    axes[0].legend(loc="lower right")
    load, spreads = loads_and_spreads(table, SOFT)
    for rows, colour in ((load < 1.0, style.BLUE), (load >= 1.0, style.ORANGE), (slice(1), style.RED)):
        axes[1].semilogy(load[rows], spreads[rows], "o", color=colour, markersize=3.5)
    axes[1].axvline(1.0, color=style.GREY, linewidth=0.7, linestyle=":")
    axes[1].set(xlabel="greatest load of an inner contact", ylabel="spread of the targets")
    style.title(axes[1], "(b)  the chains of (a)")
    return figure
