"""Scenes: one TOML file each, checked on reading. What a scene says becomes chains, starting velocities and a view."""

from softcradle.scenes.library import load, names, parse, text_of
from softcradle.scenes.scene import Lane, Scene, View
from softcradle.scenes.scene_errors import SceneError

__all__ = ["Lane", "Scene", "SceneError", "View", "load", "names", "parse", "text_of"]
