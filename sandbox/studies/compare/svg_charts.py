"""Charts as inline SVG: curves against time or overlap, and bars of what contacts do; colours come from the page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.draw.number_format import power_of_ten, ticks

Array = NDArray[np.float64]
Span = tuple[float, float]

WIDTH, HEIGHT = 440.0, 230.0
LEFT, RIGHT, TOP, BOTTOM = 52.0, 20.0, 12.0, 38.0
MOST_POINTS = 500
LEAP = 0.01  # of the axis: a jump from one sample to the next that thinning must keep
LEAST_PLAIN, MOST_PLAIN = 1e-2, 1e4  # the largest number of an axis that shows numbers as they are
ROW = 24.0  # height of a bar and the space below it


@dataclass(frozen=True)
class Curve:
    """x and y (T,), its name, and the class that gives it its colour."""

    name: str
    x: Array
    y: Array
    tint: str


@dataclass(frozen=True)
class Axes:
    """The ends of both axes and what stands beside them; with a `clock` the film moves a cursor over the chart."""

    x: Span
    y: Span
    x_label: str
    y_label: str
    clock: bool = True

    def across(self, value: Array) -> Array:
        """Horizontal places of `value`."""
        return LEFT + (WIDTH - LEFT - RIGHT) * (value - self.x[0]) / (self.x[1] - self.x[0])

    def down(self, value: Array) -> Array:
        """Vertical places of `value`."""
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (value - self.y[0]) / (self.y[1] - self.y[0])


def span(values: Sequence[Array], zero: bool = True) -> Span:
    """From the least to the greatest of all `values`, with some room; 0 is inside where `zero`."""
    low, high = min(float(v.min()) for v in values), max(float(v.max()) for v in values)
    if zero:
        low, high = min(low, 0.0), max(high, 0.0)
    if low == high:
        return low - 1.0, high + 1.0
    room = 0.06 * (high - low)
    return (low - room if low < 0.0 else low), high + room


def chart(title: str, curves: Sequence[Curve], axes: Axes) -> str:
    """A figure with the curves, a grid, and a legend where there is more than one."""
    lines = [
        f'<path class="curve {curve.tint}" d="{_path(curve, axes)}"><title>{escape(curve.name)}</title></path>'
        for curve in reversed(curves)
    ]
    body = _grid(axes) + "".join(lines) + (_cursor(axes.x, HEIGHT - BOTTOM) if axes.clock else "")
    legend = _legend([(curve.name, curve.tint) for curve in curves]) if len(curves) > 1 else ""
    return _figure(title, body, HEIGHT, legend)


def bars(title: str, rows: Sequence[tuple[str, Sequence[tuple[str, float, float]]]], x: Span, x_label: str) -> str:
    """A figure with a row of stretches (class, from, to) for each name; below them the time axis."""
    height = TOP + ROW * len(rows) + BOTTOM
    axes = Axes(x, (0.0, 1.0), x_label, "")
    parts = []
    for k, (name, stretches) in enumerate(rows):
        top = TOP + ROW * k
        parts.append(f'<text x="{LEFT - 6:.1f}" y="{top + 14:.1f}" class="end">{escape(name)}</text>')
        for tint, begin, end in stretches:
            left, right = axes.across(np.array([begin, end]))
            parts.append(
                f'<rect class="{tint}" x="{left:.1f}" y="{top:.1f}" width="{max(right - left, 0.3):.1f}" '
                f'height="{ROW - 7:.0f}"><title>{escape(name)} {tint} {begin:.4g} to {end:.4g} s</title></rect>'
            )
    parts.append(_x_axis(axes, height))
    parts.append(_cursor(x, height - BOTTOM))
    return _figure(title, "".join(parts), height, _legend([(kind, kind) for kind in ("open", "touching", "loaded")]))


def _path(curve: Curve, axes: Axes) -> str:
    rows = _kept(curve.x, curve.y, axes)
    places = zip(axes.across(curve.x[rows]).tolist(), axes.down(curve.y[rows]).tolist(), strict=True)
    return "M" + "L".join(f"{x:.1f},{y:.1f}" for x, y in places)


def _kept(x: Array, y: Array, axes: Axes) -> NDArray[np.int_]:
    """Rows inside the axes that draw the same curve: some evenly in x, and both ends of every leap."""
    inside = np.flatnonzero((x >= axes.x[0]) & (x <= axes.x[1]))
    if not inside.size:
        return inside
    wanted = np.linspace(x[inside[0]], x[inside[-1]], MOST_POINTS)
    even = np.searchsorted(x[inside], wanted)
    leaps = np.flatnonzero(np.abs(np.diff(y[inside])) > LEAP * (axes.y[1] - axes.y[0]))
    picked = np.concatenate((even, leaps, leaps + 1, [0, inside.size - 1]))
    kept: NDArray[np.int_] = inside[np.unique(np.clip(picked, 0, inside.size - 1))]
    return kept


def _grid(axes: Axes) -> str:
    parts = []
    largest = max(abs(end) for end in axes.y)
    power = math.floor(math.log10(largest)) if not LEAST_PLAIN < largest < MOST_PLAIN else 0
    for shown, text in ticks(axes.y[0] / 10.0**power, axes.y[1] / 10.0**power, 5):
        value = shown * 10.0**power
        y = float(axes.down(np.array(value)))
        tint = "zero" if value == 0.0 else "grid"
        parts.append(f'<path class="{tint}" d="M{LEFT:.1f},{y:.1f}H{WIDTH - RIGHT:.1f}"/>')
        parts.append(f'<text x="{LEFT - 6:.1f}" y="{y + 4:.1f}" class="end">{text}</text>')
    middle = (TOP + HEIGHT - BOTTOM) / 2
    place = f'x="13" y="{middle:.1f}" transform="rotate(-90 13 {middle:.1f})"'
    label = axes.y_label + (f" · {power_of_ten(-power)}" if power else "")
    return "".join(parts) + f'<text {place} class="middle">{escape(label)}</text>' + _x_axis(axes, HEIGHT)


def _x_axis(axes: Axes, height: float) -> str:
    foot = height - BOTTOM
    parts = [f'<path class="zero" d="M{LEFT:.1f},{foot:.1f}H{WIDTH - RIGHT:.1f}"/>']
    for value, text in ticks(*axes.x, 5):
        x = float(axes.across(np.array(value)))
        parts.append(f'<path class="zero" d="M{x:.1f},{foot:.1f}v4"/>')
        parts.append(f'<text x="{x:.1f}" y="{foot + 17:.1f}" class="middle">{text}</text>')
    middle = (LEFT + WIDTH - RIGHT) / 2
    return "".join(parts) + f'<text x="{middle:.1f}" y="{height - 5:.1f}" class="middle">{escape(axes.x_label)}</text>'


def _cursor(x: Span, foot: float) -> str:
    ends = f'data-low="{x[0]:.9g}" data-high="{x[1]:.9g}" data-left="{LEFT}" data-right="{WIDTH - RIGHT}"'
    return f'<path class="cursor" {ends} d="M0,{TOP:.1f}V{foot:.1f}" visibility="hidden"/>'


def _legend(entries: Sequence[tuple[str, str]]) -> str:
    items = "".join(f'<span><i class="{tint}"></i>{escape(name)}</span>' for name, tint in entries)
    return f'<div class="legend">{items}</div>'


def _figure(title: str, body: str, height: float, legend: str) -> str:
    name = escape(title)
    return (
        f"<figure><figcaption>{name}</figcaption>"
        f'<svg viewBox="0 0 {WIDTH:.0f} {height:.0f}" role="img" aria-label="{name}">{body}</svg>{legend}</figure>'
    )
