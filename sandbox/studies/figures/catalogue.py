"""List of all figures in the order of the paper. Each entry has a name, a place, a caption and two functions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.studies.data_table import Table
from softcradle.sandbox.studies.figures import collision, coupler, disorder, rigidity, scaling, train, variant, wave
from softcradle.sandbox.studies.paper import ALPHA, SOFTER_ALPHA
from softcradle.sandbox.studies.plot_style import styled, write_picture
from softcradle.sandbox.sweeps import listed
from softcradle.sandbox.sweeps.run_sweep import Progress, map_points
from softcradle.sandbox.user_error import named

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class FigureEntry:
    """Entry of the list of figures.

    Attributes:
        name: argument of `softcradle figures`, and name of the files.
        place: number of the figure or section in the paper.
        caption: description of the figure.
        table: function that computes the numbers, with a column for each quantity.
        draw: function that draws these numbers; call it inside `plot_style.styled`.
    """

    name: str
    place: str
    caption: str
    table: Callable[[], Table]
    draw: Callable[[Table], Figure]


FIGURES: tuple[FigureEntry, ...] = (
    FigureEntry("1b", "Fig. 1b", "positions in a one-on-four collision", collision.positions, collision.draw_positions),
    FigureEntry("1c", "Fig. 1c", "its velocities, alpha = 1/10",
                partial(collision.velocities, ALPHA), partial(collision.draw_velocities, alpha=ALPHA)),
    FigureEntry("1d", "Fig. 1d", "the same, alpha = 1/14",
                partial(collision.velocities, SOFTER_ALPHA), partial(collision.draw_velocities, alpha=SOFTER_ALPHA)),
    FigureEntry("2a", "Fig. 2a", "the two modes of the mode-coupling model", collision.modes, collision.draw_modes),
    FigureEntry("2b", "Fig. 2b", "forces, mode coupling against full", collision.forces, collision.draw_forces),
    FigureEntry("2c", "Fig. 2c", "their relative discrepancies; (a) ends at 1.4e-3, which f01 leaves as it ends: (b) shows how",
                collision.discrepancies, collision.draw_discrepancies),
    FigureEntry("2d", "Fig. 2d", "the initial rise of the forces", collision.rise, collision.draw_rise),
    FigureEntry("B", "App. B", "test of the evanescent hypothesis, nine cases", rigidity.panels, rigidity.draw_panels),
    FigureEntry("spread", "Fig. 3 of ref. [1]", "velocity spread of the targets", rigidity.spreads, rigidity.draw_spreads),
    FigureEntry("softness", "Sec. IV",
                "where rigid-like behaviour ends; (a) has kinks where f12 begins or ceases to act a second time",
                rigidity.losses, rigidity.draw_losses),
    FigureEntry("scalings", "Sec. IV", "what vanishes as alpha does, and what stays",
                scaling.scalings, scaling.draw_scalings),
    FigureEntry("collapse", "Sec. IV", "the end of rigid-like behaviour, and its scaling variable",
                scaling.spreads, scaling.draw_spreads),
    FigureEntry("ringing", "Sec. IV", "the inner contact oscillates about its branch",
                collision.history, collision.draw_history),
    FigureEntry("equivalence", "App. C", "which gear speed equals which alpha", coupler.nearest, coupler.draw_nearest),
    FigureEntry("driven", "Sec. V, not shown", "a steady force on a cluster at rest", wave.history, wave.draw_history),
    FigureEntry("driven-scan", "Sec. V, not shown", "its period and amplitude", wave.scan, wave.draw_scan),
    FigureEntry("disorder", "Sec. V, not shown", "random chains, soft and usual", disorder.outcomes, disorder.draw_outcomes),
    FigureEntry("clusters", "App. A (ii)", "three on five: two evanescent modes", variant.clusters, variant.draw_clusters),
    FigureEntry("exchange", "App. A (i)", "striker and target exchanged", variant.exchange, variant.draw_exchange),
    FigureEntry("interface", "App. A (iii), not shown", "Hooke interface", variant.interface, variant.draw_interface),
    FigureEntry("roads", "Secs. I, V", "evanescent mode, stiff springs, prestress", wave.roads, wave.draw_roads),
    FigureEntry("train", "App. C, draft gears", "in-train forces of a shunting blow", train.history, train.draw_history),
    FigureEntry("envelopes", "App. C, draft gears", "largest in-train forces over the speed of the blow",
                train.envelopes, train.draw_envelopes),
    FigureEntry("stop", "App. C, draft gears", "solid stop and stiffness of wagons", coupler.stops, coupler.draw_stops),
    FigureEntry("starting", "App. C, draft gears", "a train moves off, slack after slack",
                coupler.starting, coupler.draw_starting),
    FigureEntry("pulse", "Sec. V", "the solitary pulse of the usual cradle", wave.pulse, wave.draw_pulse),
)  # fmt: skip


def figures_named(names: Sequence[str]) -> list[FigureEntry]:
    """Return the figures called `names`, or all figures if `names` is empty. Raise UserError if a name is unknown."""
    return named("figure", names, {figure.name: figure for figure in FIGURES})


# Figures that take seconds to minutes each. These figures are computed first, because otherwise cores would wait at the
# end.
LONGEST = ("collapse", "softness", "spread", "B")


def compute_tables(
    figures: Sequence[FigureEntry],
    kept: Path | None = None,
    progress: Progress | None = None,
    workers: int | None = None,
) -> Iterator[Table]:
    """Compute the tables of `figures` in their order, as a sweep in which each point is a figure.

    Tables that an earlier sweep has stored in `kept` are not computed again; see `map_points`.
    """
    names = [figure.name for figure in figures]
    order = sorted(names, key=lambda name: name not in LONGEST)
    alike = not set(LONGEST) & set(order)
    rows = map_points(table_columns, listed({"figure": order}), kept, progress, workers, alike=alike)
    for name in names:
        yield _table_in(rows[order.index(name)], name)


def table_columns(figure: str) -> Table:
    """Compute the table of the figure called `figure`. Each column name in the result begins with the name of the
    figure.
    """
    (found,) = figures_named([figure])
    return {f"{figure}: {column}": values for column, values in found.table().items()}


def _table_in(row: Mapping[str, Any], figure: str) -> Table:
    """Return the table of a figure from its point of the sweep."""
    own = f"{figure}: "
    return {name.removeprefix(own): values for name, values in row.items() if name.startswith(own)}


def write_figure(figure: FigureEntry, folder: Path, table: Table | None = None) -> list[Path]:
    """Write `figure` into `folder` as .png, .pdf and .csv files, and return their paths.

    The table is computed if `table` is None. Raise UserError if a file cannot be written.
    """
    table = figure.table() if table is None else table
    with styled():
        return write_picture(figure.draw(table), table, folder / f"figure-{figure.name}")
