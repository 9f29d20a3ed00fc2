"""Thumbnails of scenes: drawn by the project's own stage, kept on disk under the digest of all that makes them."""

from __future__ import annotations

import os
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import pygame
from softcradle.physics.methods import AUTO
from softcradle.physics.source_digest import PHYSICS, digest_of
from softcradle.sandbox.draw import lane_drawing
from softcradle.sandbox.draw.lane_drawing import LaneDrawing
from softcradle.sandbox.draw.palette import FAINT, LANE_BACKGROUND
from softcradle.sandbox.draw.shared_scales import left_edges, scales_of
from softcradle.sandbox.motion import Motion
from softcradle.scenes import Scene

SIZE = (578, 250)  # pixels: twice what a gallery at 1280x720 shows
ROWS = 240  # of the motion that the moment is chosen from
QUICK = "conserving"  # the method of a look ahead: a picture needs no more digits


@lru_cache(maxsize=1)
def _sources() -> tuple[Path, ...]:
    """The source files that a thumbnail depends on."""
    drawing = Path(lane_drawing.__file__).parent
    return (*PHYSICS.rglob("*.py"), *drawing.glob("*.py"), Path(__file__))


def cache_folder() -> Path:
    """Where thumbnails are kept; SOFTCRADLE_CACHE moves it."""
    moved = os.environ.get("SOFTCRADLE_CACHE")
    if moved:
        return Path(moved)
    import platformdirs

    return Path(platformdirs.user_cache_dir("softcradle", appauthor=False)) / "thumbnails"


def cached_path(scene: Scene) -> Path:
    """The file of the thumbnail of `scene`; another scene, drawing or physics has another name."""
    return cache_folder() / f"{digest_of(_sources(), scene.model_dump_json())}.png"


def read(scene: Scene) -> pygame.Surface | None:
    """The kept thumbnail, or None."""
    try:
        return pygame.image.load(str(cached_path(scene)))
    except (OSError, pygame.error):
        return None


def keep(scene: Scene, thumbnail: pygame.Surface) -> None:
    """Keep `thumbnail` on disk; a cache that cannot be written is done without."""
    from softcradle.physics.atomic_files import output_file

    path = cached_path(scene)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with output_file(path) as temporary:
            pygame.image.save(thumbnail, str(temporary))
    except (OSError, pygame.error):
        return


def motion(scene: Scene) -> list[Motion]:
    """What a thumbnail is drawn from: the motion of each lane. Takes some milliseconds; runs behind the window."""
    from softcradle.sandbox.film.scene_motion import scene_motions_quietly

    rate = ROWS / (scene.duration or 1.0)
    method = QUICK if scene.method in (None, AUTO) else scene.method
    tracks, _ = scene_motions_quietly(scene, max(rate, 60.0 * scene.view.slow), method=method)
    return tracks  # whoever plays the scene has a badge for what it warns of


def paint(scene: Scene, tracks: list[Motion]) -> pygame.Surface:
    """The moment of the greatest force, one lane below the other."""
    from softcradle.sandbox.film.scene_motion import strongest_row

    surface = pygame.Surface(SIZE, 0, 32)
    surface.fill(LANE_BACKGROUND)
    row, scales, length = strongest_row(tracks), scales_of(scene, tracks), scene.view.length
    edges = [left_edges(t.position[row], t.overlap[row], length, scales.magnify) for t in tracks]
    low, high = min(float(e.min()) for e in edges), max(float(e.max()) for e in edges) + length
    scales = replace(scales, window=(low - 0.4 * length, high + 0.4 * length))
    tall = SIZE[1] / len(tracks)
    for k, track in enumerate(tracks):
        rect = pygame.Rect(0, round(k * tall), SIZE[0], round(tall))
        stage = LaneDrawing(rect, 1.5 if len(tracks) == 1 else 0.9, scene, k, scales)
        surface.fill(FAINT, (0, round(stage.ground), SIZE[0], 3))
        stage.paint(surface, track, row, stage.left())
    return surface
