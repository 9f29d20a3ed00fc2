"""Tests of the chart of computing time against accuracy.

The tests check the measured points of our methods and of other packages, the picture, and the command that draws it.
"""

import csv
import math
import os
import re
from dataclasses import replace
from importlib.util import find_spec
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest
from softcradle.physics import METHODS, Chain, Coupler, TimedForce, hertz, hooke, one_on, power_law, simulate
from softcradle.physics.version import version
from softcradle.sandbox.studies.plot_style import styled
from softcradle.sandbox.studies.precision import measurement, table
from softcradle.sandbox.studies.precision.cases import CASE_DEFINITIONS, TRUTH_TOLERANCE, CaseDefinition, definitions_of
from softcradle.sandbox.studies.precision.chart import draw_chart
from softcradle.sandbox.studies.precision.measurement import NO_SAMPLES, Solver, TimeLimits, error_of, measure_series
from softcradle.sandbox.studies.precision.peers import PEERS, missing_peers, peer_solvers
from softcradle.sandbox.studies.precision.table import MeasuredCase, curve_rows, fastest, fitted_order, ratio
from softcradle.scenes import load

from tests.helpers.series import SHORT_LIMITS, made_series, our_solver
from tests.helpers.truth import ELASTIC

DEFINITIONS = {definition.name: definition for definition in CASE_DEFINITIONS}
SLIDING = Chain([1.0, 1.0, 1.0], hooke(1.0), 0.1, friction=0.01)
PUSHED = Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1), forces=TimedForce(0, [0.0, 1.0], [0.0, 0.1]))
BRAKED = Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1), brakes=TimedForce(0, [0.0], [0.1]))
PULLED = Chain([1.0, 1.0], Coupler(hooke(1.0), hooke(100.0, loss=0.5), slack=0.1))


@pytest.fixture(scope="module")
def case():
    return DEFINITIONS["one-on-4"].solve()


def test_every_method_has_a_solver(case):
    found = measurement.our_solvers(case)
    assert [solver.name for solver in found] == [*(method.name for method in METHODS), "auto"]
    assert all(solver.steps != method.adaptive for solver, method in zip(found[:-1], METHODS, strict=True))
    assert len(our_solver(case, "verlet").starts(case, 100.0)) == measurement.START_PHASES
    assert len(our_solver(case, "radau").starts(case, 1e-3)) == 1
    every = {method.name for method in METHODS}
    lossy = {method.name for method in METHODS if method.dissipative}
    for chain, names in (SLIDING, lossy), (PUSHED, every), (PULLED, lossy - {"pymunk"}):
        taken = SimpleNamespace(chain=chain)
        assert {solver.name for solver in measurement.our_solvers(taken)} == {"auto", *names}
        assert peer_solvers(taken) == []


def test_errors_are_averaged_over_the_start_phase(case):
    # This reference solution was computed with quadruple precision.
    truth = next(truth for truth in ELASTIC if truth.name == "one on 4, alpha 1/10")
    assert (case.truth == truth.final).all()
    assert case.uncertainty == 0.0
    assert case.error(case.truth + np.array([0, 0, 1e-3, 0, 0])) == pytest.approx(1e-3)
    assert case.error(np.full(5, np.nan)) == np.inf
    solver, steps = our_solver(case, "verlet", 120.0), 120.0
    (point,) = measure_series(case, solver, limits=SHORT_LIMITS).points
    errors = [case.error(solver.run(steps, start, NO_SAMPLES).velocity) for start in solver.starts(case, steps)]
    # The error depends on the phase between the time steps and the collision. A single phase would give a random
    # result.
    assert np.ptp(errors) > 0.1 * point.error
    assert point.error == pytest.approx(np.sqrt(np.mean(np.square(errors))))
    assert point.evaluations == pytest.approx(120, abs=3)


@pytest.mark.parametrize("quantity", ["forces", "overlaps"])
def test_forces_and_overlaps_have_errors_of_their_own(case, quantity):
    solvers = [our_solver(case, "accurate", tolerance) for tolerance in (1e-3, 1e-9)]
    coarse, fine = (measure_series(case, solver, quantity, SHORT_LIMITS).points[0].error for solver in solvers)
    assert fine < 1e-6 < coarse < 0.3
    pulled = CaseDefinition("pulled", "pulled", lambda: PULLED, 1.0, velocity=np.array([0.0, 1.0])).solve(False)
    true = pulled.sampled_truth
    off = SimpleNamespace(velocity=true.final_velocity, overlap=1.01 * true.overlap, force=1.01 * true.force)
    assert 0.002 < error_of(pulled, quantity, off) <= 0.0101


def test_series_and_cases_keep_their_time_limits(case, monkeypatch):
    solver = our_solver(case, "verlet")
    found = measure_series(case, solver, limits=TimeLimits(run=1e-4, series=10.0))
    assert found.out_of_time
    assert len(found.points) < len(solver.finenesses)
    exact = measure_series(case, our_solver(case, "accurate", 1e-3, 1e-11, 1e-12, 1e-13))
    assert [point.fineness for point in exact.points] == [1e-3, 1e-11, 1e-12]
    assert not exact.out_of_time
    shares, made = [], made_series("x", True, (0.1, 1.0))
    monkeypatch.setattr(measurement, "measure_series", lambda *a: shares.append(a[3].series) or made)
    measurement.measure_case(case, [solver] * 4, limits=TimeLimits(1.0, 10.0, 8.0))
    assert shares[0] == pytest.approx(2.0)
    # The last series gets the time that the other series have not used.
    assert shares[-1] == pytest.approx(8.0, abs=0.5)


def test_a_peer_that_raises_has_given_up(case, tmp_path):
    broken = Mock(side_effect=ValueError("array must not contain infs or NaNs"))
    (series,) = measurement.measure_case(case, [Solver("peer", "", (1e-2, 1e-3), broken)], limits=SHORT_LIMITS)
    assert all(point.error == math.inf for point in series.points)
    table.write_csv([MeasuredCase(case, [series])], tmp_path / "x.csv")
    rows = csv.DictReader((tmp_path / "x.csv").read_text().splitlines())
    assert [row["error of velocities"] for row in rows] == ["", ""]
    with pytest.raises(ValueError, match="infs"):
        measurement.measure_case(case, [Solver("method", "", (1e-2,), broken, ours=True)], limits=SHORT_LIMITS)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["one-on-5", "hertz-100", "gear-above"])
def test_every_truth_is_from_outside(name):
    """Compare two of our methods with the independent reference solutions. The velocities must agree within their
    estimated errors.
    """
    solved, ours = DEFINITIONS[name].solve(), DEFINITIONS[name].solve(by_reference=False)
    assert 0.0 < solved.uncertainty < 1e-10
    assert "scipy at" in solved.source
    assert solved.error(ours.truth) < 3.0 * (ours.uncertainty + solved.uncertainty)


@pytest.mark.parametrize("name", ["one-on-10", "gear-below", "step-force"])
def test_radau_agrees_with_extended_precision(name):
    solved = DEFINITIONS[name].solve()
    found = simulate(solved.chain, solved.velocity, method="radau", tolerance=1e-11)
    exact = "exact" in solved.source
    assert exact == (name != "one-on-10")
    assert solved.error(found.final_velocity) < (1e-9 if exact else 3.0 * solved.uncertainty)


def test_an_earlier_start_ends_the_same(case):
    starts = case.starts([0.0, 0.01, 0.3])
    assert [start.early for start in starts] == [0.0, 0.01, 0.3]
    for start in starts:
        found = simulate(start.chain, start.velocity, method="accurate", tolerance=1e-10)
        assert case.error(found.final_velocity) < 1e-9
        assert found.contact_intervals[0][0][0] == pytest.approx(start.early, abs=1e-12)
    verlet = our_solver(case, "verlet")
    first, second = (verlet.run(30000.0, start, case.sample_times) for start in case.starts([0.0, 0.25]))
    # The sample times are shifted together with the start time, so the forces agree.
    assert np.median(np.abs(first.force - second.force)) < 1e-3
    assert error_of(case, "forces", second) < 0.02
    # At the start, bead 2 moves away from bead 1. At an earlier time, they would overlap.
    velocity = np.array([1.0, 0.0, 0.1])
    parting = CaseDefinition("parting", "parting", lambda: one_on(2, power_law(1.0, 0.1)), velocity=velocity)
    solved = parting.solve(by_reference=False)
    assert 0.0 < solved.uncertainty < 1e-10  # The reference solution is computed in two ways that agree.
    assert f"radau at {TRUTH_TOLERANCE:g}" in solved.source
    assert len(solved.starts([0.1, 0.2])) == 1
    # The start cannot be moved back for these chains either. Before the start, forces would already act on the beads.
    for chain in (SLIDING, PUSHED, BRAKED, PULLED):
        acted_on = replace(case, chain=chain, velocity=np.eye(1, chain.contacts + 1)[0])
        assert len(acted_on.starts([0.1, 0.2])) == 1


def test_a_bed_that_goes_on_acting_acts_until_the_collision_is_over():
    case = CaseDefinition("bed", "bed", lambda: SLIDING).solve()
    assert case.uncertainty < 1e-10
    for name, fineness, error in (("scipy", 1e-10, 1e-9), ("accurate", 1e-10, 1e-9), ("conserving", 16000.0, 1e-5)):
        solver = our_solver(case, name)
        (start,) = solver.starts(case, fineness)
        assert case.error(solver.run(fineness, start, NO_SAMPLES).velocity) < error, name


def test_a_scene_is_one_case_for_each_lane():
    assert [one.label for one in definitions_of(load("one-on-four"))] == [load("one-on-four").title]
    scene = load("galilean")
    assert [one.make_chain() for one in definitions_of(scene)] == [lane.chain() for lane in scene.lanes]


needs_numba = pytest.mark.skipif(
    find_spec("numba") is None or os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="peers need compiled code"
)


@needs_numba
def test_peers_integrate_mixed_chains(monkeypatch):
    monkeypatch.setattr(
        "softcradle.sandbox.studies.precision.peers.integrators.TIME_LIMIT", np.inf
    )  # Remove the time limit of one second, which is too short on a busy computer.
    contacts = [power_law(1.0, 0.1), hertz(2.0), power_law(3.0, 1.0)]
    chain = Chain([1, 2, 0.5, np.inf], contacts, 0.0, [0.5, 0, 0.25, 0])
    unlike = CaseDefinition("unlike", "unlike", lambda: chain, 1.0, velocity=np.array([1.0, 0.5, 0.3, 0.0])).solve()
    solver = next(peer for peer in PEERS if peer.package == "scipy").solvers(unlike)[0]
    found = solver.run(1e-8, unlike.starts([0.0])[0], NO_SAMPLES)
    assert unlike.error(found.velocity) < 1e-6
    assert found.evaluations > 100


@needs_numba
def test_verlet_by_hand_is_verlet(case):
    (solver,) = next(peer for peer in PEERS if peer.name == "Verlet by hand").solvers(case)
    start = case.starts([0.0])[0]
    found = solver.run(500.0, start, NO_SAMPLES).velocity
    assert found == pytest.approx(our_solver(case, "verlet").run(500.0, start, NO_SAMPLES).velocity, abs=1e-12)


# The package CyRK is left out, because it compiles for half a minute. CyRK runs only in `make bench`. The method Radau
# of SciPy is left out, because it does not reach a small error within the time limit.
@needs_numba
@pytest.mark.parametrize("peer", [peer for peer in PEERS if peer.name != "CyRK"], ids=lambda peer: peer.name)
def test_an_installed_peer_reaches_the_truth(case, peer, monkeypatch):
    pytest.importorskip(peer.package)
    monkeypatch.setattr(
        "softcradle.sandbox.studies.precision.peers.integrators.TIME_LIMIT", np.inf
    )  # Remove the time limit of one second, which is too short on a busy computer.
    solver = next(solver for solver in peer.solvers(case)[::-1] if solver.name != "SciPy Radau")
    fineness = 30000.0 if solver.steps else 1e-12 if solver.name == "CVODE BDF" else 1e-10
    start = case.starts([0.0])[0]
    final, sampled = (solver.run(fineness, start, times) for times in (NO_SAMPLES, case.sample_times))
    assert case.error(final.velocity) < 1e-3
    assert final.seconds > 0.0
    assert sampled.overlap.shape == (64, 4)
    assert error_of(case, "forces", sampled) < 0.3


@needs_numba
@pytest.mark.parametrize("package", ["scipy", "sksundae"])
def test_a_peer_called_from_python_gives_up_at_its_time_limit(monkeypatch, package):
    pytest.importorskip(package)
    monkeypatch.setattr("softcradle.sandbox.studies.precision.peers.integrators.TIME_LIMIT", 0.02)
    case = DEFINITIONS["one-on-10"].solve(by_reference=False)
    (peer,) = (peer for peer in PEERS if peer.package == package)
    assert peer.solvers(case)[0].run(1e-8, case.starts([0.0])[0], NO_SAMPLES).velocity is None


def test_missing_peers_are_left_out(monkeypatch):
    monkeypatch.setattr("softcradle.sandbox.studies.precision.peers.find_spec", lambda package: None)
    assert missing_peers() == list(PEERS)
    assert peer_solvers(SimpleNamespace(chain=one_on(2, hertz(1.0)))) == []


def test_labels_and_stamp_of_a_chart_are_readable(case):
    ends = [(1e-5 if k % 2 else 1e-7, 2e-3) for k in range(24)]
    series = [made_series(f"method {k}", k < 9, (1e-2, 1e-4), (1e-5, 1e-3), end) for k, end in enumerate(ends)]
    stamp = measurement.machine_stamp(["no such package"])
    assert f"softcradle {version()}" in stamp
    assert f"numpy {np.__version__}" in stamp
    assert re.search(r"\d+ cores?; \w+, Python 3", stamp)
    with styled():
        picture = draw_chart([MeasuredCase(case, series)], stamp)
        picture.canvas.draw()
        texts = [text for axes in picture.axes for text in (*axes.texts, axes.xaxis.label)]
        boxes = [text.get_window_extent() for text in texts]
        (shown,) = [text for text in picture.texts if text.get_gid() == "stamp"]
        place = shown.get_window_extent()
    labels = [box for text, box in zip(texts, boxes, strict=True) if text.get_gid() == "label"]
    # Each label overlaps only its own box.
    assert [box.count_overlaps(labels) for box in labels] == [1] * 2 * len(series)
    assert max(box.x1 for box in labels) < picture.bbox.x1
    assert shown.get_text() == stamp
    assert place.count_overlaps(boxes) == 0
    assert place.y0 >= 0.0
    curves = [line for line in picture.axes[0].lines if line.get_marker() != "." and line.get_linestyle() != "None"]
    styles = {(line.get_marker(), line.get_linestyle(), line.get_markerfacecolor() == "white") for line in curves}
    assert len(styles) == len(series)


def test_the_chart_command_accepts_scene_files(tmp_path, monkeypatch, softcradle):
    monkeypatch.setattr(measurement.measure_case, "__defaults__", ("velocities", SHORT_LIMITS, lambda _: None))
    picture = tmp_path / "chart.png"
    printed = softcradle("chart", "one-on-four", "--ours", "--csv", "-o", str(picture)).out
    assert picture.stat().st_size > 10_000
    rows = [*csv.DictReader((tmp_path / "chart.csv").read_text().splitlines())]
    assert {row["method"] for row in rows} == {"auto", *(method.name for method in METHODS)}
    assert min(float(row["error of velocities"]) for row in rows) < 1e-3
    assert all(0.0 < float(row["seconds"]) < 60.0 for row in rows)
    assert "accurate" in printed
    softcradle("chart", "step-force", "--ours", "--error", "forces", "-o", str(tmp_path / "two.svg"))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["chart.csv", "chart.png", "two.svg"]
    printed = softcradle("chart", "--list").out
    assert all(name in printed for name in DEFINITIONS)


def test_only_best_points_count_for_orders():
    series = made_series("x", True, (1e-7, 1e-3), (1e-2, 2e-3), (1e-6, 3e-3), (1e-8, 4e-3))
    assert fastest([series], 1e-6) is series.points[2]
    assert fastest([series], 1e-9) is None
    first = made_series("x", True, (1e-1, 1.0), (1e-3, 4.0))
    second = made_series("x", True, (1e-2, 2.0), (1e-2, 3.0), (1e-5, 9.0))
    assert [point.error for point in table.frontier([first, second])] == [1e-1, 1e-2, 1e-3, 1e-5]
    assert [point.error for point in table.frontier([first], "evaluations")] == [1e-1, 1e-3]
    assert fitted_order(first, 1e-14) is None
    third = made_series("x", True, (1e-2, 1.0), (1e-4, 1.0), (1e-6, 1.0))
    assert fitted_order(third, 1e-14) == pytest.approx(2.0)
    assert fitted_order(third, 1e-6) is None


def test_ratios_are_of_the_fastest_on_each_side():
    fine = (1e-12, 5e-3)
    pair = [made_series("a", True, (1e-4, 2e-3), fine), made_series("b", False, (1e-4, 4e-3), fine)]
    found = MeasuredCase(None, pair)
    assert [ratio(curve_rows(found), level) for level in (0, 1)] == pytest.approx([2.0, 1.0])
    assert "b / a = 2" in table.ratio_sentence(curve_rows(found))
    assert ratio(curve_rows(MeasuredCase(None, found.series[:1])), 0) == math.inf
    assert ratio(curve_rows(MeasuredCase(None, found.series[1:])), 0) is None
    auto = [made_series("a", True, (1e-4, 2e-3), fine), made_series("auto", True, (1e-4, 3e-3), fine)]
    assert table.ratio_sentence(curve_rows(MeasuredCase(None, auto))).startswith("fastest, at 0.001: a; ")
    assert "0.001: 1.5" in table.auto_sentence(curve_rows(MeasuredCase(None, auto)))
    assert table.auto_sentence(curve_rows(MeasuredCase(None, auto[:1]))) == ""
