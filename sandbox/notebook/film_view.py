"""Films of a notebook: the recorded motion of a trajectory, or a scene."""

from __future__ import annotations

import tempfile
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pygame
from softcradle.physics import Contact, Trajectory, hooke
from softcradle.physics.notebook_views import InlineFilm
from softcradle.sandbox.draw import Picture, motion_of
from softcradle.sandbox.film.scene_film import render_scene
from softcradle.sandbox.film.writer import open_film
from softcradle.scenes import Lane, Scene, View
from softcradle.scenes.contact_table import law_of
from softcradle.scenes.scene_schema import ForceTable

FILM_RATE = 30.0  # frames a second
UNDRAWN = law_of(hooke(1.0))  # stands in the scene for a law of one's own, which no scene can name and no picture shows
FILM_LENGTH = 6.0  # seconds of film where no slow motion is given


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
    slow = slow or (FILM_LENGTH / span if span > 0.0 else 1.0)
    times = trajectory.time[0] + np.arange(int(span * slow * FILM_RATE) + 1) / (slow * FILM_RATE)
    between = 0.5 * (trajectory.time[1:] + trajectory.time[:-1])
    picture = Picture(_scene(trajectory, slow), [motion_of(trajectory)], size, slow=slow)
    with open_film(path, size, FILM_RATE) as film:
        for row in np.searchsorted(between, times):
            surface: pygame.Surface = film.free_surface()
            picture.paint(surface, int(row))
            film.add(surface)


def _scene(trajectory: Trajectory, slow: float) -> Scene:
    """The trajectory's chain as a scene: a picture takes title and view from it."""
    chain = trajectory.chain
    lane = Lane(
        mass=chain.mass,
        contact=tuple(law_of(contact) if isinstance(contact, Contact) else UNDRAWN for contact in chain.contact),
        velocity=tuple(trajectory.velocity[0].tolist()),
        gap=chain.gap,
        drive=chain.drive,
        friction=chain.friction,
        forces=tuple(ForceTable(**asdict(item)) for item in chain.forces),
        brakes=tuple(ForceTable(**asdict(item)) for item in chain.brakes),
    )
    title = f"{chain.contacts + 1} beads, by {trajectory.method}"
    return Scene(title=title, lanes=(lane,), duration=float(trajectory.time[-1]) or None, view=View(slow=slow))
