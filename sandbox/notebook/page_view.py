"""The page of a scene, or of a trajectory that was made without one."""

from __future__ import annotations

from os import PathLike

from softcradle.physics import Trajectory
from softcradle.sandbox.notebook.chain_scene import scene_of, usual_slow
from softcradle.sandbox.page import render_page, scene_text, write_page
from softcradle.scenes import Scene


def write_page_of(shown: Trajectory | Scene, path: str | PathLike[str], slow: float | None) -> None:
    """Write the page; `slow` is seconds for one of motion, None the scene's or the usual slow motion."""
    if isinstance(shown, Scene):
        render_page(shown, path, slow)
    else:
        write_page(shown, scene_of(shown, slow or usual_slow(shown)), path)


def page_text(scene: Scene, slow: float | None) -> str:
    """The page of a scene as text."""
    return scene_text(scene, slow)[0]
