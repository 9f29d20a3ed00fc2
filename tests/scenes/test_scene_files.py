"""Tests of scene files, including scenes with couplers. The scenes must agree with their descriptions. A file that is
read and written again must be equal, and invalid files must be rejected.
"""

import math
import pickle
import tomllib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from softcradle.physics import Chain, Contact, Coupler, hooke, power_law, simulate
from softcradle.physics.analysis.closed_forms import rigid_stroke
from softcradle.physics.simulation import MOST_SAMPLED
from softcradle.scenes import Lane, Scene, SceneError, View
from softcradle.scenes.contact_kinds import KINDS
from softcradle.scenes.contact_table import table_of
from softcradle.scenes.scene_schema import MOST_BEADS

from softcradle import scenes
from tests.helpers.relations import FIXED_STEP, simulate_quietly

# Final velocities [m/s] of quadruple-precision solutions.
TRUE_OUTCOMES = {
    "one-on-four": (-0.567586, 0.173921, 0.454079, 0.469784, 0.469802),
    "one-on-four-softer": (-0.597544, 0.338743, 0.419348, 0.419727, 0.419727),
    "two-on-two": (-0.001129, 0.001131, 0.998869, 1.001129),
    "hooke-cradle": (-0.132279, -0.075329, -0.031011, 0.296218, 0.942402),
    "hooke-interface": (-0.599956, 0.392027, 0.401142, 0.403393, 0.403395),
}


def final_velocities(name: str) -> list[np.ndarray]:
    """Return the final velocities of every lane. In the scene `mixed`, the final velocities are determined only to
    1e-4, so the runs warn.
    """
    found = [simulate_quietly(lane.chain(), lane.velocity) for lane in scenes.load(name).lanes]
    assert name == "mixed" or not any(run.warnings for run in found)
    return [run.final_velocity for run in found]


@pytest.mark.parametrize("name", scenes.names())
def test_every_scene_is_written_back_equal(name, tmp_path):
    scene = scenes.load(name)
    # Some editors write a byte order mark at the beginning of a file.
    (tmp_path / "own.toml").write_text(scene.to_toml(), encoding="utf-8-sig")
    assert scenes.load(tmp_path / "own.toml") == scene
    assert scenes.text_of(tmp_path / "own.toml") == scene.to_toml()
    assert scene.title
    assert scene.source
    # The trains stop and reverse dozens of times. Methods of fixed steps are faster for such motions.
    assert scene.method is None or name.startswith("train-")
    endless = any(lane.chain().walls or lane.drive or lane.strings for lane in scene.lanes) or name.startswith("train-")
    assert endless == (scene.duration is not None)
    assert all(lane.label for lane in scene.lanes)


def test_scene_errors_can_be_pickled():
    with pytest.raises(SceneError) as refused:
        scenes.parse('title = "x"\nlanes = 1\nduration = 0.0\n')
    again = pickle.loads(pickle.dumps(refused.value))
    assert str(again) == str(refused.value)
    assert again.problems == refused.value.problems
    assert len(again.problems) == 2


@pytest.mark.parametrize(("name", "outcome"), TRUE_OUTCOMES.items())
def test_scene_is_the_case_whose_true_outcome_is_known(name, outcome):
    (velocity,) = final_velocities(name)
    np.testing.assert_allclose(velocity, outcome, atol=3e-3)


def test_texts_agree_with_the_motions():
    three_on_five, mixed = final_velocities("three-on-five")[0], final_velocities("mixed")[0]
    assert (three_on_five[:3] < -0.2).all()
    assert (three_on_five[3:] > 0.7).all()
    assert np.ptp(mixed[1:]) / mixed[1:].mean() < 0.03  # The description of the scene contains "almost as one body".
    four_on_one, one_on_four = final_velocities("galilean")
    np.testing.assert_allclose(four_on_one, 1.0 - one_on_four[::-1], atol=1e-9)
    # The description of the scene contains "one and a half times as fast as the four came".
    assert four_on_one[-1] > 1.5
    assert (four_on_one[:4] > 0.5).all()
    rigid, usual = final_velocities("locked-pistons")
    assert rigid[1:] == pytest.approx(0.25, abs=2e-3)
    assert np.ptp(rigid[1:]) < 1e-9
    assert usual[3] > 0.98 * 0.5  # The description of the scene contains "almost all the speed".
    assert np.abs(usual[:3]).max() < 0.12 * 0.5
    for name, strikers in (("draft-gear-one-on-three", 1), ("draft-gear-two-on-two", 2)):
        (gears,) = final_velocities(name)
        assert np.ptp(gears[strikers:]) < 1e-9  # The speed is too low for the inner springs to yield.


def test_beads_touch_as_long_as_the_gears_beside_them():
    beads, gear = scenes.load("beads-against-gear").lanes
    assert (beads.chain().mass, beads.velocity) == (gear.chain().mass, gear.velocity)
    (closed, opened), *_ = simulate(beads.chain(), beads.velocity).contact_intervals[0]
    expected = rigid_stroke(gear.chain().contact[0], gear.chain().mass, 1, gear.velocity[0]).contact_time
    assert opened - closed == pytest.approx(expected, rel=0.01)


def lane(text: str) -> Lane:
    return scenes.parse(f'title = "t"\n[[lanes]]\n{text}').lanes[0]


def test_short_forms_mean_what_they_stand_for():
    soft = 'contact = {law = "power_law", f0 = 2, alpha = "1/14"}'
    short = lane(f"beads = [2, 3]\nvelocity = 0.5\napproach = 0.25\n{soft}")
    assert short.velocity == (0.5, 0.5, 0.0, 0.0, 0.0)
    assert short.chain().mass == (1.0,) * 5
    assert short.chain().gap == (0.0, 0.25, 0.0, 0.0)
    assert short.chain().contact == (power_law(2.0, 1 / 14),) * 4
    wall = lane('mass = [inf, 1, 2]\nvelocity = [0, -1, 0]\ngap = [1, 0.5]\ncontact = {law = "hooke", stiffness = 3}')
    assert wall.chain() == Chain([math.inf, 1.0, 2.0], hooke(3.0), [1.0, 0.5])
    with pytest.raises(ValueError, match="mass"):
        # A mass of None means a wall only in JSON files.
        Lane(mass=(None, 1.0), velocity=(0.0, 1.0), contact={"law": "hertz", "stiffness": 1.0})


def test_overrides_replace_what_the_scene_says():
    scene = scenes.load("one-on-four").model_copy(update={"method": "verlet", "step": 0.01, "duration": 3.0})
    assert scene.settings() == {"duration": 3.0, "method": "verlet", "step": 0.01}
    assert scene.settings(step=0.5, method=None) == {"duration": 3.0, "method": "verlet", "step": 0.5}
    assert scene.settings(method="euler") == {"duration": 3.0, "method": "euler"}
    assert scenes.load("one-on-four").settings() == {}
    rough = scenes.load("one-on-four").model_copy(update={"tolerance": 1e-4})
    assert rough.settings(method="accurate") == {"method": "accurate", "tolerance": 1e-4}
    # The window uses the method `conserving` for a scene with a step.
    stepped = scenes.load("one-on-four").model_copy(update={"step": 0.01})
    assert stepped.settings() == {"method": "conserving", "step": 0.01}
    assert stepped.settings(method="accurate") == {"method": "accurate"}
    pulling = scenes.parse(TRAIN.replace('method = "conserving"', "").replace("exponent = 1.7", "exponent = 0.7"))
    assert pulling.settings() == {"duration": 1.0, "method": "conserving"}  # The method `accurate` rejects this chain.
    # A lane with the largest number of beads accepts as many samples as `run` takes.
    assert MOST_SAMPLED >= 1001 * MOST_BEADS


POSITIVE = st.floats(min_value=1e-6, max_value=1e6)
EXPONENT = st.floats(min_value=1e-6, max_value=10.0)
NOT_NEGATIVE = st.just(0.0) | POSITIVE
SPEED = st.floats(-1e3, 1e3).map(lambda speed: round(speed, 9))
NUMBERS = {
    "f0": POSITIVE, "alpha": EXPONENT | st.just("1/14"), "stiffness": POSITIVE, "precompression": NOT_NEGATIVE,
    "preload": NOT_NEGATIVE, "exponent": EXPONENT,
}  # fmt: skip
CONTACT = st.sampled_from(KINDS).flatmap(
    lambda kind: st.fixed_dictionaries({"law": st.just(kind.law), **{name: NUMBERS[name] for name in kind.numbers}})
)


@st.composite
def lanes(draw: st.DrawFn) -> Lane:
    strikers, targets = draw(st.integers(1, 3)), draw(st.integers(1, 3))
    n = strikers + targets

    def one_or_many(item: st.SearchStrategy[object], count: int) -> st.SearchStrategy[object]:
        return item | st.lists(item, min_size=count, max_size=count)

    masses = one_or_many(POSITIVE, n) | st.lists(POSITIVE, min_size=n - 1, max_size=n - 1).map(lambda m: [math.inf, *m])
    table = {"label": draw(st.text()), "mass": draw(masses), "contact": draw(one_or_many(CONTACT, n - 1))}
    if draw(st.booleans()):
        table |= {"beads": [strikers, targets], "approach": draw(st.none() | NOT_NEGATIVE), "velocity": draw(SPEED)}
    else:
        velocity = draw(st.lists(SPEED, min_size=n, max_size=n))
        table |= {"gap": draw(one_or_many(NOT_NEGATIVE, n - 1)), "velocity": velocity}
    return Lane.model_validate(table)


FINENESS = st.fixed_dictionaries(
    {"step": st.none() | POSITIVE, "tolerance": st.none() | POSITIVE}
) | st.fixed_dictionaries(
    {"step": st.none() | POSITIVE, "method": st.sampled_from([method.name for method in FIXED_STEP])}
)
SCENES = st.builds(
    lambda fineness, **rest: Scene(**fineness, **rest),
    title=st.text(min_size=1).filter(str.strip), text=st.text(), source=st.text(),
    lanes=st.lists(lanes(), min_size=1, max_size=3).map(tuple),
    duration=st.none() | POSITIVE, fineness=FINENESS,
    view=st.builds(
        View, slow=POSITIVE, length=POSITIVE, magnify=st.none() | st.floats(1.0, 1e9),
        after=st.none() | NOT_NEGATIVE, labels=st.booleans(),
    ),
)  # fmt: skip


@given(SCENES)
@settings(max_examples=150, deadline=None)
def test_any_scene_is_written_back_equal(scene):
    for again in scenes.parse(scene.to_toml()), Scene.model_validate_json(scene.model_dump_json()):
        assert again == scene
        assert [lane.chain() for lane in again.lanes] == [lane.chain() for lane in scene.lanes]


ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=4) | st.just("1/3"),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["law", "f0", "slow"]), inner),
    max_leaves=5,
)


@given(data=st.data())
@settings(max_examples=300, deadline=None)
def test_any_file_is_a_scene_or_a_refusal(data):
    """Set one key of a valid scene to any value. The parser must accept the scene or raise a SceneError. Other
    exceptions are not allowed.
    """
    import tomli_w

    table = tomllib.loads(scenes.text_of("beads-against-gear"))
    place = data.draw(st.sampled_from([table, table["lanes"][0], table["lanes"][1]["contact"], table["view"]]))
    keys = [*place, "mass", "beads", "gap", "approach", "duration", "method", "step", "law"]
    place[data.draw(st.sampled_from(keys))] = data.draw(ANYTHING.filter(lambda value: value is not None))
    try:
        text = tomli_w.dumps(table)
    except TypeError:  # TOML cannot represent the value null.
        return
    problems = ()
    try:
        scenes.parse(text, "any.toml")
    except SceneError as error:
        problems = error.problems
    assert all(problem.startswith("any.toml: ") and "\n" not in problem for problem in problems)


TRAIN = """
title = "Train"
duration = 1.0
method = "conserving"
[[lanes]]
beads = 3
mass = 8e4
velocity = [0.0, 0.0, 1.0]
gap = 0.01
[lanes.contact]
law = "coupler"
push = {law = "preloaded", preload = 250e3, stiffness = 3.75e7, exponent = 1.7, loss = 0.8}
pull = {law = "hooke", stiffness = 1e7}
slack = 0.02
travel = 0.166
stop = 1e8
"""
COUPLER = Coupler(Contact(250e3, 3.75e7, 1.7, 0.8), Contact(0.0, 1e7, 1.0), 0.02, 0.166, 1e8)


def test_couplers_of_scene_files_are_written_back():
    scene = scenes.parse(TRAIN)
    assert scene.lanes[0].chain() == Chain([8e4] * 3, COUPLER, 0.01)
    assert scenes.parse(scene.to_toml()) == scene
    for coupler in COUPLER, Coupler(Contact(1.0, 2.0, 1.5)), Coupler(COUPLER.push, COUPLER.pull):
        table = table_of(coupler)
        assert table.contact() == coupler
        assert type(table).model_validate(table.model_dump()) == table


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("travel = 0.166\n", "", "needs both travel and stop"),
        ("slack = 0.02", "slack = -1.0", "slack"),
        ('pull = {law = "hooke", stiffness = 1e7}\n', "", "needs a pull beyond it"),
        ('law = "hooke"', 'law = "coupler"', "unknown law 'coupler'"),
        ('push = {law = "preloaded",', 'push = {law = "preloded",', "did you mean 'preloaded'"),
        ('law = "coupler"', 'law = "cupler"', "did you mean 'coupler'"),
        ('method = "conserving"', 'method = "pymunk"', "not couplers: take 'accurate', 'conserving' or 'scipy'"),
        ("duration = 1.0\n", "", "never comes apart: give a duration"),
    ],
)
def test_what_is_wrong_with_a_coupler_is_said(old, new, sentence):
    assert old in TRAIN
    with pytest.raises(SceneError, match=sentence):
        scenes.parse(TRAIN.replace(old, new, 1))
