"""Draft gears at work: the force in every coupling of a train that is struck, over time, from the two train scenes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics import simulate
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.figures.solved_cases import Table

from softcradle import scenes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PANELS = {"one on ten": "train-shunting", "five on ten": "train-cut"}
DURATION, SAMPLES = 2.8, 1401  # s
KILONEWTON = 1e3


def history() -> Table:
    """t [s], and for each scene the force in every coupling [kN] and what gears and bed have absorbed [kJ]."""
    table: Table = {}
    for label, name in PANELS.items():
        lane = scenes.load(name).lanes[0]
        found = simulate(lane.chain(), lane.velocity, DURATION, "conserving", samples=SAMPLES)
        table["t"] = found.time
        table |= {f"{label}: force {i + 1}-{i + 2}": force / KILONEWTON for i, force in enumerate(found.force.T)}
        table[f"{label}: absorbed by gears"] = found.absorbed_by_contacts / KILONEWTON
        table[f"{label}: absorbed by bed"] = found.absorbed_by_bed / KILONEWTON
    return table


def draw(table: Table) -> Figure:
    """A row of curves for each scene, one coupling above the next from the struck end on, all to one scale."""
    figure, axes = style.page(style.PAGE, 4.2, columns=2)
    for axis, label in zip(axes, PANELS, strict=True):
        forces = {name: force for name, force in table.items() if name.startswith(f"{label}: force")}
        _draw_couplings(axis, table["t"], list(forces.values()))
        absorbed = table[f"{label}: absorbed by gears"][-1]
        axis.set_title(f"{label}: gears absorb {absorbed:.0f} kJ")
    axes[0].set_ylabel("coupling, and its force (1 MN a line)")
    return figure


def _draw_couplings(axis: Axes, time: np.ndarray, forces: list[np.ndarray]) -> None:
    for i, force in enumerate(forces):
        axis.fill_between(time, i + 1.0, i + 1.0 + force / KILONEWTON, color=style.BLUE, alpha=0.25, linewidth=0.0)
        axis.plot(time, i + 1.0 + force / KILONEWTON, color=style.BLUE, linewidth=0.8)
        axis.text(time[-1] * 0.99, i + 1.1, f"{force.max():.0f} kN", ha="right", va="bottom", fontsize=6.5)
    axis.set_xlabel("time [s]")
    axis.set_xlim(time[0], time[-1])
    axis.set_ylim(0.6, len(forces) + 2.0)
    axis.set_yticks(range(1, len(forces) + 1), [f"{i}-{i + 1}" for i in range(1, len(forces) + 1)])
