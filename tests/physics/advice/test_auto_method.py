"""Method auto: the wanted error holds, the choice is said and fits the costs, and the costs are measured once."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from softcradle.physics import (
    METHODS,
    Chain,
    Contact,
    State,
    Trajectory,
    advance,
    draft_gear,
    hertz,
    hooke,
    one_on,
    power_law,
    simulate,
)
from softcradle.physics.advice import auto_method as auto
from softcradle.physics.advice import step_cost as cost
from softcradle.physics.advice.step_cost import Cost
from softcradle.physics.analysis.critical_speed import critical_speed
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.precision.cases import CASE_DEFINITIONS
from softcradle.scenes import load, names
from softcradle.scenes.catalogue import SceneError

ERRORS = tuple(10.0**-k for k in range(3, 10))
CASES = {definition.name: definition for definition in CASE_DEFINITIONS}
# what this machine would say is left out of most tests: the choice, and with it the digits, is to be the same everywhere
EVEN = {key: Cost(3e-8, 1e-8) if key[0] != "accurate" else Cost(3e-6, 1e-6) for key in cost.TIMED}


@pytest.fixture(autouse=True)
def even_costs(monkeypatch):
    monkeypatch.setattr(auto, "costs", lambda: EVEN)


@pytest.fixture(scope="module", params=list(CASES))
def case(request):
    return CASES[request.param].solve(by_reference=False)


@pytest.mark.parametrize("error", ERRORS)
def test_the_wanted_error_holds_on_every_case_of_the_chart(case, error):
    found = simulate(case.chain, case.velocity, case.duration, method="auto", tolerance=error, samples=2)
    assert case.error(found.final_velocity) <= 3.0 * error


def test_the_wanted_error_holds_at_every_tight_tolerance():
    """One on 5 bounces six times at the end: a run that nothing checks misses a bounce at one tolerance in some hundred."""
    case = CASES["one-on-5"].solve()
    for error in np.geomspace(5e-10, 5e-9, 60):
        found = simulate(case.chain, case.velocity, method="auto", tolerance=error, samples=2)
        assert case.error(found.final_velocity) <= 3.0 * error


@pytest.mark.parametrize("method", ["verlet", "yoshida4", "conserving", "accurate"])
@pytest.mark.parametrize("error", [1e-3, 1e-4, 1e-5])
def test_the_error_holds_whatever_is_cheapest(case, method, error):
    """Each candidate is made the cheapest: its own estimate of its error must hold, not that of the usual choice."""
    price = {key: Cost(1e-12 if key[0] == method else 1.0, 0.0) for key in cost.TIMED}
    choice = auto.choose(case.chain, case.velocity, case.run_duration, error, price)
    if choice.method != method or case.run_duration / (choice.step or 1.0) > 3e5:
        pytest.skip("no candidate here, or one of minutes")
    starts = case.starts([0.0, 0.4 * choice.step]) if choice.step else case.starts([0.0])
    for start in starts:
        fineness = {"step": choice.step} if choice.step else {"tolerance": choice.tolerance}
        found = simulate(start.chain, start.velocity, case.run_duration + start.early, method, samples=2, **fineness)
        assert case.error(found.final_velocity) <= 3.0 * error


@pytest.mark.parametrize(
    "contact", [power_law(1.0, 0.3), power_law(5.0, 0.7), hooke(2.0), hertz(50.0), power_law(1.0, 2.0)]
)
@pytest.mark.parametrize("n", [1, 3, 8])
@pytest.mark.parametrize("error", [1e-3, 1e-5, 1e-7])
def test_the_wanted_error_holds_on_chains_it_was_not_made_for(contact, n, error):
    chain = one_on(n, contact, mass=np.linspace(0.3, 2.0, n + 1))
    velocity = 3.0 * np.eye(1, n + 1)[0]
    duration = float(simulate(chain, velocity, tolerance=1e-6, samples=2).time[-1])
    duration = min(duration, 5.0 * auto.collision_time(chain, velocity))
    truth = simulate(chain, velocity, duration, method="radau", tolerance=1e-11).final_velocity
    found = simulate(chain, velocity, duration, method="auto", tolerance=error)
    assert np.abs(found.final_velocity - truth).max() / velocity[0] <= 3.0 * error


def test_the_choice_is_said_with_its_reason(case):
    found = simulate(case.chain, case.velocity, case.duration, method="auto", tolerance=1e-4, samples=2)
    assert found.method in {method.name for method in METHODS}
    assert found.choice.startswith(f"{found.method}, ")
    assert "wanted error of 0.0001" in found.choice
    assert "expected cost" in found.choice


def test_what_chatters_is_left_out_and_it_is_said_why():
    gear = one_on(3, draft_gear(1.0, 1.0))
    assert "verlet" not in {
        choice.method for choice in auto._candidates(gear, [1, 0, 0, 0], 9.0, 1e-3, EVEN, near=False)
    }
    assert "chatters" in auto.choose(gear, [1, 0, 0, 0], 9.0, 1e-3, EVEN).reason


@pytest.mark.parametrize(
    "chain",
    [
        Chain([math.inf, 1, 1], power_law(1.0, 0.1)),
        Chain([1, 1, 1], hertz(1.0), [0.1, 0.2]),
        Chain([1, 1, 1], hertz(1.0), drive=[1, 0, 0]),
    ],
)
def test_fixed_steps_are_left_out_where_collisions_follow_collisions(chain):
    found = list(auto._candidates(chain, [1.0, 0.5, 0.0], 3.0, 1e-3, EVEN, near=False))
    assert [choice.method for choice in found] == ["accurate"]
    assert "left out" in auto.choose(chain, [1.0, 0.5, 0.0], 3.0, 1e-3, EVEN).reason


DRY = (
    Chain([1.0] * 4, Contact(0.0, 1.0, 0.1, loss=0.3)),
    Chain([1.0] * 6, Contact(0.0, 1.0, 1.5, loss=0.5)),
    Chain([1.0] * 4, power_law(1.0, 0.1), friction=0.02),
    Chain([1.0] * 5, Contact(1.0, 1.0, 1.0, loss=0.8)),
)


@pytest.mark.parametrize("chain", DRY)
@pytest.mark.parametrize("error", [1e-2, 1e-3, 1e-4])
def test_where_something_rubs_it_is_conserving(chain, error):
    velocity, duration = np.eye(1, chain.contacts + 1)[0], 6.0
    found = simulate(chain, velocity, duration, method="auto", tolerance=error)
    truth = simulate(chain, velocity, duration, method="conserving", step=duration / 300_000, samples=2)
    assert found.method == "conserving"
    assert "with friction or loss" in found.choice
    assert np.abs(found.final_velocity - truth.final_velocity).max() <= 3.0 * error


@pytest.mark.parametrize("error", ERRORS)
@pytest.mark.parametrize("ratio", [0.95, 0.99, 1.014, 1.1])
def test_a_gear_that_yields_for_a_moment_is_not_taken_for_rigid(error, ratio):
    gear = draft_gear(1.0, 1.0)
    velocity = ratio * critical_speed(gear, np.ones(5), 1) * np.eye(1, 5)[0]
    truth = simulate(one_on(4, gear), velocity, 4.0, method="radau", tolerance=1e-11).final_velocity
    found = simulate(one_on(4, gear), velocity, 4.0, method="auto", tolerance=error)
    assert np.abs(found.final_velocity - truth).max() / velocity[0] <= 3.0 * error
    assert "critical speed" in found.choice


def test_near_a_critical_speed_is_said_of_what_is_near():
    gear = draft_gear(1.0, 1.0)
    critical = critical_speed(gear, np.ones(5), 1)
    near = [auto.nearly_yields(one_on(4, gear), ratio * critical * np.eye(1, 5)[0]) for ratio in (0.8, 0.95, 1.1, 1.3)]
    assert near == [False, True, True, False]
    assert not auto.nearly_yields(one_on(4, power_law(1.0, 0.1)), np.eye(1, 5)[0])
    assert not auto.nearly_yields(one_on(4, gear), np.zeros(5))


def test_what_no_method_holds_is_refused():
    with pytest.raises(ValueError, match="no method holds an error of 1e-10"):
        simulate(DRY[0], [1, 0, 0, 0], 6.0, method="auto", tolerance=1e-10)


def test_the_choice_follows_the_costs():
    chain, velocity = one_on(20, hertz(1.0)), np.eye(1, 21)[0]
    dear = {key: Cost(1.0, 1.0) if key[0] == "accurate" else Cost(1e-8, 1e-9) for key in cost.TIMED}
    cheap = {key: Cost(1e-9, 1e-9) if key[0] == "accurate" else Cost(1.0, 1.0) for key in cost.TIMED}
    slow = {**dear, ("yoshida4", cost.SMOOTH): Cost(3e-8, 3e-9)}  # it takes three forces a step
    assert auto.choose(chain, velocity, 50.0, 1e-2, slow).method == "verlet"
    assert auto.choose(chain, velocity, 50.0, 1e-6, dear).method == "yoshida4"
    assert auto.choose(chain, velocity, 50.0, 1e-3, cheap).method == "accurate"
    assert auto.choose(chain, velocity, None, 1e-3, dear).method == "accurate"
    assert "never see the end" in auto.choose(chain, velocity, None, 1e-3, dear).reason


def test_a_smaller_error_never_costs_less():
    for definition in CASE_DEFINITIONS:
        chain = definition.make_chain()
        velocity = np.eye(1, chain.contacts + 1)[0]
        prices = [auto.choose(chain, velocity, definition.duration, error, EVEN).seconds for error in ERRORS]
        assert prices == sorted(prices)


def test_a_saved_trajectory_keeps_its_choice(tmp_path):
    found = simulate(one_on(2, power_law(1.0, 0.1)), [1, 0, 0], method="auto", tolerance=1e-4)
    found.save(tmp_path / "x.npz")
    assert Trajectory.load(tmp_path / "x.npz").choice == found.choice != ""


def test_other_methods_have_no_choice_to_tell():
    assert simulate(one_on(2, power_law(1.0, 0.1)), [1, 0, 0]).choice == ""


@pytest.mark.parametrize(
    ("wish", "said"),
    [
        ({"step": 0.1}, "'auto' chooses its own steps"),
        ({"tolerance": 0.0}, "tolerance must be a finite number > 0"),
        ({"duration": -1.0}, "duration"),
    ],
)
def test_refusals(wish, said):
    with pytest.raises(ValueError, match=said):
        simulate(one_on(2, power_law(1.0, 0.1)), [1, 0, 0], method="auto", **wish)


def test_advance_wants_a_name():
    chain = one_on(2, power_law(1.0, 0.1))
    with pytest.raises(ValueError, match="'auto' is for simulate"):
        advance(chain, State.at_start(chain, [1, 0, 0]), 0.1, method="auto")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(cost, "cache_file", lambda: tmp_path / "deep" / "costs.json")
    cost.costs.cache_clear()
    yield tmp_path / "deep"
    cost.costs.cache_clear()


def test_costs_are_measured_once_and_kept(folder, monkeypatch):
    calls = []
    monkeypatch.setattr(cost, "measure", lambda: calls.append(1) or dict(EVEN))
    assert cost.costs() == EVEN
    cost.costs.cache_clear()  # another process
    assert cost.costs() == EVEN
    assert calls == [1]


@pytest.mark.parametrize("content", ["", "[]", "[1]", '{"a": 1}', '[["verlet", "soft", 1e-8, NaN]]', "[[1, 2, 3]]"])
def test_a_spoilt_file_is_measured_anew(folder, monkeypatch, content):
    folder.mkdir()
    (folder / "costs.json").write_text(content)
    monkeypatch.setattr(cost, "measure", lambda: dict(EVEN))
    assert cost.costs() == EVEN
    assert len(json.loads((folder / "costs.json").read_text())) == len(EVEN)


def test_a_folder_that_cannot_be_written_is_no_failure(monkeypatch):
    monkeypatch.setattr(cost, "cache_file", lambda: Path("/dev/null/costs.json"))
    monkeypatch.setattr(cost, "measure", lambda: dict(EVEN))
    cost.costs.cache_clear()
    assert cost.costs() == EVEN
    cost.costs.cache_clear()


def test_the_file_belongs_to_these_kernels(tmp_path, monkeypatch):
    before = cost.cache_file()
    (tmp_path / "law.py").write_text("changed = True\n")
    monkeypatch.setattr(cost, "kernel_sources", lambda: [tmp_path / "law.py"])
    assert cost.cache_file() != before
    assert cost.cache_file().parent == before.parent


def test_measured_costs_are_those_of_steps(monkeypatch):
    monkeypatch.setattr(cost, "ROUNDS", 2)
    found = cost.measure()
    assert set(found) == set(cost.TIMED)
    for price in found.values():
        assert 0.0 < price.of(1.0, 10) < 1.0


def test_run_and_scenes_take_it(capsys, tmp_path):
    assert main(["run", "one-on-four", "--method", "auto", "--tolerance", "1e-4"]) == 0
    assert "wanted error of 0.0001" in " ".join(capsys.readouterr().out.split())
    scene = tmp_path / "mine.toml"
    text = Path(load.__globals__["__file__"]).parent / "catalogue" / "one-on-four.toml"
    scene.write_text('method = "auto"\ntolerance = 1e-5\n' + text.read_text())
    assert main(["run", str(scene), "--json"]) == 0
    assert "wanted error of 1e-05" in json.loads(capsys.readouterr().out)["lanes"][0]["choice"]
    scene.write_text('method = "auto"\nstep = 1e-5\n' + text.read_text())
    with pytest.raises(SceneError, match="chooses its own steps"):
        load(str(scene))
    assert "one-on-four" in names()


def test_render_takes_it(tmp_path):
    assert main(["render", "one-on-four", "--method", "auto", "--size", "320x180", "-o", str(tmp_path / "x.png")]) == 0
    assert (tmp_path / "x.png").stat().st_size > 1000
