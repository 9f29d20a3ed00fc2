"""Points of a scene: the numbers at dotted paths are replaced, and give what a file with these numbers gives."""

from __future__ import annotations

import pickle

import pytest
from softcradle.sandbox.sweeps.scene_points import ScenePoints, replaced
from softcradle.scenes import SceneError, load, parse

SCENE = load("one-on-four")
LISTS = """
title = "mixed"
tolerance = 1e-6
[[lanes]]
mass = [1.0, 2.0, 3.0]
contact = [{law = "power_law", f0 = 1.0, alpha = 0.1}, {law = "hertz", stiffness = 100.0}]
velocity = [1.0, 0.0, 0.0]
"""
TEXT = """
title = "three on five"
[[lanes]]
beads = [STRIKERS, TARGETS]
mass = MASS
contact = {law = "power_law", f0 = 1.0, alpha = ALPHA}
velocity = 0.5
"""


def scene(strikers: int, targets: int, mass: float, alpha: float):
    numbers = {"STRIKERS": strikers, "TARGETS": targets, "MASS": mass, "ALPHA": alpha}
    text = TEXT
    for word, number in numbers.items():
        text = text.replace(word, str(number))
    return parse(text)


def test_a_point_is_the_scene_with_these_numbers():
    values = {"lanes.0.beads.0": 2, "lanes.0.beads.1": 3, "lanes.0.mass": 2.5, "lanes.0.contact.alpha": 0.25}
    (found,) = ScenePoints(scene(3, 5, 1.0, 0.1)).starts(values)
    lane = scene(2, 3, 2.5, 0.25).lanes[0]
    assert found.chain == lane.chain()
    assert tuple(found.velocity) == lane.velocity == (0.5, 0.5, 0.0, 0.0, 0.0)


def test_one_bead_of_those_that_have_one_mass():
    (found,) = ScenePoints(SCENE).starts({"lanes.0.mass.2": 5.0, "lanes.0.velocity.1": 0.5, "lanes.0.gap.3": 0.1})
    assert found.chain.mass == (1.0, 1.0, 5.0, 1.0, 1.0)
    assert found.chain.gap == (0.0, 0.0, 0.0, 0.1)
    assert tuple(found.velocity) == (1.0, 0.5, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("paths", [("lanes.0.mass", "lanes.0.mass.2"), ("lanes.0.mass.*", "lanes.0.mass.2")])
def test_of_two_values_for_one_number_the_last_counts(paths):
    """And the numbers of one point are not those of the next."""
    points = ScenePoints(SCENE)
    for bead in (5.0, 6.0):
        (found,) = points.starts(dict(zip(paths, (2.0, bead), strict=True)))
        assert found.chain.mass == (2.0, 2.0, bead, 2.0, 2.0)
    assert points.starts({})[0].chain.mass == (1.0,) * 5


def test_contacts_one_by_one_or_all():
    mixed = ScenePoints(parse(LISTS))
    (found,) = mixed.starts({"lanes.0.contact.1.stiffness": 7.0, "lanes.0.contact.*.loss": 0.25, "tolerance": 1e-3})
    assert [contact.stiffness for contact in found.chain.contact] == [1.0, 7.0]
    assert [contact.loss for contact in found.chain.contact] == [0.25, 0.25]
    assert found.settings["tolerance"] == 1e-3
    assert mixed.scene == parse(LISTS)


def test_it_can_be_sent_to_another_process():
    for known in (SCENE, parse(LISTS), load("experiment-one-on-three")):
        sent = pickle.loads(pickle.dumps(ScenePoints(known)))
        assert sent.scene == known
        values = {"lanes.0.mass.1": 3.0}
        assert sent.starts(values)[0].chain == ScenePoints(known).starts(values)[0].chain


def test_methods_are_texts():
    (found,) = ScenePoints(SCENE).starts({"method": "conserving", "step": 0.01})
    assert (found.settings["method"], found.settings["step"]) == ("conserving", 0.01)


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        ("lane.0.mass", 1.0, r"lane.0.mass: there is no 'lane' \(did you mean 'lanes'\?\); allowed: title"),
        ("lanes.1.mass", 1.0, r"lanes.1.mass: '1' must be a number from 0 to 0, or \* for all"),
        ("lanes.0.contact.alfa", 1.0, r"there is no 'alfa' \(did you mean 'alpha'\?\)"),
        ("lanes.0.contact.alpha.1", 1.0, "there is nothing below 'lanes.0.contact.alpha', which is 0.1"),
    ],
)
def test_a_path_that_is_not_there(path, value, sentence):
    with pytest.raises(SceneError, match=sentence):
        replaced(SCENE, path.split("."), value, path)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"lanes.0.contact.alpha": -1.0}, "exponent|alpha"),
        ({"lanes.0.mass": 0.0}, "mass"),
        ({"lanes.0.beads.1": 0}, "beads"),
        ({"method": "verlett"}, "unknown method 'verlett'"),
    ],
)
def test_numbers_that_cannot_be(values, sentence):
    with pytest.raises(ValueError, match=sentence):
        ScenePoints(scene(1, 4, 1.0, 0.1)).starts(values)
