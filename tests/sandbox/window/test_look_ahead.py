"""The look ahead, which runs on a thread."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from softcradle.sandbox.film.scene_motion import scene_motions, scene_motions_quietly
from softcradle.sandbox.window.look_ahead import motions_ahead

from softcradle import scenes


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
