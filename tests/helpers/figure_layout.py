"""Find faults in the layout of a matplotlib figure. A fault is a text that is too small, overlaps another text or a
curve, or lies outside the figure.
"""

from itertools import combinations
from unittest.mock import patch

from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

SCRIPT = 0.7  # Size of exponents and indices, as a fraction of the size of the text that contains them.
LEAST_SIZE = 6.0  # Smallest size of a text [points] that counts as readable.
TOUCH = 1.0  # Distance by which the boxes of two texts may overlap [points].


def texts_of(figure: Figure) -> list[tuple[Text, Bbox]]:
    """Return the texts that matplotlib actually draws, with their boxes [pixels]. Tick labels that are not drawn are
    left out.
    """
    drawn: dict[Text, None] = {}
    original = Text.draw

    def draw(text: Text, renderer: RendererBase) -> None:
        if text.get_visible() and text.get_text().strip():
            drawn[text] = None
        original(text, renderer)

    with patch.object(Text, "draw", draw):
        figure.draw_without_rendering()
    return [(text, text.get_window_extent()) for text in drawn]


def texts_on_texts(figure: Figure) -> list[tuple[str, str]]:
    texts = [(text.get_text(), box.padded(-0.5 * TOUCH * figure.dpi / 72.0)) for text, box in texts_of(figure)]
    return [(one, other) for (one, box), (other, below) in combinations(texts, 2) if box.overlaps(below)]


def keys_on_curves(figure: Figure) -> list[tuple[str, str]]:
    """Return the texts of legend keys that a curve crosses, with the label of this curve. A reader could take such a
    curve for the key.
    """
    figure.draw_without_rendering()
    found = []
    for axes in figure.findobj(Axes):
        legend = axes.get_legend()
        for key, text in zip(legend.legend_handles, legend.get_texts(), strict=True) if legend else ():
            box = text.get_window_extent()
            middle, x = 0.5 * (box.y0 + box.y1), key.get_window_extent()
            around = Bbox.from_extents(x.x0, middle - 0.25 * box.height, x.x1, middle + 0.25 * box.height)
            found += [(text.get_text(), label) for label in _crossing(around, axes)]
    return found


def unreadable(figure: Figure) -> list[object]:
    """Return the texts that are hard to read. Such texts are smaller than LEAST_SIZE, outside the figure, or on other
    texts or curves. Indices may be smaller by the factor SCRIPT.
    """
    found, edge = [], figure.bbox
    for text, box in texts_of(figure):
        words = text.get_text()
        script = SCRIPT if "$" in words and ("^" in words or "_" in words) else 1.0
        beyond = box.x0 < edge.x0 or box.y0 < edge.y0 or box.x1 > edge.x1 - 1 or box.y1 > edge.y1 - 1
        if beyond or text.get_fontsize() * script < LEAST_SIZE:
            found.append(words)
        inner = Bbox.from_extents(box.x0, box.y0 + 0.2 * box.height, box.x1, box.y1 - 0.2 * box.height)
        for axes in figure.findobj(Axes):
            if axes.bbox.contains(*box.get_points().mean(axis=0)):
                found += [(words, label) for label in _crossing(inner, axes)]
    return [*found, *texts_on_texts(figure)]


def unnamed_colours(figure: Figure) -> set[str]:
    """Return the colours that do not identify a curve. Panels with several curves use these colours, but the colours
    appear in no legend key or text.
    """
    panels = figure.findobj(Axes)
    legends = [legend for axes in panels if (legend := axes.get_legend())]
    named = [text for text in figure.findobj(Text) if text.get_text()]
    keys = [key for legend in legends for key in legend.legend_handles]
    known = {to_hex(artist.get_color()) for artist in (*named, *keys)}
    found: set[str] = set()
    for axes in panels:
        colours = {to_hex(line.get_color()) for line in axes.get_lines() if len(line.get_xdata()) > 2}
        found |= colours - known if len(colours) > 1 else set()
    return found


def _crossing(box: Bbox, axes: Axes) -> list[str]:
    """Return the labels of the curves whose visible part passes through `box`."""
    seen = Bbox.intersection(box, axes.bbox)
    lines = [line for line in axes.get_lines() if seen and line.get_linestyle() != "None" and line.get_visible()]
    paths = [line.get_transform().transform_path(line.get_path()) for line in lines]
    passes = [path.intersects_bbox(seen, filled=False) for path in paths]
    return [str(line.get_label()) for line, passing in zip(lines, passes, strict=True) if passing]
