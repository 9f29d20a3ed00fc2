"""Couplers: what the solid stop and the wagons' own stiffness do to the largest force, and how a train moves off."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics import Chain, Coupler, ensemble, hooke, simulate
from softcradle.sandbox.studies.data_table import Array, Table, long_table, rows_where
from softcradle.sandbox.studies.plot_style import BLUE, ORANGE, RED, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SOLID, STARTING = "train-solid", "train-starting"  # scenes
SPEEDS = (0.5, 1.0, 1.5, 2.0, 2.25, 2.5, 2.75, 3.0, 3.5, 4.0)  # [m/s] of the blow
DURATION = 0.6  # [s] in which the first coupling has its largest force
STEP = 1e-4  # [s] of a blow of 0.1 s
SAMPLES = 6001
STIFF_HALF = 3e8  # [N/m] of a wagon between its halves, 2 E A / L of the sill of the stop: ours
TRAINS = {"gear without an end": RED, "solid stop, rigid wagons": BLUE, "solid stop, elastic wagons": ORANGE}
KILO = 1e3


def in_halves(chain: Chain, stiffness: float) -> Chain:
    """Each wagon as two halves that a spring [N/m] holds together: its first mode of length."""
    link = Coupler(hooke(stiffness), pull=hooke(stiffness))
    contacts = [link]
    for contact in chain.contact:
        contacts += [contact, link]  # type: ignore[list-item]  # the scene's are couplers
    gaps = [0.0, *(value for gap in chain.gap for value in (gap, 0.0))]
    return Chain(np.repeat(chain.mass, 2) / 2.0, contacts, gaps, friction=chain.friction)


def stops() -> Table:
    """A row for each train of TRAINS (0 to 2) and speed [m/s]: largest force [kN] and travel [mm] of the first coupling."""
    from softcradle import scenes

    lane = scenes.load(SOLID).lanes[0]
    chain, start = lane.chain(), np.array(lane.velocity)
    endless = replace(chain, contact=tuple(Coupler(c.push, c.pull, c.slack) for _, c in chain.couplers))
    rows = []
    for number, train in enumerate((endless, chain, in_halves(chain, STIFF_HALF))):
        halves = len(train.mass) // len(chain.mass)
        starts = [np.repeat(speed * start / start.max(), halves).tolist() for speed in SPEEDS]
        found = ensemble([train] * len(SPEEDS), starts, DURATION, "conserving", STEP, SAMPLES)
        for speed, motion in zip(SPEEDS, found, strict=True):
            first = halves - 1  # the coupling behind the striking wagon
            rows.append((number, speed, motion.force[:, first].max() / KILO, motion.overlap[:, first].max() * KILO))
    return long_table(("train", "speed", "force", "travel"), rows)


def draw_stops(table: Table) -> Figure:
    """The largest force over the speed of the blow, a curve for each train; dotted, the speed at which the gear is full."""
    figure, axes = new_figure()
    for number, (name, colour) in enumerate(TRAINS.items()):
        rows = rows_where(table, train=number)
        axes.plot(rows["speed"], rows["force"] / KILO, "o-", color=colour, linewidth=0.8, ms=3, label=name)
    solid = rows_where(table, train=0)
    full = float(np.interp(_full_travel(), solid["travel"], solid["speed"]))
    axes.axvline(full, color="0.4", linewidth=0.7, linestyle=":")
    axes.annotate(f"gear full at {full:.2f} m/s", (full, 0.55), xycoords=("data", "axes fraction"), xytext=(-4, 0),
                  textcoords="offset points", ha="right", fontsize=6.5)  # fmt: skip
    axes.set(xlabel="speed of the blow, one wagon on ten [m/s]", ylabel="largest coupling force [MN]", ylim=(0.0, None))
    axes.legend(loc="upper left")
    return figure


def _full_travel() -> float:
    """[mm] of the couplings of the scene."""
    from softcradle import scenes

    return scenes.load(SOLID).lanes[0].chain().couplers[0][1].travel * KILO


def starting() -> Table:
    """t [s], and for each wagon of the train that moves off its velocity [m/s], the locomotive first."""
    from softcradle import scenes

    scene = scenes.load(STARTING)
    lane = scene.lanes[0]
    found = simulate(lane.chain(), lane.velocity, scene.duration, "conserving", samples=1201)
    names = ["locomotive", *(f"wagon {k}" for k in range(1, len(lane.velocity)))]
    return {"t": found.time, **dict(zip(names, found.velocity.T[::-1], strict=True))}


def draw_starting(table: Table) -> Figure:
    """Velocity of each wagon over time; the locomotive takes one after another with it."""
    from matplotlib import colormaps

    figure, axes = new_figure()
    names = [name for name in table if name != "t"]
    shades: Array = colormaps["viridis"](np.linspace(0.0, 0.9, len(names)))
    for name, shade in zip(names, shades, strict=True):
        axes.plot(table["t"], table[name], color=shade, linewidth=0.9, label=name)
    axes.set(xlabel="time [s]", ylabel="velocity [m/s]", xlim=(0.0, 3.0), ylim=(0.0, 0.85))
    axes.legend(loc="upper left", ncols=2)
    return figure
