"""The paper's figures and those of the data it does not show: one small module each, a table and a drawing of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Picture

    from sandbox.figures.cases import Table


@dataclass(frozen=True)
class Figure:
    """A figure: what it is called, where it belongs, and the functions that compute and draw it.

    Attributes:
        name: what `softcradle figures` takes, and the name of its files.
        place: in the paper.
        caption: what is to be seen.
        module: under `sandbox.figures`; `table` and `draw` are names in it.
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
        """The drawing of those numbers; call it inside `sandbox.figures.style.styled`."""
        function: Callable[[Table], Picture] = getattr(self._home(), self.draw)
        return function(table)

    def _home(self) -> object:
        return import_module(f"sandbox.figures.{self.module}")


FIGURES: tuple[Figure, ...] = (
    Figure("1b", "Fig. 1b", "positions in a one-on-four collision", "collision", "positions", "draw_positions"),
    Figure("1c", "Fig. 1c", "its velocities, alpha = 1/10", "collision", "figure_1c", "draw_1c"),
    Figure("1d", "Fig. 1d", "the same, alpha = 1/14", "collision", "figure_1d", "draw_1d"),
    Figure("2a", "Fig. 2a", "the two modes of the mode-coupling model", "coupling", "modes", "draw_modes"),
    Figure("2b", "Fig. 2b", "forces, mode coupling against full", "coupling", "forces", "draw_forces"),
    Figure("2c", "Fig. 2c", "their relative discrepancies", "coupling", "discrepancies", "draw_discrepancies"),
    Figure("2d", "Fig. 2d", "the initial rise of the forces", "coupling", "rise", "draw_rise"),
    Figure("B", "App. B", "test of the evanescent hypothesis, nine cases", "hypothesis", "panels", "draw_panels"),
    Figure("spread", "Fig. 3 of ref. [1]", "velocity spread of the targets", "rigidity", "spreads", "draw_spreads"),
    Figure("softness", "Sec. IV", "where rigid-like behaviour ends", "rigidity", "losses", "draw_losses"),
    Figure("scalings", "Sec. IV", "what vanishes as alpha does, and what stays", "scalings", "scan", "draw_scan"),
    Figure("driven", "Sec. V, not shown", "a steady force on a cluster at rest", "driven", "history", "draw_history"),
    Figure("driven-scan", "Sec. V, not shown", "its period and amplitude", "driven", "scan", "draw_scan"),
    Figure("disorder", "Sec. V, not shown", "random chains, soft and usual", "disorder", "outcomes", "draw"),
    Figure("clusters", "App. A (ii)", "three on five: two evanescent modes", "variants", "clusters", "draw_clusters"),
    Figure("exchange", "App. A (i)", "striker and target exchanged", "variants", "exchange", "draw_exchange"),
    Figure("interface", "App. A (iii), not shown", "Hooke interface", "variants", "interface", "draw_interface"),
    Figure("roads", "Secs. I, V", "evanescent mode, stiff springs, prestress", "waves", "roads", "draw_roads"),
    Figure("train", "App. C, draft gears", "in-train forces of a shunting blow", "train", "history", "draw"),
    Figure("pulse", "Sec. V", "the solitary pulse of the usual cradle", "waves", "pulse", "draw_pulse"),
)


def named(names: Sequence[str]) -> list[Figure]:
    """The figures of those names, all for none; KeyError with the first name that is not one."""
    known = {figure.name: figure for figure in FIGURES}
    return [known[name] for name in names] if names else list(FIGURES)
