"""The camera: frames of one lane as the stage draws them, a marker on every bead, and the line of pixels with the markers."""

from __future__ import annotations

import math

import numpy as np
import pygame
from numpy.typing import NDArray
from softcradle.sandbox.draw.bead_sprites import CYLINDER_LENGTH
from softcradle.sandbox.draw.lane_drawing import TALLEST_BEAD, LaneDrawing, is_gear
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.draw.supersampling import fill_rectangle
from softcradle.sandbox.film.codecs import pixels_of
from softcradle.sandbox.motion import Motion
from softcradle.scenes import Scene

Pixels = NDArray[np.uint8]
Array = NDArray[np.float64]

BLACK = (0, 0, 0)
LEAST_MARKER = 5.0  # pixels
MARKER = 0.09  # of a bead's length: width of its marker
LINE = 0.16  # of a bead's length above the ground: where the line of pixels is taken
TALL = 0.06  # of a bead's length: half the height of a marker
AROUND = 90.0  # pixels of the stage above and below the beads


class Camera:
    """Looks at lane `number` of `scene` from the side; `reach` pixels across, on beads drawn to scale.

    Arguments:
        scene: the Scene; its `scales` must not magnify overlaps.
        scales: what stands for what: the window is what the camera sees.
        reach: width of a frame [pixels].
    """

    def __init__(self, scene: Scene, number: int, scales: Scales, reach: int) -> None:
        low, high = scales.window
        height = math.ceil(scene.view.length * reach / (high - low) / TALLEST_BEAD + 2 * AROUND)
        self.stage = LaneDrawing(pygame.Rect(0, 0, reach, height), 1.0, scene, number, scales)
        self.ground = pygame.Surface((reach, height), 0, 32)
        self.stage.backdrop(self.ground)
        self.frame = pygame.Surface((reach, height), 0, 32)
        self.row = round(self.stage.ground - LINE * self.stage.bead)
        self.marker = max(LEAST_MARKER, MARKER * self.stage.bead)  # pixels
        chain = self.stage.chain
        middle = [
            0.5 * (CYLINDER_LENGTH if is_gear(chain.contact[min(i, chain.contacts - 1)]) else 1.0)
            for i in range(len(chain.mass))
        ]
        self.middle = scene.view.length * (np.array(middle) + np.arange(len(middle)))
        self.marked = np.isfinite(chain.mass)  # a wall has no marker

    def markers(self, track: Motion) -> Array:
        """(T, beads) where the trajectory says the middles of the markers are: pixels from the left of a frame."""
        places: Array = self.stage.left() + self.stage.scale * (track.position + self.middle)
        return places[:, self.marked]

    def shoot(self, track: Motion, row: int) -> pygame.Surface:
        """The frame of row `row` of `track`; it is good until the next."""
        self.frame.blit(self.ground, (0, 0))
        self.stage.paint(self.frame, track, row, self.stage.left())
        top = self.row - TALL * self.stage.bead
        for x in self.markers_of_row(track, row):
            fill_rectangle(self.frame, BLACK, (x - self.marker / 2, top, self.marker, 2 * TALL * self.stage.bead + 1))
        return self.frame

    def markers_of_row(self, track: Motion, row: int) -> list[float]:
        """The same as :meth:`markers` for one row."""
        place = self.stage.left() + self.stage.scale * (track.position[row] + self.middle)
        found: list[float] = place[self.marked].tolist()
        return found

    def line(self, track: Motion, row: int) -> Pixels:
        """(reach, 3) the line of pixels of that frame which holds the markers, red, green, blue."""
        cut: Pixels = pixels_of(self.shoot(track, row))[self.row, :, 2::-1].copy()
        return cut


def stacked(camera: Camera, track: Motion) -> Pixels:
    """(T, reach, 3) the lines of all frames: the kymograph as the paper's, time along the first axis."""
    return np.stack([camera.line(track, row) for row in range(len(track.time))])


def traced(camera: Camera, track: Motion) -> Pixels:
    """(T, reach, 3) the same from the trajectory alone: black where a marker covers a pixel, white elsewhere."""
    edges = np.arange(camera.frame.get_width())
    ink = np.zeros((len(track.time), len(edges)))
    for place in camera.markers(track).T:
        left, right = place[:, None] - camera.marker / 2, place[:, None] + camera.marker / 2
        ink += np.clip(np.minimum(right, edges + 1.0) - np.maximum(left, edges), 0.0, 1.0)
    shade = np.round(255.0 * (1.0 - np.minimum(ink, 1.0))).astype(np.uint8)
    return np.repeat(shade[..., None], 3, axis=2)
