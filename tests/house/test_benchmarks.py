import json

import numpy as np
import pytest
from softcradle.physics import State

from benchmarks import __main__ as command
from benchmarks import floor, steps
from benchmarks.report import against


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


def test_the_state_amid_a_collision_moves():
    chain, state = steps.amid(4)
    assert state.time == pytest.approx(steps.MIDDLE)
    assert state.velocity(chain).sum() == pytest.approx(1.0)
    assert not np.allclose(state.rate, State.at_start(chain, np.eye(1, 5)[0]).rate)


def test_the_floor_stands_beside_the_bare_powers():
    row = next(floor.rows((70,), rounds=2))
    assert set(row["powers"]) == set(floor.POWERS)
    assert min(row["powers"].values()) > 0.0
    assert row["over_best_power"] * min(row["powers"].values()) == pytest.approx(row["nanoseconds"])
    assert 57 <= row["bytes"] < 200  # law, mass, overlap, rate, force, flag at the least


def test_every_way_takes_the_same_power():
    base, exponent = np.array([0.01, 0.5]), np.array([0.1, 0.2])
    for take in floor.POWERS.values():
        result = np.empty(2)
        take(base, exponent, result)
        assert result == pytest.approx(base**exponent, rel=1e-15)
