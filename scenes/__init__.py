"""Scenes: one TOML file each, checked on reading. What a scene says becomes chains, starting velocities and a view."""

from scenes.library import load, names, parse, text_of
from scenes.problems import SceneError
from scenes.scene import Lane, Scene, View

__all__ = ["Lane", "Scene", "SceneError", "View", "load", "names", "parse", "text_of"]
