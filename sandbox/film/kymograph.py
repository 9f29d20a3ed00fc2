"""Kymograph (space-time picture) of each lane. All lanes have the same time axis. The picture has scale bars, and a
fine line on the markers shows the trajectory of each bead.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

import numpy as np
import pygame
from numpy.typing import NDArray
from softcradle.sandbox.draw.bodies import CYLINDER_LENGTH
from softcradle.sandbox.draw.lane_drawing import TALLEST_BEAD, LaneDrawing
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.shared_scales import Scales, scales_of
from softcradle.sandbox.draw.supersampling import fill_rectangle
from softcradle.sandbox.draw.text import shortened, width, write
from softcradle.sandbox.film.encoder import open_film
from softcradle.sandbox.film.formats import check, pixels_of
from softcradle.sandbox.film.scene_film import RenderReport
from softcradle.sandbox.film.scene_motion import Frames, after_time, motion_end, scene_motions, shown_span
from softcradle.sandbox.languages import N_
from softcradle.sandbox.motion import Motion
from softcradle.sandbox.story.bodies import is_gear
from softcradle.sandbox.story.numbers import plain, round_down, scientific
from softcradle.scenes import Scene

Pixels = NDArray[np.uint8]
Array = NDArray[np.float64]

BLACK = (0, 0, 0)
MARKER_WIDTH = 0.09  # width of a marker on a bead, as a fraction of the length of a bead
NARROWEST_MARKER = 5.0  # smallest width of a marker [pixels]
MARKER_HALF_HEIGHT = 0.06  # half of the height of a marker, as a fraction of the length of a bead
LINE_HEIGHT = 0.16  # Height of the recorded line of pixels above the ground, as a fraction of the length of a bead
SURROUNDINGS = 90.0  # Height of a camera frame above and below the beads [pixels]


class SlitCamera:
    """Camera that films one lane of a scene from the side.

    Arguments:
        scene: the Scene.
        number: index of the lane.
        scales: scales of all lanes, without magnified overlaps; their window is the field of view.
        width: width of a frame [pixels].
    """

    def __init__(self, scene: Scene, number: int, scales: Scales, width: int) -> None:
        low, high = scales.window
        height = math.ceil(scene.view.length * width / (high - low) / TALLEST_BEAD + 2 * SURROUNDINGS)
        self.drawing = LaneDrawing(pygame.Rect(0, 0, width, height), 1.0, scene, number, scales)
        self.background = pygame.Surface((width, height), 0, 32)
        self.drawing.backdrop(self.background)
        self.frame = pygame.Surface((width, height), 0, 32)
        self.line_y = round(self.drawing.ground - LINE_HEIGHT * self.drawing.bead)
        self.marker = max(NARROWEST_MARKER, MARKER_WIDTH * self.drawing.bead)  # width of a marker [pixels]
        chain = self.drawing.chain
        middle = [
            0.5 * (CYLINDER_LENGTH if is_gear(chain.contact[min(i, chain.contacts - 1)]) else 1.0)
            for i in range(len(chain.mass))
        ]
        self.middle = scene.view.length * (np.array(middle) + np.arange(len(middle)))
        self.marked = np.isfinite(chain.mass)  # Walls have no markers.

    def markers(self, motion: Motion, rows: int | slice = slice(None)) -> Array:
        """Return the centres of the markers on the beads (..., beads) for the samples `rows` of the motion. The
        positions are measured in pixels from the left edge of a frame.
        """
        places: Array = self.drawing.left() + self.drawing.scale * (motion.position[rows] + self.middle)
        return places[..., self.marked]

    def shoot(self, motion: Motion, row: int) -> pygame.Surface:
        """Return the frame that shows the sample `row` of `motion`. The next call reuses the surface."""
        self.frame.blit(self.background, (0, 0))
        self.drawing.paint(self.frame, motion, row, self.drawing.left())
        half = MARKER_HALF_HEIGHT * self.drawing.bead
        top, height = self.line_y - half, 2 * half + 1
        for x in self.markers(motion, row).tolist():
            fill_rectangle(self.frame, BLACK, (x - self.marker / 2, top, self.marker, height))
        return self.frame

    def line(self, motion: Motion, row: int) -> Pixels:
        """Return the horizontal line of pixels through the markers in the frame of the sample `row`. The shape of the
        line is (width, 3), with the colours red, green and blue.
        """
        cut: Pixels = pixels_of(self.shoot(motion, row))[self.line_y, :, 2::-1].copy()
        return cut


def stacked(camera: SlitCamera, motion: Motion) -> Pixels:
    """Return the kymograph as an array (T, width, 3). The kymograph contains one line of pixels from each frame. Time
    increases along the first axis.
    """
    return np.stack([camera.line(motion, row) for row in range(len(motion.time))])


CAMERA_RATE = 2052.0  # frame rate of the camera in the paper [frames per second]
CAMERA_FRAMES = Frames(of=N_("kymograph"), remedy=N_("choose fewer frames a second (--fps)"))
FEWEST_FRAMES = 120  # Smallest number of frames of a kymograph. If the motion is shorter, the frame rate increases.

# The following lengths are margins around the lanes, in design pixels.
MARGIN = 28.0  # left and right margin
HEADER = 80.0
FOOTER = 58.0  # lower margin, which contains the time bar
SIDE = 92.0  # margin on the right, which contains the length bars
LABEL = 24.0  # height of the name above a lane
LANE_GAP = 14.0  # space below each lane

TIME_BAR = 0.1  # length of the time bar [s], as in the paper
# Shortest duration [s] of a kymograph in SI units. This duration leaves enough space for the time bar of the paper.
SHORTEST_TIME = 0.35
DOT = 5  # length of one dot of a dotted line [pixels]
MARK = 13.0  # height of the name of a dotted line [design pixels]
WHITE = (255, 255, 255)


def in_si(scene: Scene) -> bool:
    """Return True if the scene uses SI units. A scene uses SI units if it sets the length and the mass of its beads."""
    massive = all("mass" in lane.model_fields_set for lane in scene.lanes)
    return massive and "length" in scene.view.model_fields_set


def camera_rate(scene: Scene, end: float, width: int) -> float:
    """Return the number of camera frames per second of motion. `end` [s] is the end of the motion.

    In SI units, the rate is the rate of the paper's camera. If this rate does not suit `width`, it is multiplied or
    divided by a whole number.
    """
    span = sum(shown_span(scene, end))
    if not in_si(scene):
        return width / span
    frames = CAMERA_RATE * span
    if frames > width:
        return CAMERA_RATE / math.ceil(frames / width)
    return CAMERA_RATE * math.ceil(FEWEST_FRAMES / frames) if frames < FEWEST_FRAMES else CAMERA_RATE


def filmed_scene(scene: Scene, end: float) -> Scene:
    """Return the scene with overlaps drawn to scale. If the scene is in SI units, it is shown long enough for the time
    bar of the paper.

    `end` [s] is the end of the motion. If the beads never touch, their motion does not end. Such beads are shown until
    the fastest bead is one bead length farther from the others.
    """
    view = {"magnify": 1.0}
    after = after_time(scene, end)
    if scene.duration is None and not end + after:
        after = view["after"] = scene.view.length / max(float(np.ptp(lane.velocity)) or 1.0 for lane in scene.lanes)
    if in_si(scene):
        view["after"] = max(after, SHORTEST_TIME - end)
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
    """Write a kymograph of `scene` to `output`. If this fails, no file is written.

    Arguments:
        scene: the Scene.
        output: a .png file.
        size: (width, height) of the picture [pixels].
        fps: camera frames per second of motion. None means 2052 as in the paper if the scene is in SI units, and
            otherwise one frame for each column of pixels.
        method, step: method and time step of the simulation, as for a film.

    Raises:
        UserError: if the kymograph cannot be written or the scene cannot be simulated.
    """
    start = perf_counter()
    check(output, size, None)
    with open_film(output, size, 1.0) as film:
        unit = min(size[1] / 720.0, size[0] / 1000.0)
        end = motion_end(scene, method, step)
        scene = filmed_scene(scene, end)
        rate = fps or camera_rate(scene, end, _width(size[0], unit))
        motions = scene_motions(scene, rate, method, step, end, CAMERA_FRAMES)
        simulated = perf_counter() - start
        surface = film.free_surface()
        paint(surface, scene, motions, rate, unit)
        film.add(surface)
    frames, seconds = len(motions[0].time), perf_counter() - start
    return RenderReport(Path(output), frames, 0.0, seconds, simulated, simulated, float(motions[0].time[0]))


def paint(surface: pygame.Surface, scene: Scene, motions: Sequence[Motion], rate: float, unit: float) -> None:
    """Draw the complete picture on `surface`. The `motions` have `rate` samples per second. There is one sample for
    each camera frame.
    """
    surface.fill(tones.background)
    wide, high = surface.get_size()
    left, scales = round(MARGIN * unit), scales_of(scene, motions)
    room = wide - 2 * MARGIN * unit
    write(
        surface,
        shortened(scene.title, 25 * unit, room, bold=True),
        (left, 16 * unit),
        25 * unit,
        tones.foreground,
        bold=True,
    )
    text = f"a line of pixels of each frame, {plain(rate, 5)} frames a second · white: the trajectory · {motions[0].method}"
    write(surface, shortened(text, 14 * unit, room), (left, 51 * unit), 14 * unit, tones.muted)
    each = (high - (HEADER + FOOTER) * unit) / len(motions)
    width = _width(wide, unit)
    for number, motion in enumerate(motions):
        label = LABEL * unit if scene.lanes[number].label else 0.0
        top = HEADER * unit + number * each + label
        camera = SlitCamera(scene, number, scales, max(8, round(each - label - LANE_GAP * unit)))
        place = pygame.Rect(left, round(top), width, camera.frame.get_width())
        if label:
            write(surface, scene.lanes[number].label, (left, top - 4 * unit), 15 * unit, bold=True, align=(0, 1))
        _lane(surface, place, camera, motion, unit)
        _length_bar(surface, place, scene, camera, unit)
    _time_bar(surface, scene, motions[0], (left, width / len(motions[0].time) * rate), high, unit)


def _width(wide: int, unit: float) -> int:
    """Return the width [pixels] of the kymographs in a picture that is `wide` pixels wide."""
    return round(wide - (2 * MARGIN + SIDE) * unit)


def instants(motion: Motion) -> list[tuple[str, int]]:
    """Return the name and the sample number of each marked moment.

    The marked moments are the release of strikers that start apart from the others, as in the paper, and the first
    touch.
    """
    found = []
    # Beads that touch at the start move in free flight before t = 0. If the motion has no free flight, the beads never
    # touch, or an external force acts.
    if motion.time[0] == 0.0 and (motion.overlap[0] < 0.0).any() and not (motion.force[0] > 0.0).any():
        found.append(("release", 0))
    pushing = np.flatnonzero((motion.force > 0.0).any(axis=1))
    if pushing.size:
        found.append(("first touch", int(pushing[0])))
    return found


def _mark(surface: pygame.Surface, place: pygame.Rect, x: int, words: str, down: float, unit: float) -> None:
    """Draw a dotted line across the rectangle `place`. Write the name of the line `down` pixels below its upper end."""
    for y in range(place.top, place.bottom, 2 * DOT):
        surface.fill(tones.foreground, (x, y, 1, min(DOT, place.bottom - y)))
    size = MARK * unit
    surface.fill(tones.background, (x + 3 * unit, place.top + down, width(words, size) + 6 * unit, 1.5 * size))
    write(surface, words, (x + 6 * unit, place.top + down), size, tones.foreground)


def _lane(surface: pygame.Surface, place: pygame.Rect, camera: SlitCamera, motion: Motion, unit: float) -> None:
    """Draw the kymograph of one lane, stretched to the rectangle `place`. Positions increase upwards. Dotted lines mark
    the release and the first touch.
    """
    lines: Pixels = stacked(camera, motion)
    frame_of = np.arange(place.width) * len(lines) // place.width
    surface.blit(pygame.surfarray.make_surface(lines[frame_of][:, ::-1]), place.topleft)
    column = place.width / len(lines)
    # The names are written at different heights because the marked moments can be close together.
    for k, (words, row) in enumerate(instants(motion)):
        x = round(place.left + column * row)
        _mark(surface, place, x, words, (6.0 + 1.8 * MARK * k) * unit, unit)
    xs = place.left + column * (np.arange(len(lines)) + 0.5)
    for path in place.bottom - camera.markers(motion).T:
        pygame.draw.aalines(surface, WHITE, False, np.column_stack((xs, path - 0.5)).tolist())


def _length_bar(surface: pygame.Surface, place: pygame.Rect, scene: Scene, camera: SlitCamera, unit: float) -> None:
    """Draw a scale bar on the right. The scale bar is as long as a bead."""
    length = scene.view.length
    x, tall = place.right + 16 * unit, length * camera.drawing.scale
    fill_rectangle(surface, tones.foreground, (x, place.bottom - tall, 4 * unit, tall))
    write(
        surface, _length(length), (x + 12 * unit, place.bottom - tall / 2), 15 * unit, tones.foreground, align=(0, 0.5)
    )


def _time_bar(
    surface: pygame.Surface, scene: Scene, motion: Motion, axis: tuple[float, float], high: int, unit: float
) -> None:
    """Draw the time bar. The time bar is 100 ms long as in the paper if there is enough space. Otherwise the length of
    the time bar is a round time.

    `axis` contains the left end of the time axis [pixels] and the number of pixels per second.
    """
    left, pixels = axis
    span = float(motion.time[-1] - motion.time[0])
    time = TIME_BAR if in_si(scene) and 0.02 * span < TIME_BAR < 0.9 * span else round_down(0.25 * span)
    y = high - (FOOTER - 12) * unit
    fill_rectangle(surface, tones.foreground, (left, y, time * pixels, 4 * unit))
    write(surface, _time(time), (left + time * pixels / 2, y + 8 * unit), 15 * unit, tones.foreground, align=(0.5, 0))


def _length(length: float) -> str:
    return f"{plain(100.0 * length)} cm" if 0.01 <= length < 1.0 else f"{scientific(length, 2)} m"


def _time(time: float) -> str:
    return f"{plain(1000.0 * time)} ms" if time < 0.5 else f"{plain(time)} s"
