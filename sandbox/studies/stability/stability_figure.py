"""The figure of the scans: a column of maps a method, three rows a scan; `stable_step` is drawn on top."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.methods import Method
from softcradle.sandbox.studies.plot_style import RED, new_figure
from softcradle.sandbox.studies.stability.failure_scans import SCANS, Scan, ScanRun, finenesses, scanned_methods

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

MAP_WIDTH = 2.15  # [inches] with its axis
MAP_HEIGHT = 1.65  # [inches]


class Quantity(NamedTuple):
    """What a map shows.

    Attributes:
        label: beside the scale of colours.
        low, high: range of colours [decades].
        level: the logarithm to base 10 for a run; nan leaves the cell white.
    """

    label: str
    low: float
    high: float
    level: Callable[[ScanRun], float]


def _logarithm(value: float) -> float:
    return math.log10(max(value, 1e-300))


QUANTITIES = (
    Quantity("energy error at the end\nlog10", -8.0, 0.0, lambda run: _logarithm(run.final_energy)),
    Quantity("r.m.s. error of target velocities\nlog10", -8.0, 0.0, lambda run: _logarithm(run.spread)),
    Quantity(
        "contact switches too many\nlog10 (white: none)", 0.0, 4.0,
        lambda run: math.log10(run.switches) if run.switches else math.nan,
    ),
)  # fmt: skip


def draw_scans(runs: Sequence[ScanRun], scans: Sequence[Scan] = SCANS) -> Figure:
    """The picture; call it inside `plot_style.styled`."""
    mapped = [method for method in scanned_methods() if any(run.method == method.name for run in runs)]
    rows = [(scan, quantity) for scan in scans for quantity in QUANTITIES]
    size = MAP_WIDTH * len(mapped) + 1.2, MAP_HEIGHT * len(rows)
    figure, panels = new_figure(*size, len(rows), len(mapped), squeeze=False)
    for (scan, quantity), row in zip(rows, panels, strict=True):
        image: Any = None
        for method, axes in zip(mapped, row, strict=True):
            own = [run for run in runs if run.scan == scan.name and run.method == method.name]
            image = _draw_map(axes, scan, method, quantity, own)
            if quantity is QUANTITIES[0]:
                axes.set_title(method.name, fontsize=9, fontweight="bold")
            if quantity is QUANTITIES[-1]:
                axes.set_xlabel(scan.label, fontsize=7)
            axes.set_ylabel("tolerance" if method.adaptive else "step [s]", fontsize=7)
        bar = figure.colorbar(image, ax=row, fraction=0.04, pad=0.01)
        bar.set_label(quantity.label, fontsize=6.5)
        bar.ax.tick_params(labelsize=6)
    return figure


def _draw_map(axes: Axes, scan: Scan, method: Method, quantity: Quantity, runs: Sequence[ScanRun]) -> Any:
    fine, values = finenesses(method), scan.values
    grid = np.full((len(fine), len(values)), np.nan)
    for run in runs:
        grid[fine.index(run.fineness), values.index(run.value)] = quantity.level(run)
    image = axes.pcolormesh(
        np.arange(len(values) + 1) - 0.5, np.arange(len(fine) + 1) - 0.5, np.clip(grid, quantity.low, quantity.high),
        cmap="cividis_r", vmin=quantity.low, vmax=quantity.high,
    )  # fmt: skip
    _mark_failures(axes, values, fine, runs)
    if not method.adaptive:
        _draw_limit(axes, values, fine, runs)
    _set_ticks(axes, values, fine)
    return image


def _mark_failures(axes: Axes, values: Sequence[float], fine: Sequence[float], runs: Sequence[ScanRun]) -> None:
    """The first letter of the failure on every failed run, red where there was no warning."""
    for run in runs:
        if run.failure:
            axes.text(
                values.index(run.value), fine.index(run.fineness), run.failure[0], fontsize=4.5, ha="center",
                va="center", color="white" if run.warned else RED, fontweight="bold",
            )  # fmt: skip


def _draw_limit(axes: Axes, values: Sequence[float], fine: Sequence[float], runs: Sequence[ScanRun]) -> None:
    """The line of `stable_step`."""
    limits = {run.value: run.limit for run in runs}
    line = np.interp(np.log([limits[value] for value in values]), np.log(fine), np.arange(len(fine)), left=-0.5)
    axes.step(np.arange(len(values)), line, where="mid", color=RED, linewidth=1.3)


def _set_ticks(axes: Axes, values: Sequence[float], fine: Sequence[float]) -> None:
    across, up = range(0, len(values), 3), range(0, len(fine), 4)
    axes.set_xticks(list(across), [f"{values[k]:.2g}" for k in across], fontsize=6)
    axes.set_yticks(list(up), [f"{fine[k]:.0e}" for k in up], fontsize=6)
    axes.tick_params(length=2, top=False, right=False)
