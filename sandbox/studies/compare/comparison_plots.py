"""The charts of a comparison: velocities and forces of each side, and what is best seen on top of each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.analysis.measures import LEAST_OVERLAP, energy_inside, first_touch
from softcradle.sandbox.draw.number_format import subscript, time_unit
from softcradle.sandbox.studies.compare.comparison_results import Result
from softcradle.sandbox.studies.compare.svg_charts import Axes, Curve, Span, bars, chart, span

Array = NDArray[np.float64]
BEAD_TINTS = 7  # classes c0 ... c6 of the page
LAW_POINTS = 400


class Clock:
    """The time axis that all charts share: from 0 to the end of the longest motion, in its unit."""

    def __init__(self, results: Sequence[Result]) -> None:
        self.end = max(float(result.trajectory.time[-1]) for result in results)
        self.unit, name = time_unit(self.end)
        self.label = f"time ({name})"
        self.span: Span = (0.0, self.end / self.unit)

    def of(self, result: Result) -> Array:
        """(T+2,) sample times, then the end of the motion and of the axis, in the unit; see :func:`_held`."""
        time = result.trajectory.time
        extended: Array = np.concatenate((time, [time[-1], max(self.end, float(time[-1]))])) / self.unit
        return extended


def velocity_charts(results: Sequence[Result], clock: Clock) -> str:
    """A chart a side: velocities of its beads, all on the same axes."""
    return _beside(results, clock, "velocity (m/s)", "v", _velocities, 0)


def force_charts(results: Sequence[Result], clock: Clock) -> str:
    """A chart a side: forces of its contacts, all on the same axes."""
    return _beside(results, clock, "contact force (N)", "f", _forces, 1)


def _beside(
    results: Sequence[Result], clock: Clock, label: str, letter: str, values: Callable[[Result], Array], first: int
) -> str:
    found = [values(result) for result in results]
    axes = Axes(clock.span, span(found), clock.label, label)
    charts = []
    for result, columns in zip(results, found, strict=True):
        names = [letter + (subscript(k, k + 1) if first else subscript(k)) for k in range(columns.shape[1])]
        curves = [
            Curve(name, clock.of(result), columns[:, k], f"c{(k + first) % BEAD_TINTS}") for k, name in enumerate(names)
        ]
        charts.append(chart(f"{result.side.name}: {label}", curves, axes))
    return _row(charts)


def _held(values: Array, last: Array | float) -> Array:
    """(T+2, ...) `values` (T, ...) and what they are when the motion is over, at its end and at that of the axis."""
    held: Array = np.concatenate((values, np.broadcast_to(last, (2, *values.shape[1:]))))
    return held


def _velocities(result: Result) -> Array:
    return _held(result.trajectory.velocity, result.trajectory.final_velocity)


def _forces(result: Result) -> Array:
    """(T+2, n) contact forces; 0 after the motion for contacts that have opened for good."""
    made = result.trajectory
    closed = [bool(spans) and math.isinf(spans[-1][1]) for spans in made.contact_intervals]
    return _held(made.force, np.where(closed, made.force[-1], 0.0))


def overlays(results: Sequence[Result], clock: Clock) -> str:
    """Force of the struck contact, energy inside the target cluster, and the laws, of all sides on top of each other."""
    forces = [_forces(r)[:, r.measures.struck] for r in results]
    inside = [_inside(r) for r in results]
    pairs = list(enumerate(results))
    force = [Curve(r.side.name, clock.of(r), forces[k], f"s{k}") for k, r in pairs]
    energy = [Curve(r.side.name, clock.of(r), inside[k], f"s{k}") for k, r in pairs]
    return _row(
        [
            chart("Force of the struck contact", force, Axes(clock.span, span(forces), clock.label, "force (N)")),
            chart(
                "Energy inside the target cluster",
                energy,
                Axes(clock.span, span(inside), clock.label, "share of all energy"),
            ),
            _laws(results),
        ]
    )


def _inside(result: Result) -> Array:
    share = energy_inside(result.trajectory, result.measures.struck)
    return np.nan_to_num(_held(share, share[-1]))


def _laws(results: Sequence[Result]) -> str:
    """The law of the struck contact as far as it is pressed by the deepest of all, with the leap at overlap 0."""
    deepest = max(float(r.trajectory.overlap[:, r.measures.struck].max()) for r in results)
    deep = np.concatenate(([0.0], np.geomspace(1e-6, 1.0, LAW_POINTS) * deepest))
    curves = []
    for k, result in enumerate(results):
        law = result.trajectory.chain.contact[result.measures.struck]
        force = np.asarray(law.force(deep))
        curves.append(Curve(result.side.name, deep, force, f"s{k}"))
        if law.loss:
            curves.append(Curve(f"{result.side.name}, unloading", deep, (1.0 - law.loss) * force, f"s{k}"))
    axes = Axes((0.0, deepest), span([curve.y for curve in curves]), "overlap (m)", "force (N)", clock=False)
    return chart("Law of the struck contact", curves, axes)


def contact_bars(results: Sequence[Result], clock: Clock) -> str:
    """A chart a side: when each contact was open, touching and loaded."""
    charts = []
    for result in results:
        rows = [(f"{k}-{k + 1}", _stretches(result, k, clock)) for k in range(result.trajectory.chain.contacts)]
        charts.append(bars(f"{result.side.name}: contacts", rows, clock.span, clock.label))
    return _row(charts)


def _stretches(result: Result, contact: int, clock: Clock) -> list[tuple[str, float, float]]:
    """Open all along, and on top of it when it touched and when it was loaded."""
    trajectory, unit = result.trajectory, clock.unit
    found = [("open", 0.0, clock.end / unit)]
    pressed = trajectory.overlap[:, contact] > LEAST_OVERLAP * float(trajectory.overlap.max())
    for begin, opened in trajectory.contact_intervals[contact]:
        end = opened if math.isfinite(opened) else clock.end
        if trajectory.chain.contact[contact].preload == 0.0:
            found.append(("loaded", begin / unit, end / unit))
            continue
        begun = max(begin, first_touch(trajectory, result.measures.struck))  # lying side by side before it is no touch
        if begun < end:
            found.append(("touching", begun / unit, end / unit))
        found += [("loaded", a / unit, b / unit) for a, b in _runs(trajectory.time, pressed, begin, end)]
    return found


def _runs(time: Array, pressed: NDArray[np.bool_], begin: float, end: float) -> list[tuple[float, float]]:
    """Stretches between `begin` and `end` in which `pressed` (T,) holds; a sample more on either side."""
    inside = pressed & (time >= begin) & (time <= end)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], inside.astype(int), [0]))))
    last = len(time) - 1
    return [
        (max(begin, float(time[max(a - 1, 0)])), min(end, float(time[min(b, last)])))
        for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
    ]


def _row(charts: Sequence[str]) -> str:
    return f'<div class="charts">{"".join(charts)}</div>'
