"""The maps: a column a method, three rows of maps a scan, and the estimate of `stable_step` drawn on top."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.methods import Method
from softcradle.sandbox.studies.figures import figure_style as style
from softcradle.sandbox.studies.stability.failure_scans import QUANTITIES, SCANS, Scan, Spot, finenesses, methods

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

# what a map shows, its range in decades, and its scale's name
SHOWN: dict[str, tuple[float, float, str]] = {
    "energy error": (-8.0, 0.0, "energy error at the end, log10"),
    "velocity spread": (-8.0, 0.0, "r.m.s. error of target velocities, log10"),
    "contact switches": (0.0, 4.0, "contact switches too many, log10 (white: none)"),
}
WIDTH, HEIGHT = 2.15, 1.65  # of a map [inches]


def draw(spots: Sequence[Spot], scans: Sequence[Scan] = SCANS) -> Figure:
    """The picture; call it inside `softcradle.sandbox.studies.figures.figure_style.styled`."""
    mapped = [method for method in methods() if any(spot.method == method.name for spot in spots)]
    rows = [(scan, quantity) for scan in scans for quantity in QUANTITIES]
    figure, panels = style.page(WIDTH * len(mapped) + 1.2, HEIGHT * len(rows), len(rows), len(mapped), squeeze=False)
    for (scan, quantity), line in zip(rows, panels, strict=True):
        image: Any = None
        for method, axes in zip(mapped, line, strict=True):
            some = [spot for spot in spots if spot.scan == scan.name and spot.method == method.name]
            image = _map(axes, scan, method, quantity, some)
            if quantity == QUANTITIES[0]:
                axes.set_title(method.name, fontsize=9, fontweight="bold")
            if quantity == QUANTITIES[-1]:
                axes.set_xlabel(scan.label, fontsize=7)
            axes.set_ylabel("tolerance" if method.adaptive else "step [s]", fontsize=7)
        bar = figure.colorbar(image, ax=line, fraction=0.04, pad=0.01)
        bar.set_label(SHOWN[quantity][2].replace(", ", "\n", 1), fontsize=6.5)
        bar.ax.tick_params(labelsize=6)
    return figure


def _map(axes: Axes, scan: Scan, method: Method, quantity: str, spots: Sequence[Spot]) -> Any:
    low, high, _ = SHOWN[quantity]
    fine, values = finenesses(method), scan.values
    grid = np.full((len(fine), len(values)), np.nan)
    for spot in spots:
        grid[fine.index(spot.fineness), values.index(spot.value)] = _level(spot, quantity, low, high)
    image = axes.pcolormesh(
        np.arange(len(values) + 1) - 0.5, np.arange(len(fine) + 1) - 0.5, grid, cmap="cividis_r", vmin=low, vmax=high
    )
    _mark(axes, scan, method, spots)
    _ticks(axes, values, fine)
    return image


def _level(spot: Spot, quantity: str, low: float, high: float) -> float:
    if quantity == "contact switches":
        return math.log10(spot.switches) if spot.switches else math.nan
    value = spot.final_energy if quantity == "energy error" else spot.spread
    return min(max(math.log10(max(value, 1e-300)), low), high)


def _mark(axes: Axes, scan: Scan, method: Method, spots: Sequence[Spot]) -> None:
    """A letter on every failed run, and the line of `stable_step`."""
    fine, values = finenesses(method), scan.values
    for spot in spots:
        if spot.failure:
            axes.text(
                values.index(spot.value), fine.index(spot.fineness), spot.failure[0], fontsize=4.5, ha="center",
                va="center", color="white" if spot.warned else style.RED, fontweight="bold",
            )  # fmt: skip
    if method.adaptive:
        return
    limits = {spot.value: spot.limit for spot in spots}
    line = np.interp(np.log([limits[value] for value in values]), np.log(fine), np.arange(len(fine)), left=-0.5)
    axes.step(np.arange(len(values)), line, where="mid", color=style.RED, linewidth=1.3)


def _ticks(axes: Axes, values: Sequence[float], fine: Sequence[float]) -> None:
    across, up = range(0, len(values), 3), range(0, len(fine), 4)
    axes.set_xticks(list(across), [f"{values[k]:.2g}" for k in across], fontsize=6)
    axes.set_yticks(list(up), [f"{fine[k]:.0e}" for k in up], fontsize=6)
    axes.tick_params(length=2, top=False, right=False)
