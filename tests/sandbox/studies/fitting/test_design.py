"""Tests of the function `design`, which chooses parameters of a chain for a given goal.

The tests check known optima, the comparison with uniform values, given target values with their errors, and the
command.
"""

import json
import math

import numpy as np
import pytest
from softcradle.physics.analysis.closed_forms import one_on_one
from softcradle.sandbox.studies.fitting.design_scene import design
from softcradle.sandbox.studies.fitting.goals import SAMPLES, goals_of, peak_forces
from softcradle.sandbox.sweeps.measure_table import Run
from softcradle.sandbox.sweeps.scene_points import LaneStart
from softcradle.sandbox.user_error import StudyError

from softcradle import Chain, draft_gear, hertz, hooke, power_law, scenes, simulate
from tests.helpers.paths import ROOT


def scene_of(chain, velocity, **settings):
    return scenes.Scene(title="a test", lanes=[scenes.Lane.of(chain, velocity)], **settings)


@pytest.mark.parametrize("law", [hooke(100.0), hertz(500.0, loss=0.3), power_law(3.0, 0.2), draft_gear(200.0, 0.01)])
def test_peak_forces_are_those_of_the_closed_form(law):
    exact = one_on_one(law, 0.5, 1.0).peak_force
    chain = Chain([1.0, 1.0], law, gap=0.3)
    found = peak_forces(Run(LaneStart(chain, [1.0, 0.0], {})))
    assert found[0] == pytest.approx(exact, rel=1e-5)
    assert SAMPLES < 1000


def test_the_best_mass_between_two_is_their_geometric_mean():
    scene = scene_of(Chain([4.0, 2.5, 1.0], hertz(1e4), gap=[0.0, 1.0]), [1.0, 0.0, 0.0])
    found = design(scene, "most momentum of bead 2", ["lanes.0.mass[1]=0.5..5"])
    assert found.values[0] == pytest.approx(2.0, rel=1e-3)
    best = 1.0 * (2 * 4 / 6) * (2 * 2 / 3)  # Exact velocity after two elastic collisions.
    assert found.reached[0] == pytest.approx(best, rel=1e-6)
    assert found.reached[0] > found.before[0]
    again = design(scene, "momentum of bead 2", ["lanes.0.mass[1]=0.5..5"])
    assert again.goals[0].text == "most momentum of bead 2"
    assert again.values == pytest.approx(found.values, rel=1e-12)


def test_separate_values_are_better_than_uniform_ones():
    """Check the design of two masses between a bead of mass 8 and a bead of mass 1.

    The optimal masses are 4 and 2. Two equal masses of sqrt(8) transfer less momentum.
    """
    scene = scene_of(Chain([8.0, 3.0, 3.0, 1.0], hertz(1e4), gap=0.2), [1.0, 0.0, 0.0, 0.0])
    free = ["lanes.0.mass[1]=0.5..10", "lanes.0.mass[2]=0.5..10"]
    assert math.isnan(design(scene, "most velocity of bead 3", free).uniform)
    inner = scene_of(Chain([8.0, 3.0, 3.0, 1.0], hertz(1e4), gap=0.2), [1.0, 0.0, 0.0, 0.0])
    found = design(inner, "most velocity of bead 3", free)
    assert found.values == pytest.approx([4.0, 2.0], rel=2e-2)
    assert found.reached[0] == pytest.approx((4 / 3) ** 3, rel=1e-4)
    uniform = design(scene, "least peak force of contact 2", ["lanes.0.contact[:].stiffness=1e3..1e5"])
    assert uniform.factor >= 1.0
    assert uniform.uniform >= uniform.reached[0]
    assert "the design is better by a factor" in " ".join(uniform.statements)


def test_a_stated_value_is_reached_with_the_error_of_its_range():
    """Fit the loss of one contact to a given velocity of the bead that is hit.

    For equal masses, the velocity is v = (1 + sqrt(1 - loss)) / 2.
    """
    scene = scene_of(Chain([1.0, 1.0], hertz(100.0, loss=0.1)), [1.0, 0.0])
    found = design(scene, "velocity of bead 1 = 0.9", ["lanes.0.contact.loss"])
    assert found.values[0] == pytest.approx(1.0 - 0.8**2, rel=1e-6)
    assert math.isnan(found.errors[0])
    found = design(scene, "velocity of bead 1 = 0.88..0.92", ["lanes.0.contact.loss"])
    # The error of the loss follows from the derivative |d loss / d v| = 4 sqrt(1 - loss).
    assert found.errors[0] == pytest.approx(4.0 * 0.8 * 0.02, rel=1e-3)
    assert found.scene.lanes[0].contact.loss == found.values[0]
    far = design(scene, "velocity of bead 1 = 2", ["lanes.0.contact.loss"])
    assert far.statements[0].endswith("not reached")


def test_goals_are_read_from_words():
    lanes = scene_of(Chain([1.0, 1.0, 1.0], hooke(1.0)), [1.0, 0.0, 0.0]).lanes
    (goal,) = goals_of(["Missing  momentum = 5..10 %"], lanes)
    assert (goal.measure, goal.target, goal.error) == ("missing_momentum", pytest.approx(0.075), pytest.approx(0.025))
    (goal,) = goals_of(["lane 0 least contact_peak_force of contact 1"], lanes)
    assert (goal.sense, goal.index) == ("least", 1)
    with pytest.raises(StudyError, match="only goals with a stated value"):
        goals_of(["least peak force", "momentum of bead 2"], lanes)
    with pytest.raises(StudyError, match="lane 3 does not exist"):
        goals_of(["lane 3 least peak force"], lanes)
    with pytest.raises(StudyError, match=r"must be a number or a range"):
        goals_of(["momentum of bead 2 = much"], lanes)


def test_the_command_writes_a_scene_and_a_page(softcradle, tmp_path):
    outputs = [tmp_path / f"found.{suffix}" for suffix in ("toml", "html", "json")]
    words = [word for path in outputs for word in ("-o", str(path))]
    free = "lanes.0.contact.alpha=0.05..1"
    shown = softcradle("fit", "one-on-four", "--goal", "least velocity of bead 4", "--free", free, *words).out
    assert "least velocity of bead 4: 0.4" in shown
    numbers = json.loads(outputs[2].read_text(encoding="utf-8"))
    alpha = numbers["values"]["lanes.0.contact.alpha"]["value"]
    found = scenes.load(str(outputs[0]))
    assert found.lanes[0].contact.alpha == pytest.approx(alpha, rel=1e-5)
    run = simulate(found.lanes[0].chain(), found.lanes[0].velocity)
    assert run.final_velocity[4] == pytest.approx(numbers["goals"][0]["reached"], rel=1e-6)
    assert outputs[1].read_text(encoding="utf-8").startswith("<!")


@pytest.mark.slow
def test_an_absorber_of_six_buffers_is_better_than_uniform_ones():
    scene = scenes.load(str(ROOT / "examples" / "absorber.toml"))
    found = design(scene, "least peak force", ["lanes.0.contact[:].push.stiffness=300..30000"])
    assert found.factor > 1.15
    assert found.before[0] / found.reached[0] > 3.0
    run = simulate(found.scene.lanes[0].chain(), found.scene.lanes[0].velocity)
    assert float(np.max(run.hits()["largest_force"])) == pytest.approx(found.reached[0], rel=1e-3)
