"""The peers of the chart: other integrators, where they are installed."""

import os
from importlib.util import find_spec

import numpy as np
import pytest
from softcradle.physics import Chain, hertz, one_on, power_law
from softcradle.sandbox.studies.precision.measurement import NO_SAMPLES, error_of

from benchmarks import peers
from benchmarks.peers import PEERS, missing_peers, peer_solvers
from tests.helpers.series import our_solver

needs_numba = pytest.mark.skipif(
    find_spec("numba") is None or os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="peers need compiled code"
)


def test_a_chain_with_friction_has_no_peers():
    sliding = type("ChartCase", (), {"chain": Chain([1.0, 1.0, 1.0], power_law(1.0, 0.1), friction=0.1)})()
    assert peer_solvers(sliding) == []


@needs_numba
def test_the_right_hand_side_of_the_peers_is_that_of_the_chain():
    from benchmarks.peers.problem import derivatives, parameter_array

    chain = Chain(
        [1.0, 2.0, 0.5, np.inf], [power_law(1.0, 0.1), hertz(2.0), power_law(3.0, 1.0)], 0.0, [0.5, 0, 0.25, 0]
    )
    overlap, rate, counter = np.array([0.1, -0.2, 0.3]), np.array([1.0, 2.0, 3.0]), np.zeros(1)
    out = np.empty(6)
    parameters = parameter_array(type("ChartCase", (), {"chain": chain})(), counter)
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
def test_an_installed_peer_reaches_the_truth(case, peer):
    pytest.importorskip(peer.package)
    solver = next(solver for solver in peer.solvers(case)[::-1] if solver.name != "SciPy Radau")
    fineness = 30000.0 if solver.steps else 1e-12 if solver.name == "CVODE BDF" else 1e-10
    start = case.starts([0.0])[0]
    final, sampled = (solver.run(fineness, start, times) for times in (NO_SAMPLES, case.sample_times))
    assert case.error(final.velocity) < 1e-3
    assert final.seconds > 0.0
    assert sampled.force.shape == sampled.overlap.shape == (64, 4)
    assert error_of(case, "forces", sampled) < 0.3


@needs_numba
@pytest.mark.parametrize("package", ["scipy", "sksundae"])
def test_a_peer_called_from_python_gives_up_at_its_time_limit(definitions, monkeypatch, package):
    pytest.importorskip(package)
    from benchmarks.peers import integrators

    monkeypatch.setattr(integrators, "TIME_LIMIT", 0.02)
    case = definitions["one-on-10"].solve(by_reference=False)
    (peer,) = (peer for peer in PEERS if peer.package == package)
    solution = peer.solvers(case)[0].run(1e-8, case.starts([0.0])[0], NO_SAMPLES)
    assert solution.velocity is None


def test_missing_peers_are_left_out(monkeypatch):
    monkeypatch.setattr(peers, "find_spec", lambda package: None)
    assert missing_peers() == list(PEERS)
    assert peer_solvers(type("ChartCase", (), {"chain": one_on(2, hertz(1.0))})()) == []
