"""Figures of the forces in couplings of trains: over time, and their largest values over the impact speed."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics import ensemble, simulate
from softcradle.sandbox.quantities import TIME
from softcradle.sandbox.scene_runs import KEEPING
from softcradle.sandbox.studies.data_table import Array, Table, long_table, rows_where
from softcradle.sandbox.studies.plot_style import BLUE, GREY, PAGE_WIDTH, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Maps the title of a panel to the name of its scene.
SCENES = {"one on ten": "train-shunting", "five on ten": "train-cut"}
DURATION = 2.8  # Duration of a simulation [s].
SAMPLES = 1401
# Number of samples for the envelopes. The number is large because the impact on the solid stop is short.
PEAK_SAMPLES = 2801
STEP = 2e-4  # Time step for the envelopes [s]: a thousandth of an impact.
KILO = 1e3
# Impact speeds [m/s]. Wagons are usually shunted at up to 2 or 3 m/s.
SPEEDS = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0)
SOLID = "train-solid"  # The envelopes use the couplings of this scene, which have a stop at full travel.


def history() -> Table:
    """Compute the time t [s], the force in every coupling [kN], and the absorbed energy [kJ] for each scene.

    The energy is absorbed by the draft gears and the bed.
    """
    # The import is local because this module imports pydantic, which the list of figures does not need.
    from softcradle import scenes

    table: Table = {}
    for title, name in SCENES.items():
        lane = scenes.load(name).lanes[0]
        found = simulate(lane.chain(), lane.velocity, DURATION, KEEPING, samples=SAMPLES)
        table["t"] = found.time
        table |= {f"{title}: force {i + 1}-{i + 2}": force / KILO for i, force in enumerate(found.force.T)}
        table[f"{title}: absorbed by gears"] = found.absorbed_by_contacts / KILO
        table[f"{title}: absorbed by bed"] = found.absorbed_by_bed / KILO
    return table


def draw_history(table: Table) -> Figure:
    """Draw a panel for each scene, with one curve of the force for each coupling.

    The curves are stacked in the order of the couplings, from the left upwards. All have the same scale.
    """
    figure, panels = new_figure(PAGE_WIDTH, 4.2, columns=2)
    for axes, title in zip(panels, SCENES, strict=True):
        _draw_couplings(axes, table["t"], [table[name] for name in table if name.startswith(f"{title}: force")])
        axes.set_title(f"{title}: gears absorb {table[f'{title}: absorbed by gears'][-1]:.0f} kJ")
    panels[0].set_ylabel("coupling, and its force (1 MN a line)")
    return figure


def envelopes() -> Table:
    """Compute the largest force [kN] and travel [mm] of each coupling.

    There is one row for each scene (0, 1), speed [m/s] and coupling.
    """
    from softcradle import scenes

    rows, coupler = [], scenes.load(SOLID).lanes[0].chain().couplers[0][1]
    for number, name in enumerate(SCENES.values()):
        lane = scenes.load(name).lanes[0]
        chain, start = replace(lane.chain(), contact=(coupler,) * lane.chain().contacts), np.array(lane.velocity)
        starts = [(speed * start / start.max()).tolist() for speed in SPEEDS]
        found = ensemble([chain] * len(SPEEDS), starts, DURATION, KEEPING, STEP, PEAK_SAMPLES)
        for speed, motion in zip(SPEEDS, found, strict=True):
            forces, travels = motion.force.max(axis=0) / KILO, motion.overlap.max(axis=0) * KILO
            rows += [(number, speed, i + 1, *both) for i, both in enumerate(zip(forces, travels, strict=True))]
    return long_table(("train", "speed", "coupling", "force", "travel"), rows)


def draw_envelopes(table: Table) -> Figure:
    """Draw a panel for each scene with the largest force along the train. Each speed has a curve.

    A marker is hollow if the draft gear has reached its solid stop.
    """
    from matplotlib import colormaps
    from matplotlib.ticker import MaxNLocator

    from softcradle import scenes

    figure, panels = new_figure(PAGE_WIDTH, 2.9, columns=2, sharey=True)
    shades = colormaps["viridis"](np.linspace(0.0, 0.85, len(SPEEDS)))
    travel = scenes.load(SOLID).lanes[0].chain().couplers[0][1].travel * KILO
    for number, (axes, title) in enumerate(zip(panels, SCENES, strict=True)):
        for speed, shade in zip(SPEEDS, shades, strict=True):
            rows = rows_where(table, train=number, speed=speed)
            axes.plot(rows["coupling"], rows["force"] / KILO, color=shade, linewidth=0.8, label=f"{speed:g}")
            solid = rows["travel"] > travel
            for kind, fill in ((~solid, shade), (solid, "white")):
                axes.plot(rows["coupling"][kind], rows["force"][kind] / KILO, "o", color=shade, mfc=fill, ms=3)
        axes.set(title=title, xlabel="coupling, from the left", xlim=(0.5, rows["coupling"].max() + 0.5))
        axes.set_ylim(0.0, 1.05 * table["force"].max() / KILO)
        axes.xaxis.set_major_locator(MaxNLocator(8, integer=True))
    panels[0].set_ylabel("largest force [MN]")
    panels[0].plot([], [], "o", color=GREY, mfc="white", ms=3, label="gear solid")
    panels[0].legend(title="speed of the blow [m/s]", loc="upper right", ncols=2, handlelength=1.2)
    return figure


def _draw_couplings(axes: Axes, time: Array, forces: list[Array]) -> None:
    """Draw the forces [kN] of all couplings. Two neighbouring curves are one meganewton apart."""
    for i, force in enumerate(forces, 1):
        axes.fill_between(time, i, i + force / KILO, color=BLUE, alpha=0.25, linewidth=0.0)
        axes.plot(time, i + force / KILO, color=BLUE, linewidth=0.8)
        axes.annotate(
            f"{force.max():.0f} kN", (1.01, i), xycoords=("axes fraction", "data"), va="bottom", fontsize=6.5
        )  # The text is outside the axes, where no curve crosses it.
    axes.set_xlabel(TIME.label)
    axes.set_xlim(time[0], time[-1])
    axes.set_ylim(0.6, len(forces) + 2.0)
    axes.set_yticks(range(1, len(forces) + 1), [f"{i}-{i + 1}" for i in range(1, len(forces) + 1)])
