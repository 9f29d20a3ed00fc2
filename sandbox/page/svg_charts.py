"""Charts as inline SVG: curves against time or overlap, and bars of contact states; the page gives the colours.

Curves of a motion are empty here: the page's script draws them from the packed motion, and moves a line to the time shown.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.draw.number_format import decades, power_of_ten, ticks

Array = NDArray[np.float64]
Range = tuple[float, float]

WIDTH = 440.0  # of a chart, in the units of its view box
HEIGHT = 230.0
LEFT = 52.0  # margins around the axes
RIGHT = 20.0
TOP = 12.0
BOTTOM = 38.0
BAR_PITCH = 24.0  # height of a bar and the space below it
BAR_SPACE = 7.0  # the space below a bar
MOST_POINTS = 500  # of a drawn curve, jumps not counted
JUMP = 0.01  # of the axis: a larger change from one sample to the next is drawn at its own samples
MARKERS = 5  # shapes of the marks on the curves of a motion
MOST_NAMES = 10  # a longer legend would not be read
PLAIN_NUMBERS = (1e-2, 1e4)  # an axis whose largest number lies between these shows no power of ten


@dataclass(frozen=True)
class Curve:
    """A curve: its name, x and y (T,), and the CSS class that gives its colour."""

    name: str
    x: Array
    y: Array
    css_class: str


@dataclass(frozen=True)
class MotionCurves:
    """Curves that the page's script draws: which lane, what of it ("velocity", "force" or "overlap"), and their names.

    Attributes:
        first: number of the bead that gives the first curve its colour.
    """

    lane: int
    channel: str
    names: Sequence[str]
    first: int


@dataclass(frozen=True)
class Axes:
    """Ranges and labels of both axes.

    Attributes:
        unit: [s] of a time axis, in which a line shows the time of the player; 0 for an axis of something else.
        y_unit: of the vertical axis, in SI units.
        logarithmic: whether `y` are exponents of ten.
    """

    x: Range
    y: Range
    x_label: str
    y_label: str
    unit: float = 0.0
    y_unit: float = 1.0
    logarithmic: bool = False

    def across(self, value: Array) -> Array:
        """Horizontal positions of `value`."""
        return LEFT + (WIDTH - LEFT - RIGHT) * (value - self.x[0]) / (self.x[1] - self.x[0])

    def down(self, value: Array) -> Array:
        """Vertical positions of `value`."""
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (value - self.y[0]) / (self.y[1] - self.y[0])


def axis_range(values: Sequence[Array]) -> Range:
    """The range of all `values` and of 0, and some room beyond the values."""
    low, high = min(0.0, *(float(v.min()) for v in values)), max(0.0, *(float(v.max()) for v in values))
    if low == high:
        return low - 1.0, high + 1.0
    room = 0.06 * (high - low)
    return (low - room if low < 0.0 else low), high + room


def line_chart(title: str, curves: Sequence[Curve], axes: Axes) -> str:
    """A figure with the curves, a grid, and a legend where there is more than one."""
    lines = [
        f'<path class="curve {curve.css_class}" d="{_path(curve, axes)}"><title>{escape(curve.name)}</title></path>'
        for curve in reversed(curves)
    ]
    legend = _legend([(curve.name, curve.css_class) for curve in curves]) if len(curves) > 1 else ""
    return _figure(title, _grid(axes) + "".join(lines), HEIGHT, legend, axes)


def motion_chart(title: str, curves: MotionCurves, axes: Axes) -> str:
    """A figure with a grid, in which the page's script draws the curves, and a legend where it is short enough to be read.

    The `title` says what its vertical axis shows.
    """
    data = f'data-lane="{curves.lane}" data-channel="{curves.channel}" data-first="{curves.first}"'
    body = _grid(replace(axes, y_label="")) + f'<g class="motion" {data} data-count="{len(curves.names)}"></g>'
    marks = [f"c{k + curves.first} m{k % MARKERS}" for k in range(len(curves.names))]
    few = len(curves.names) <= MOST_NAMES
    return _figure(title, body, HEIGHT, _legend(list(zip(curves.names, marks, strict=True))) if few else "", axes)


def bar_chart(title: str, rows: Sequence[tuple[str, Sequence[tuple[str, float, float]]]], axes: Axes) -> str:
    """A figure with a bar of intervals (state, begin, end) for each name, above a time axis; `axes.y` has no meaning."""
    height = TOP + BAR_PITCH * len(rows) + BOTTOM
    parts = []
    for k, (name, intervals) in enumerate(rows):
        top = TOP + BAR_PITCH * k
        parts.append(f'<text x="{LEFT - 6:.1f}" y="{top + 14:.1f}" class="end">{escape(name)}</text>')
        for state, begin, end in intervals:
            left, right = axes.across(np.array([begin, end]))
            parts.append(
                f'<rect class="{state}" x="{left:.1f}" y="{top:.1f}" width="{max(right - left, 0.3):.1f}" '
                f'height="{BAR_PITCH - BAR_SPACE:.0f}"><title>{escape(name)} {state} {begin:.4g} to {end:.4g} s</title></rect>'
            )
    parts.append(_x_axis(axes, height))
    legend = _legend([(state, state) for state in ("open", "touching", "loaded")])
    return _figure(title, "".join(parts), height, legend, axes)


def _path(curve: Curve, axes: Axes) -> str:
    rows = _thinned(curve.x, curve.y, axes)
    points = zip(axes.across(curve.x[rows]).tolist(), axes.down(curve.y[rows]).tolist(), strict=True)
    return "M" + "L".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _thinned(x: Array, y: Array, axes: Axes) -> NDArray[np.int_]:
    """Rows inside the axes that draw the same curve: MOST_POINTS evenly in x, and both ends of every jump."""
    inside = np.flatnonzero((x >= axes.x[0]) & (x <= axes.x[1]))
    if not inside.size:
        return inside
    wanted = np.linspace(x[inside[0]], x[inside[-1]], MOST_POINTS)
    even = np.searchsorted(x[inside], wanted)
    jumps = np.flatnonzero(np.abs(np.diff(y[inside])) > JUMP * (axes.y[1] - axes.y[0]))
    picked = np.concatenate((even, jumps, jumps + 1, [0, inside.size - 1]))
    rows: NDArray[np.int_] = inside[np.unique(np.clip(picked, 0, inside.size - 1))]
    return rows


def _grid(axes: Axes) -> str:
    marks, power = _value_ticks(axes)
    parts = []
    for value, text in marks:
        y = float(axes.down(np.array(value)))
        line = "zero" if value == 0.0 and not axes.logarithmic else "grid"
        parts.append(f'<path class="{line}" d="M{LEFT:.1f},{y:.1f}H{WIDTH - RIGHT:.1f}"/>')
        parts.append(f'<text x="{LEFT - 6:.1f}" y="{y + 4:.1f}" class="end">{text}</text>')
    middle = (TOP + HEIGHT - BOTTOM) / 2
    place = f'x="13" y="{middle:.1f}" transform="rotate(-90 13 {middle:.1f})"'
    label = " · ".join(text for text in (axes.y_label, power_of_ten(-power) if power else "") if text)
    if label:
        parts.append(f'<text {place} class="middle">{escape(label)}</text>')
    return "".join(parts) + _x_axis(axes, HEIGHT)


def _value_ticks(axes: Axes) -> tuple[list[tuple[float, str]], int]:
    """Places and labels of the vertical axis, and the power of ten by which its labels are too small."""
    if axes.logarithmic:
        return decades(round(axes.y[0]), round(axes.y[1]), 5), 0
    largest = max(abs(end) for end in axes.y)
    power = 0 if PLAIN_NUMBERS[0] < largest < PLAIN_NUMBERS[1] else math.floor(math.log10(largest))
    marks = ticks(axes.y[0] / 10.0**power, axes.y[1] / 10.0**power, 5)
    return [(value * 10.0**power, text) for value, text in marks], power


def _x_axis(axes: Axes, height: float) -> str:
    foot = height - BOTTOM
    parts = [f'<path class="zero" d="M{LEFT:.1f},{foot:.1f}H{WIDTH - RIGHT:.1f}"/>']
    for value, text in ticks(*axes.x, 5):
        x = float(axes.across(np.array(value)))
        parts.append(f'<path class="zero" d="M{x:.1f},{foot:.1f}v4"/>')
        parts.append(f'<text x="{x:.1f}" y="{foot + 17:.1f}" class="middle">{text}</text>')
    middle = (LEFT + WIDTH - RIGHT) / 2
    return "".join(parts) + f'<text x="{middle:.1f}" y="{height - 5:.1f}" class="middle">{escape(axes.x_label)}</text>'


def _cursor(axes: Axes, foot: float) -> str:
    """The line at the time of the player, and the veil over what lies ahead of it."""
    if not axes.unit:
        return ""
    veil = f'<rect class="veil" y="{TOP:.1f}" width="{WIDTH - RIGHT - LEFT:.1f}" height="{foot - TOP:.1f}" visibility="hidden"/>'
    return veil + f'<path class="cursor" d="M0,{TOP:.1f}V{foot:.1f}" visibility="hidden"/>'


def _legend(entries: Sequence[tuple[str, str]]) -> str:
    items = "".join(f'<span><i class="{css_class}"></i>{escape(name)}</span>' for name, css_class in entries)
    return f'<div class="legend">{items}</div>'


def _figure(title: str, body: str, height: float, legend: str, axes: Axes) -> str:
    name, foot = escape(title), height - BOTTOM
    low, high = (axes.y_unit * end for end in axes.y)
    area = f'data-area="{LEFT} {TOP} {WIDTH - RIGHT} {foot}" data-value="{low:.9g} {high:.9g}"'
    time = f' data-time="{axes.x[0] * axes.unit:.9g} {axes.x[1] * axes.unit:.9g}"' if axes.unit else ""
    data = area + time + (" data-logarithmic" if axes.logarithmic else "")
    return (
        f"<figure><figcaption>{name}</figcaption>"
        f'<svg viewBox="0 0 {WIDTH:.0f} {height:.0f}" role="img" aria-label="{name}" {data}>{body}{_cursor(axes, foot)}</svg>'
        f"{legend}</figure>"
    )
