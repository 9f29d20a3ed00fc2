"""Ringing of the inner contact: f12 about its quasi-static branch while the striker pushes, and its period. Sec. IV.

The paper sees no oscillation at n = 4, alpha = 1/10. At smaller exponents the inner force turns more often: it oscillates about
the force (n-1)/n f01 that a rigid cluster takes, at the local frequency of the contact.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from softcradle.physics.analysis.measures import response_times
from softcradle.physics.analysis.ringing import ringing
from softcradle.sandbox.studies.data_table import Table, long_table
from softcradle.sandbox.studies.paper import full_one_on, opening_time
from softcradle.sandbox.studies.plot_style import BLUE, GREY, ORANGE, PAGE_WIDTH, new_figure, panel_title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = 2  # targets
SHOWN = 1.0 / 17.0  # exponent of the curve over time
INVERSE = tuple(np.arange(16.0, 26.1, 0.5).tolist())  # 1/alpha of the periods
SAMPLES = 20_001


def _while_struck(alpha: float) -> tuple[float, float]:
    return min(opening_time(SIZE, alpha), opening_time(SIZE, alpha, 1)), alpha


def history() -> Table:
    """t, f12, and the branch (n-1)/n f01; below them, a row an exponent: 1/alpha, turns, period and that of the branch."""
    end, alpha = _while_struck(SHOWN)
    found = full_one_on(SIZE, alpha, end, 4001, 1e-10)
    branch = (SIZE - 1.0) / SIZE * found.force[:, 0]
    rows: list[tuple[ArrayLike, ...]] = [(found.time, found.force[:, 1], branch, np.nan, np.nan, np.nan, np.nan)]
    for inverse in INVERSE:
        end, alpha = _while_struck(1.0 / inverse)
        found = full_one_on(SIZE, alpha, end, SAMPLES, 1e-10)
        heard = ringing(found.time, found.force[:, 1])
        local = 2.0 * math.pi * float(response_times(found)[1])
        rows.append((np.nan, np.nan, np.nan, inverse, heard.turns, heard.period or np.nan, local))
    return long_table(("t", "f12", "branch", "1/alpha", "turns", "period", "period of the branch"), rows)


def draw_history(table: Table) -> Figure:
    """(a) f12 less its branch over time, (b) the periods over 1/alpha."""
    figure, (left, right) = new_figure(PAGE_WIDTH, 2.5, 1, 2)
    shown = np.isfinite(table["t"]) & (table["t"] > 0.1) & (table["t"] < 1.35)
    left.plot(table["t"][shown], 1e3 * (table["f12"] - table["branch"])[shown], color=ORANGE, linewidth=0.9)
    left.axhline(0.0, color=GREY, linewidth=0.5)
    left.set(xlabel="$t$", ylabel=r"$(f_{1,2}-f_{0,1}/2)\,/\,10^{-3}$")
    inverse = table["1/alpha"]
    right.semilogy(
        inverse, table["period of the branch"], color=BLUE, linewidth=0.9, label=r"$2\pi/\omega$, largest overlap"
    )
    right.semilogy(inverse, table["period"], "o", color=ORANGE, markersize=3.5, label="measured")
    right.set(xlabel=r"$1/\alpha$", ylabel="period of $f_{1,2}$")
    right.legend(loc="upper right")
    panel_title(left, rf"(a)  $n={SIZE}$, $\alpha=1/{1 / SHOWN:.0f}$")
    panel_title(right, f"(b)  $n={SIZE}$")
    return figure
