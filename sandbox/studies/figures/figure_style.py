"""The look of the figures: a journal's columns, a serif that matches the formulas, colours that all eyes tell apart."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN, PAGE = 3.4, 7.0  # widths [inches] of one column and of the page

# Okabe and Ito's palette, after the paper's: blue and orange for the first two beads and forces, red for psi
BLUE, ORANGE, GREEN, PURPLE, SKY, RED, GREY = (
    "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#6b6b6b",
)  # fmt: skip
ORDER = (BLUE, ORANGE, GREEN, PURPLE, SKY, RED, GREY, "#000000")

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
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "legend.borderaxespad": 0.4,
    "lines.linewidth": 1.1,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 300.0,
    "pdf.fonttype": 42,
    "svg.hashsalt": "softcradle",
}


@contextmanager
def styled() -> Iterator[None]:
    """Draw inside with these settings and without a window."""
    import matplotlib as mpl

    with mpl.rc_context(SETTINGS):  # type: ignore[arg-type]
        yield


def page(
    width: float = COLUMN, height: float = 2.5, rows: int = 1, columns: int = 1, **options: Any
) -> tuple[Figure, Any]:
    """A figure of that size [inches] and its axes, an array of them for several."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, columns, **options)


def label(axes: Axes, text: str, x: float = 0.03, y: float = 0.95, **options: Any) -> None:
    """`text` inside the axes at a fraction of them, upper left unless said otherwise."""
    axes.text(x, y, text, transform=axes.transAxes, va="top", **options)


def title(axes: Axes, text: str) -> None:
    """Name a panel above its upper left corner."""
    axes.set_title(text, loc="left", pad=4.0)


def zero(axes: Axes) -> None:
    """A thin line at 0."""
    axes.axhline(0.0, color=GREY, linewidth=0.5, zorder=0)


def beside(axes: Axes, x: float, y: float, text: str, colour: str, **options: Any) -> None:
    """Name a curve where it stands, instead of a legend."""
    settings = {"ha": "left", "va": "center", "fontsize": 8.5, **options}
    axes.annotate(text, (x, y), xytext=(3, 0), textcoords="offset points", color=colour, **settings)
