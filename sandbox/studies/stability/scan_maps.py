"""Maps of the scans, with one column for each method.

The overview has a row for each scan, and colours show the kind of failure. The details show three quantities.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from softcradle.physics.advice.stability_limits import TRUSTED_ERROR
from softcradle.physics.methods import Method
from softcradle.sandbox.studies.plot_style import BLACK, RED, new_figure
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

# Colours of the results holds, error, chatter and blow-up. The colours can be distinguished in grey.
COLOURS = ("#e4eef3", "#f2c14e", "#d1495b", "#4a1d4f")
MEANINGS = (
    "holds its error",
    "error: off, without chatter",
    "chatter: contacts switch more often than they should",
    "blow-up: the energy has at least doubled",
)
ORDER = (None, Failure.ERROR, Failure.CHATTER, Failure.BLOW_UP)
PANEL = 1.55, 1.75  # Width and height of a map of the overview with its axes [inches].
MARGIN = 1.05  # Height of the space for the legend below the maps [inches].
DETAIL = 2.15, 1.65  # Width and height of a map of the details with its axes [inches].

Marker = Callable[["Axes", "ScanRun", int, int], None]  # Function that marks a failed simulation at its column and row.


class MappedNumber(NamedTuple):
    """Quantity that a map shows.

    Attributes:
        low, high: smallest and largest value on the colour scale.
        level: function that returns the value of a simulation; the cell is white if it is NaN.
        label: label of the colour bar.
    """

    low: float
    high: float
    level: Callable[[ScanRun], float]
    label: str = ""


def _logarithm(value: float) -> float:
    return math.log10(max(value, 1e-300))


FAILURES = MappedNumber(-0.5, 3.5, lambda run: ORDER.index(run.failure))
QUANTITIES = (
    MappedNumber(-8.0, 0.0, lambda run: _logarithm(run.final_energy), "energy error at the end\nlog10"),
    MappedNumber(-8.0, 0.0, lambda run: _logarithm(run.spread), "r.m.s. error of target velocities\nlog10"),
    MappedNumber(
        0.0, 4.0, lambda run: math.log10(run.switches) if run.switches else math.nan,
        "contact switches too many\nlog10 (white: none)",
    ),
)  # fmt: skip


def draw_overview(runs: Sequence[ScanRun], scans: Sequence[Scan] = SCANS) -> Figure:
    """Draw the kinds of failure with a legend. Call it inside `plot_style.styled`."""
    from matplotlib.colors import ListedColormap

    mapped = _mapped(runs)
    width, height = PANEL[0] * len(mapped) + 0.6, PANEL[1] * len(scans) + MARGIN
    figure, panels = new_figure(width, height, len(scans), len(mapped), squeeze=False)
    for scan, row in zip(scans, panels, strict=True):
        for column, (method, axes) in enumerate(zip(mapped, row, strict=True)):
            _draw_map(axes, scan, method, runs, FAILURES, ListedColormap(COLOURS), _dot, BLACK, ticks=(4, 6.5))
            axes.set_xlabel(scan.label.partition(",")[0], fontsize=7.5)
            if column == 0 or method.adaptive != mapped[column - 1].adaptive:
                _name_finenesses(axes, method, 7.5)
    _title(panels[0], mapped)
    _explain(figure, height)
    return figure


def draw_details(runs: Sequence[ScanRun], scans: Sequence[Scan] = SCANS) -> Figure:
    """Draw the errors of energy and velocities, and the excess events. Call it inside `plot_style.styled`."""
    mapped = _mapped(runs)
    rows = [(scan, quantity) for scan in scans for quantity in QUANTITIES]
    size = DETAIL[0] * len(mapped) + 1.2, DETAIL[1] * len(rows)
    figure, panels = new_figure(*size, len(rows), len(mapped), squeeze=False)
    for (scan, quantity), row in zip(rows, panels, strict=True):
        image: Any = None
        for method, axes in zip(mapped, row, strict=True):
            image = _draw_map(axes, scan, method, runs, quantity, "cividis_r", _letter, RED, ticks=(3, 6.0))
            _name_finenesses(axes, method, 7.0)
            if quantity is QUANTITIES[-1]:
                axes.set_xlabel(scan.label, fontsize=7)
        if quantity is QUANTITIES[0]:
            _title(row, mapped)
        bar = figure.colorbar(image, ax=row, fraction=0.04, pad=0.01)
        bar.set_label(quantity.label, fontsize=6.5)
        bar.ax.tick_params(labelsize=6)
    return figure


def _mapped(runs: Sequence[ScanRun]) -> list[Method]:
    return [method for method in scanned_methods() if any(run.method == method.name for run in runs)]


def _title(row: Sequence[Axes], methods: Sequence[Method]) -> None:
    for axes, method in zip(row, methods, strict=True):
        axes.set_title(method.name, fontsize=9, fontweight="bold")


def _name_finenesses(axes: Axes, method: Method, size: float) -> None:
    axes.set_ylabel("tolerance" if method.adaptive else "step [s]", fontsize=size)


def _draw_map(
    axes: Axes, scan: Scan, method: Method, runs: Sequence[ScanRun], quantity: MappedNumber, colours: Any, mark: Marker,
    line_colour: str, ticks: tuple[int, float],
) -> Any:  # fmt: skip
    """Draw one map with marks on failed runs and the line of `stable_step`; ticks: their spacing in values, and their
    size.
    """
    fine, values = finenesses(method), scan.values
    grid = np.full((len(fine), len(values)), np.nan)
    limits = {}
    for run in runs:
        if (run.scan, run.method) == (scan.name, method.name):
            across, up = values.index(run.value), fine.index(run.fineness)
            grid[up, across], limits[run.value] = quantity.level(run), run.limit
            if run.failure:
                mark(axes, run, across, up)
    edges = np.arange(len(values) + 1) - 0.5, np.arange(len(fine) + 1) - 0.5
    clipped = np.clip(grid, quantity.low, quantity.high)
    image = axes.pcolormesh(*edges, clipped, cmap=colours, vmin=quantity.low, vmax=quantity.high)
    if not method.adaptive:
        line = np.interp(np.log([limits[value] for value in values]), np.log(fine), np.arange(len(fine)), left=-0.5)
        axes.step(np.arange(len(values)), line, where="mid", color=line_colour, linewidth=1.4)
    every, size = ticks
    axes.set_xticks(range(0, len(values), every), [f"{value:.2g}" for value in values[::every]], fontsize=size)
    axes.set_yticks(range(0, len(fine), 4), [f"{value:.0e}" for value in fine[::4]], fontsize=size)
    axes.tick_params(length=2, top=False, right=False)
    return image


def _dot(axes: Axes, run: ScanRun, across: int, up: int) -> None:
    """Draw a dot on a failed simulation without a warning."""
    if not run.warned:
        axes.plot(across, up, "o", color="white", markeredgecolor=BLACK, markersize=3.0, markeredgewidth=0.6)


def _letter(axes: Axes, run: ScanRun, across: int, up: int) -> None:
    """Draw the first letter of the failure. The letter is red if the simulation gave no warning."""
    colour = "white" if run.warned else RED
    letter = str(run.failure)[0]
    axes.text(across, up, letter, fontsize=4.5, ha="center", va="center", color=colour, fontweight="bold")


def _explain(figure: Figure, height: float) -> None:
    """Write an explanation of colours, line and dots below the maps."""
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
