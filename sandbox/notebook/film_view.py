"""Films of a notebook: the recorded motion of a trajectory, or a scene."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pygame
from softcradle.physics import Trajectory
from softcradle.physics.notebook_views import InlineFilm
from softcradle.sandbox.draw import Picture, motion_of
from softcradle.sandbox.film.film_encoder import open_film
from softcradle.sandbox.film.scene_film import render_scene
from softcradle.sandbox.notebook.chain_scene import scene_of, usual_slow
from softcradle.scenes import Scene

FILM_RATE = 30.0  # frames a second


def film_of(shown: Trajectory | Scene, slow: float | None, size: tuple[int, int]) -> InlineFilm:
    """The film as bytes; `slow` is seconds of film for one of motion."""
    with tempfile.TemporaryDirectory(prefix="softcradle-") as folder:
        path = Path(folder) / "film.mp4"
        if isinstance(shown, Scene):
            render_scene(shown, path, size, fps=FILM_RATE, slow=slow, progress=False)
        else:
            _write(shown, path, slow, size)
        return InlineFilm(path.read_bytes(), size)


def _write(trajectory: Trajectory, path: Path, slow: float | None, size: tuple[int, int]) -> None:
    """Write the samples of the trajectory, each for as long as it is the nearest one."""
    span = float(trajectory.time[-1] - trajectory.time[0])
    slow = slow or usual_slow(trajectory)
    times = trajectory.time[0] + np.arange(int(span * slow * FILM_RATE) + 1) / (slow * FILM_RATE)
    between = 0.5 * (trajectory.time[1:] + trajectory.time[:-1])
    picture = Picture(scene_of(trajectory, slow), [motion_of(trajectory)], size, slow=slow)
    with open_film(path, size, FILM_RATE) as film:
        for row in np.searchsorted(between, times):
            surface: pygame.Surface = film.free_surface()
            picture.paint(surface, int(row))
            film.add(surface)
