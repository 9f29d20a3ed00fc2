"""What the points of the chart say: frontiers, orders, ratios, and the file of all points."""

from __future__ import annotations

import csv
import math

import pytest
from softcradle.physics import one_on, power_law
from softcradle.sandbox.studies.precision.cases import CaseDefinition
from softcradle.sandbox.studies.precision.measurement import TimeLimits, measure_series
from softcradle.sandbox.studies.precision.table import (
    MeasuredCase,
    auto_sentence,
    curve_rows,
    fastest,
    fitted_order,
    frontier,
    ratio,
    ratio_sentence,
    write_csv,
)

from tests.helpers.series import made_series, our_solver


def test_a_small_error_by_chance_does_not_count():
    series = made_series("x", True, (1e-7, 1e-3), (1e-2, 2e-3), (1e-6, 3e-3), (1e-8, 4e-3))
    assert fastest([series], 1e-6) is series.points[2]
    assert fastest([series], 1e-9) is None


def test_the_frontier_has_the_points_that_no_other_beats():
    first, second = (
        made_series("x", True, (1e-1, 1.0), (1e-3, 4.0)),
        made_series("x", True, (1e-2, 2.0), (1e-2, 3.0), (1e-5, 9.0)),
    )
    assert [point.error for point in frontier([first, second])] == [1e-1, 1e-2, 1e-3, 1e-5]
    assert [point.error for point in frontier([first], "evaluations")] == [1e-1, 1e-3]


@pytest.mark.parametrize("alpha", [0.1, 0.5])
def test_orders_at_an_impact_are_those_of_the_onset(alpha):
    case = CaseDefinition("impact", "impact", lambda: one_on(1, power_law(1.0, alpha))).solve()
    found = measure_series(case, our_solver(case, "verlet"), limits=TimeLimits(0.05, 1.0))
    assert fitted_order(found, max(case.uncertainty, 1e-12)) == pytest.approx(1.0 + alpha, abs=0.25)


def test_an_order_needs_three_points_that_count():
    assert fitted_order(made_series("x", True, (1e-2, 1.0), (1e-3, 1.0)), 1e-14) is None
    assert fitted_order(made_series("x", True, (1e-2, 1.0), (1e-4, 1.0), (1e-6, 1.0)), 1e-14) == pytest.approx(2.0)
    assert fitted_order(made_series("x", True, (1e-2, 1.0), (1e-4, 1.0), (1e-6, 1.0)), 1e-6) is None


def test_ratios_are_of_the_fastest_on_each_side():
    fine = (1e-12, 5e-3)
    found = MeasuredCase(
        None, [made_series("a", True, (1e-4, 2e-3), fine), made_series("b", False, (1e-4, 4e-3), fine)]
    )
    assert ratio(curve_rows(found), 0) == pytest.approx(2.0)
    assert ratio(curve_rows(found), 1) == pytest.approx(1.0)
    assert "b / a = 2" in ratio_sentence(curve_rows(found))
    assert ratio(curve_rows(MeasuredCase(None, found.series[:1])), 0) == math.inf
    assert ratio(curve_rows(MeasuredCase(None, found.series[1:])), 0) is None


def test_a_sentence_compares_auto_with_the_fastest():
    fine = (1e-12, 9e-3)
    found = [made_series("a", True, (1e-4, 2e-3), fine), made_series("auto", True, (1e-4, 3e-3), fine)]
    assert "0.001: 1.5" in auto_sentence(curve_rows(MeasuredCase(None, found)))
    assert auto_sentence(curve_rows(MeasuredCase(None, found[:1]))) == ""


def test_csv_has_every_point(tmp_path, case):
    series = [made_series("a", True, (1e-4, 2e-3), (math.inf, 1e-3))]
    write_csv([MeasuredCase(case, series)], tmp_path / "x.csv")
    with (tmp_path / "x.csv").open() as file:
        first, second = list(csv.DictReader(file))
    assert float(first["error of velocities"]) == 1e-4
    assert float(first["seconds"]) == 2e-3
    assert second["error of velocities"] == ""
