"""The overview of the scans: a map a method and scan, a colour for each way to fail, and what a reader needs to know."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.advice.stability_limits import TRUSTED_ERROR
from softcradle.physics.methods import Method
from softcradle.sandbox.studies.plot_style import BLACK, new_figure
from softcradle.sandbox.studies.stability.failure_scans import (
    ADAPTIVE_ERROR_FACTOR,
    SCANS,
    Failure,
    Scan,
    ScanRun,
    finenesses,
    scanned_methods,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#e4eef3", "#f2c14e", "#d1495b", "#4a1d4f")  # holds, error, chatter, blow-up: told apart in grey too
MEANINGS = (
    "holds its error",
    "error: off, without chatter",
    "chatter: contacts switch more often than they should",
    "blow-up: the energy has at least doubled",
)
ORDER = (None, Failure.ERROR, Failure.CHATTER, Failure.BLOW_UP)
PANEL = 1.55, 1.75  # [inches] of a map with its axes
MARGIN = 1.05  # [inches] below, for the legend


def draw_overview(runs: Sequence[ScanRun], scans: Sequence[Scan] = SCANS) -> Figure:
    """The picture; call it inside `plot_style.styled`."""
    mapped = [method for method in scanned_methods() if any(run.method == method.name for run in runs)]
    width, height = PANEL[0] * len(mapped) + 0.6, PANEL[1] * len(scans) + MARGIN
    figure, panels = new_figure(width, height, len(scans), len(mapped), squeeze=False)
    for row, (scan, axes_of_scan) in enumerate(zip(scans, panels, strict=True)):
        for column, (method, axes) in enumerate(zip(mapped, axes_of_scan, strict=True)):
            _draw_map(axes, scan, method, [run for run in runs if (run.scan, run.method) == (scan.name, method.name)])
            axes.set_xlabel(scan.label.partition(",")[0], fontsize=7.5)
            if row == 0:
                axes.set_title(method.name, fontsize=9, fontweight="bold")
            if column == 0 or method.adaptive != mapped[column - 1].adaptive:
                axes.set_ylabel("tolerance" if method.adaptive else "step [s]", fontsize=7.5)
    _explain(figure, height)
    return figure


def _draw_map(axes: Axes, scan: Scan, method: Method, runs: Sequence[ScanRun]) -> None:
    from matplotlib.colors import ListedColormap

    fine, values = finenesses(method), scan.values
    grid: NDArray[np.float64] = np.full((len(fine), len(values)), np.nan)
    for run in runs:
        place = fine.index(run.fineness), values.index(run.value)
        grid[place] = ORDER.index(run.failure)
        if run.failure and not run.warned:
            axes.plot(
                place[1], place[0], "o", color="white", markeredgecolor=BLACK, markersize=3.0, markeredgewidth=0.6
            )
    edges = np.arange(len(values) + 1) - 0.5, np.arange(len(fine) + 1) - 0.5
    axes.pcolormesh(*edges, grid, cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=3.5)
    if not method.adaptive:
        limits = {run.value: run.limit for run in runs}
        line = np.interp(np.log([limits[value] for value in values]), np.log(fine), np.arange(len(fine)), left=-0.5)
        axes.step(np.arange(len(values)), line, where="mid", color=BLACK, linewidth=1.4)
    across, up = range(0, len(values), 4), range(0, len(fine), 4)
    axes.set_xticks(list(across), [f"{values[k]:.2g}" for k in across], fontsize=6.5)
    axes.set_yticks(list(up), [f"{fine[k]:.0e}" for k in up], fontsize=6.5)
    axes.tick_params(length=2, top=False, right=False)


def _explain(figure: Figure, height: float) -> None:
    """The meaning of colours, line and dots, below the maps."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    marks: list[Patch | Line2D] = [
        Patch(facecolor=colour, edgecolor=BLACK, linewidth=0.4, label=meaning)
        for colour, meaning in zip(COLOURS, MEANINGS, strict=True)
    ]
    marks.append(Line2D([], [], color=BLACK, linewidth=1.4, label="longest step that stable_step advises"))
    dot = {"marker": "o", "color": "white", "markeredgecolor": BLACK, "markersize": 4.0}
    marks.append(Line2D([], [], linestyle="", label="failed without a warning", **dot))  # type: ignore[arg-type]
    words = (
        f"One bead strikes n others. Each cell is a run; its target velocities may be off by {TRUSTED_ERROR:g} of the closing "
        f"speed, or by {ADAPTIVE_ERROR_FACTOR:g} times the tolerance. Finer runs are further down; "
        "from left to right: greater exponents, more targets, more preload."
    )
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.set(rect=(0.0, MARGIN / height, 1.0, 1.0 - MARGIN / height))  # type: ignore[call-arg]  # of this engine
    figure.legend(
        handles=marks, loc="lower center", ncols=3, fontsize=7.5, frameon=False, bbox_to_anchor=(0.5, 0.4 / height)
    )
    figure.text(0.5, 0.1 / height, words, fontsize=7.0, ha="center", va="bottom")
