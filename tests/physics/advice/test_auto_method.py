"""Tests of the method auto. The error must stay within the tolerance. The result must contain the chosen method and the
reason for the choice.
"""

import json
import math

import numpy as np
import pytest
from softcradle.physics import METHODS, Chain, one_on, simulate
from softcradle.physics.advice import auto_method
from softcradle.physics.analysis.closed_forms import critical_speed
from softcradle.physics.contact import Contact, draft_gear, hertz, hooke, power_law
from softcradle.physics.scales import contact_scales
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.precision.cases import CASE_DEFINITIONS
from softcradle.scenes.catalogue import SceneError, parse, text_of

from tests.helpers.relations import struck

ERRORS, TIGHT = tuple(10.0**-k for k in range(3, 10)), np.geomspace(5e-10, 5e-9, 60)
CASES = {definition.name: definition for definition in CASE_DEFINITIONS}
SOFT, GEAR = power_law(1.0, 0.1), draft_gear(1.0, 1.0)
CRITICAL = critical_speed(GEAR, np.ones(5), 1)  # Critical speed [m/s] of one bead that hits four beads.


@pytest.mark.parametrize(("name", "errors"), [*((name, ERRORS) for name in CASES), ("one-on-5", TIGHT)])
def test_the_wanted_error_holds_on_every_case_of_the_chart(name, errors):
    """Check the error of each collision in the chart.

    If one bead hits five beads, there are six more bounces at the end of the motion. A run that is not confirmed misses
    a bounce at about one tolerance in a hundred.
    """
    case = CASES[name].solve(by_reference=errors is TIGHT)
    for error in errors:
        found = simulate(case.chain, case.velocity, case.duration, method="auto", tolerance=error, samples=2)
        assert case.error(found.final_velocity) <= 3.0 * error
        assert found.method in {method.name for method in METHODS}
        assert found.choice.startswith(f"{found.method}, ")
        assert f"wanted error of {error:g}" in found.choice


NOT_MADE_FOR = (  # Each entry contains a chain, a speed [m/s] and a duration [s].
    *(
        (one_on(n, contact, mass=np.linspace(0.3, 2.0, n + 1)), 3.0, None)
        for contact in (power_law(1, 0.3), power_law(5, 0.7), hooke(2), hertz(50), power_law(1, 2))
        for n in (1, 3, 8)
    ),
    (Chain([1.0] * 4, Contact(0.0, 1.0, 0.1, loss=0.3)), 1.0, 6.0),
    (Chain([1.0] * 6, Contact(0.0, 1.0, 1.5, loss=0.5)), 1.0, 6.0),
    (Chain([1.0] * 4, power_law(1.0, 0.1), friction=0.02), 1.0, 6.0),
    (Chain([1.0] * 5, Contact(1.0, 1.0, 1.0, loss=0.8)), 1.0, 6.0),
    *((one_on(4, GEAR), ratio * CRITICAL, 4.0) for ratio in (0.95, 0.99, 1.014, 1.1)),
)


@pytest.mark.parametrize(("chain", "speed", "duration"), NOT_MADE_FOR)
def test_the_wanted_error_holds_on_chains_it_was_not_made_for(chain, speed, duration):
    velocity = speed * struck(chain)
    duration = duration or min(
        float(simulate(chain, velocity, tolerance=1e-6, samples=2).time[-1]),
        30.0 * float(contact_scales(chain, velocity)[1].min()),
    )
    truth = simulate(chain, velocity, duration, method="radau", tolerance=1e-11)
    assert truth.choice == ""
    for error in (1e-2, *ERRORS):
        found = simulate(chain, velocity, duration, method="auto", tolerance=error)
        assert np.abs(found.final_velocity - truth.final_velocity).max() / speed <= 3.0 * error


@pytest.mark.parametrize(
    ("chain", "duration", "error", "method", "reason"),
    [
        (one_on(3, SOFT), 9.0, 1e-3, "conserving", "exact at any step"),
        (one_on(3, SOFT), 9.0, 1e-4, "accurate", "fewer than fixed ones"),
        (one_on(3, SOFT), None, 1e-3, "accurate", "may never see the end"),
        (one_on(3, hertz(1.0)), 9.0, 1e-2, "conserving", "exact at any step"),
        (one_on(3, GEAR), 9.0, 1e-6, "radau", "contacts with preload touch"),
        *(
            (one_on(4, GEAR, mass=(2.0 * ratio * CRITICAL) ** 2), 9.0, 1e-3, method, reason)
            for ratio, method, reason in (
                (0.91, "radau", "critical speed"), (1.14, "radau", "critical speed"),
                (0.89, "conserving", "exact at any step"), (1.16, "conserving", "exact at any step"),
            )
        ),
        (Chain([1, 1, 1e-5, 1], SOFT), 6.0, 1e-2, "accurate", "far more fixed steps"),
        (Chain([5e5, 2e5, 1.6, 5e-6, 0.36], [hertz(9.0), hertz(0.2), SOFT, hertz(80.0)]), 6.0, 1e-3, "accurate", "far more"),
        (Chain([1, 1, 1e-4, 1], hertz(100.0)), 6.0, 1e-3, "accurate", "far more fixed steps"),
        # The beads fly freely, which hardly takes computing time.
        (Chain([1, 1, 0.2, 1], hertz(100.0)), 1e6, 1e-3, "conserving", "exact at any step"),
        # The draft gear never yields in this motion.
        (Chain([1] * 4, [SOFT, draft_gear(1e6, 1.0), SOFT]), 9.0, 1e-3, "conserving", "exact at any step"),
        (Chain([math.inf, 1, 1], SOFT), 3.0, 1e-3, "accurate", "collision after collision"),
        (Chain([1, 1, 1], hertz(1.0), [0.1, 0.2]), 3.0, 1e-3, "accurate", "collision after collision"),
        (Chain([1, 1, 1], hertz(1.0), drive=[1, 0, 0]), 3.0, 1e-3, "accurate", "collision after collision"),
    ],
)  # fmt: skip
def test_the_choice_follows_chain_duration_and_error(chain, duration, error, method, reason):
    choice = auto_method.choose(chain, 0.5 * struck(chain), duration, error)
    assert choice.method == method
    assert (choice.step > 0.0) == (method == "conserving")
    assert choice.reason.startswith(f"{method}, ")
    assert reason in choice.reason


def test_a_scene_is_computed_by_it(capsys, tmp_path):
    scene, picture, text = tmp_path / "mine.toml", tmp_path / "x.png", text_of("one-on-four")
    scene.write_text('method = "auto"\ntolerance = 1e-5\n' + text)
    assert main(["run", str(scene), "--json"]) == 0
    assert "wanted error of 1e-05" in json.loads(capsys.readouterr().out)["lanes"][0]["choice"]
    assert main(["run", "one-on-four", "--method", "auto", "--tolerance", "1e-4"]) == 0
    assert "wanted error of 0.0001" in " ".join(capsys.readouterr().out.split())
    assert main(["render", str(scene), "--size", "320x180", "-o", str(picture)]) == 0
    assert picture.stat().st_size > 1000
    with pytest.raises(SceneError, match="chooses its own steps"):
        parse('method = "auto"\nstep = 1e-5\n' + text)
