"""The look ahead, which runs on a thread."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from softcradle.physics import METHODS
from softcradle.sandbox.film.scene_motion import scene_motions, scene_motions_quietly
from softcradle.sandbox.user_error import GaveUpError
from softcradle.sandbox.window.plots.scales import MOST_AT_ONCE, MOST_BEHIND, motions_ahead

from softcradle import scenes
from tests.helpers.scene_kinds import EVERY_SCENE


def test_the_look_ahead_does_not_touch_the_warning_filters(monkeypatch):
    """It runs on a thread, and the filters are those of all threads. A film still warns of the same motion."""
    scene = scenes.load("one-on-four").model_copy(update={"method": "euler", "step": 1e-3})
    with pytest.warns(RuntimeWarning):
        of_film = scene_motions(scene, 2000.0)

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a thread used the warnings")

    for name in ("catch_warnings", "simplefilter", "filterwarnings", "warn"):
        monkeypatch.setattr(warnings, name, refuse)
    motions, sentences = scene_motions_quietly(scene, 2000.0)
    assert sentences
    assert np.array_equal(motions[0].position, of_film[0].position)
    assert motions_ahead(scene)


@pytest.mark.parametrize("name", EVERY_SCENE)
def test_the_window_sees_every_shipped_scene_ahead_at_once(name):
    assert motions_ahead(scenes.load(name), MOST_AT_ONCE)


@pytest.mark.parametrize("method", [method.name for method in METHODS])
def test_a_run_ahead_is_none_of_a_method_in_python(method):
    """A comparison by pymunk held the window up for more than ten minutes."""
    motions = motions_ahead(scenes.load("one-on-four").model_copy(update={"method": method}), MOST_AT_ONCE)
    assert motions[0].method.split(",")[0] == ("conserving" if method in ("pymunk", "scipy") else method)


def test_a_run_ahead_that_takes_long_does_not_hold_up_the_window(driver):
    """Its scales are estimated, and follow from a thread, which gives up as well where a step was mistyped."""
    scene = scenes.load("one-on-four").model_copy(update={"method": "conserving", "step": 1e-9})
    for most in (MOST_AT_ONCE, MOST_BEHIND):
        with pytest.raises(GaveUpError):
            motions_ahead(scene, most)
    driver.page.show_scene(scene)
    assert driver.page.view.follower.pending
    slower = scenes.load("one-on-four").model_copy(update={"method": "conserving", "step": 2e-6})
    driver.page.show_scene(slower)
    assert driver.page.view.follower.pending
    driver.until(lambda: not driver.page.view.follower.pending)
    assert driver.page.view.scales.scales
