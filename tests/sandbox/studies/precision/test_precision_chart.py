"""The picture of the chart, and the command that makes it."""

from __future__ import annotations

import re

import numpy as np
import pytest
from softcradle.physics import METHODS
from softcradle.physics.version import version
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.machine_stamp import machine_stamp
from softcradle.sandbox.studies.plot_style import styled
from softcradle.sandbox.studies.precision import measurement
from softcradle.sandbox.studies.precision.chart import draw_chart
from softcradle.sandbox.studies.precision.table import MeasuredCase

from tests.helpers.series import SHORT_LIMITS, made_series


def overlapping_boxes(boxes):
    """Pairs of boxes (left, bottom, right, top) that overlap."""
    return [
        (i, j)
        for i, a in enumerate(boxes)
        for j, b in enumerate(boxes[:i])
        if a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
    ]


def test_labels_of_a_chart_do_not_overlap(case):
    series = [
        made_series(f"method {k}", k < 9, (1e-2, 1e-4), (1e-5, 1e-3), (1e-5 if k % 2 else 1e-7, 2e-3))
        for k in range(20)
    ]
    with styled():
        picture = draw_chart([MeasuredCase(case, series)])
        picture.canvas.draw()
        boxes = [
            text.get_window_extent().extents
            for axes in picture.axes
            for text in axes.texts
            if text.get_gid() == "label"
        ]
        inside = picture.bbox.extents
    assert len(boxes) == 40
    assert overlapping_boxes(boxes) == []
    assert max(box[2] for box in boxes) < inside[2]


def test_a_chart_says_where_it_was_measured(case):
    """Below the panels, on no other text."""
    stamp = machine_stamp(["no such package"])
    assert f"softcradle {version()}" in stamp
    assert f"numpy {np.__version__}" in stamp
    assert re.search(r"\d+ cores?; \w+, Python 3", stamp)
    with styled():
        picture = draw_chart([MeasuredCase(case, [made_series("ours", True, (1e-2, 1e-4), (1e-5, 1e-3))])], stamp)
        picture.canvas.draw()
        (shown,) = [text for text in picture.texts if text.get_gid() == "stamp"]
        boxes = [shown.get_window_extent().extents]
        boxes += [text.get_window_extent().extents for axes in picture.axes for text in axes.texts]
        boxes += [axes.xaxis.label.get_window_extent().extents for axes in picture.axes]
    assert shown.get_text() == stamp
    assert [pair for pair in overlapping_boxes(boxes) if 0 in pair] == []
    assert boxes[0][1] >= 0.0


def test_methods_differ_without_colour(case):
    series = [made_series(f"method {k}", k < 9, (1e-2, 1e-4), (1e-5, 1e-3)) for k in range(24)]
    with styled():
        axes = draw_chart([MeasuredCase(case, series)]).axes[0]
    styles = {
        (line.get_marker(), line.get_linestyle(), line.get_markerfacecolor() == "white")
        for line in axes.lines
        if line.get_marker() != "." and line.get_linestyle() != "None"
    }
    assert len(styles) == 24


def test_the_command_draws_a_scene_of_your_own(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(measurement.measure_case, "__defaults__", ("velocities", SHORT_LIMITS, lambda _: None))
    picture = tmp_path / "chart.png"
    assert main(["chart", "one-on-four", "--ours", "--csv", "-o", str(picture)]) == 0
    printed = capsys.readouterr().out
    assert picture.stat().st_size > 10_000
    assert {row.split(",")[1] for row in (tmp_path / "chart.csv").read_text().splitlines()[1:]} == {
        "auto",
        *(method.name for method in METHODS),
    }
    assert "accurate" in printed
    assert sorted(path.name for path in tmp_path.iterdir()) == ["chart.csv", "chart.png"]
    assert main(["chart", "step-force", "--ours", "--error", "forces", "-o", str(tmp_path / "two.svg")]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["chart.csv", "chart.png", "two.svg"]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["chart", "one-on-for"], "did you mean"),
        (["chart", "-o", "chart.txt"], "chart writes .png, .pdf, .svg"),
        (["chart", "--error", "nonsense"], "velocities"),
        (["chart", "-o", "/dev/null/x.png", "one-on-4"], "cannot write"),
    ],
)
def test_refusals_are_sentences(arguments, sentence, capsys):
    assert main(arguments) == 2
    assert sentence in capsys.readouterr().err


def test_the_list_of_cases(definitions, capsys):
    assert main(["chart", "--list"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in definitions)
