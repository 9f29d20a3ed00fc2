"""The paper's figures and those of the data it does not show: one small module each, a table and a drawing of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Picture
    from softcradle.sandbox.studies.figures.solved_cases import Table


@dataclass(frozen=True)
class Figure:
    """A figure: what it is called, where it belongs, and the functions that compute and draw it.

    Attributes:
        name: what `softcradle figures` takes, and the name of its files.
        place: in the paper.
        caption: what is to be seen.
        module: under `softcradle.sandbox.studies.figures`; `table` and `draw` are names in it.
    """

    name: str
    place: str
    caption: str
    module: str
    table: str
    draw: str

    def compute(self) -> Table:
        """The numbers: a column a quantity."""
        function: Callable[[], Table] = getattr(self._home(), self.table)
        return function()

    def picture(self, table: Table) -> Picture:
        """The drawing of those numbers; call it inside `softcradle.sandbox.studies.figures.figure_style.styled`."""
        function: Callable[[Table], Picture] = getattr(self._home(), self.draw)
        return function(table)

    def _home(self) -> object:
        return import_module(f"softcradle.sandbox.studies.figures.{self.module}")


FIGURES: tuple[Figure, ...] = (
    Figure("1b", "Fig. 1b", "positions in a one-on-four collision", "collision_figure", "positions", "draw_positions"),
    Figure("1c", "Fig. 1c", "its velocities, alpha = 1/10", "collision_figure", "figure_1c", "draw_1c"),
    Figure("1d", "Fig. 1d", "the same, alpha = 1/14", "collision_figure", "figure_1d", "draw_1d"),
    Figure("2a", "Fig. 2a", "the two modes of the mode-coupling model", "coupling_figure", "modes", "draw_modes"),
    Figure("2b", "Fig. 2b", "forces, mode coupling against full", "coupling_figure", "forces", "draw_forces"),
    Figure("2c", "Fig. 2c", "their relative discrepancies", "coupling_figure", "discrepancies", "draw_discrepancies"),
    Figure("2d", "Fig. 2d", "the initial rise of the forces", "coupling_figure", "rise", "draw_rise"),
    Figure(
        "B", "App. B", "test of the evanescent hypothesis, nine cases", "hypothesis_figure", "panels", "draw_panels"
    ),
    Figure(
        "spread", "Fig. 3 of ref. [1]", "velocity spread of the targets", "rigidity_figure", "spreads", "draw_spreads"
    ),
    Figure("softness", "Sec. IV", "where rigid-like behaviour ends", "rigidity_figure", "losses", "draw_losses"),
    Figure("scalings", "Sec. IV", "what vanishes as alpha does, and what stays", "scaling_figure", "scan", "draw_scan"),
    Figure(
        "driven", "Sec. V, not shown", "a steady force on a cluster at rest", "driven_figure", "history", "draw_history"
    ),
    Figure("driven-scan", "Sec. V, not shown", "its period and amplitude", "driven_figure", "scan", "draw_scan"),
    Figure("disorder", "Sec. V, not shown", "random chains, soft and usual", "disorder_figure", "outcomes", "draw"),
    Figure("clusters", "App. A (ii)", "three on five: two evanescent modes", "variants", "clusters", "draw_clusters"),
    Figure("exchange", "App. A (i)", "striker and target exchanged", "variants", "exchange", "draw_exchange"),
    Figure("interface", "App. A (iii), not shown", "Hooke interface", "variants", "interface", "draw_interface"),
    Figure("roads", "Secs. I, V", "evanescent mode, stiff springs, prestress", "wave_figure", "roads", "draw_roads"),
    Figure("train", "App. C, draft gears", "in-train forces of a shunting blow", "train_figure", "history", "draw"),
    Figure("pulse", "Sec. V", "the solitary pulse of the usual cradle", "wave_figure", "pulse", "draw_pulse"),
)


def named(names: Sequence[str]) -> list[Figure]:
    """The figures of those names, all for none; KeyError with the first name that is not one."""
    known = {figure.name: figure for figure in FIGURES}
    return [known[name] for name in names] if names else list(FIGURES)
