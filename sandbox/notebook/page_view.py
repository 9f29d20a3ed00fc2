"""The page to share of a trajectory that was made without a scene."""

from __future__ import annotations

from os import PathLike

from softcradle.physics import Trajectory
from softcradle.sandbox.notebook.chain_scene import scene_of, usual_slow
from softcradle.sandbox.page import write_page


def write_trajectory(trajectory: Trajectory, path: str | PathLike[str], slow: float | None) -> None:
    """Write the page; `slow` is seconds for one of motion, None the usual slow motion."""
    write_page(trajectory, scene_of(trajectory, slow or usual_slow(trajectory)), path)
