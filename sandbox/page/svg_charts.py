"""Charts as inline SVG. Line charts show curves over time or overlap, and bar charts show the states of contacts. The
style of the page defines the colours.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.story.numbers import power_of_ten, ticks

Array = NDArray[np.float64]
Range = tuple[float, float]

WIDTH = 440.0  # Width of a chart in the units of the SVG view box.
HEIGHT = 230.0
LEFT = 52.0  # Left margin. The next three constants are the other margins around the axes.
RIGHT = 20.0
TOP = 12.0
BOTTOM = 38.0
BAR_PITCH = 24.0  # Height of a bar, including the space below it.
BAR_SPACE = 7.0  # Height of the space below a bar.
MOST_POINTS = 500  # Largest number of points of a curve, not counting the ends of jumps.
# Smallest change between two samples that counts as a jump, as a fraction of the axis. Both samples are drawn.
JUMP = 0.01
PLAIN_NUMBERS = (1e-2, 1e4)  # If the largest number of an axis is in this range, the axis lacks a power of ten.


@dataclass(frozen=True)
class Curve:
    """Curve of a chart. A curve has a name, coordinates x and y (T,), and a CSS class that defines its colour."""

    name: str
    x: Array
    y: Array
    css_class: str


@dataclass(frozen=True)
class ChartAxes:
    """Ranges and labels of the two axes of a chart."""

    x: Range
    y: Range
    x_label: str
    y_label: str

    def across(self, value: Array) -> Array:
        """Return the horizontal positions of `value` in the chart."""
        return LEFT + (WIDTH - LEFT - RIGHT) * (value - self.x[0]) / (self.x[1] - self.x[0])

    def down(self, value: Array) -> Array:
        """Return the vertical positions of `value` in the chart."""
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (value - self.y[0]) / (self.y[1] - self.y[0])


def line_chart(title: str, curves: Sequence[Curve], axes: ChartAxes) -> str:
    """Return a figure with the curves and a grid. If there are several curves, the figure has a legend."""
    lines = [
        f'<path class="curve {curve.css_class}" d="{_path(curve, axes)}"><title>{escape(curve.name)}</title></path>'
        for curve in reversed(curves)
    ]
    legend = _legend([(curve.name, curve.css_class) for curve in curves]) if len(curves) > 1 else ""
    return _figure(title, _grid(axes) + "".join(lines), HEIGHT, legend)


def bar_chart(
    title: str, rows: Sequence[tuple[str, Sequence[tuple[str, float, float]]]], axes: ChartAxes, unit: str
) -> str:
    """Return a figure with one line of bars for each name. The lines are above a time axis.

    A bar is an interval (state, begin, end). The times of a bar are in the unit `unit`. `axes.y` is not used.
    """
    height = TOP + BAR_PITCH * len(rows) + BOTTOM
    parts = []
    for k, (name, intervals) in enumerate(rows):
        top = TOP + BAR_PITCH * k
        parts.append(f'<text x="{LEFT - 6:.1f}" y="{top + 14:.1f}" class="end">{escape(name)}</text>')
        for state, begin, end in intervals:
            left, right = axes.across(np.array([begin, end]))
            hint = f"{escape(name)} {state} {begin:.4g} to {end:.4g} {unit}"
            parts.append(
                f'<rect class="{state}" x="{left:.1f}" y="{top:.1f}" width="{max(right - left, 0.3):.1f}" '
                f'height="{BAR_PITCH - BAR_SPACE:.0f}"><title>{hint}</title></rect>'
            )
    parts.append(_x_axis(axes, height))
    legend = _legend([(state, state) for state in ("open", "touching", "loaded")])
    return _figure(title, "".join(parts), height, legend)


def _path(curve: Curve, axes: ChartAxes) -> str:
    rows = _thinned(curve.x, curve.y, axes)
    points = zip(axes.across(curve.x[rows]).tolist(), axes.down(curve.y[rows]).tolist(), strict=True)
    return "M" + "L".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _thinned(x: Array, y: Array, axes: ChartAxes) -> NDArray[np.int_]:
    """Return the indices of fewer points that draw the same curve inside the axes.

    The chosen points are MOST_POINTS points that are evenly spaced in x, and the two ends of every jump.
    """
    inside = np.flatnonzero((x >= axes.x[0]) & (x <= axes.x[1]))
    if not inside.size:
        return inside
    wanted = np.linspace(x[inside[0]], x[inside[-1]], MOST_POINTS)
    even = np.searchsorted(x[inside], wanted)
    jumps = np.flatnonzero(np.abs(np.diff(y[inside])) > JUMP * (axes.y[1] - axes.y[0]))
    picked = np.concatenate((even, jumps, jumps + 1, [0, inside.size - 1]))
    rows: NDArray[np.int_] = inside[np.unique(np.clip(picked, 0, inside.size - 1))]
    return rows


def _grid(axes: ChartAxes) -> str:
    marks, power = _value_ticks(axes)
    parts = []
    for value, text in marks:
        y = float(axes.down(np.array(value)))
        line = "zero" if value == 0.0 else "grid"
        parts.append(f'<path class="{line}" d="M{LEFT:.1f},{y:.1f}H{WIDTH - RIGHT:.1f}"/>')
        parts.append(f'<text x="{LEFT - 6:.1f}" y="{y + 4:.1f}" class="end">{text}</text>')
    middle = (TOP + HEIGHT - BOTTOM) / 2
    place = f'x="13" y="{middle:.1f}" transform="rotate(-90 13 {middle:.1f})"'
    label = " · ".join(text for text in (axes.y_label, power_of_ten(-power) if power else "") if text)
    if label:
        parts.append(f'<text {place} class="middle">{escape(label)}</text>')
    return "".join(parts) + _x_axis(axes, HEIGHT)


def _value_ticks(axes: ChartAxes) -> tuple[list[tuple[float, str]], int]:
    """Return the positions and labels of the ticks of the vertical axis. Also return the power of ten by which the
    labels must be multiplied.
    """
    largest = max(abs(end) for end in axes.y)
    power = 0 if PLAIN_NUMBERS[0] < largest < PLAIN_NUMBERS[1] else math.floor(math.log10(largest))
    marks = ticks(axes.y[0] / 10.0**power, axes.y[1] / 10.0**power, 5)
    return [(value * 10.0**power, text) for value, text in marks], power


def _x_axis(axes: ChartAxes, height: float) -> str:
    foot = height - BOTTOM
    parts = [f'<path class="zero" d="M{LEFT:.1f},{foot:.1f}H{WIDTH - RIGHT:.1f}"/>']
    for value, text in ticks(*axes.x, 5):
        x = float(axes.across(np.array(value)))
        parts.append(f'<path class="zero" d="M{x:.1f},{foot:.1f}v4"/>')
        parts.append(f'<text x="{x:.1f}" y="{foot + 17:.1f}" class="middle">{text}</text>')
    middle = (LEFT + WIDTH - RIGHT) / 2
    return "".join(parts) + f'<text x="{middle:.1f}" y="{height - 5:.1f}" class="middle">{escape(axes.x_label)}</text>'


def _legend(entries: Sequence[tuple[str, str]]) -> str:
    items = "".join(f'<span><i class="{css_class}"></i>{escape(name)}</span>' for name, css_class in entries)
    return f'<div class="legend">{items}</div>'


def _figure(title: str, body: str, height: float, legend: str) -> str:
    name = escape(title)
    return (
        f"<figure><figcaption>{name}</figcaption>"
        f'<svg viewBox="0 0 {WIDTH:.0f} {height:.0f}" role="img" aria-label="{name}">{body}</svg>{legend}</figure>'
    )


def chart_row(charts: list[str]) -> str:
    """Return charts side by side. If the page is too narrow, the charts are below each other."""
    return f'<div class="charts">{"".join(charts)}</div>'
