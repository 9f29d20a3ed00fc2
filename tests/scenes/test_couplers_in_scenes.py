"""Couplers in scene files: read, written again, and refused in a sentence."""

import pytest
from softcradle.physics import Chain, Contact, Coupler
from softcradle.sandbox.cli.main import main
from softcradle.scenes import SceneError
from softcradle.scenes.contact_table import table_of

from softcradle import scenes

TEXT = """
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


def test_a_scene_file_gives_couplers():
    scene = scenes.parse(TEXT)
    assert scene.lanes[0].chain() == Chain([8e4] * 3, COUPLER, 0.01)
    assert scenes.parse(scene.to_toml()) == scene


@pytest.mark.parametrize("coupler", [COUPLER, Coupler(Contact(1.0, 2.0, 1.5)), Coupler(COUPLER.push, COUPLER.pull)])
def test_the_table_of_a_coupler_gives_it_back(coupler):
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
        ("duration = 1.0\n", "", "needs a duration"),
    ],
)
def test_what_is_wrong_with_a_coupler_is_said(old, new, sentence):
    assert old in TEXT
    with pytest.raises(SceneError, match=sentence):
        scenes.parse(TEXT.replace(old, new, 1))


def test_the_table_of_results_has_the_largest_pull_where_couplers_pull(capsys):
    for scene, pulls in (("train-starting", True), ("one-on-four", False)):
        assert main(["run", scene]) == 0
        assert ("pull [kN]" in capsys.readouterr().out) is pulls
