"""Render: a scene into a film. Simulate each lane once, draw every frame, and let the film's thread compress them."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import pygame
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from softcradle.physics.simulation import solve
from softcradle.physics.trajectory import Trajectory
from softcradle.sandbox.draw import Picture, longest_lead, motion_of
from softcradle.sandbox.film.codecs import check
from softcradle.sandbox.film.writer import open_film
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Scene

FILM_METHOD = "conserving"  # energy to round-off, and a kernel that is compiled in a few seconds
LEAD = 0.25  # free flight before the start, as a share of the motion, where the scene begins in touch
AFTER = 0.35  # free flight after the end, the same way, where the scene does not say
READING = 0.22  # seconds of film a word of the scene's text
LONGEST_READING = 5.0
FADE = 0.5  # seconds in which the text goes
REST = 1.2  # seconds for which the last frame stays
LONGEST_FILM = 100_000  # frames
PICTURE_RATE = 60.0  # frames a second of a folder of pictures


@dataclass(frozen=True)
class RenderReport:
    """What a film is and what it cost.

    Attributes:
        output: where it is.
        frames: their number.
        duration: of the film [s]; 0 for a single picture.
        seconds: wall time of all.
        simulated, first_frame: wall time until the motion was known, and until the first frame was drawn [s].
        clock: time in the motion of its first moving frame [s]; where the scene has a text, frames to read it come before.
    """

    output: Path
    frames: int
    duration: float
    seconds: float
    simulated: float
    first_frame: float
    clock: float


def render_scene(
    scene: Scene,
    output: str | os.PathLike[str],
    size: tuple[int, int] = (1280, 720),
    *,
    fps: float | None = None,
    slow: float | None = None,
    method: str | None = None,
    step: float | None = None,
    pixels: str | None = None,
    progress: bool = True,
) -> RenderReport:
    """Write `scene` as a film to `output`, whole or not at all.

    Arguments:
        scene: the Scene.
        output: .mp4, .gif, .webp or .avif; .png: one picture, of the moment of the greatest force; a folder (ends in
            /): numbered PNG files.
        size: (width, height) [pixels].
        fps: frames a second; None: 60 for mp4 and folders, 25 for GIF, 30 for WebP and AVIF.
        slow: seconds of film for one of motion; None takes the scene's.
        method, step: for the simulation; None takes the scene's, else `conserving`: its steps, a thousandth of the shortest
            contact, are finer than a pixel.
        pixels: yuv420p or yuv444p, for mp4.
        progress: show a bar with the time left.

    Raises:
        UserError: what cannot be written or simulated; nothing is left behind.
    """
    began = perf_counter()
    output = os.fspath(output)
    codec = check(output, size, fps, pixels)
    rate = fps or (codec.frame_rate if codec else PICTURE_RATE)
    slow = scene.view.slow if slow is None else slow
    if not (math.isfinite(slow) and slow > 0.0):
        raise UserError(f"slow motion must be a number > 0, not {slow:g}")
    still = codec is None and output.lower().endswith(".png")
    with open_film(output, size, rate, pixels) as film, _Bar(progress and not still) as bar:
        tracks = simulated(scene, rate * slow, method=method, step=step)
        known = perf_counter() - began
        picture = Picture(scene, tracks, size, slow=slow)
        sample = pygame.Surface(size, 0, 32)
        picture.paint(sample, strongest_row(tracks))
        film.learn(sample)
        first_frame = perf_counter() - began
        shots = [Shot(strongest_row(tracks))] if still else script(scene, len(tracks[0].time), rate)
        bar.begin(len(shots))
        for shot in shots:
            surface = film.blank()
            picture.paint(surface, shot.row, text_opacity=shot.text_opacity)
            film.add(surface)
            bar.advance()
    duration, clock = 0.0 if still else len(shots) / rate, float(tracks[0].time[0])
    return RenderReport(Path(output), len(shots), duration, perf_counter() - began, known, first_frame, clock)


@dataclass(frozen=True)
class Shot:
    """One frame: the row of the tracks, and how opaque the scene's text is."""

    row: int
    text_opacity: float = 0.0


def script(scene: Scene, rows: int, rate: float) -> list[Shot]:
    """The frames: the first row while the scene's text can be read, then the motion, then the last row for a moment."""
    reading = round(min(READING * len(scene.text.split()), LONGEST_READING) * rate)
    fade = max(1, round(FADE * rate))
    opening = [Shot(0, min(1.0, (reading - k) / fade)) for k in range(reading)]
    return opening + [Shot(row) for row in range(rows)] + [Shot(rows - 1)] * round(REST * rate)


def strongest_row(tracks: Sequence[Motion]) -> int:
    """Row of the greatest contact force in any lane: the moment for a single picture."""
    return int(np.argmax(np.max([track.force.max(axis=1) for track in tracks], axis=0)))


def simulated(
    scene: Scene, rows_per_second: float, method: str | None = None, step: float | None = None
) -> list[Motion]:
    """A track for each lane of `scene`, all at the same times, with free flight at both ends.

    Raises UserError where the method or the step does not suit the scene, or where there would be too many rows;
    `rows_per_second` are those of the motion. What may be wrong with it is said by RuntimeWarnings.
    """
    tracks, sentences = simulated_quietly(scene, rows_per_second, method, step)
    for sentence in sentences:
        warnings.warn(sentence, RuntimeWarning, stacklevel=2)
    return tracks


def simulated_quietly(
    scene: Scene, rows_per_second: float, method: str | None = None, step: float | None = None
) -> tuple[list[Motion], tuple[str, ...]]:
    """What :func:`simulated` does, with the sentences that it warns with: Python's warnings are not for threads."""
    try:
        settings = scene.settings(method=method or scene.method or FILM_METHOD, step=step)
        times = _times(scene, motion_end(scene, method, step), rows_per_second)
        moving = times[times >= 0.0]
        settings |= {"duration": float(moving[-1]), "samples": moving}
        found = [_solve(scene, k, settings) for k in range(len(scene.lanes))]
    except ValueError as error:
        raise UserError(str(error)) from error
    tracks = [motion_of(trajectory, times[times < 0.0]) for trajectory in found]
    _require_finite(tracks)
    return tracks, tuple(sentence for trajectory in found for sentence in trajectory.warnings)


def _require_finite(tracks: Sequence[Motion]) -> None:
    if not all(np.isfinite(track.position).all() and np.isfinite(track.force).all() for track in tracks):
        raise UserError(f"the motion by {tracks[0].method} did not stay finite: choose a smaller step")


def motion_end(scene: Scene, method: str | None = None, step: float | None = None) -> float:
    """Time at which the last lane of `scene` is over, or what the scene says [s]. UserError as in :func:`simulated`."""
    try:
        settings = scene.settings(method=method or scene.method or FILM_METHOD, step=step, samples=2)
        return float(scene.duration or max(_solve(scene, k, settings).time[-1] for k in range(len(scene.lanes))))
    except ValueError as error:
        raise UserError(str(error)) from error


def _solve(scene: Scene, lane: int, settings: dict[str, Any]) -> Trajectory:
    return solve(scene.lanes[lane].chain(), scene.lanes[lane].velocity, **settings)


def _times(scene: Scene, end: float, rows_per_second: float) -> Array:
    """Times of all rows [s]; 0, the start, is one of them."""
    touching = any(0.0 in lane.chain().gap for lane in scene.lanes) and not any(
        any(lane.chain().gap) for lane in scene.lanes
    )
    lead = LEAD * end if touching else 0.0
    for lane in scene.lanes:
        lead = min(lead, longest_lead(lane.chain(), np.array(lane.velocity)))
    after = AFTER * end if scene.view.after is None else scene.view.after
    if scene.duration is not None:
        after = 0.0
    first, last = -math.floor(lead * rows_per_second), math.ceil((end + after) * rows_per_second)
    if last - first > LONGEST_FILM:
        raise UserError(f"the film would have {last - first} frames, more than {LONGEST_FILM}: choose less slow motion")
    return np.arange(first, max(last, first + 1) + 1) / rows_per_second


class _Bar:
    """What is being done, frames so far and time left, on standard error."""

    def __init__(self, shown: bool) -> None:
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("frames, time left"),
            TimeRemainingColumn(),
        )
        self._progress = Progress(*columns, console=Console(stderr=True), transient=True, disable=not shown)
        self._task = self._progress.add_task("simulating", total=None)

    def __enter__(self) -> _Bar:
        self._progress.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._progress.stop()

    def begin(self, frames: int) -> None:
        """The motion is known; `frames` are to be drawn."""
        self._progress.reset(self._task, description="rendering", total=frames)

    def advance(self) -> None:
        """One more frame."""
        self._progress.advance(self._task)
