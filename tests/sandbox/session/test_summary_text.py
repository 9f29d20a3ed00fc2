"""The summary in words: hits, clusters, directions, and whether to trust it."""

import re

import numpy as np
import pytest
from softcradle.sandbox.motion_words import describe
from softcradle.sandbox.scene_runs import run_scene
from softcradle.sandbox.session import Session, SetMethod
from softcradle.sandbox.session.summary_text import summary_text

from softcradle import scenes
from tests.helpers.scene_kinds import EVERY_SCENE


def test_a_collision_is_told_in_words():
    session = Session(scenes.load("draft-gear-one-on-three"))
    assert "Bead 0 goes to the right at 0.5 metres a second. Beads 1 to 3 stand still." in summary_text(session)
    session.step_frames(2000)
    text = summary_text(session)
    assert "Bead 0 hit bead 1 at " in text
    assert "with 0.5 metres a second" in text
    assert "No contact has been closed since " in text
    together = re.search(r"Beads 1 to 3 go together to the right at (.*?) metres a second\.", text)
    striker = re.search(r"Bead 0 goes to the left at (.*?) metres a second\.", text)
    assert float(together[1]) == pytest.approx(0.25, abs=0.005)
    assert float(striker[1]) == pytest.approx(0.25, abs=0.005)
    assert "trust" not in text


def test_lanes_are_named_and_faults_are_told():
    session = Session(scenes.load("beads-against-gear"))
    session.apply(SetMethod(1, "verlet"))
    session.step_frames(2000)
    text = summary_text(session)
    assert "alpha = 1/10: " in text
    assert "draft gear: " in text
    assert "Do not trust it: verlet chattered from " in text


@pytest.mark.parametrize("name", EVERY_SCENE)
def test_the_bead_that_hits_is_the_one_that_approached(name):
    """Contacts that merely touch, or are pressed, close at the same time or before."""
    scene = scenes.load(name)
    for lane, found in zip(scene.lanes, run_scene(scene), strict=True):
        rate = -np.diff(lane.velocity)
        hit = re.search(r"Bead (\d+) hit bead (\d+)", describe("", found))
        assert (int(hit[1]), int(hit[2]) - 1) == (int(rate.argmax()),) * 2 if rate.any() else hit is None
