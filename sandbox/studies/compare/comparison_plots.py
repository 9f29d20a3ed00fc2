"""The charts of a comparison: contact states of each side, and overlays of all sides."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.analysis.measures import LEAST_OVERLAP, energy_inside, first_touch
from softcradle.sandbox.page.motion_charts import chart_row
from softcradle.sandbox.page.played_motion import PlayedMotion
from softcradle.sandbox.page.svg_charts import Axes, Curve, Range, axis_range, bar_chart, line_chart
from softcradle.sandbox.studies.compare.comparison_results import SideResult

Array = NDArray[np.float64]
LAW_POINTS = 400  # points on the curve of a contact law


class TimeAxis:
    """The time axis of all charts of a page, that of its player, in a unit that fits it."""

    def __init__(self, played: PlayedMotion) -> None:
        self.begin, self.end = played.scales.time
        self.unit, name = played.time_unit
        self.label = f"time ({name})"

    def axes(self, values: Range, label: str) -> Axes:
        """Axes of `values` over time."""
        return Axes((self.begin / self.unit, self.end / self.unit), values, self.label, label, self.unit)

    def times(self, result: SideResult) -> Array:
        """(T+2,) sample times, then the end of the motion and of the axis, in the unit; see :func:`_extended`."""
        time = result.trajectory.time
        extended: Array = np.concatenate((time, [time[-1], max(self.end, float(time[-1]))])) / self.unit
        return extended


def _extended(values: Array, last: Array | float) -> Array:
    """(T+2, ...) `values` (T, ...) and then twice the `last` ones, which hold from the end of the motion on."""
    extended: Array = np.concatenate((values, np.broadcast_to(last, (2, *values.shape[1:]))))
    return extended


def _forces(result: SideResult) -> Array:
    """(T+2, n) contact forces; 0 after the motion for contacts that are open at its end."""
    found = result.trajectory
    closed = [bool(spans) and math.isinf(spans[-1][1]) for spans in found.contact_intervals]
    return _extended(found.force, np.where(closed, found.force[-1], 0.0))


def overlays(results: Sequence[SideResult], axis: TimeAxis) -> str:
    """Force of the struck contact, energy inside the target cluster, and contact laws: a curve a side in each."""
    forces = [_forces(result)[:, result.measures.struck] for result in results]
    inside = [_energy_inside(result) for result in results]
    return chart_row(
        [
            _overlay("Force of the struck contact", results, forces, axis, "force (N)"),
            _overlay("Energy inside the target cluster", results, inside, axis, "share of all energy"),
            _law_chart(results),
        ]
    )


def _overlay(title: str, results: Sequence[SideResult], values: Sequence[Array], axis: TimeAxis, label: str) -> str:
    curves = [
        Curve(result.side.name, axis.times(result), column, f"s{k}")
        for k, (result, column) in enumerate(zip(results, values, strict=True))
    ]
    return line_chart(title, curves, axis.axes(axis_range(values), label))


def _energy_inside(result: SideResult) -> Array:
    share = energy_inside(result.trajectory, result.measures.struck)
    return np.nan_to_num(_extended(share, share[-1]))


def _law_chart(results: Sequence[SideResult]) -> str:
    """The law of the struck contact up to the greatest overlap on any side, with the jump at overlap 0."""
    deepest = max(float(r.trajectory.overlap[:, r.measures.struck].max()) for r in results)
    overlap = np.concatenate(([0.0], np.geomspace(1e-6, 1.0, LAW_POINTS) * deepest))
    curves = []
    for k, result in enumerate(results):
        law = result.trajectory.chain.contact[result.measures.struck]
        force = np.asarray(law.force(overlap))
        curves.append(Curve(result.side.name, overlap, force, f"s{k}"))
        if law.loss:
            curves.append(Curve(f"{result.side.name}, unloading", overlap, (1.0 - law.loss) * force, f"s{k}"))
    axes = Axes((0.0, deepest), axis_range([curve.y for curve in curves]), "overlap (m)", "force (N)")
    return line_chart("Law of the struck contact", curves, axes)


def contact_bars(results: Sequence[SideResult], axis: TimeAxis) -> str:
    """A chart a side: when each contact is open, touching and loaded."""
    charts = []
    for result in results:
        rows = [(f"{k}-{k + 1}", _states(result, k, axis)) for k in range(result.trajectory.chain.contacts)]
        charts.append(bar_chart(f"{result.side.name}: contacts", rows, axis.axes((0.0, 1.0), "")))
    return chart_row(charts)


def _states(result: SideResult, contact: int, axis: TimeAxis) -> list[tuple[str, float, float]]:
    """(state, begin, end) in the unit of the axis: open all along, and drawn over it when it is touching and loaded."""
    trajectory, unit = result.trajectory, axis.unit
    found = [("open", axis.begin / unit, axis.end / unit)]
    loaded = trajectory.overlap[:, contact] > LEAST_OVERLAP * float(trajectory.overlap.max())
    for begin, opened in trajectory.contact_intervals[contact]:
        end = opened if math.isfinite(opened) else axis.end
        if trajectory.chain.contact[contact].preload == 0.0:
            found.append(("loaded", begin / unit, end / unit))
            continue
        # contacts at rest side by side do not count as touching before the collision begins
        touched = max(begin, first_touch(trajectory, result.measures.struck))
        if touched < end:
            found.append(("touching", touched / unit, end / unit))
        found += [("loaded", a / unit, b / unit) for a, b in _intervals(trajectory.time, loaded, begin, end)]
    return found


def _intervals(time: Array, loaded: NDArray[np.bool_], begin: float, end: float) -> list[tuple[float, float]]:
    """Intervals between `begin` and `end` in which `loaded` (T,) holds, longer by a sample at both ends."""
    inside = loaded & (time >= begin) & (time <= end)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], inside.astype(int), [0]))))
    last = len(time) - 1
    return [
        (max(begin, float(time[max(a - 1, 0)])), min(end, float(time[min(b, last)])))
        for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
    ]
