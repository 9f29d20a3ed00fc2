"""Check that window, terminal, film, lessons and web page report the same outcome of a collision.

All scenes of the catalogue and the collision of one bead with 49 beads are checked. The scripts and compiled kernels of
the web page run in Node.js, without a document.
"""

import json
import math
import shutil
import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pygame
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from softcradle.sandbox.draw.scene_picture import Picture
from softcradle.sandbox.files import resource
from softcradle.sandbox.film.scene_motion import scene_motions
from softcradle.sandbox.languages import LANGUAGES, use_language
from softcradle.sandbox.notebook.views import html_of
from softcradle.sandbox.page.document import SCRIPTS, page_script_text
from softcradle.sandbox.page.shared_page import scene_text
from softcradle.sandbox.scene_runs import run_scene
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.summary_text import outcome_text, session_outcome, session_story
from softcradle.sandbox.story.lane_story import motion_outcome, story_of
from softcradle.sandbox.story.outcome import Group, Outcome, outcome_of
from softcradle.sandbox.story.page_story import story_script
from softcradle.sandbox.story.sentences import describe, outcome_words
from softcradle.sandbox.window.lessons.runner import MEASURES
from softcradle.scenes import Scene, load, names, parse

from tests.helpers.drawn_text import colliding, drawn_texts
from tests.helpers.paths import ROOT
from tests.sandbox.page.conftest import page_data

ONE_ON_49 = """
title = "One on 49"
[[lanes]]
beads = [1, 49]
velocity = 1.0
contact = {law = "power_law", f0 = 1.0, alpha = "1/100"}
[view]
slow = 2.0
"""
NAMES = (*names(), "one-on-49")
NODE = shutil.which("node")
needs_node = pytest.mark.skipif(NODE is None, reason="node is not installed")
# Largest allowed difference of two velocities, as a fraction of the largest velocity. The velocities are computed with
# different methods and steps.
VELOCITY = 0.01
# Scripts of a web page that can run without a document.
HEADLESS = tuple(name for name in SCRIPTS if name not in ("page", "controls"))


def scene_of(name: str) -> Scene:
    return parse(ONE_ON_49) if name == "one-on-49" else load(name)


def summary(outcome) -> list[tuple[int, int, str]]:
    return [(group.first, group.last, group.state) for group in outcome.groups]


@cache
def told(name: str) -> list:
    """Return the outcomes that the terminal prints, as one story for each row of beads."""
    return [story_of(run) for run in run_scene(scene_of(name))]


@cache
def played(name: str) -> tuple[Session, list[float | None]]:
    """Return a session that was played to the end in the same way as in the window.

    Also return the time at which the motion of each row of beads was over.
    """
    session = Session(scene_of(name))
    ends: list[float | None] = [None] * len(session.lanes)
    last = session.scene.duration or math.inf
    # Half a frame is subtracted because round-off of the time must not add a frame.
    last -= 0.5 * session.setup.frame_time
    while not all(lane.over for lane in session.lanes) and session.time < last:
        session.step_frames(1)
        ends = [(end or session.time) if lane.over else None for end, lane in zip(ends, session.lanes, strict=True)]
    return session, ends


@cache
def filmed(name: str) -> list:
    """Return the motions that a film of the scene shows, one for each row of beads."""
    scene = scene_of(name)
    return scene_motions(scene, 120.0 * scene.view.slow)


@cache
def shared() -> dict[str, dict]:
    """Return the outcome that the web page of each scene reports at the end, as a dictionary with the scene name as
    key.
    """
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        script, pages = Path(folder, "page.js"), Path(folder, "pages.json")
        script.write_text(story_script() + "\n".join(map(page_script_text, HEADLESS)), encoding="utf-8")
        found = []
        for name in NAMES:
            text, computed = scene_text(scene_of(name))
            found.append({"data": page_data(text), "computed": computed})
        pages.write_text(json.dumps(found), encoding="utf-8")
        runner = Path(__file__).with_name("story_of_pages.cjs")
        words = [str(NODE), str(runner), str(script), str(pages), str(resource("page/kernels.wasm"))]
        done = subprocess.run(words, capture_output=True, text=True, check=True, encoding="utf-8", timeout=300)
    return dict(zip(NAMES, json.loads(done.stdout), strict=True))


@pytest.mark.parametrize("name", NAMES)
def test_window_and_terminal_tell_the_same_story(name):
    session, ends = played(name)
    for lane, story in enumerate(told(name)):
        outcome = session_outcome(session, lane)
        assert summary(outcome) == summary(story.outcome)
        speeds = [[group.velocity for group in one.groups] for one in (outcome, story.outcome)]
        fastest = max(1e-3, *map(abs, speeds[0]))
        np.testing.assert_allclose(*speeds, atol=VELOCITY * fastest)
        if session.scene.duration is None:
            opened = session_story(session, lane).opened
            assert opened == pytest.approx(story.opened, rel=0.01)
            if session.lanes[lane].chain.on_bed:  # The window continues to play until friction has stopped all beads.
                assert ends[lane] > opened
                assert not session.lanes[lane].velocity.any()
                assert outcome_text(session).endswith("Then friction stopped them.")
            else:
                assert ends[lane] == pytest.approx(opened, abs=2.0 * session.setup.frame_time)


@needs_node
@pytest.mark.parametrize("name", NAMES)
def test_page_and_terminal_tell_the_same_story(name):
    page = shared()[name]
    for lane, story in enumerate(told(name)):
        found = page["lanes"][lane]
        assert [(group["first"], group["last"], group["state"]) for group in found["groups"]] == summary(story.outcome)
        speeds = [[group["velocity"] for group in found["groups"]], [group.velocity for group in story.outcome.groups]]
        fastest = max(1e-3, *map(abs, speeds[0]))
        np.testing.assert_allclose(*speeds, atol=VELOCITY * fastest)
        if found["end"] is not None:
            assert found["end"] == pytest.approx(story.opened, rel=0.01, abs=2.0 * page["frame"])


@needs_node
@pytest.mark.parametrize("name", NAMES)
def test_page_has_the_sentences_of_the_terminal(name):
    for code in LANGUAGES:
        use_language(code)
        for found in shared()[name]["lanes"]:
            groups = (Group(*map(one.get, ("first", "last", "velocity", "state", "wall"))) for one in found["groups"])
            assert found["said"][code] == outcome_words(Outcome(tuple(groups), ()))


@pytest.mark.parametrize("name", NAMES)
def test_film_and_terminal_tell_the_same_story(name):
    scene = scene_of(name)
    for motion, story in zip(filmed(name), told(name), strict=True):
        outcome = motion_outcome(motion, scene.duration is not None)
        assert summary(outcome) == summary(story.outcome)
        speeds = [[group.velocity for group in one.groups] for one in (outcome, story.outcome)]
        np.testing.assert_allclose(*speeds, atol=VELOCITY * max(1e-3, *map(abs, speeds[1])))
        if scene.duration is None:
            assert motion.time[-1] >= story.opened * (1.0 - VELOCITY)


@pytest.mark.parametrize("name", NAMES)
def test_lessons_have_the_same_answers_in_window_terminal_and_film(name):
    scene, (session, _) = scene_of(name), played(name)
    window = [session_outcome(session, lane) for lane in range(len(session.lanes))]
    film = [motion_outcome(motion, scene.duration is not None) for motion in filmed(name)]
    terminal = [story.outcome for story in told(name)]
    for measure in MEASURES.values():
        assert measure(window) == measure(terminal) == measure(film)


def test_last_frame_of_a_film_shows_the_outcome():
    scene = load("one-on-four")
    picture = Picture(scene, scene_motions(scene, 120.0), (1280, 720))
    with drawn_texts((1280, 720)) as found:
        picture.paint(pygame.Surface((1280, 720), 0, 32), -1, text_opacity=1.0)
    said = " ".join(one.text for one in found).replace("\u00a0", " ")
    assert "Beads 2 to 4 move right together at 0.46 m/s." in said
    assert not colliding(found)


def test_notebook_shows_the_story_of_the_terminal():
    (run,) = run_scene(load("one-on-four"))
    assert describe("", run) in html_of(run)


@pytest.mark.parametrize("name", ["one-on-four", "hertz-cradle", "one-on-49"])
def test_card_and_describe_have_the_same_sentences(name):
    session, _ = played(name)
    (run,) = run_scene(scene_of(name), method="conserving")
    assert describe("", run).endswith(outcome_text(session))


VALUES = st.one_of(st.just(0.0), st.floats(-2.0, 2.0).map(lambda value: round(value, 2)))
ROWS = st.integers(2, 14).flatmap(
    lambda count: st.tuples(
        st.lists(st.sampled_from([1.0, 1.0, 3.0, 0.01, None]), min_size=count, max_size=count),
        *2 * [st.lists(VALUES, min_size=count, max_size=count)],
    )
)


@needs_node
@given(st.lists(ROWS, min_size=200, max_size=200))
@settings(max_examples=1, deadline=None, derandomize=True)
def test_rule_in_javascript_is_the_rule_in_python(rows):
    code = story_script() + page_script_text("ending")
    code += f"console.log(JSON.stringify({json.dumps(rows)}.map((row) => groupsOf(...row))))"
    done = subprocess.run([str(NODE), "-"], input=code, capture_output=True, text=True, check=True, encoding="utf-8")
    for (mass, start, velocity), groups in zip(rows, json.loads(done.stdout), strict=True):
        masses = [math.inf if one is None else one for one in mass]
        found = outcome_of(masses, start, velocity).groups
        assert [(one["first"], one["last"], one["state"], one["wall"]) for one in groups] == [
            (one.first, one.last, one.state, one.wall) for one in found
        ]
        np.testing.assert_allclose([one["velocity"] for one in groups], [one.velocity for one in found], atol=1e-12)


def test_no_bound_of_the_story_is_written_twice():
    scripts = {path.name: path.read_text(encoding="utf-8") for path in (ROOT / "assets/page").glob("*.js")}
    rules = ("FRAME_RATE", "FRAME_COST", "STEP_COST", "CONTACT_STEPS", "HAND_FREQUENCY", "HAND_SPEED")
    for name in ("TOGETHER", "STANDS", "AT_REST", "SLOW", *rules):
        assert not any(f"const {name}" in text for text in scripts.values())
