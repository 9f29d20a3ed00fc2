"""Thumbnails and their cache."""

from __future__ import annotations

import pygame
from softcradle.sandbox.window.gallery import thumbnails

from softcradle import scenes


def test_thumbnail_of_another_scene_has_another_file():
    scene = scenes.load("one-on-four")
    other = scene.model_copy(update={"title": "Another"})
    assert thumbnails.cached_path(scene, "light") == thumbnails.cached_path(scenes.load("one-on-four"), "light")
    assert len({thumbnails.cached_path(*each) for each in ((scene, "light"), (other, "light"), (scene, "dark"))}) == 3


def test_a_cache_that_cannot_be_written_is_no_error(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("SOFTCRADLE_CACHE", str(tmp_path / "file" / "cache"))
    scene = scenes.load("one-on-four")
    assert thumbnails.load(scene, "light") is None
    thumbnails.save(scene, "light", pygame.Surface((4, 4)))
    assert thumbnails.load(scene, "light") is None
