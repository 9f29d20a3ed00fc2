"""Which draft gear does what a power law does: the V/v_c whose final velocities are nearest to those of alpha, over n. App. C.

The outcome of gears depends on V/v_c alone; stiffness and precompression that go with it then give any contact time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics import draft_gear, ensemble, one_on
from softcradle.physics.analysis.critical_speed import critical_speed
from softcradle.sandbox.studies.data_table import Array, Table, long_table, rows_where
from softcradle.sandbox.studies.paper import soft_chain
from softcradle.sandbox.studies.plot_style import COLOUR_CYCLE, GREY, PAGE_WIDTH, label_above, new_figure, panel_title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZES = (2, 3, 4, 6, 8)
ALPHAS = tuple(np.geomspace(1.0 / 20.0, 1.0, 40).tolist())
RATIOS = np.concatenate(([0.9], np.geomspace(1.0, 40.0, 240)))  # V/v_c; below 1 all are alike
TOLERANCE = 1e-6


def nearest() -> Table:
    """n, alpha, the nearest V/v_c, and the root mean square of the velocities' differences over the striker's."""
    rows = []
    for n in SIZES:
        gears = _gear_outcomes(n)
        chains = [soft_chain(n, alpha) for alpha in ALPHAS]
        found = ensemble(chains, [[1.0] + [0.0] * n] * len(chains), tolerance=TOLERANCE)
        soft = np.array([one.final_velocity if not one.status.gave_up else np.full(n + 1, np.nan) for one in found])
        apart = np.sqrt(((soft[:, None, :] - gears[None, :, :]) ** 2).mean(axis=2))
        best = np.argmin(np.where(np.isnan(apart), np.inf, apart), axis=1)
        distance = apart[np.arange(len(chains)), best]
        rows.append((n, np.array(ALPHAS), np.where(np.isnan(distance), np.nan, RATIOS[best]), distance))
    return long_table(("n", "alpha", "V over v_c", "apart"), rows)


def _gear_outcomes(n: int) -> Array:
    """(R, n+1) final velocities of gears at RATIOS, over the striker's."""
    chain = one_on(n, draft_gear(1.0, 1.0))
    speeds = RATIOS * critical_speed(chain.power_laws[0], chain.mass, 1)
    found = ensemble([chain] * len(speeds), [[speed] + [0.0] * n for speed in speeds], tolerance=TOLERANCE)
    return np.array([one.final_velocity / speed for one, speed in zip(found, speeds, strict=True)])


def draw_nearest(table: Table) -> Figure:
    """(a) the nearest V/v_c over alpha, (b) how near it comes."""
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.6, 1, 2)
    for n, colour in zip(SIZES, COLOUR_CYCLE, strict=False):
        points = rows_where(table, n=n)
        left.loglog(points["alpha"], points["V over v_c"], color=colour, linewidth=0.9, label=f"$n={n}$")
        right.loglog(points["alpha"], points["apart"], color=colour, linewidth=0.9)
    left.axhline(1.0, color=GREY, linewidth=0.6, linestyle="--")
    label_above(left, 0.4, 1.0, "exactly rigid below", GREY, -9.0, fontsize=7.5)
    left.set(xlabel=r"$\alpha$ of the power law", ylabel="$V/v_c$ of the nearest draft gear", ylim=(0.7, 40.0))
    left.legend(loc="upper left", fontsize=7.5)
    right.set(xlabel=r"$\alpha$ of the power law", ylabel="final velocities apart / striker's")
    panel_title(left, "(a)")
    panel_title(right, "(b)")
    return figure
