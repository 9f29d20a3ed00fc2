"""Style of all figures and charts.

The widths are column widths of a journal. The serif font matches the formulas. All figures use the same colours.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from softcradle.sandbox.files import output_file
from softcradle.sandbox.studies.data_table import Table, write_table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN_WIDTH = 86.0 / 25.4  # Width of a journal column, 86 mm, in inches.
# Width of a journal page, 178 mm, in inches. This width is used for figures with several panels.
PAGE_WIDTH = 178.0 / 25.4

# Colours of Okabe and Ito, which colour-blind readers can distinguish. As in the paper, the first two beads and forces
# are blue and orange, and psi is red.
BLUE = "#0072B2"
ORANGE = "#E69F00"
GREEN = "#009E73"
PURPLE = "#CC79A7"
SKY = "#56B4E9"
RED = "#D55E00"
GREY = "#6b6b6b"
BLACK = "#000000"
COLOUR_CYCLE = (BLUE, ORANGE, GREEN, PURPLE, SKY, RED, GREY, BLACK)

# Style of the curves of the mode-coupling model: dashed, thick and pale. These curves lie below the thin solid curves
# of the full equations.
MODEL_LINE: dict[str, Any] = {"linestyle": (0, (4, 2)), "linewidth": 2.2, "alpha": 0.5}

SETTINGS: dict[str, Any] = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 9.0,
    "axes.labelsize": 9.5,
    "axes.titlesize": 9.0,
    "axes.linewidth": 0.6,
    "axes.axisbelow": True,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.pad": 5.0,  # Distance in points that separates the labels in the lower left corner.
    "xtick.labelsize": 8.6,  # With this size, exponents have more than 6 points, the minimum for print.
    "ytick.labelsize": 8.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.fontsize": 8.6,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "legend.borderaxespad": 0.4,
    "lines.linewidth": 1.1,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 300.0,
    "pdf.fonttype": 42,
    "svg.hashsalt": "softcradle",
}


def require_matplotlib() -> None:
    """Raise ModuleNotFoundError if matplotlib is missing. Call this before the computations for a figure."""
    import matplotlib  # noqa: F401


@contextmanager
def styled() -> Iterator[None]:
    """Apply the style of this module to all figures that are drawn inside the block."""
    import matplotlib as mpl

    with mpl.rc_context(SETTINGS):  # type: ignore[arg-type]
        yield


def new_figure(
    width: float = COLUMN_WIDTH,
    height: float = 2.5,
    rows: int = 1,
    columns: int = 1,
    titles: Sequence[str] = (),
    **options: Any,
) -> tuple[Figure, Any]:
    """Return a new figure without a window, and its axes. The size is in inches.

    If there are several axes, they are returned as an array, and `titles` contains their titles.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    panels = figure.subplots(rows, columns, **options)
    for axes, title in zip(np.ravel(panels), titles, strict=False):
        panel_title(axes, title)
    return figure, panels


def inner_label(axes: Axes, text: str, x: float = 0.03, y: float = 0.95, **options: Any) -> None:
    """Write `text` inside the axes. The position (x, y) of its upper left corner is a fraction of their width and
    height.
    """
    axes.text(x, y, text, transform=axes.transAxes, va="top", **options)


def panel_title(axes: Axes, text: str) -> None:
    """Write a title above the upper left corner of a panel."""
    axes.set_title(text, loc="left", pad=4.0)


def zero_line(axes: Axes) -> None:
    """Draw a thin horizontal line at 0."""
    axes.axhline(0.0, color=GREY, linewidth=0.5, zorder=0)


def curve_label(axes: Axes, x: float, y: float, text: str, colour: str) -> None:
    """Write the name of a curve to the right of its point (x, y). Such labels replace a legend."""
    axes.annotate(
        text, (x, y), xytext=(3, 0), textcoords="offset points", color=colour, ha="left", va="center", fontsize=8.6
    )


def label_above(
    axes: Axes, x: float, y: float, text: str, colour: str = BLACK, lift: float = 5.0, **options: Any
) -> None:
    """Write `text` above the point (x, y), at a distance of `lift` [points]."""
    axes.annotate(text, (x, y), xytext=(0, lift), textcoords="offset points", color=colour, ha="center", **options)


def model_legend(axes: Axes, columns: int = 2, **options: Any) -> None:
    """Add a legend with the line styles of the mode-coupling model and of the full equations.

    Curves that have a label are included.
    """
    axes.plot([], [], color=GREY, label="mode coupling", **MODEL_LINE)
    axes.plot([], [], color=GREY, linewidth=0.8, label="full")
    axes.legend(**{"loc": "upper right", "ncols": columns, "handlelength": 2.2} | options)


def bead_colour(bead: int, strikers: int = 1) -> str:
    """Return the colour of a bead: blue for strikers, orange for the bead that they hit, black for all other beads."""
    return BLUE if bead < strikers else ORANGE if bead == strikers else BLACK


SUFFIXES = (".png", ".pdf", ".csv")


def save_figure(figure: Figure, path: Path, dpi: float | None = None) -> None:
    """Write `figure` to `path` in the format of the suffix. Equal figures give equal files.

    The figure is first drawn in memory. On a full disk, the writer of .pdf files would raise a library-specific error.

    Raises:
        OSError: if the file cannot be written.
    """
    metadata = {"CreationDate": None} if path.suffix == ".pdf" else {"Date": None} if path.suffix == ".svg" else None
    drawn = BytesIO()
    figure.savefig(drawn, format=path.suffix[1:], metadata=metadata, dpi=dpi)
    path.write_bytes(drawn.getvalue())


def write_picture(picture: Figure, table: Table, stem: Path) -> list[Path]:
    """Write `picture` to the files `stem`.png and `stem`.pdf, and its numbers to `stem`.csv. Return the paths.

    Raise UserError if a file cannot be written.
    """
    png, pdf, numbers = paths = [stem.with_name(stem.name + suffix) for suffix in SUFFIXES]
    with output_file(png) as temporary:
        save_figure(picture, temporary)
    with output_file(pdf) as temporary:
        save_figure(picture, temporary)
    with output_file(numbers) as temporary:
        write_table(table, temporary)
    return paths
