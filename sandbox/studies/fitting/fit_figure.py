"""Figure of a fit. The figure shows data and fit of each quantity over time, and the residuals below."""

from __future__ import annotations

from typing import TYPE_CHECKING

from softcradle.sandbox.studies.fitting.observations import UNIT_OF
from softcradle.sandbox.studies.plot_style import (
    BLACK,
    COLOUR_CYCLE,
    PAGE_WIDTH,
    new_figure,
    panel_title,
    require_matplotlib,
    styled,
    zero_line,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from softcradle.sandbox.studies.fitting.fit_scene import SceneFit

HEIGHT = 3.4  # Height of the figure [inches].
# Largest number of data points drawn for a column of data. More points would look like one thick line.
MOST_POINTS = 600


def draw_fit(found: SceneFit) -> Figure:
    """Return a figure with a column of two panels for each quantity.

    The upper panel shows the data and the fit. The lower panel shows the data minus the fit.
    """
    require_matplotlib()
    quantities = list(found.noise)
    with styled():
        figure, panels = new_figure(
            PAGE_WIDTH, HEIGHT, 2, len(quantities), sharex="col", squeeze=False, height_ratios=(2.2, 1.0)
        )
        for column, quantity in enumerate(quantities):
            above, below = panels[0, column], panels[1, column]
            owner = "contact" if quantity == "force" else "bead"
            for one, residual in zip(found.observed, found.residuals, strict=True):
                if one.quantity != quantity:
                    continue
                colour = COLOUR_CYCLE[one.index % len(COLOUR_CYCLE)]
                thin = slice(None, None, max(1, found.time.size // MOST_POINTS))
                above.plot(
                    found.time[thin], one.values[thin], linestyle="none", marker=".", markersize=4.0, color=colour,
                    alpha=0.6, markeredgewidth=0.0, label=f"{owner} {one.index}",
                )  # fmt: skip
                above.plot(found.time, one.values - residual, color=BLACK, linewidth=0.7)
                below.plot(found.time[thin], residual[thin], linestyle="none", marker=".", markersize=1.5, color=colour)
            zero_line(below)
            above.set_ylabel(f"{quantity} [{UNIT_OF[quantity]}]")
            below.set_ylabel(f"data - fit [{UNIT_OF[quantity]}]")
            below.set_xlabel("time of the data [s]")
            above.legend(loc="best", title="dots: data, line: fit", markerscale=2.0)
            panel_title(above, f"{found.scene.title}: noise {found.noise[quantity]:.2g} {UNIT_OF[quantity]}")
        figure.align_ylabels()
    return figure
