import json
import os
from importlib.util import find_spec

import numpy as np
import pytest
from rich.console import Console

from benchmarks import __main__ as command
from benchmarks import steps
from benchmarks.cases import RECIPES
from benchmarks.precision import Point, fastest, least, measure, scan, table
from benchmarks.report import against
from benchmarks.solvers import Solver, ours
from physics import Chain, State, hertz, power_law, simulate
from physics.closed_forms import critical_speed


@pytest.fixture(scope="module")
def case():
    return RECIPES[0].cook()


def settings(case, name, *finenesses):
    solver = next(solver for solver in ours(case) if solver.name == name)
    return Solver(name, "", finenesses, solver.run, True)


def test_every_case_meets_with_unit_speed_and_unit_masses():
    for recipe in RECIPES:
        assert set(recipe.build().mass) == {1.0}


def test_the_gears_meet_at_three_times_their_critical_speed():
    chain = RECIPES[-1].build()
    assert critical_speed(chain.contact[0], chain.mass, 1) == pytest.approx(1.0 / 3.0, rel=1e-14)


def test_a_case_knows_its_truth(case):
    assert case.doubt == 0.0
    assert case.error(case.truth) == 0.0
    assert case.error(case.truth + np.array([0, 0, 1e-3, 0, 0])) == pytest.approx(1e-3)
    assert case.error(np.full(5, np.nan)) == np.inf


@pytest.mark.parametrize("recipe", RECIPES[1:4], ids=lambda recipe: recipe.name)
def test_two_ways_to_a_truth_that_is_not_known_agree(recipe):
    cooked = recipe.cook()
    assert 0.0 < cooked.doubt < 1e-10


def test_a_lucky_hit_does_not_count(case):
    solver = settings(case, "accurate", 1e-3)
    errors = (1e-7, 1e-2, 1e-6, 1e-8)
    points = [Point(solver, 10.0**-k, error, 1e-3 * (k + 1)) for k, error in enumerate(errors)]
    assert fastest([points], 1e-6) is points[2]
    assert fastest([points], 1e-9) is None


def test_a_scan_ends_when_two_settings_are_fine_enough(case):
    points = scan(case, settings(case, "accurate", 1e-3, 1e-11, 1e-12, 1e-13))
    assert [point.fineness for point in points] == [1e-3, 1e-11, 1e-12]
    assert points[0].error > points[1].error


def test_the_table_of_a_case(case):
    found = measure(case, [settings(case, "accurate", 1e-5, 1e-7), settings(case, "conserving", 60, 120)], rounds=1)
    assert [row["name"] for row in found] == ["accurate", "conserving"]
    assert found[0]["best"][1]["error"] <= 1e-6
    assert found[0]["best"][2] is None
    assert least(found, True, 1) == found[0]["best"][1]["milliseconds"] > 0.0
    report = table(case, found, rounds=1)
    assert report.rows[0][3] == "- (0.7) missed"
    assert json.loads(json.dumps(report.data))["case"] == case.name
    report.show(Console(quiet=True))


def test_values_stand_beside_their_aims():
    assert against(0.5, None) == "0.5"
    assert against(0.5, 1.0) == "0.5 (1)"
    assert against(2.0, 1.0) == "2 (1) missed"


@pytest.mark.parametrize("alike", [True, False])
@pytest.mark.parametrize("method", ["verlet", "conserving"])
def test_cost_of_a_step_is_taken_with_all_contacts_closed(method, alike):
    found = steps.nanoseconds(method, 1e-4, 4, alike, work=40, rounds=1)
    assert found["closed"] == 4
    assert found["steps"] == 10
    assert found["nanoseconds"] > 0.0


def test_the_command_writes_what_it_shows(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(steps, "CASES", (("verlet", 1e-4, 4, True, 20.0),))
    monkeypatch.setattr(steps, "WORK", 40)
    assert command.main(["steps", "--json", str(tmp_path / "deep" / "bench.json")]) == 0
    assert "Cost of a step" in capsys.readouterr().out
    content = json.loads((tmp_path / "deep" / "bench.json").read_text())
    assert [row["method"] for row in content["steps"][0]] == ["verlet"]
    assert content["versions"]["numpy"] == np.__version__
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["bench.json"]


def test_an_unknown_part_is_refused(capsys):
    with pytest.raises(SystemExit) as refusal:
        command.main(["nonsense"])
    assert refusal.value.code == 2
    assert "nonsense" in capsys.readouterr().err


needs_numba = pytest.mark.skipif(
    find_spec("numba") is None or os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="peers need compiled code"
)


@needs_numba
def test_the_right_hand_side_of_the_peers_is_that_of_the_chain():
    from benchmarks import peers

    chain = Chain([1.0, 2.0, 0.5, np.inf], [power_law(1.0, 0.1), hertz(2.0), power_law(3.0, 1.0)])
    overlap, rate = np.array([0.1, -0.2, 0.3]), np.array([1.0, 2.0, 3.0])
    law, inverse_mass = chain.parameters
    out = np.empty(6)
    peers.slopes(np.concatenate((overlap, rate)), out, np.concatenate(([3], law.ravel(), inverse_mass)))
    force = [contact.force(d) for contact, d in zip(chain.contact, overlap, strict=True)]
    acceleration = -np.diff(np.concatenate(([0.0], force, [0.0]))) * inverse_mass
    assert out[:3] == pytest.approx(rate)
    assert out[3:] == pytest.approx(-np.diff(acceleration), rel=1e-14)


@needs_numba
def test_verlet_by_hand_is_verlet(case):
    from benchmarks import peers

    steps_taken = 500
    found, _ = peers.verlet_by_hand(case).run(steps_taken)
    duration = 1.001 * case.end
    same = simulate(case.chain, case.velocity, duration, method="verlet", step=duration / steps_taken, samples=2)
    assert found == pytest.approx(same.final_velocity, abs=1e-12)


@needs_numba
@pytest.mark.parametrize("name", ["numbalsoda", "heyoka"])  # CyRK compiles for half a minute: `make bench` does
def test_an_installed_peer_reaches_the_truth(case, name):
    pytest.importorskip(name)
    from benchmarks import peers

    solver = getattr(peers, name.lower())(case)[-1]
    velocity, seconds = solver.run(1e-10)
    assert case.error(velocity) < 1e-3
    assert seconds > 0.0


def test_the_state_amid_a_collision_moves():
    chain, state = steps.amid(4)
    assert state.time == pytest.approx(steps.MIDDLE)
    assert state.velocity(chain).sum() == pytest.approx(1.0)
    assert not np.allclose(state.rate, State.at_start(chain, np.eye(1, 5)[0]).rate)
