"""Scenes: TOML files that describe chains, their start velocities, and how to show them. Files are checked when read."""

from softcradle.scenes.catalogue import load, names, parse, text_of
from softcradle.scenes.scene_errors import SceneError
from softcradle.scenes.scene_schema import Lane, Scene, View

__all__ = ["Lane", "Scene", "SceneError", "View", "load", "names", "parse", "text_of"]
