"""Couplers and draft gears of App. C: impacts against solid stops, a starting train, and the gear similar to a power
law.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics import Chain, Coupler, draft_gear, ensemble, hooke, one_on, simulate
from softcradle.physics.analysis.closed_forms import critical_speed
from softcradle.sandbox.quantities import TIME, VELOCITY
from softcradle.sandbox.scene_runs import KEEPING
from softcradle.sandbox.studies.data_table import Array, Table, long_table, rows_where
from softcradle.sandbox.studies.paper import soft_chain
from softcradle.sandbox.studies.plot_style import (
    BLUE,
    COLOUR_CYCLE,
    GREY,
    ORANGE,
    PAGE_WIDTH,
    RED,
    label_above,
    new_figure,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SOLID, STARTING = "train-solid", "train-starting"  # Names of the two scenes.
SPEEDS = (0.5, 1.0, 1.5, 2.0, 2.25, 2.5, 2.75, 3.0, 3.5, 4.0)  # Impact speeds [m/s].
DURATION = 0.6  # Duration of a simulation [s]. The force of the first coupling is largest within this time.
STEP = 1e-4  # Time step [s]. An impact lasts 0.1 s.
SAMPLES = 6001
# Stiffness [N/m] of the spring between the halves of a wagon, 2 E A / L of its sill. It is our assumption.
STIFF_HALF = 3e8
TRAINS = {"gear without an end": RED, "solid stop, rigid wagons": BLUE, "solid stop, elastic wagons": ORANGE}
KILO = 1e3


def in_halves(chain: Chain, stiffness: float) -> Chain:
    """Return a chain in which each wagon consists of two halves, joined by a spring of `stiffness` [N/m].

    The spring represents the first longitudinal oscillation of the wagon.
    """
    link = Coupler(hooke(stiffness), pull=hooke(stiffness))
    contacts = [link]
    for contact in chain.contact:
        contacts += [contact, link]  # type: ignore[list-item]  # the scene's are couplers
    gaps = [0.0, *(value for gap in chain.gap for value in (gap, 0.0))]
    return Chain(np.repeat(chain.mass, 2) / 2.0, contacts, gaps, friction=chain.friction)


def stops() -> Table:
    """Compute the largest force [kN] and travel [mm] of the first coupling.

    There is one row for each train of TRAINS (0 to 2) and each speed [m/s].
    """
    from softcradle import scenes

    lane = scenes.load(SOLID).lanes[0]
    chain, start = lane.chain(), np.array(lane.velocity)
    endless = replace(chain, contact=tuple(Coupler(c.push, c.pull, c.slack) for _, c in chain.couplers))
    rows = []
    for number, train in enumerate((endless, chain, in_halves(chain, STIFF_HALF))):
        halves = len(train.mass) // len(chain.mass)
        starts = [np.repeat(speed * start / start.max(), halves).tolist() for speed in SPEEDS]
        found = ensemble([train] * len(SPEEDS), starts, DURATION, KEEPING, STEP, SAMPLES)
        for speed, motion in zip(SPEEDS, found, strict=True):
            first = halves - 1  # Index of the coupling behind the striking wagon.
            rows.append((number, speed, motion.force[:, first].max() / KILO, motion.overlap[:, first].max() * KILO))
    return long_table(("train", "speed", "force", "travel"), rows)


def draw_stops(table: Table) -> Figure:
    """Draw the largest force over the impact speed, with a curve for each train.

    A dotted line marks the speed at which the coupling reaches its full travel.
    """
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
    """Return the full travel [mm] of the couplings in the scene."""
    from softcradle import scenes

    return scenes.load(SOLID).lanes[0].chain().couplers[0][1].travel * KILO


def starting() -> Table:
    """Compute the time t [s] and the velocity [m/s] of each wagon of a starting train. The locomotive is first."""
    from softcradle import scenes

    scene = scenes.load(STARTING)
    lane = scene.lanes[0]
    found = simulate(lane.chain(), lane.velocity, scene.duration, KEEPING, samples=1201)
    names = ["locomotive", *(f"wagon {k}" for k in range(1, len(lane.velocity)))]
    return {"t": found.time, **dict(zip(names, found.velocity.T[::-1], strict=True))}


def draw_starting(table: Table) -> Figure:
    """Draw the velocity of each wagon over time. The locomotive sets the wagons in motion one after another."""
    from matplotlib import colormaps

    figure, axes = new_figure()
    names = [name for name in table if name != "t"]
    shades: Array = colormaps["viridis"](np.linspace(0.0, 0.9, len(names)))
    for name, shade in zip(names, shades, strict=True):
        axes.plot(table["t"], table[name], color=shade, linewidth=0.9, label=name)
    axes.set(xlabel=TIME.label, ylabel=VELOCITY.label, xlim=(0.0, 3.0), ylim=(0.0, 0.85))
    axes.legend(loc="upper left", ncols=2)
    return figure


SIZES = (2, 3, 4, 6, 8)
ALPHAS = tuple(np.geomspace(1.0 / 20.0, 1.0, 40).tolist())
# Values of V/v_c. All final velocities below 1 are equal.
RATIOS = np.concatenate(([0.9], np.geomspace(1.0, 40.0, 240)))
TOLERANCE = 1e-6


def nearest() -> Table:
    """Compute n, alpha, the nearest V/v_c, and the difference of the velocities.

    The difference is a root mean square, relative to the velocity of the striker. The difference is NaN beyond RATIOS.
    """
    rows = []
    for n in SIZES:
        gears = _gear_outcomes(n)
        chains = [soft_chain(n, alpha) for alpha in ALPHAS]
        found = ensemble(chains, [[1.0] + [0.0] * n] * len(chains), tolerance=TOLERANCE)
        soft = np.array([one.final_velocity if not one.status.gave_up else np.full(n + 1, np.nan) for one in found])
        apart = np.sqrt(((soft[:, None, :] - gears[None, :, :]) ** 2).mean(axis=2))
        best = np.argmin(np.where(np.isnan(apart), np.inf, apart), axis=1)
        distance = np.where(best < len(RATIOS) - 1, apart[np.arange(len(chains)), best], np.nan)
        rows.append((n, np.array(ALPHAS), np.where(np.isnan(distance), np.nan, RATIOS[best]), distance))
    return long_table(("n", "alpha", "V over v_c", "apart"), rows)


def _gear_outcomes(n: int) -> Array:
    """Return the (R, n+1) final velocities of draft gears at RATIOS, relative to the velocity of the striker."""
    chain = one_on(n, draft_gear(1.0, 1.0))
    speeds = RATIOS * critical_speed(chain.power_laws[0], chain.mass, 1)
    found = ensemble([chain] * len(speeds), [[speed] + [0.0] * n for speed in speeds], tolerance=TOLERANCE)
    return np.array([one.final_velocity / speed for one, speed in zip(found, speeds, strict=True)])


def draw_nearest(table: Table) -> Figure:
    """Draw (a) the nearest V/v_c over alpha, and (b) the difference of the velocities."""
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.6, 1, 2, ("(a)", "(b)"))
    for n, colour in zip(SIZES, COLOUR_CYCLE, strict=False):
        points = rows_where(table, n=n)
        left.loglog(points["alpha"], points["V over v_c"], color=colour, linewidth=0.9, label=f"$n={n}$")
        right.loglog(points["alpha"], points["apart"], color=colour, linewidth=0.9)
    left.axhline(1.0, color=GREY, linewidth=0.6, linestyle="--")
    label_above(left, 0.4, 1.0, "exactly rigid below", GREY, -9.0, fontsize=7.5)
    left.set(xlabel=r"$\alpha$ of the power law", ylabel="$V/v_c$ of the nearest draft gear", ylim=(0.7, 40.0))
    left.legend(loc="upper left", fontsize=7.5)
    right.set(xlabel=r"$\alpha$ of the power law", ylabel="final velocities apart / striker's")
    return figure
