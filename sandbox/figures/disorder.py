"""Not shown in the paper: random chains. Soft clusters stay whole, the pulse of the usual cradle breaks up."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from physics import Chain, Contact
from sandbox.figures import style
from sandbox.figures.cases import Array, Table, long_table, pick, solved, start

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TARGETS, CHAINS, SEED = 6, 40, 20100324
SOFT, CRADLE = 0.0, 1.0  # in the column "kind"
SOFT_EXPONENTS, CRADLE_EXPONENT = (1.0 / 50.0, 1.0 / 30.0), 1.5
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
            velocity = solved(chain, start(chain), samples=2).final_velocity
            whole = 2.0 * chain.mass[0] / sum(chain.mass)
            rows.append((kind, k, np.arange(TARGETS + 1), np.array(chain.mass), velocity, velocity / whole))
    return long_table(("kind", "chain", "bead", "mass", "v", "v over rigid"), rows)


def spread(table: Table, kind: float, chain: int) -> float:
    """Root mean square of the targets' velocities about their mean, by mass, as a part of that mean."""
    some = pick(table, kind=kind, chain=chain)
    mass, velocity = some["mass"][1:], some["v"][1:]
    mean = np.average(velocity, weights=mass)
    return float(np.sqrt(np.average((velocity - mean) ** 2, weights=mass)) / mean)


def draw(table: Table) -> Figure:
    """Velocities of all targets in both kinds of chain."""
    figure, axes = style.page(style.PAGE, 2.7, 1, 2)
    titles = (r"(a)  $\alpha_{i,i+1}$ between 1/50 and 1/30", r"(b)  $\alpha=3/2$, the usual cradle")
    for kind, where, title in zip((SOFT, CRADLE), axes, titles, strict=True):
        for k in range(CHAINS, -1, -1):
            some = pick(table, kind=kind, chain=k)
            look = (
                {"color": style.RED, "linewidth": 1.5, "label": "all alike"}
                if k == 0
                else {"color": style.BLUE, "linewidth": 0.5, "alpha": 0.5}
            )
            where.plot(some["bead"][1:], some["v over rigid"][1:], marker="o", markersize=2.5, **look)
        where.axhline(1.0, color=style.GREY, linewidth=0.6, linestyle="--")
        where.set(xlabel="bead $i$", xticks=range(1, TARGETS + 1))
        style.title(where, title)
    axes[0].set(ylabel="$v_i$ / velocity of a rigid target", ylim=(0.0, 2.0))
    axes[0].legend(loc="lower right")
    return figure
