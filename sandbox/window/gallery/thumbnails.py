"""Thumbnails of scenes. Each is cached on disk under a digest of all its inputs."""

from __future__ import annotations

import os
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import pygame
from softcradle.physics.source_digest import PHYSICS, digest_of
from softcradle.sandbox.draw import lane_drawing
from softcradle.sandbox.draw.lane_drawing import LaneDrawing
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.shared_scales import left_edges, scales_of
from softcradle.sandbox.draw.surfaces import write_png
from softcradle.sandbox.languages import language
from softcradle.sandbox.motion import Motion
from softcradle.sandbox.window.plots import scales
from softcradle.scenes import Scene

PICTURES = Path(__file__).parent / "pictures"  # Folder of the thumbnails made by `make screenshots`.
SIZE = (578, 250)  # Size of a thumbnail in pixels: twice the displayed size in a gallery of 1280x720 pixels.


@lru_cache(maxsize=1)
def _sources() -> tuple[Path, ...]:
    """Return the source files that affect the appearance of a thumbnail."""
    drawing = Path(lane_drawing.__file__).parent
    return (*PHYSICS.rglob("*.py"), *drawing.glob("*.py"), Path(scales.__file__), Path(__file__))


def cache_folder() -> Path:
    """Return the folder of the cached thumbnails. The variable SOFTCRADLE_CACHE sets another folder."""
    given = os.environ.get("SOFTCRADLE_CACHE")
    if given:
        return Path(given)
    import platformdirs

    return Path(platformdirs.user_cache_dir("softcradle", appauthor=False)) / "thumbnails"


def cached_path(scene: Scene, theme: str) -> Path:
    """Return the path of the thumbnail of `scene`. The path depends on the scene, the theme, the language, and the code
    for drawing and physics.
    """
    return cache_folder() / f"{digest_of(_sources(), theme, language(), scene.model_dump_json())}.png"


def shipped(name: str, theme: str) -> pygame.Surface | None:
    """Return the thumbnail of a catalogue scene that is part of the package, or None. Its numbers have the English
    format.
    """
    try:
        return pygame.image.load(str(PICTURES / theme / f"{name}.png"))
    except (OSError, pygame.error):
        return None


def load(scene: Scene, theme: str) -> pygame.Surface | None:
    """Return the cached thumbnail, or None."""
    try:
        return pygame.image.load(str(cached_path(scene, theme)))
    except (OSError, pygame.error):
        return None


def save(scene: Scene, theme: str, thumbnail: pygame.Surface) -> None:
    """Write `thumbnail` to the cache, if the folder is writable."""
    from softcradle.physics.atomic_files import output_file

    path = cached_path(scene, theme)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with output_file(path) as temporary:
            write_png(thumbnail, temporary)
    except (OSError, pygame.error):
        return


def start_of(scene: Scene) -> list[Motion]:
    """Return the start of each lane as a Motion with a single sample. It replaces a motion that could not be computed."""
    from softcradle.sandbox.session.lane_setup import setup_of
    from softcradle.sandbox.session.live_lane import LiveLane

    return [LiveLane.at_start(lane).motion for lane in setup_of(scene).lanes]


def paint(scene: Scene, motions: list[Motion]) -> pygame.Surface:
    """Draw the frame with the largest force. The lanes are drawn below each other."""
    from softcradle.sandbox.film.scene_motion import strongest_row

    surface = pygame.Surface(SIZE, 0, 32)
    surface.fill(tones.lane_background)
    row, scales, length = strongest_row(motions), scales_of(scene, motions), scene.view.length
    edges = [left_edges(m.position[row], m.overlap[row], length, scales.magnify) for m in motions]
    low, high = min(float(e.min()) for e in edges), max(float(e.max()) for e in edges) + length
    scales = replace(scales, window=(low - 0.4 * length, high + 0.4 * length))
    height = SIZE[1] / len(motions)
    for k, motion in enumerate(motions):
        rect = pygame.Rect(0, round(k * height), SIZE[0], round(height))
        drawing = LaneDrawing(rect, 1.5 if len(motions) == 1 else 0.9, scene, k, scales)
        surface.fill(tones.faint, (0, round(drawing.ground), SIZE[0], 3))
        drawing.paint(surface, motion, row, drawing.left())
    return surface
