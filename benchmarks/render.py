"""The rate of rendering, against the rate at which the encoder alone takes finished frames.

    python -m benchmarks.render [--scene one-on-four] [--size 1280x720] [--json]

Both encode the same frames, those of the scene's film, because a moving picture costs the encoder more than a still one.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.draw import Picture
from softcradle.sandbox.film.scene_film import Shot, render_scene, shot_list
from softcradle.sandbox.film.scene_motion import scene_motions
from softcradle.sandbox.film.writer import open_film

from softcradle import scenes

if TYPE_CHECKING:
    from pygame import Surface

RATE = 60.0  # frames a second of the film
MOST_FRAMES = 240  # of a round


def measure(name: str, size: tuple[int, int], rounds: int = 5) -> dict[str, Any]:
    """Frames a second of drawing alone, the encoder alone and both together: medians of `rounds` interleaved rounds."""
    scene = scenes.load(name)
    motions = scene_motions(scene, RATE * scene.view.slow)
    picture = Picture(scene, motions, size)
    shots = shot_list(scene, len(motions[0].time), RATE)
    shots = shots[:: max(1, len(shots) // MOST_FRAMES)]
    ready = [_painted(picture, shot, picture.background.copy()) for shot in shots]
    results = [_round(picture, shots, ready, size) for _ in range(rounds)]
    drawing, encoding, both = (median(result[k] for result in results) for k in range(3))
    with tempfile.TemporaryDirectory() as folder:
        report = render_scene(scene, Path(folder) / "film.mp4", size, progress=False)
    return {
        "scene": name,
        "size": list(size),
        "frames": len(ready),
        "drawing": drawing,
        "encoder": encoding,
        "render": both,
        "share": median(result[2] / result[1] for result in results),
        "first_frame_seconds": report.first_frame,
        "whole_film_seconds": report.seconds,
    }


def _round(
    picture: Picture, shots: list[Shot], ready: list[Surface], size: tuple[int, int]
) -> tuple[float, float, float]:
    canvas = picture.background.copy()
    began = perf_counter()
    for shot in shots:
        _painted(picture, shot, canvas)
    drawn = perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        with open_film(Path(folder) / "ready.mp4", size, RATE) as film:
            for surface in ready:
                film.free_surface()  # waits as a drawing thread would; the frames themselves are ready
                film.add(surface)
        encoded = perf_counter()
        with open_film(Path(folder) / "both.mp4", size, RATE) as film:
            for shot in shots:
                film.add(_painted(picture, shot, film.free_surface()))
        both = perf_counter()
    return len(shots) / (drawn - began), len(ready) / (encoded - drawn), len(shots) / (both - encoded)


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
    print(f"{found['scene']} at {width}x{height}, frames a second (median of 5):")
    print(f"  drawing alone   {found['drawing']:7.0f}")
    print(f"  encoder alone   {found['encoder']:7.0f}")
    print(f"  both, rendering {found['render']:7.0f}   {100 * found['share']:.0f} % of the encoder alone")
    print(f"first frame after {found['first_frame_seconds']:.2f} s, whole film {found['whole_film_seconds']:.1f} s")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
