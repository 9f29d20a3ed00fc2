"""Film of a scene. The module computes the motion, draws every frame, and passes the frames to the encoder, which runs
in separate threads.
"""

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import pygame
from softcradle.sandbox.console import ProgressShown
from softcradle.sandbox.draw.scene_picture import Picture
from softcradle.sandbox.film.encoder import open_film
from softcradle.sandbox.film.formats import check
from softcradle.sandbox.film.scene_motion import Frames, checked_slow, first_force, scene_motions, strongest_row
from softcradle.sandbox.motion import Motion
from softcradle.scenes import Scene

READING_TIME = 0.22  # duration for which the scene's text is shown, in seconds of film per word
LONGEST_READING_TIME = 5.0  # longest duration for which the scene's text is shown [s of film]
# Smallest number of samples of the motion per second of film. This number keeps curves smooth at low frame rates.
LEAST_ROWS = 50.0
FADE_TIME = 0.5  # duration in which the text of the scene appears [s of film]
LAST_FRAME_TIME = 1.2  # duration for which the last frame is shown before the text appears [s of film]
# Longest flight before the first force, as a fraction of a film without its text. A longer flight is cut.
MOST_BEFORE_HIT = 0.2
FOLDER_RATE = 60.0  # default frames per second of a folder of pictures


@dataclass(frozen=True)
class RenderReport:
    """Result and cost of writing a film or picture.

    Attributes:
        output: the file or folder.
        frames: number of frames.
        duration: duration of the film [s]; 0 for a single picture.
        seconds: total wall time.
        simulated: wall time until the motion was computed [s].
        first_frame: wall time until the first frame was drawn [s].
        clock: time of the motion that the first frame shows [s].
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
    pixel_format: str | None = None,
    progress: bool = True,
) -> RenderReport:
    """Write `scene` as a film to `output`. If this fails, no file is written.

    Arguments:
        scene: the Scene.
        output: name of the output. A name that ends in .mp4 or .gif is a film. A name that ends in .png is one picture
            at the largest force. A folder, which ends in /, contains numbered PNG files.
        size: (width, height) [pixels].
        fps: frames per second. None means 60 for mp4 and folders, and 25 for GIF.
        slow: seconds of film for each second of motion. None uses the value of the scene.
        method, step: method and time step of the simulation. None uses the values of the scene. The default is
            `conserving`. Its steps are a thousandth of the shortest contact and finer than a pixel.
        pixel_format: yuv420p or yuv444p, for mp4.
        progress: if True, show a bar with the remaining time.

    Raises:
        UserError: if the film cannot be written or the scene cannot be simulated. No file is left behind.
    """
    start = perf_counter()
    output = os.fspath(output)
    codec = check(output, size, fps, pixel_format)
    rate = fps or (codec.frame_rate if codec else FOLDER_RATE)
    slow = scene.view.slow if slow is None else checked_slow(slow)
    single = codec is None and output.lower().endswith(".png")
    with (
        open_film(output, size, rate, pixel_format) as film,
        ProgressShown("simulating", shown=progress and not single) as bar,
    ):
        rows_a_frame = math.ceil(LEAST_ROWS / rate)
        frames = None if single else Frames(rows_a_frame)
        motions = scene_motions(scene, rate * slow * rows_a_frame, method, step, frames=frames)
        simulated = perf_counter() - start
        picture, strongest = Picture(scene, motions, size, slow=slow), strongest_row(motions)
        sample = pygame.Surface(size, 0, 32)
        picture.paint(sample, strongest)
        film.take_colours(sample)
        first_frame = perf_counter() - start
        shots = [Shot(strongest)] if single else film_shots(scene, motions, rate, rows_a_frame)
        bar.tell("frames", 0, len(shots))

        def paint(surface: pygame.Surface, shot: Shot) -> None:
            picture.paint(surface, shot.row, text_opacity=shot.text_opacity)

        film.paint_frames(shots, paint, bar.advance)
    duration, clock = 0.0 if single else len(shots) / rate, float(motions[0].time[shots[0].row])
    return RenderReport(Path(output), len(shots), duration, perf_counter() - start, simulated, first_frame, clock)


@dataclass(frozen=True)
class Shot:
    """One frame of a film. A shot consists of the sample number of the motions and the opacity of the scene's text (0
    to 1).
    """

    row: int
    text_opacity: float = 0.0


def film_shots(scene: Scene, motions: Sequence[Motion], rate: float, rows_a_frame: int = 1) -> list[Shot]:
    """Return the list of frames of a film that shows `motions` at `rate` frames per second."""
    return shot_list(scene, len(motions[0].time), rate, rows_a_frame, first_force(motions))


def shot_list(scene: Scene, rows: int, rate: float, rows_a_frame: int = 1, hit: int = 0) -> list[Shot]:
    """Return the list of frames of a film. The film first shows the motion. Then the film shows the last sample for a
    moment. Finally, the film shows the last sample together with the text of the scene.

    `hit` is the sample number of the first force. The time before this sample takes at most the fraction
    MOST_BEFORE_HIT of the film.
    """
    reading = round(min(READING_TIME * len(scene.text.split()), LONGEST_READING_TIME) * rate)
    fade, still = max(1, round(FADE_TIME * rate)), round(LAST_FRAME_TIME * rate)
    whole = rows + rows_a_frame * still
    begin = max(0, math.ceil((hit - MOST_BEFORE_HIT * whole) / (1.0 - MOST_BEFORE_HIT)))
    text = [Shot(rows - 1, min(1.0, (k + 1) / fade)) for k in range(reading)]
    return [Shot(row) for row in range(begin, rows, rows_a_frame)] + [Shot(rows - 1)] * still + text
