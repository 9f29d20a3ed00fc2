"""Charts as SVG."""

from __future__ import annotations

import re

import numpy as np
from softcradle.sandbox.page.svg_charts import ChartAxes, Curve, axis_range, line_chart


def test_thinned_curves_keep_their_jumps():
    x = np.linspace(0.0, 1.0, 20_001)
    y = np.where(x < 0.50003, 0.0, 1.0)
    axes = ChartAxes((0.0, 1.0), axis_range([y]), "x", "y")
    drawn = re.search(r'd="M([^"]+)"><title>one', line_chart("t", [Curve("one", x, y, "c0")], axes))[1]
    points = np.array([[float(v) for v in pair.split(",")] for pair in drawn.split("L")])
    assert len(points) < 600
    jump = np.flatnonzero(np.abs(np.diff(points[:, 1])) > 50.0)
    assert len(jump) == 1
    assert points[jump[0] + 1, 0] - points[jump[0], 0] < 0.2
