"""The picture of the chart, and the command that makes it."""

import csv
import math
import re

import numpy as np
import pytest
from softcradle.physics import METHODS
from softcradle.physics.version import version
from softcradle.sandbox.studies.plot_style import styled
from softcradle.sandbox.studies.precision import measurement, table
from softcradle.sandbox.studies.precision.chart import draw_chart
from softcradle.sandbox.studies.precision.measurement import machine_stamp
from softcradle.sandbox.studies.precision.table import MeasuredCase, curve_rows, fastest, fitted_order, ratio

from tests.helpers.series import SHORT_LIMITS, made_series


def boxes_of(artists):
    return [artist.get_window_extent() for artist in artists]


def test_labels_of_a_chart_do_not_overlap(case):
    fine = [(1e-5 if k % 2 else 1e-7, 2e-3) for k in range(20)]
    series = [made_series(f"method {k}", k < 9, (1e-2, 1e-4), (1e-5, 1e-3), last) for k, last in enumerate(fine)]
    with styled():
        picture = draw_chart([MeasuredCase(case, series)])
        picture.canvas.draw()
        boxes = boxes_of(text for axes in picture.axes for text in axes.texts if text.get_gid() == "label")
    assert [box.count_overlaps(boxes) for box in boxes] == [1] * 40  # with itself
    assert max(box.x1 for box in boxes) < picture.bbox.x1


def test_a_chart_says_where_it_was_measured(case):
    stamp = machine_stamp(["no such package"])
    assert f"softcradle {version()}" in stamp
    assert f"numpy {np.__version__}" in stamp
    assert re.search(r"\d+ cores?; \w+, Python 3", stamp)
    with styled():
        picture = draw_chart([MeasuredCase(case, [made_series("ours", True, (1e-2, 1e-4), (1e-5, 1e-3))])], stamp)
        picture.canvas.draw()
        (shown,) = [text for text in picture.texts if text.get_gid() == "stamp"]
        (box,) = boxes_of([shown])
        others = boxes_of(text for axes in picture.axes for text in (*axes.texts, axes.xaxis.label))
    assert shown.get_text() == stamp
    assert box.count_overlaps(others) == 0
    assert box.y0 >= 0.0


def test_methods_differ_without_colour(case):
    series = [made_series(f"method {k}", k < 9, (1e-2, 1e-4), (1e-5, 1e-3)) for k in range(24)]
    with styled():
        axes = draw_chart([MeasuredCase(case, series)]).axes[0]
    curves = [line for line in axes.lines if line.get_marker() != "." and line.get_linestyle() != "None"]
    styles = {(line.get_marker(), line.get_linestyle(), line.get_markerfacecolor() == "white") for line in curves}
    assert len(styles) == 24


def test_the_command_draws_a_scene_of_your_own_and_lists_the_cases(tmp_path, definitions, monkeypatch, softcradle):
    monkeypatch.setattr(measurement.measure_case, "__defaults__", ("velocities", SHORT_LIMITS, lambda _: None))
    picture = tmp_path / "chart.png"
    printed = softcradle("chart", "one-on-four", "--ours", "--csv", "-o", str(picture)).out
    assert picture.stat().st_size > 10_000
    rows = (tmp_path / "chart.csv").read_text().splitlines()[1:]
    assert {row.split(",")[1] for row in rows} == {"auto", *(method.name for method in METHODS)}
    assert "accurate" in printed
    softcradle("chart", "step-force", "--ours", "--error", "forces", "-o", str(tmp_path / "two.svg"))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["chart.csv", "chart.png", "two.svg"]
    printed = softcradle("chart", "--list").out
    assert all(name in printed for name in definitions)


def test_a_small_error_by_chance_does_not_count_and_the_frontier_has_what_no_other_point_beats():
    series = made_series("x", True, (1e-7, 1e-3), (1e-2, 2e-3), (1e-6, 3e-3), (1e-8, 4e-3))
    assert fastest([series], 1e-6) is series.points[2]
    assert fastest([series], 1e-9) is None
    first = made_series("x", True, (1e-1, 1.0), (1e-3, 4.0))
    second = made_series("x", True, (1e-2, 2.0), (1e-2, 3.0), (1e-5, 9.0))
    assert [point.error for point in table.frontier([first, second])] == [1e-1, 1e-2, 1e-3, 1e-5]
    assert [point.error for point in table.frontier([first], "evaluations")] == [1e-1, 1e-3]


def test_an_order_needs_three_points_that_count():
    series = made_series("x", True, (1e-2, 1.0), (1e-4, 1.0), (1e-6, 1.0))
    assert fitted_order(made_series("x", True, (1e-2, 1.0), (1e-3, 1.0)), 1e-14) is None
    assert fitted_order(series, 1e-14) == pytest.approx(2.0)
    assert fitted_order(series, 1e-6) is None


def test_ratios_are_of_the_fastest_on_each_side():
    fine = (1e-12, 5e-3)
    pair = [made_series("a", True, (1e-4, 2e-3), fine), made_series("b", False, (1e-4, 4e-3), fine)]
    found = MeasuredCase(None, pair)
    assert ratio(curve_rows(found), 0) == pytest.approx(2.0)
    assert ratio(curve_rows(found), 1) == pytest.approx(1.0)
    assert "b / a = 2" in table.ratio_sentence(curve_rows(found))
    assert ratio(curve_rows(MeasuredCase(None, found.series[:1])), 0) == math.inf
    assert ratio(curve_rows(MeasuredCase(None, found.series[1:])), 0) is None
    auto = [made_series("a", True, (1e-4, 2e-3), fine), made_series("auto", True, (1e-4, 3e-3), fine)]
    assert "0.001: 1.5" in table.auto_sentence(curve_rows(MeasuredCase(None, auto)))
    assert table.auto_sentence(curve_rows(MeasuredCase(None, auto[:1]))) == ""


def test_csv_has_every_point(tmp_path, case):
    series = [made_series("a", True, (1e-4, 2e-3), (math.inf, 1e-3))]
    table.write_csv([MeasuredCase(case, series)], tmp_path / "x.csv")
    first, second = csv.DictReader((tmp_path / "x.csv").read_text().splitlines())
    assert (float(first["error of velocities"]), float(first["seconds"])) == (1e-4, 2e-3)
    assert second["error of velocities"] == ""
