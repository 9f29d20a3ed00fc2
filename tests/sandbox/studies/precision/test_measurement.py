"""Measurement of solvers, ours and peers: errors over start phases and samples, time limits, failures."""

import math
import os
from dataclasses import replace
from importlib.util import find_spec
from types import SimpleNamespace

import numpy as np
import pytest
from softcradle.physics import METHODS, Chain, Coupler, TimedForce, hertz, hooke, one_on, power_law, simulate
from softcradle.sandbox.studies.precision import measurement
from softcradle.sandbox.studies.precision.cases import TRUTH_TOLERANCE, CaseDefinition, definitions_of
from softcradle.sandbox.studies.precision.measurement import NO_SAMPLES, Solver, TimeLimits, error_of, measure_series
from softcradle.scenes import load

from benchmarks import peers
from benchmarks.peers import PEERS, missing_peers, peer_solvers
from tests.helpers.series import SHORT_LIMITS, made_series, our_solver
from tests.helpers.truth import ELASTIC

SLIDING = Chain([1.0, 1.0, 1.0], hooke(1.0), 0.1, friction=0.01)
PUSHED = Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1), forces=TimedForce(0, [0.0, 1.0], [0.0, 0.1]))
BRAKED = Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1), brakes=TimedForce(0, [0.0], [0.1]))
PULLED = Chain([1.0, 1.0], Coupler(hooke(1.0), hooke(100.0, loss=0.5), slack=0.1))


def test_every_method_has_a_solver(case):
    found = measurement.our_solvers(case)
    assert [solver.name for solver in found] == [*(method.name for method in METHODS), "auto"]
    assert all(solver.steps != method.adaptive for solver, method in zip(found[:-1], METHODS, strict=True))
    assert len(our_solver(case, "verlet").starts(case, 100.0)) == measurement.START_PHASES
    assert len(our_solver(case, "radau").starts(case, 1e-3)) == 1
    methods = {method.name for method in METHODS if method.dissipative}
    for chain, names in (
        (SLIDING, methods),
        (PUSHED, {method.name for method in METHODS}),
        (PULLED, methods - {"pymunk"}),
    ):
        taken = SimpleNamespace(chain=chain)
        assert {solver.name for solver in measurement.our_solvers(taken)} == {"auto", *names}
        assert peer_solvers(taken) == []


def test_errors_are_distances_from_the_truth_which_is_that_in_quadruple_precision(case):
    truth = next(truth for truth in ELASTIC if truth.name == "one on 4, alpha 1/10")
    assert (case.truth == truth.final).all()
    assert case.uncertainty == 0.0
    assert case.error(case.truth + np.array([0, 0, 1e-3, 0, 0])) == pytest.approx(1e-3)
    assert case.error(np.full(5, np.nan)) == np.inf


def test_errors_average_over_the_start_phase(case):
    solver, steps = our_solver(case, "verlet"), 120.0
    (point,) = measure_series(case, our_solver(case, "verlet", steps), limits=SHORT_LIMITS).points
    errors = [case.error(solver.run(steps, start, NO_SAMPLES).velocity) for start in solver.starts(case, steps)]
    assert np.ptp(errors) > 0.1 * point.error  # the error at one phase alone is a matter of chance
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


def test_samples_of_an_earlier_start_are_as_much_later(case):
    solver = our_solver(case, "verlet")
    first, second = (solver.run(30000.0, start, case.sample_times) for start in case.starts([0.0, 0.25]))
    assert np.median(np.abs(first.force - second.force)) < 1e-3
    assert error_of(case, "forces", second) < 0.02


def test_a_series_ends_at_its_time_limit(case):
    solver = our_solver(case, "verlet")
    found = measure_series(case, solver, limits=TimeLimits(run=1e-4, series=10.0))
    assert found.out_of_time
    assert len(found.points) < len(solver.finenesses)
    exact = measure_series(case, our_solver(case, "accurate", 1e-3, 1e-11, 1e-12, 1e-13))
    assert [point.fineness for point in exact.points] == [1e-3, 1e-11, 1e-12]
    assert not exact.out_of_time


def test_a_case_shares_its_time_among_its_solvers(case, monkeypatch):
    shares, solver, made = [], our_solver(case, "verlet", 30.0), made_series("x", True, (0.1, 1.0))
    monkeypatch.setattr(measurement, "measure_series", lambda *a: shares.append(a[3].series) or made)
    measurement.measure_case(case, [solver] * 4, limits=TimeLimits(1.0, 10.0, 8.0))
    assert shares[0] == pytest.approx(2.0)
    assert shares[-1] == pytest.approx(8.0, abs=0.5)  # what the others have not used


def test_a_peer_that_raises_has_given_up_and_a_method_of_ours_has_a_bug(case):
    def broken(*_):
        raise ValueError("array must not contain infs or NaNs")

    (series,) = measurement.measure_case(case, [Solver("peer", "", (1e-2, 1e-3), broken)], limits=SHORT_LIMITS)
    assert all(point.error == math.inf for point in series.points)
    with pytest.raises(ValueError, match="infs"):
        measurement.measure_case(case, [Solver("method", "", (1e-2,), broken, ours=True)], limits=SHORT_LIMITS)


def test_without_the_reference_two_ways_to_the_truth_agree(definitions):
    solved = definitions["one-on-5"].solve(by_reference=False)
    assert 0.0 < solved.uncertainty < 1e-10
    assert f"radau at {TRUTH_TOLERANCE:g}" in solved.source


@pytest.mark.slow
@pytest.mark.parametrize("name", ["one-on-5", "hertz-100", "gear-above"])
def test_every_truth_is_from_outside(definitions, name):
    """Two of our own methods are as near as they say."""
    solved, ours = definitions[name].solve(), definitions[name].solve(by_reference=False)
    assert 0.0 < solved.uncertainty < 1e-10
    assert "scipy at" in solved.source
    assert solved.error(ours.truth) < 3.0 * (ours.uncertainty + solved.uncertainty)


@pytest.mark.parametrize("name", ["one-on-10", "gear-below", "step-force"])
def test_extended_precision_and_closed_forms_are_what_radau_finds(definitions, name):
    solved = definitions[name].solve()
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
    velocity = np.array([1.0, 0.0, 0.1])  # it cannot begin earlier
    parting = CaseDefinition("parting", "parting", lambda: one_on(2, power_law(1.0, 0.1)), velocity=velocity)
    assert len(parting.solve().starts([0.1, 0.2])) == 1
    for chain in (SLIDING, PUSHED, BRAKED, PULLED):  # nor where it would not be in free flight until then
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
def test_the_right_hand_side_of_the_peers_is_that_of_the_chain():
    from benchmarks.peers.problem import derivatives, parameter_array

    chain = Chain([1, 2, 0.5, np.inf], [power_law(1.0, 0.1), hertz(2.0), power_law(3.0, 1.0)], 0.0, [0.5, 0, 0.25, 0])
    overlap, rate, counter = np.array([0.1, -0.2, 0.3]), np.array([1.0, 2.0, 3.0]), np.zeros(1)
    out = np.empty(6)
    parameters = parameter_array(SimpleNamespace(chain=chain), counter)
    for _ in range(3):
        derivatives(np.concatenate((overlap, rate)), out, parameters)
    force = [contact.force(d) for contact, d in zip(chain.contact, overlap, strict=True)]
    total = -np.diff(np.concatenate(([0.0], force, [0.0]))) + chain.drive_force
    assert out[:3] == pytest.approx(rate)
    assert out[3:] == pytest.approx(-np.diff(total * chain.parameters.inverse_mass), rel=1e-14)
    assert counter[0] == 3.0


@needs_numba
def test_verlet_by_hand_is_verlet(case):
    from benchmarks.peers.integrators import verlet_by_hand

    (solver,) = verlet_by_hand(case)
    start = case.starts([0.0])[0]
    found = solver.run(500.0, start, NO_SAMPLES).velocity
    assert found == pytest.approx(our_solver(case, "verlet").run(500.0, start, NO_SAMPLES).velocity, abs=1e-12)


# CyRK compiles for half a minute, in `make bench` alone; Radau of SciPy reaches no small error in its time
@needs_numba
@pytest.mark.parametrize("peer", [peer for peer in PEERS if peer.name != "CyRK"], ids=lambda peer: peer.name)
def test_an_installed_peer_reaches_the_truth(case, peer, monkeypatch):
    pytest.importorskip(peer.package)
    from benchmarks.peers import integrators

    monkeypatch.setattr(integrators, "TIME_LIMIT", np.inf)  # a second, which is short beside other work
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
def test_a_peer_called_from_python_gives_up_at_its_time_limit(definitions, monkeypatch, package):
    pytest.importorskip(package)
    from benchmarks.peers import integrators

    monkeypatch.setattr(integrators, "TIME_LIMIT", 0.02)
    case = definitions["one-on-10"].solve(by_reference=False)
    (peer,) = (peer for peer in PEERS if peer.package == package)
    assert peer.solvers(case)[0].run(1e-8, case.starts([0.0])[0], NO_SAMPLES).velocity is None


def test_missing_peers_are_left_out(monkeypatch):
    monkeypatch.setattr(peers, "find_spec", lambda package: None)
    assert missing_peers() == list(PEERS)
    assert peer_solvers(SimpleNamespace(chain=one_on(2, hertz(1.0)))) == []
