"""Maps of the rigidity of a cluster of n beads that one bead hits. All beads have unit mass.

The power-law map has the axes alpha and n. The draft-gear map has the axes speed and n. Colours show the rigidity on a
logarithmic scale. Contours and a line mark the change of behaviour.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, draft_gear, one_on, power_law
from softcradle.physics.analysis.closed_forms import critical_speed
from softcradle.physics.status import Status
from softcradle.sandbox.studies.data_table import Array, Table
from softcradle.sandbox.studies.plot_style import PAGE_WIDTH, inner_label, new_figure, panel_title
from softcradle.sandbox.sweeps import grid
from softcradle.sandbox.sweeps.measure_table import Run
from softcradle.sandbox.sweeps.run_sweep import Progress, map_points
from softcradle.sandbox.sweeps.scene_points import LaneStart

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ALPHAS = (1.0 / 100.0, 1.0)  # Smallest and largest exponent.
SPEEDS = (0.5, 20.0)  # Smallest and largest speed of the striker, relative to the critical speed.
FEWEST_TARGETS = 2  # Smallest number of targets. A single target is always rigid.
GEAR = draft_gear(1.0, 1.0)  # Stiffness and precompression of this gear are the units, so only the speed varies.
# Tolerance of the simulations. The colours of a map show differences of a percent. Smaller tolerances would resolve
# every closing of chattering chains without any effect on the map.
TOLERANCE = 1e-5


@dataclass(frozen=True)
class RigidityMap:
    """Definition of a map of points (abscissa, n).

    Attributes:
        name: name of its files, and key of its chain in CHAINS.
        title: title above its panels.
        abscissa: name of the parameter along the abscissa.
        values: (X,) abscissae.
        sizes: (Y,) numbers n of targets.
    """

    name: str
    title: str
    abscissa: str
    values: Array
    sizes: Sequence[int]


def rigidity_maps(columns: int, rows: int) -> tuple[RigidityMap, RigidityMap]:
    """Return the two maps, with `columns` abscissae and `rows` cluster sizes that start at 2."""
    sizes = range(FEWEST_TARGETS, FEWEST_TARGETS + rows)
    alphas, speeds = np.geomspace(*ALPHAS, columns), np.geomspace(*SPEEDS, columns)
    return (
        RigidityMap("power-law", "power-law beads", "alpha", alphas, sizes),
        RigidityMap("draft-gear", "draft gears", "speed / critical speed", speeds, sizes),
    )


def _power_law_chain(alpha: float, n: int) -> tuple[Chain, float]:
    return one_on(n, power_law(1.0, alpha)), 1.0


def _draft_gear_chain(speed: float, n: int) -> tuple[Chain, float]:
    chain = one_on(n, GEAR)
    return chain, speed * critical_speed(GEAR, chain.mass, strikers=1)


CHAINS = {
    "power-law": _power_law_chain,
    "draft-gear": _draft_gear_chain,
}  # Each function returns the chain and the velocity of the striker for (abscissa, n).


def compute_map(
    scanned: RigidityMap, kept: Path | None = None, progress: Progress | None = None, workers: int | None = None
) -> Table:
    """Compute one row for each point of a map.

    The columns are the abscissa, n, the rigidity at detachment, the rigidity at the end, the status and a mark for
    warnings. A rigidity is NaN if it is unknown. The status is that of the simulation
    (softcradle.physics.status.Status). If it is 2 or more, the simulation gave up and its end is unknown. Points that
    an earlier call has stored in `kept` are not computed again; see `map_points`.
    """
    points = grid({"n": list(scanned.sizes), "abscissa": scanned.values.tolist()})
    rows = map_points(partial(point_numbers, scanned.name, TOLERANCE), points, kept, progress, workers)
    found = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    at = points.columns(0, points.count)
    columns = {scanned.abscissa: at["abscissa"], "n": at["n"]}
    columns |= {name.replace("_", " "): found[name] for name in ("rigidity_at_detachment", "rigidity_at_the_end")}
    return columns | {name: found[name].astype(int) for name in ("status", "warned")}


def point_numbers(name: str, tolerance: float, abscissa: float, n: int) -> dict[str, float]:
    """Compute one point of the map called `name`."""
    chain, speed = CHAINS[name](abscissa, n)
    run = Run(LaneStart(chain, [speed, *[0.0] * n], {"tolerance": tolerance}))
    found = {"rigidity_at_detachment": run.spread(run.detached), "rigidity_at_the_end": run.spread(run.motion)}
    return found | {
        "status": float(max((one.status for one in run.runs()), key=_severity)),
        "warned": float(any(one.warnings for one in run.runs())),
    }


def _severity(status: Status) -> tuple[bool, int]:
    """Return a sort key of a status. The statuses of simulations that gave up come last; their cells are hatched."""
    return status.gave_up, status


COLUMNS = ("rigidity at detachment", "rigidity at the end")
TITLES = ("(a) when the striker leaves", "(b) at the end")
# Smallest spread on the colour scale. With this tolerance, smaller spreads cannot be distinguished from 0.
SMALLEST_SHOWN = 100.0 * TOLERANCE
LARGEST_SHOWN = 10.0  # Larger spreads have the same colour.
HATCH: dict[str, Any] = {
    "hatch": "/////",
    "facecolor": "0.85",
    "edgecolor": "black",
    "linewidth": 0.0,
}  # Style of the cells whose simulation gave up.
# Reasons for which a simulation gave up.
REASONS = {Status.OUT_OF_STEPS: "took too many steps", Status.FAILED: "could not go on"}
# Values of the rigidity that have smooth contours, for each abscissa.
CONTOURS = {"alpha": (1e-1, 1.0), "speed / critical speed": (1.0,)}
AXIS_LABELS = {"alpha": r"$\alpha$", "speed / critical speed": "speed / critical speed"}  # Label of each abscissa.


def draw_map(scanned: RigidityMap, table: Table) -> Figure:
    """Draw the rigidity at detachment and at the end in two panels that share one colour scale."""
    figure, row = new_figure(PAGE_WIDTH, 3.1, 1, 2, sharex=True, sharey=True)
    shape = len(scanned.sizes), len(scanned.values)
    mesh: Any = None
    for axes, column, title in zip(row, COLUMNS, TITLES, strict=True):
        values = table[column].reshape(shape)
        mesh = _draw_panel(axes, scanned, values)
        panel_title(axes, f"{title}: {scanned.title}")
        reasons = _reasons(table["status"].reshape(shape), np.isnan(values))
        axes.set_xlabel(AXIS_LABELS[scanned.abscissa] + (f"    (hatched: {reasons})" if reasons else ""))
    row[0].set_ylabel("targets $n$")
    bar = figure.colorbar(mesh, ax=row, extend="both", pad=0.01, aspect=30)
    bar.set_label(f"velocity spread of the targets / their mean\n(white: below {100.0 * SMALLEST_SHOWN:g} %)")
    return figure


def _draw_panel(axes: Axes, scanned: RigidityMap, values: Array) -> Any:
    from matplotlib import colormaps
    from matplotlib.colors import LogNorm
    from matplotlib.ticker import MaxNLocator

    colours = colormaps["viridis"].with_extremes(under="white")
    unknown = np.isnan(values)
    shown = np.ma.masked_array(np.clip(values, SMALLEST_SHOWN / 10.0, LARGEST_SHOWN), mask=unknown)
    mesh = axes.pcolormesh(
        _edges(np.log(scanned.values)), np.arange(len(scanned.sizes) + 1) + scanned.sizes[0] - 0.5, shown,
        norm=LogNorm(SMALLEST_SHOWN, LARGEST_SHOWN), cmap=colours, rasterized=True,
    )  # fmt: skip
    _hatch(axes, scanned, unknown)
    axes.set_xscale("log")
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    _draw_contours(axes, scanned, shown)
    if scanned.abscissa == "alpha":
        _draw_guide(axes, 1.0 / np.array(scanned.sizes), scanned.sizes, r"$\alpha = 1/n$", "left")
    else:
        _draw_guide(axes, np.ones(len(scanned.sizes)), scanned.sizes, "critical speed", "right", rotation=90)
        inner_label(axes, "exactly\nrigid", 0.03, 0.55, fontsize=8.0)
    axes.set_xlim(scanned.values[0], scanned.values[-1])
    return mesh


def _hatch(axes: Axes, scanned: RigidityMap, unknown: NDArray[np.bool_]) -> None:
    """Hatch the cells of simulations that gave up, to distinguish them from rigid and soft cells."""
    from matplotlib.patches import Rectangle

    edges = _edges(np.log(scanned.values))
    for row, column in np.argwhere(unknown):
        left, bottom = edges[column], scanned.sizes[row] - 0.5
        axes.add_patch(Rectangle((left, bottom), edges[column + 1] - left, 1.0, **HATCH))


def _reasons(status: Array, unknown: NDArray[np.bool_]) -> str:
    """Return a text with the reasons for which simulations of hatched cells gave up, and their counts."""
    counts = {reason: int((unknown & (status == code)).sum()) for code, reason in REASONS.items()}
    return ", ".join(f"{count} {reason}" for reason, count in counts.items() if count)


def _edges(logarithms: Array) -> Array:
    """Return the (X+1,) borders of the cells around (X,) values whose logarithms are uniform."""
    half = 0.5 * (logarithms[1] - logarithms[0])
    edges: Array = np.exp(np.append(logarithms - half, logarithms[-1] + half))
    return edges


def _draw_contours(axes: Axes, scanned: RigidityMap, values: Array) -> None:
    from matplotlib.patheffects import withStroke

    if min(values.shape) < 2:
        return
    lines = axes.contour(
        scanned.values, list(scanned.sizes), np.log10(values), levels=np.log10(CONTOURS[scanned.abscissa]), colors="black",
        linewidths=0.7, linestyles="solid",
    )  # fmt: skip
    rows = [
        scanned.sizes[len(scanned.sizes) // part] for part in (4, 2)
    ]  # The labels of two contours are in different rows, so that they do not overlap.
    levels = zip(reversed(lines.allsegs), rows, strict=False)
    places = [place for segments, row in levels for place in _nearest(segments, row)]
    labels = axes.clabel(
        lines, fmt=lambda level: f"{100.0 * 10.0**level:.0f} %", fontsize=7.0, inline_spacing=2, manual=places
    )
    for label in labels:
        label.set_path_effects([withStroke(linewidth=1.5, foreground="white")])


def _nearest(segments: Sequence[Array], row: float) -> list[Array]:
    """Return the point of a contour that is nearest to a row of the map.

    The point lies on the longest of the `segments` (K, 2). The list is empty if there is no segment.
    """
    longest = max(segments, key=len, default=np.empty((0, 2)))
    return [longest[int(np.argmin(np.abs(longest[:, 1] - row)))]] if len(longest) else []


def _draw_guide(
    axes: Axes,
    values: Array,
    sizes: Sequence[int],
    text: str,
    alignment: Literal["left", "right"],
    rotation: float = 0.0,
) -> None:
    """Draw a dashed line through `values` (Y,) at all sizes, with a text near the top of the line."""
    rows = np.array(sizes, dtype=np.float64)
    ends = np.concatenate(([rows[0] - 0.5], rows, [rows[-1] + 0.5]))
    line = np.interp(ends, rows, values)
    for colour, width, dashes in (("black", 2.0, "-"), ("white", 1.2, (0, (4, 3)))):
        axes.plot(line, ends, color=colour, linewidth=width, linestyle=dashes)
    axes.annotate(
        text, (line[-1], ends[-1]), xytext=(4 if alignment == "left" else -4, -5), textcoords="offset points",
        ha=alignment, va="top", fontsize=8.0, rotation=rotation,
    )  # fmt: skip
