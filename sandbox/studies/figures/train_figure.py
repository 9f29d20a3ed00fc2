"""The force in every coupling of a train that is struck, over time, from the two train scenes: draft gears with loss."""

from __future__ import annotations

from typing import TYPE_CHECKING

from softcradle.physics import simulate
from softcradle.sandbox.studies.data_table import Array, Table
from softcradle.sandbox.studies.plot_style import BLUE, PAGE_WIDTH, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SCENES = {"one on ten": "train-shunting", "five on ten": "train-cut"}  # title of a panel: its scene
DURATION = 2.8  # [s]
SAMPLES = 1401
KILO = 1e3


def history() -> Table:
    """t [s], and for each scene the force in every coupling [kN] and what gears and bed have absorbed [kJ]."""
    from softcradle import scenes  # imports pydantic, which listing the figures does not need

    table: Table = {}
    for title, name in SCENES.items():
        lane = scenes.load(name).lanes[0]
        found = simulate(lane.chain(), lane.velocity, DURATION, "conserving", samples=SAMPLES)
        table["t"] = found.time
        table |= {f"{title}: force {i + 1}-{i + 2}": force / KILO for i, force in enumerate(found.force.T)}
        table[f"{title}: absorbed by gears"] = found.absorbed_by_contacts / KILO
        table[f"{title}: absorbed by bed"] = found.absorbed_by_bed / KILO
    return table


def draw_history(table: Table) -> Figure:
    """A panel for each scene with a curve for each coupling, from the struck end upwards, all to one scale."""
    figure, panels = new_figure(PAGE_WIDTH, 4.2, columns=2)
    for axes, title in zip(panels, SCENES, strict=True):
        _draw_couplings(axes, table["t"], [table[name] for name in table if name.startswith(f"{title}: force")])
        axes.set_title(f"{title}: gears absorb {table[f'{title}: absorbed by gears'][-1]:.0f} kJ")
    panels[0].set_ylabel("coupling, and its force (1 MN a line)")
    return figure


def _draw_couplings(axes: Axes, time: Array, forces: list[Array]) -> None:
    """Forces [kN], a meganewton high as the distance of two curves."""
    for i, force in enumerate(forces, 1):
        axes.fill_between(time, i, i + force / KILO, color=BLUE, alpha=0.25, linewidth=0.0)
        axes.plot(time, i + force / KILO, color=BLUE, linewidth=0.8)
        axes.text(time[-1] * 0.99, i + 0.1, f"{force.max():.0f} kN", ha="right", va="bottom", fontsize=6.5)
    axes.set_xlabel("time [s]")
    axes.set_xlim(time[0], time[-1])
    axes.set_ylim(0.6, len(forces) + 2.0)
    axes.set_yticks(range(1, len(forces) + 1), [f"{i}-{i + 1}" for i in range(1, len(forces) + 1)])
