"""In-train forces: of every coupling over time in the train scenes, and their envelope over the impact speed."""

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

SCENES = {"one on ten": "train-shunting", "five on ten": "train-cut"}  # panel title: scene
DURATION = 2.8  # [s]
SAMPLES = 1401
PEAK_SAMPLES = 2801  # samples of the scan, many because the solid stop is short
STEP = 2e-4  # [s] step of the scan: a thousandth of an impact
KILO = 1e3
SPEEDS = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0)  # impact speeds [m/s]; shunting is done at up to 2 or 3
SOLID = "train-solid"  # the envelopes use the couplings of this scene, with a stop at full travel


def history() -> Table:
    """Compute t [s], and for each scene the force in every coupling [kN] and the energy absorbed by gears and bed [kJ]."""
    from softcradle import scenes  # imports pydantic, which the list of figures does not need

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
    """Draw a panel for each scene with a curve for each coupling, stacked from the left upwards, with one scale."""
    figure, panels = new_figure(PAGE_WIDTH, 4.2, columns=2)
    for axes, title in zip(panels, SCENES, strict=True):
        _draw_couplings(axes, table["t"], [table[name] for name in table if name.startswith(f"{title}: force")])
        axes.set_title(f"{title}: gears absorb {table[f'{title}: absorbed by gears'][-1]:.0f} kJ")
    panels[0].set_ylabel("coupling, and its force (1 MN a line)")
    return figure


def envelopes() -> Table:
    """Compute a row for each scene (0, 1), speed [m/s] and coupling: its largest force [kN] and travel [mm]."""
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
    """Draw a panel for each scene: the largest force along the train, a curve for each speed, hollow if the gears are
    solid.
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
    """Draw forces [kN]; the distance of two curves is a meganewton."""
    for i, force in enumerate(forces, 1):
        axes.fill_between(time, i, i + force / KILO, color=BLUE, alpha=0.25, linewidth=0.0)
        axes.plot(time, i + force / KILO, color=BLUE, linewidth=0.8)
        axes.annotate(
            f"{force.max():.0f} kN", (1.01, i), xycoords=("axes fraction", "data"), va="bottom", fontsize=6.5
        )  # outside the axes, so that no curve crosses it
    axes.set_xlabel(TIME.label)
    axes.set_xlim(time[0], time[-1])
    axes.set_ylim(0.6, len(forces) + 2.0)
    axes.set_yticks(range(1, len(forces) + 1), [f"{i}-{i + 1}" for i in range(1, len(forces) + 1)])
