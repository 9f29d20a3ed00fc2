"""The chart of speed against accuracy: cases, solvers, peers, and what is said of them."""

from __future__ import annotations

import csv
import json
import math
import os
from importlib.util import find_spec

import numpy as np
import pytest
import softcradle.sandbox.studies.precision.work_precision as measuring
from softcradle.physics import METHODS, Chain, hertz, one_on, power_law, simulate
from softcradle.physics.analysis.closed_forms import critical_speed
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.figures.figure_style import styled
from softcradle.sandbox.studies.precision import peers
from softcradle.sandbox.studies.precision.chart_cases import FINE, RECIPES, Recipe, recipes_of
from softcradle.sandbox.studies.precision.curve_labels import apart, overlapping
from softcradle.sandbox.studies.precision.precision_chart import draw
from softcradle.sandbox.studies.precision.precision_table import (
    Measured,
    auto_sentence,
    ratio,
    ratio_sentence,
    rows,
    write_csv,
)
from softcradle.sandbox.studies.precision.solvers import NO_MOMENTS, PHASES, Answer, Solver, ours
from softcradle.sandbox.studies.precision.work_precision import (
    Patience,
    Point,
    Series,
    error_of,
    fastest,
    fitted_order,
    frontier,
    measure,
    scan,
)
from softcradle.scenes import load

from tests.helpers.truth import ELASTIC

BY_NAME = {recipe.name: recipe for recipe in RECIPES}
SHORT = Patience(point=0.05, series=0.05, case=2.0)


@pytest.fixture(scope="module")
def case():
    return BY_NAME["one-on-4"].cook()


def ours_named(case, name):
    return next(solver for solver in ours(case) if solver.name == name)


def with_finenesses(solver, *finenesses):
    return Solver(solver.name, solver.setting, finenesses, solver.run, solver.ours, solver.steps)


def made(name, mine, *errors_and_times):
    solver = Solver(name, "", [1.0] * len(errors_and_times), lambda *_: Answer(None, 0.0), mine)
    points = [Point(solver, 10.0**-k, *both, evaluations=k) for k, both in enumerate(errors_and_times)]
    return Series(solver, points)


def test_every_case_of_the_issue_is_there():
    assert list(BY_NAME) == ["one-on-4", "one-on-5", "one-on-10", "hertz-100", "gear-below", "gear-above", "step-force"]
    for recipe in RECIPES:
        assert set(recipe.build().mass) == {1.0}


@pytest.mark.parametrize(("name", "speed"), [("gear-below", 0.8), ("gear-above", 3.0)])
def test_the_gears_meet_below_and_above_their_critical_speed(name, speed):
    chain = BY_NAME[name].build()
    assert critical_speed(chain.contact[0], chain.mass, 1) == pytest.approx(1.0 / speed, rel=1e-14)


def test_a_case_knows_its_truth(case):
    assert case.doubt == 0.0
    assert case.error(case.truth) == 0.0
    assert case.error(case.truth + np.array([0, 0, 1e-3, 0, 0])) == pytest.approx(1e-3)
    assert case.error(np.full(5, np.nan)) == np.inf


def test_the_digits_that_a_user_has_are_those_in_quadruple_precision(case):
    truth = next(truth for truth in ELASTIC if truth.name == "one on 4, alpha 1/10")
    assert (case.truth == truth.final).all()


@pytest.mark.parametrize("name", ["one-on-5", "one-on-10", "hertz-100", "gear-above"])
def test_two_ways_to_a_truth_that_is_not_known_agree(name):
    cooked = BY_NAME[name].cook()
    assert 0.0 < cooked.doubt < 1e-10
    assert f"radau at {FINE:g}" in cooked.origin


@pytest.mark.parametrize("name", ["gear-below", "step-force"])
def test_closed_forms_are_what_radau_finds(name):
    cooked = BY_NAME[name].cook()
    found = simulate(cooked.chain, cooked.velocity, method="radau", tolerance=1e-11)
    assert cooked.error(found.final_velocity) < 1e-9
    assert "exact" in cooked.origin


def test_a_start_from_afar_ends_the_same(case):
    starts = case.starts([0.0, 0.01, 0.3])
    assert [start.early for start in starts] == [0.0, 0.01, 0.3]
    for start in starts:
        found = simulate(start.chain, start.velocity, method="accurate", tolerance=1e-10)
        assert case.error(found.final_velocity) < 1e-9
        assert found.contact_intervals[0][0][0] == pytest.approx(start.early, abs=1e-12)


def test_a_case_that_cannot_begin_earlier_begins_when_it_does():
    parting = Recipe("parting", "parting", lambda: one_on(2, power_law(1.0, 0.1)), velocity=np.array([1.0, 0.0, 0.1]))
    assert len(parting.cook().starts([0.1, 0.2])) == 1


def test_a_scene_is_a_case_a_lane():
    scene = load("one-on-four")
    (recipe,) = recipes_of(scene)
    assert recipe.label == scene.title
    assert recipe.build() == scene.lanes[0].chain()
    two = recipes_of(load("galilean"))
    assert len(two) == len(load("galilean").lanes)


def test_every_method_is_charted(case):
    found = ours(case)
    assert [solver.name for solver in found] == [*(method.name for method in METHODS), "auto"]
    assert all(solver.steps != method.adaptive for solver, method in zip(found[:-1], METHODS, strict=True))
    assert len(ours_named(case, "verlet").starts(case, 100.0)) == PHASES
    assert len(ours_named(case, "radau").starts(case, 1e-3)) == 1


def test_errors_average_over_the_start_phase(case):
    solver, steps = ours_named(case, "verlet"), 120.0
    (point,) = scan(case, with_finenesses(solver, steps), patience=SHORT).points
    alone = [case.error(solver.run(steps, start, NO_MOMENTS).velocity) for start in solver.starts(case, steps)]
    assert np.ptp(alone) > 0.1 * point.error  # irregular, so that one phase would be a lottery
    assert point.error == pytest.approx(np.sqrt(np.mean(np.square(alone))))
    assert point.evaluations == pytest.approx(120, abs=3)


@pytest.mark.parametrize("quantity", ["forces", "overlaps"])
def test_forces_and_overlaps_have_errors_of_their_own(case, quantity):
    coarse, fine = (
        scan(case, with_finenesses(ours_named(case, "accurate"), tolerance), quantity, SHORT).points[0].error
        for tolerance in (1e-3, 1e-9)
    )
    assert fine < 1e-6 < coarse < 0.3


def test_what_is_compared_is_asked_for_at_the_same_moments(case):
    solver = ours_named(case, "verlet")
    early = case.starts([0.0, 0.25])
    first, second = (solver.run(30000.0, start, case.moments) for start in early)
    assert np.median(np.abs(first.force - second.force)) < 1e-3  # the start was earlier, the moments as much later
    assert error_of(case, "forces", second) < 0.02


def test_a_lucky_hit_does_not_count():
    series = made("x", True, (1e-7, 1e-3), (1e-2, 2e-3), (1e-6, 3e-3), (1e-8, 4e-3))
    assert fastest([series], 1e-6) is series.points[2]
    assert fastest([series], 1e-9) is None


def test_the_frontier_holds_what_nothing_beats():
    first, second = made("x", True, (1e-1, 1.0), (1e-3, 4.0)), made("x", True, (1e-2, 2.0), (1e-2, 3.0), (1e-5, 9.0))
    assert [point.error for point in frontier([first, second])] == [1e-1, 1e-2, 1e-3, 1e-5]
    assert [point.error for point in frontier([first], "evaluations")] == [1e-1, 1e-3]


@pytest.mark.parametrize("alpha", [0.1, 0.5])
def test_orders_at_an_impact_are_those_of_the_onset(alpha):
    case = Recipe("impact", "impact", lambda: one_on(1, power_law(1.0, alpha))).cook()
    found = scan(case, ours_named(case, "verlet"), patience=Patience(0.05, 1.0))
    assert fitted_order(found, max(case.doubt, 1e-12)) == pytest.approx(1.0 + alpha, abs=0.25)


def test_orders_of_three_points_at_least():
    assert fitted_order(made("x", True, (1e-2, 1.0), (1e-3, 1.0)), 1e-14) is None
    assert fitted_order(made("x", True, (1e-2, 1.0), (1e-4, 1.0), (1e-6, 1.0)), 1e-14) == pytest.approx(2.0)
    assert fitted_order(made("x", True, (1e-2, 1.0), (1e-4, 1.0), (1e-6, 1.0)), 1e-6) is None


def test_a_series_ends_with_its_share_of_time_and_says_so(case):
    found = scan(case, ours_named(case, "verlet"), patience=Patience(point=1e-4, series=10.0))
    assert found.ended.startswith("a finer run would take about")
    assert found.points[-1].seconds < 1e-3
    exact = scan(case, with_finenesses(ours_named(case, "accurate"), 1e-3, 1e-11, 1e-12, 1e-13))
    assert [point.fineness for point in exact.points] == [1e-3, 1e-11, 1e-12]
    assert exact.ended == ""


def test_a_case_shares_its_time_among_its_solvers(case, monkeypatch):
    shares = []
    monkeypatch.setattr(measuring, "scan", lambda *a: shares.append(a[3].series) or made("x", True, (0.1, 1.0)))
    solver = with_finenesses(ours_named(case, "verlet"), 30.0)
    measure(case, [solver] * 4, patience=Patience(1.0, 10.0, 8.0))
    assert shares[0] == pytest.approx(2.0)
    assert shares[-1] == pytest.approx(8.0, abs=0.5)  # what the others have not used


def test_a_peer_that_raises_has_given_up_and_ours_has_a_bug(case):
    def broken(*_):
        raise ValueError("array must not contain infs or NaNs")

    (series,) = measure(case, [Solver("peer", "", (1e-2, 1e-3), broken)], patience=SHORT)
    assert all(point.error == math.inf for point in series.points)
    with pytest.raises(ValueError, match="infs"):
        measure(case, [Solver("method", "", (1e-2,), broken, ours=True)], patience=SHORT)


def test_ratios_are_of_the_fastest_on_each_side():
    fine = (1e-12, 5e-3)
    found = Measured(None, [made("a", True, (1e-4, 2e-3), fine), made("b", False, (1e-4, 4e-3), fine)])
    assert ratio(rows(found), 0) == pytest.approx(2.0)
    assert ratio(rows(found), 1) == pytest.approx(1.0)
    assert "b / a = 2" in ratio_sentence(rows(found))
    assert ratio(rows(Measured(None, found.series[:1])), 0) == math.inf
    assert ratio(rows(Measured(None, found.series[1:])), 0) is None


def test_what_auto_costs_is_said_beside_the_best():
    fine = (1e-12, 9e-3)
    found = [made("a", True, (1e-4, 2e-3), fine), made("auto", True, (1e-4, 3e-3), fine)]
    assert "0.001: 1.5" in auto_sentence(rows(Measured(None, found)))
    assert auto_sentence(rows(Measured(None, found[:1]))) == ""


def test_labels_are_moved_apart_and_stay_in_order():
    wanted = [0.5, 0.5, 0.5, 0.1, 0.99, 0.0]
    found = apart(wanted, 0.05, 0.0, 1.0)
    assert np.diff(np.sort(found)).min() > 0.05 - 1e-12
    assert found.min() >= 0.0
    assert found.max() <= 1.0
    assert (np.argsort(found, kind="stable") == np.argsort(wanted, kind="stable")).all()
    assert apart([0.2, 0.8], 0.05) == pytest.approx([0.2, 0.8])
    assert np.ptp(apart(np.zeros(100), 0.05)) == pytest.approx(1.0)  # more than fit share the room


def test_no_label_of_a_chart_lies_on_another(case):
    series = [
        made(f"method {k}", k < 9, (1e-2, 1e-4), (1e-5, 1e-3), (1e-5 if k % 2 else 1e-7, 2e-3)) for k in range(20)
    ]
    with styled():
        picture = draw([Measured(case, series)])
        picture.canvas.draw()
        boxes = [
            text.get_window_extent().extents
            for axes in picture.axes
            for text in axes.texts
            if text.get_gid() == "label"
        ]
        inside = picture.bbox.extents
    assert len(boxes) == 40
    assert overlapping(boxes) == []
    assert max(box[2] for box in boxes) < inside[2]


def test_methods_are_told_apart_without_colour(case):
    series = [made(f"method {k}", k < 9, (1e-2, 1e-4), (1e-5, 1e-3)) for k in range(24)]
    with styled():
        axes = draw([Measured(case, series)]).axes[0]
    looks = {
        (line.get_marker(), line.get_linestyle(), line.get_markerfacecolor() == "white")
        for line in axes.lines
        if line.get_marker() != "." and line.get_linestyle() != "None"
    }
    assert len(looks) == 24


def test_csv_holds_every_point(tmp_path, case):
    series = [made("a", True, (1e-4, 2e-3), (math.inf, 1e-3))]
    write_csv([Measured(case, series)], tmp_path / "x.csv")
    with (tmp_path / "x.csv").open() as file:
        first, second = list(csv.DictReader(file))
    assert float(first["error of velocities"]) == 1e-4
    assert float(first["seconds"]) == 2e-3
    assert second["error of velocities"] == ""


def test_the_command_draws_a_scene_of_your_own(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(measuring.measure, "__defaults__", ("velocities", SHORT, lambda _: None))
    picture = tmp_path / "chart.png"
    assert main(["chart", "one-on-four", "--ours", "--csv", "-o", str(picture)]) == 0
    said = capsys.readouterr().out
    assert picture.stat().st_size > 10_000
    assert {row.split(",")[1] for row in (tmp_path / "chart.csv").read_text().splitlines()[1:]} == {
        "auto",
        *(method.name for method in METHODS),
    }
    assert "accurate" in said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["chart.csv", "chart.png"]
    assert main(["chart", "step-force", "--ours", "--error", "forces", "-o", str(tmp_path / "two.svg")]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["chart.csv", "chart.png", "two.svg"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["chart", "one-on-for"], "did you mean"),
        (["chart", "-o", "chart.txt"], "chart writes .png, .pdf, .svg"),
        (["chart", "--error", "nonsense"], "velocities"),
        (["chart", "-o", "/dev/null/x.png", "one-on-4"], "cannot write"),
    ],
)
def test_refusals_are_sentences(arguments, said, capsys):
    assert main(arguments) == 2
    assert said in capsys.readouterr().err


def test_the_list_of_cases(capsys):
    assert main(["chart", "--list"]) == 0
    said = capsys.readouterr().out
    assert all(name in said for name in BY_NAME)


def test_what_rubs_has_no_peers_and_the_methods_that_carry_it():
    rubbed = type("Case", (), {"chain": Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1), friction=0.1)})()
    assert peers.peers(rubbed) == []
    assert {solver.name for solver in ours(rubbed)} == {
        "auto",
        *(method.name for method in METHODS if method.dissipative),
    }


needs_numba = pytest.mark.skipif(
    find_spec("numba") is None or os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="peers need compiled code"
)


@needs_numba
def test_the_right_hand_side_of_the_peers_is_that_of_the_chain():
    from softcradle.sandbox.studies.precision.peers.peer_problem import parameters_of, slopes

    chain = Chain(
        [1.0, 2.0, 0.5, np.inf], [power_law(1.0, 0.1), hertz(2.0), power_law(3.0, 1.0)], 0.0, [0.5, 0, 0.25, 0]
    )
    overlap, rate, counter = np.array([0.1, -0.2, 0.3]), np.array([1.0, 2.0, 3.0]), np.zeros(1)
    out = np.empty(6)
    parameters = parameters_of(type("Case", (), {"chain": chain})(), counter)
    for _ in range(3):
        slopes(np.concatenate((overlap, rate)), out, parameters)
    force = [contact.force(d) for contact, d in zip(chain.contact, overlap, strict=True)]
    pushed = -np.diff(np.concatenate(([0.0], force, [0.0]))) + chain.drive_force
    assert out[:3] == pytest.approx(rate)
    assert out[3:] == pytest.approx(-np.diff(pushed * chain.parameters.inverse_mass), rel=1e-14)
    assert counter[0] == 3.0


@needs_numba
def test_verlet_by_hand_is_verlet(case):
    from softcradle.sandbox.studies.precision.peers import verlet_by_hand as by_hand

    (solver,) = by_hand.solvers(case)
    start = case.starts([0.0])[0]
    found = solver.run(500.0, start, NO_MOMENTS).velocity
    assert found == pytest.approx(ours_named(case, "verlet").run(500.0, start, NO_MOMENTS).velocity, abs=1e-12)


@needs_numba
@pytest.mark.parametrize("peer", [peer for peer in peers.PEERS if peer.name != "CyRK"], ids=lambda peer: peer.name)
def test_an_installed_peer_reaches_the_truth(case, peer):  # CyRK compiles for half a minute: `make bench` does
    pytest.importorskip(peer.package)
    module = __import__(f"softcradle.sandbox.studies.precision.peers.{peer.module}", fromlist=["solvers"])
    solver = next(solver for solver in module.solvers(case)[::-1] if solver.name != "SciPy Radau")  # it never does
    fineness = 30000.0 if solver.steps else 1e-12 if solver.name == "CVODE BDF" else 1e-10
    start = case.starts([0.0])[0]
    answer, dense = (solver.run(fineness, start, moments) for moments in (NO_MOMENTS, case.moments))
    assert case.error(answer.velocity) < 1e-3
    assert answer.seconds > 0.0
    assert dense.force.shape == dense.overlap.shape == (64, 4)
    assert error_of(case, "forces", dense) < 0.3


@needs_numba
@pytest.mark.parametrize("module", ["scipy", "sundae"])
def test_a_peer_that_takes_too_long_is_given_up(module, monkeypatch):
    if module == "sundae":
        pytest.importorskip("sksundae")
    peer = __import__(f"softcradle.sandbox.studies.precision.peers.{module}", fromlist=["solvers"])
    monkeypatch.setattr(peer, "LONGEST", 0.02)
    hard = BY_NAME["one-on-10"].cook()
    solver = peer.solvers(hard)[0]
    answer = solver.run(1e-8, hard.starts([0.0])[0], NO_MOMENTS)
    assert answer.velocity is None
    assert answer.seconds < 1.0


def test_missing_peers_are_named(monkeypatch):
    monkeypatch.setattr(peers, "find_spec", lambda package: None)
    assert peers.missing() == [peer.name for peer in peers.PEERS]
    assert peers.peers(type("Case", (), {"chain": one_on(2, hertz(1.0))})()) == []


def test_the_table_of_the_benchmark(case):
    from benchmarks.precision import measured

    accurate = with_finenesses(ours_named(case, "accurate"), 1e-5, 1e-7)
    report = measured(case, [accurate, with_finenesses(ours_named(case, "conserving"), 60.0, 120.0)], SHORT)
    assert [row[0] for row in report.rows] == ["accurate", "conserving"]
    assert report.rows[0][3] == "- (0.7) missed"
    assert json.loads(json.dumps(report.data))["case"] == case.label
    assert report.data["solvers"][0]["best"][1]["error"] <= 1e-6
