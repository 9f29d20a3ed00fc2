"""The rate of rendering: drawing alone, one encoder alone, both in order, and segments encoded side by side.

    python -m benchmarks.render [--scene one-on-four] [--size 1280x720] [--json]

All encode the same frames, those of the scene's film, because a moving picture costs the encoder more than a still one.
Rates are of a machine that does nothing else; processor time is nearly the same on one that does.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.draw import Picture
from softcradle.sandbox.film.encoder import open_film
from softcradle.sandbox.film.scene_film import Shot, render_scene, shot_list
from softcradle.sandbox.film.scene_motion import scene_motions

from softcradle import scenes

if TYPE_CHECKING:
    from pygame import Surface

RATE = 60.0  # frames a second of the film
MOST_FRAMES = 360  # of a round
WAYS = {
    "drawing": "drawing alone",
    "encoder": "one encoder alone",
    "in_order": "drawing and one encoder",
    "segments": "segments side by side",
}


def measure(name: str, size: tuple[int, int], rounds: int = 5) -> dict[str, Any]:
    """Frames a second, and milliseconds of processor a frame, of each way: medians of `rounds` interleaved rounds."""
    scene = scenes.load(name)
    motions = scene_motions(scene, RATE * scene.view.slow)
    picture = Picture(scene, motions, size)
    shots = shot_list(scene, len(motions[0].time), RATE)
    shots = shots[:: max(1, len(shots) // MOST_FRAMES)]  # pictures that stay are as large a part of them as of the film
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
    """Wall and processor time [s] of each of WAYS."""
    canvas = picture.background.copy()

    def drawing() -> None:
        for shot in shots:
            _painted(picture, shot, canvas)

    def encoder() -> None:
        with open_film(folder / "ready.mp4", size, RATE) as film:
            for surface in ready:
                film.free_surface()  # waits as a drawing thread would; the frames themselves are ready
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


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", default="one-on-four")
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args(arguments)
    width, height = map(int, args.size.split("x"))
    found = measure(args.scene, (width, height))
    if args.json:
        print(json.dumps(found))
        return 0
    print(f"{found['scene']} at {width}x{height}, frames a second and ms of processor a frame (medians of 5):")
    for way, title in WAYS.items():
        print(f"  {title:<28}{found[way]:7.0f} {found[f'{way}_ms']:7.2f}")
    print(f"segments over in order: {found['gain']:.2f}")
    print(f"first frame after {found['first_frame_seconds']:.2f} s, whole film {found['whole_film_seconds']:.1f} s")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
