"""Figures in a notebook. The figures show velocities and forces over time in the style of the figures of the paper."""

from io import BytesIO

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from softcradle.physics import Trajectory
from softcradle.sandbox.quantities import FORCE, TIME, VELOCITY
from softcradle.sandbox.scene_runs import run_scene
from softcradle.sandbox.studies.plot_style import COLUMN_WIDTH, bead_colour, panel_title, styled, zero_line
from softcradle.scenes import Scene

DOTS_AN_INCH = 110
SCENE_SAMPLES = 601
# Largest number of curves that all have labels. If there are more curves, only the first and the last have one.
MOST_LABELS = 8


class ShownFigure(Figure):
    """Figure that a notebook displays without any configuration of matplotlib."""

    def _repr_png_(self) -> bytes:
        encoded = BytesIO()
        with styled():
            self.savefig(encoded, format="png", dpi=DOTS_AN_INCH)
        return encoded.getvalue()


def figure_of(shown: Trajectory | Scene) -> ShownFigure:
    """Draw the velocities in the upper panels and the forces in the lower panels. A scene has one column of panels for
    each lane.
    """
    if isinstance(shown, Trajectory):
        columns = [("", shown)]
    else:
        found = run_scene(shown, samples=SCENE_SAMPLES)
        columns = [(lane.label, trajectory) for lane, trajectory in zip(shown.lanes, found, strict=True)]
    with styled():
        figure = ShownFigure(figsize=(2.0 * COLUMN_WIDTH, 4.2), layout="constrained")
        FigureCanvasAgg(figure)
        grid = figure.subplots(2, len(columns), sharex="col", sharey="row", squeeze=False)
        for column, (label, trajectory) in enumerate(columns):
            _draw(grid[0, column], grid[1, column], trajectory)
            panel_title(grid[0, column], label)
        grid[0, 0].set_ylabel(VELOCITY.label)
        grid[1, 0].set_ylabel(FORCE.label)
        if not any((trajectory.force < 0.0).any() for _, trajectory in columns):
            # All lanes share this axis. The limit of the shared axis is therefore set after all lanes have been drawn.
            grid[1, 0].set_ylim(bottom=0.0)
    return figure


def new_shown_figure(height: float = 2.6) -> tuple[ShownFigure, Axes]:
    """Return an empty figure for plots of the user, and its axes. The new figure has the style of the other figures."""
    with styled():
        figure = ShownFigure(figsize=(1.4 * COLUMN_WIDTH, height), layout="constrained")
        FigureCanvasAgg(figure)
        return figure, figure.subplots()


def _draw(velocities: Axes, forces: Axes, trajectory: Trajectory) -> None:
    beads, contacts = trajectory.chain.contacts + 1, trajectory.chain.contacts
    zero_line(velocities)
    for i in range(beads):
        velocities.plot(trajectory.time, trajectory.velocity[:, i], color=_colour(i, beads), label=f"bead {i}")
    for i in range(contacts):
        forces.plot(trajectory.time, trajectory.force[:, i], color=_colour(i + 1, beads), label=f"{i}-{i + 1}")
    forces.set_xlabel(TIME.label)
    for axes, count in ((velocities, beads), (forces, contacts)):
        handles, labels = axes.get_legend_handles_labels()
        named = range(count) if count <= MOST_LABELS else (0, count - 1)
        axes.legend(
            [handles[i] for i in named],
            [labels[i] for i in named],
            fontsize=6.5,
            loc="center left",
            bbox_to_anchor=(1.0, 0.5),
        )


def _colour(bead: int, beads: int) -> str:
    """Return the colour of a bead. The first two beads have the colours of the striking and the struck bead in the
    paper. The other beads are dark to light grey.
    """
    if bead < 2:
        return bead_colour(bead)
    return str(float(np.interp(bead, (2, max(beads - 1, 3)), (0.0, 0.65))))
