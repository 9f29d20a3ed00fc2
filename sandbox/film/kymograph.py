"""The picture: a kymograph for each lane, one time axis, scale bars, and the trajectory as a fine line on the markers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

import numpy as np
import pygame
from softcradle.sandbox.draw import scales_of
from softcradle.sandbox.draw.number_format import round_down, scientific
from softcradle.sandbox.draw.palette import BACKGROUND, FOREGROUND, MUTED
from softcradle.sandbox.draw.supersampling import fill_rectangle
from softcradle.sandbox.draw.text import shortened, write
from softcradle.sandbox.film.codecs import check
from softcradle.sandbox.film.kymograph_camera import Camera, Pixels, stacked
from softcradle.sandbox.film.scene_film import AFTER, LEAD, RenderReport, motion_end, simulated
from softcradle.sandbox.film.writer import open_film
from softcradle.sandbox.motion import Motion
from softcradle.scenes import Scene

SUFFIX = ".kymograph.png"
CAMERA_RATE = 2052.0  # frames a second of the paper's camera
FEWEST_FRAMES = 120
MARGIN, HEADER, FOOT, SIDE = 28.0, 80.0, 58.0, 92.0  # design pixels around the lanes
LABEL, BETWEEN = 24.0, 14.0  # above a lane with a name, and below every lane
TIME_BAR = 0.1  # s, the paper's
LEAST_TIME = 0.35  # s that a kymograph in SI shows
DOT = 5  # pixels of a dotted line
WHITE = (255, 255, 255)


def in_si(scene: Scene) -> bool:
    """Whether the scene speaks of real bodies: it gives their length and their mass, which are 1 where nobody does."""
    massive = all("mass" in lane.model_fields_set for lane in scene.lanes)
    return massive and "length" in scene.view.model_fields_set


def camera_rate(scene: Scene, end: float, width: int) -> float:
    """Frames for a second of motion that ends at `end` [s]: the paper's in SI, or a part or multiple that fits."""
    after = scene.view.after if scene.view.after is not None else AFTER * end
    span = end if scene.duration is not None else end + after + LEAD * end
    if not in_si(scene):
        return width / span
    frames = CAMERA_RATE * span
    if frames > width:
        return CAMERA_RATE / math.ceil(frames / width)
    return CAMERA_RATE * math.ceil(FEWEST_FRAMES / frames) if frames < FEWEST_FRAMES else CAMERA_RATE


def as_seen(scene: Scene, end: float) -> Scene:
    """The same with overlaps to scale and, in SI, so much time after its `end` [s] that the paper's bar has room."""
    view = {"magnify": 1.0}
    if in_si(scene):
        after = AFTER * end if scene.view.after is None else scene.view.after
        view["after"] = max(after, LEAST_TIME - end)
    return scene.model_copy(update={"view": scene.view.model_copy(update=view)})


def render_kymograph(
    scene: Scene,
    output: str,
    size: tuple[int, int] = (1280, 720),
    *,
    fps: float | None = None,
    method: str | None = None,
    step: float | None = None,
) -> RenderReport:
    """Write a kymograph of `scene` to `output`, whole or not at all.

    Arguments:
        scene: the Scene.
        output: a .png.
        size: (width, height) of the picture [pixels].
        fps: frames of the camera for a second of motion; None: 2052 as in the paper where the scene is in SI units,
            else as many as there are columns of pixels.
        method, step: as for a film.

    Raises:
        UserError: what cannot be written or simulated.
    """
    began = perf_counter()
    check(output, size, None)
    with open_film(output, size, 1.0) as film:
        unit = min(size[1] / 720.0, size[0] / 1000.0)
        end = motion_end(scene, method, step)
        scene = as_seen(scene, end)
        rate = fps or camera_rate(scene, end, _width(size[0], unit))
        tracks = simulated(scene, rate, method=method, step=step)
        known = perf_counter() - began
        surface = film.blank()
        paint(surface, scene, tracks, rate, unit)
        film.add(surface)
    frames, seconds = len(tracks[0].time), perf_counter() - began
    return RenderReport(Path(output), frames, 0.0, seconds, known, known, float(tracks[0].time[0]))


def paint(surface: pygame.Surface, scene: Scene, tracks: Sequence[Motion], rate: float, unit: float) -> None:
    """Draw everything on `surface`; the `tracks` have `rate` rows a second, a camera frame each."""
    surface.fill(BACKGROUND)
    wide, high = surface.get_size()
    left, scales = round(MARGIN * unit), scales_of(scene, tracks)
    room = wide - 2 * MARGIN * unit
    write(
        surface, shortened(scene.title, 25 * unit, room, bold=True), (left, 16 * unit), 25 * unit, FOREGROUND, bold=True
    )
    told = f"a line of pixels of each frame, {rate:.5g} frames a second · white: the trajectory · {tracks[0].method}"
    write(surface, shortened(told, 14 * unit, room), (left, 51 * unit), 14 * unit, MUTED)
    each = (high - (HEADER + FOOT) * unit) / len(tracks)
    width = _width(wide, unit)
    for number, track in enumerate(tracks):
        label = LABEL * unit if scene.lanes[number].label else 0.0
        top = HEADER * unit + number * each + label
        camera = Camera(scene, number, scales, max(8, round(each - label - BETWEEN * unit)))
        place = pygame.Rect(left, round(top), width, camera.frame.get_width())
        if label:
            write(surface, scene.lanes[number].label, (left, top - 4 * unit), 15 * unit, bold=True, align=(0, 1))
        _lane(surface, place, camera, track)
        _length_bar(surface, place, scene, camera, unit)
    _time_bar(surface, scene, tracks[0], (left, width / len(tracks[0].time) * rate), high, unit)


def _width(wide: int, unit: float) -> int:
    """Columns of pixels that kymographs have in a picture `wide` pixels wide."""
    return round(wide - (2 * MARGIN + SIDE) * unit)


def _lane(surface: pygame.Surface, place: pygame.Rect, camera: Camera, track: Motion) -> None:
    """The stacked lines, stretched over `place`, positions upwards; a dotted line at the first touch."""
    lines: Pixels = stacked(camera, track)
    frame_of = np.arange(place.width) * len(lines) // place.width
    surface.blit(pygame.surfarray.make_surface(lines[frame_of][:, ::-1]), place.topleft)
    touched = np.flatnonzero((track.force > 0.0).any(axis=1))
    column = place.width / len(lines)
    if touched.size:
        x = round(place.left + column * int(touched[0]))
        for y in range(place.top, place.bottom, 2 * DOT):
            surface.fill(FOREGROUND, (x, y, 1, min(DOT, place.bottom - y)))
    xs = place.left + column * (np.arange(len(lines)) + 0.5)
    for path in place.bottom - camera.markers(track).T:
        pygame.draw.aalines(surface, WHITE, False, np.column_stack((xs, path - 0.5)).tolist())


def _length_bar(surface: pygame.Surface, place: pygame.Rect, scene: Scene, camera: Camera, unit: float) -> None:
    """On the right: a bar as long as a bead."""
    length = scene.view.length
    x, tall = place.right + 16 * unit, length * camera.stage.scale
    fill_rectangle(surface, FOREGROUND, (x, place.bottom - tall, 4 * unit, tall))
    write(surface, _length(length), (x + 12 * unit, place.bottom - tall / 2), 15 * unit, FOREGROUND, align=(0, 0.5))


def _time_bar(
    surface: pygame.Surface, scene: Scene, track: Motion, axis: tuple[float, float], high: int, unit: float
) -> None:
    """Below: the paper's 100 ms where they fit, else a round time; `axis` is the left end and pixels a second."""
    left, pixels = axis
    span = float(track.time[-1] - track.time[0])
    time = TIME_BAR if in_si(scene) and 0.02 * span < TIME_BAR < 0.9 * span else round_down(0.25 * span)
    y = high - (FOOT - 12) * unit
    fill_rectangle(surface, FOREGROUND, (left, y, time * pixels, 4 * unit))
    write(surface, _time(time), (left + time * pixels / 2, y + 8 * unit), 15 * unit, FOREGROUND, align=(0.5, 0))


def _length(length: float) -> str:
    return f"{100.0 * length:.3g} cm" if 0.01 <= length < 1.0 else f"{scientific(length, 0)} m"


def _time(time: float) -> str:
    return f"{1000.0 * time:.3g} ms" if time < 0.5 else f"{time:.3g} s"
