"""Method auto: the wanted error holds, and the choice is said with its reason."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from softcradle.physics import METHODS, Chain, one_on, simulate
from softcradle.physics.advice import auto_method as auto
from softcradle.physics.analysis.closed_forms import critical_speed
from softcradle.physics.contact import Contact, draft_gear, hertz, hooke, power_law
from softcradle.physics.scales import contact_scales
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.precision.cases import CASE_DEFINITIONS
from softcradle.scenes import load, names
from softcradle.scenes.catalogue import SceneError

from tests.helpers.relations import struck

ERRORS = tuple(10.0**-k for k in range(3, 10))
CASES = {definition.name: definition for definition in CASE_DEFINITIONS}


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


NOT_MADE_FOR = (
    *(
        one_on(n, contact, mass=np.linspace(0.3, 2.0, n + 1))
        for contact in (power_law(1, 0.3), power_law(5, 0.7), hooke(2), hertz(50), power_law(1, 2))
        for n in (1, 3, 8)
    ),
    Chain([1.0] * 4, Contact(0.0, 1.0, 0.1, loss=0.3)),
    Chain([1.0] * 6, Contact(0.0, 1.0, 1.5, loss=0.5)),
    Chain([1.0] * 4, power_law(1.0, 0.1), friction=0.02),
    Chain([1.0] * 5, Contact(1.0, 1.0, 1.0, loss=0.8)),
)


@pytest.mark.parametrize("chain", NOT_MADE_FOR)
def test_the_wanted_error_holds_on_chains_it_was_not_made_for(chain):
    speed, duration = (1.0, 6.0) if chain.dissipative else (3.0, None)
    velocity = speed * struck(chain)
    duration = duration or min(
        float(simulate(chain, velocity, tolerance=1e-6, samples=2).time[-1]),
        30.0 * float(contact_scales(chain, velocity)[1].min()),
    )
    truth = simulate(chain, velocity, duration, method="radau", tolerance=1e-11).final_velocity
    for error in (1e-2, 1e-3, 1e-4, 1e-5, 1e-7):
        found = simulate(chain, velocity, duration, method="auto", tolerance=error)
        assert np.abs(found.final_velocity - truth).max() / speed <= 3.0 * error


def test_the_choice_is_said_with_its_reason(case):
    found = simulate(case.chain, case.velocity, case.duration, method="auto", tolerance=1e-4, samples=2)
    assert found.method in {method.name for method in METHODS}
    assert found.choice.startswith(f"{found.method}, ")
    assert "wanted error of 0.0001" in found.choice


@pytest.mark.parametrize(
    "chain",
    [
        Chain([math.inf, 1, 1], power_law(1.0, 0.1)),
        Chain([1, 1, 1], hertz(1.0), [0.1, 0.2]),
        Chain([1, 1, 1], hertz(1.0), drive=[1, 0, 0]),
    ],
)
def test_fixed_steps_are_left_out_where_collisions_follow_collisions(chain):
    choice = auto.choose(chain, [1.0, 0.5, 0.0], 3.0, 1e-3)
    assert choice.method == "accurate"
    assert "collision after collision" in choice.reason


@pytest.mark.parametrize(
    ("contact", "duration", "error", "method"),
    [
        (power_law(1.0, 0.1), 9.0, 1e-3, "conserving"),
        (power_law(1.0, 0.1), 9.0, 1e-4, "accurate"),
        (power_law(1.0, 0.1), None, 1e-3, "accurate"),
        (hertz(1.0), 9.0, 1e-2, "conserving"),
        (draft_gear(1.0, 1.0), 9.0, 1e-6, "radau"),
    ],
)
def test_the_choice_follows_chain_duration_and_error(contact, duration, error, method):
    choice = auto.choose(one_on(3, contact), [0.5, 0, 0, 0], duration, error)
    assert choice.method == method
    assert (choice.step > 0.0) == (method == "conserving")
    assert choice.reason.startswith(f"{method}, ")


@pytest.mark.parametrize("ratio", [0.95, 0.99, 1.014, 1.1])
def test_a_gear_that_yields_for_a_moment_is_not_taken_for_rigid(ratio):
    gear = draft_gear(1.0, 1.0)
    velocity = ratio * critical_speed(gear, np.ones(5), 1) * np.eye(1, 5)[0]
    truth = simulate(one_on(4, gear), velocity, 4.0, method="radau", tolerance=1e-11).final_velocity
    for error in ERRORS:
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


def test_other_methods_have_no_choice_to_tell():
    assert simulate(one_on(2, power_law(1.0, 0.1)), [1, 0, 0]).choice == ""


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
