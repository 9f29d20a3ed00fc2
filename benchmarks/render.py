"""Speed of rendering a film in several ways.

The ways are drawing only, one encoder only, both in sequence, and segments encoded in parallel. All ways encode the
frames of the scene's film, because moving pictures cost the encoder more than still pictures. The frame rates need an
otherwise idle machine. The processor times hardly depend on other load.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.draw.scene_picture import Picture
from softcradle.sandbox.film.encoder import open_film
from softcradle.sandbox.film.scene_film import Shot, render_scene, shot_list
from softcradle.sandbox.film.scene_motion import scene_motions

from benchmarks.reports import Report, at_least, at_most
from softcradle import scenes

if TYPE_CHECKING:
    from pygame import Surface

RATE = 60.0  # Frames per second of the film.
MOST_FRAMES = 360  # Largest number of frames in a round.
WAYS = {
    "drawing": "drawing alone",
    "encoder": "one encoder alone",
    "in_order": "drawing and one encoder",
    "segments": "segments side by side",
}


def measure(name: str, size: tuple[int, int], rounds: int = 5) -> dict[str, Any]:
    """Return frames per second and processor milliseconds per frame for each way.

    The results are medians of `rounds` rounds, in which the ways alternate.
    """
    scene = scenes.load(name)
    motions = scene_motions(scene, RATE * scene.view.slow)
    picture = Picture(scene, motions, size)
    shots = shot_list(scene, len(motions[0].time), RATE)
    # The selected frames contain the same fraction of still pictures as the film.
    shots = shots[:: max(1, len(shots) // MOST_FRAMES)]
    ready = [_painted(picture, shot, picture.background.copy()) for shot in shots]
    with tempfile.TemporaryDirectory() as folder:
        results = [_round(picture, shots, ready, size, Path(folder)) for _ in range(rounds)]
        report = render_scene(scene, Path(folder) / "film.mp4", size, progress=False)
    count = len(shots)
    found: dict[str, Any] = {"scene": name, "size": list(size), "frames": count}
    for way in WAYS:
        found[way] = count / median(result[way][0] for result in results)
        found[f"{way}_ms"] = 1e3 * median(result[way][1] for result in results) / count
    found["gain"] = median(result["in_order"][0] / result["segments"][0] for result in results)
    return found | {"first_frame_seconds": report.first_frame, "whole_film_seconds": report.seconds}


def _round(
    picture: Picture, shots: list[Shot], ready: list[Surface], size: tuple[int, int], folder: Path
) -> dict[str, tuple[float, float]]:
    """Return wall time and processor time [s] of each of WAYS."""
    canvas = picture.background.copy()

    def drawing() -> None:
        for shot in shots:
            _painted(picture, shot, canvas)

    def encoder() -> None:
        with open_film(folder / "ready.mp4", size, RATE) as film:
            for surface in ready:
                film.free_surface()  # This call waits like a drawing thread, although the frames themselves are ready.
                film.add(surface)

    def in_order() -> None:
        with open_film(folder / "in-order.mp4", size, RATE) as film:
            for shot in shots:
                film.add(_painted(picture, shot, film.free_surface()))

    def segments() -> None:
        with open_film(folder / "segments.mp4", size, RATE) as film:
            film.paint_frames(shots, lambda surface, shot: _painted(picture, shot, surface))

    return {way: _timed(work) for way, work in zip(WAYS, (drawing, encoder, in_order, segments), strict=True)}


def _timed(work: Callable[[], None]) -> tuple[float, float]:
    wall, processor = perf_counter(), process_time()
    work()
    return perf_counter() - wall, process_time() - processor


def _painted(picture: Picture, shot: Shot, surface: Surface) -> Surface:
    picture.paint(surface, shot.row, text_opacity=shot.text_opacity)
    return surface


def reports() -> Iterator[Report]:
    """Yield a table with the frames per second of each way."""
    found = measure("one-on-four", (1280, 720))
    rows = [[title, f"{found[way]:.0f}", f"{found[f'{way}_ms']:.2f}"] for way, title in WAYS.items()]
    rows.append(["segments over in order", at_least(f"{found['gain']:.2f}", found["gain"], 1.7), ""])
    rows.append(["first frame [s]", at_most(found["first_frame_seconds"], 2.0), ""])
    note = f"median of 5 rounds of {found['frames']} frames"
    columns = ["", "frames a second (aim)", "processor ms a frame"]
    yield Report("one-on-four as mp4, 1280x720", columns, rows, [note], found)
