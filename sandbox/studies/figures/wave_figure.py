"""Other roads to a rigid body, and away from it: springs that pull, prestress, and the pulse of the usual cradle.

The contact law only pushes. A spring that pulls is had all the same: linear contacts under a prestress that they never
lose act, about their rest, like springs that push and pull. The prestress is a steady force on both ends, so the ends
are free; the scenes stiff-springs and prestressed show the same.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics import Chain, Contact, State, advance, hertz, hooke, one_on, power_law
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.figures.solved_cases import ALPHA, N, Table, solved, start

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STRIKE = power_law(1.0, 1.0 / 30.0)  # the striker's contact, the same in all three
SPRING, SPRING_PRESTRESS = hooke(400.0), 20.0
SOFT, SOFT_PRESTRESS = power_law(1.0, ALPHA), 0.75
STEP, SAMPLES = 1e-4, 1000
UNTIL = {"soft": 3.0, "springs": 3.0, "prestressed": 24.0}
SPEED = {"soft": 1.0, "springs": 1.0, "prestressed": 0.1}  # of the striker; a tap that opens no contact
PULSE_BEADS, PULSE_UNTIL = 30, 40.0


def prestressed(inner: Contact, force: float) -> Chain:
    """A striker and N targets at rest whose ends are pressed together by `force`."""
    drive = [0.0, force, *[0.0] * (N - 2), -force]
    gap = [0.0, *[-float(inner.overlap(force))] * (N - 1)]
    return Chain([1.0] * (N + 1), (STRIKE, *(inner,) * (N - 1)), gap, drive)


def run(inner: Contact, force: float, until: float, speed: float) -> Table:
    """t, velocities over the striker's, and the inner forces less the prestress, from rest under the prestress."""
    chain = prestressed(inner, force) if force else one_on(N, (STRIKE, *(inner,) * (N - 1)))
    state = State.at_start(chain, speed * np.array(start(chain)))
    rows = []
    for _ in range(SAMPLES):
        rows.append((state.time, *(state.velocity(chain) / speed), *(_forces(chain, state)[1:] - force)))
        advance(chain, state, until / SAMPLES, "conserving", STEP)
    names = ("t", *(f"v{i}" for i in range(N + 1)), *(f"f{i}{i + 1}" for i in range(1, N)))
    return dict(zip(names, np.array(rows).T, strict=True))


def _forces(chain: Chain, state: State) -> np.ndarray:
    return np.array([float(c.force(d)) for c, d in zip(chain.contact, state.overlap.tolist(), strict=True)])


def roads() -> Table:
    """Evanescent cluster, stiff springs, and a soft cluster under prestress, side by side."""
    found: Table = {}
    for name, inner, force in (
        ("soft", SOFT, 0.0), ("springs", SPRING, SPRING_PRESTRESS), ("prestressed", SOFT, SOFT_PRESTRESS),
    ):  # fmt: skip
        table = run(inner, force, UNTIL[name], SPEED[name])
        found |= {f"{key} {name}": column for key, column in table.items()}
    return found


def pulse() -> Table:
    """t and the velocities of one Hertz bead on thirty."""
    chain = one_on(PULSE_BEADS, hertz(1.0))
    found = solved(chain, start(chain), PULSE_UNTIL)
    return {"t": found.time, **{f"v{i}": found.velocity[:, i] for i in range(PULSE_BEADS + 1)}}


def draw_roads(table: Table) -> Figure:
    """Velocities of the targets above, what passes through the middle contact below."""
    figure, grid = style.page(style.PAGE, 3.8, 2, 3, sharex="col")
    kinds = (
        ("soft", "(a) evanescent, $\\alpha=1/10$"),
        ("springs", "(b) stiff springs"),
        ("prestressed", "(c) $\\alpha=1/10$, prestressed"),
    )
    for column, (kind, title) in zip(grid.T, kinds, strict=True):
        for i, colour in zip(range(N, 0, -1), (style.PURPLE, style.GREEN, "black", style.ORANGE), strict=True):
            column[0].plot(table[f"t {kind}"], table[f"v{i} {kind}"], color=colour, linewidth=0.8, label=f"$v_{i}$")
        for i, colour in zip(range(1, N), (style.ORANGE, style.GREEN, style.PURPLE), strict=True):
            column[1].plot(
                table[f"t {kind}"],
                table[f"f{i}{i + 1} {kind}"],
                color=colour,
                linewidth=0.8,
                label=f"$f_{{{i},{i + 1}}}$",
            )
        style.zero(column[1])
        column[1].set(xlabel="$t$", xlim=(0.0, UNTIL[kind]))
        style.title(column[0], title)
    for axes in grid[0, :2]:
        axes.set_ylim(-0.02, 0.66)
    grid[0, 0].set_ylabel("velocity / striker's")
    grid[1, 0].set_ylabel("force less prestress")
    grid[0, 1].legend(loc="lower right", ncols=2, columnspacing=1.0)
    grid[1, 0].legend(loc="upper right", ncols=1)
    return figure


def draw_pulse(table: Table) -> Figure:
    """Velocities of all beads, each lifted by its number: one pulse of unchanging shape, and the last bead leaves."""
    figure, axes = style.page(height=3.2)
    for i in range(0, PULSE_BEADS + 1, 2):
        colour = style.BLUE if i == 0 else "black"
        axes.plot(table["t"], table[f"v{i}"] * 3.0 + i, color=colour, linewidth=0.8)
    axes.set(xlabel="$t$", ylabel=r"bead $i$, lifted by $3\,v_i$", xlim=(0.0, PULSE_UNTIL))
    style.label(axes, r"$\alpha=3/2,\ n=30$", 0.55, 0.1)
    return figure
