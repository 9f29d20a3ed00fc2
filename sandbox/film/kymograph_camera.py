"""The camera of a kymograph: frames of one lane with a marker on every bead, and the line of pixels through the markers."""

from __future__ import annotations

import math

import numpy as np
import pygame
from numpy.typing import NDArray
from softcradle.sandbox.draw.bead_sprites import CYLINDER_LENGTH
from softcradle.sandbox.draw.lane_drawing import TALLEST_BEAD, LaneDrawing, is_gear
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.draw.supersampling import fill_rectangle
from softcradle.sandbox.film.film_kinds import pixels_of
from softcradle.sandbox.motion import Motion
from softcradle.scenes import Scene

Pixels = NDArray[np.uint8]
Array = NDArray[np.float64]

BLACK = (0, 0, 0)
MARKER_WIDTH = 0.09  # of a bead's length
NARROWEST_MARKER = 5.0  # pixels
MARKER_HALF_HEIGHT = 0.06  # of a bead's length
LINE_HEIGHT = 0.16  # of the line of pixels above the ground, in lengths of a bead
SURROUNDINGS = 90.0  # pixels of a frame above and below the beads


class Camera:
    """A camera that films lane `number` of `scene` from the side.

    Arguments:
        scene: the Scene.
        number: of the lane.
        scales: the scales of all lanes, which must not magnify overlaps; their window is what the camera shows.
        width: of a frame [pixels].
    """

    def __init__(self, scene: Scene, number: int, scales: Scales, width: int) -> None:
        low, high = scales.window
        height = math.ceil(scene.view.length * width / (high - low) / TALLEST_BEAD + 2 * SURROUNDINGS)
        self.drawing = LaneDrawing(pygame.Rect(0, 0, width, height), 1.0, scene, number, scales)
        self.background = pygame.Surface((width, height), 0, 32)
        self.drawing.backdrop(self.background)
        self.frame = pygame.Surface((width, height), 0, 32)
        self.line_y = round(self.drawing.ground - LINE_HEIGHT * self.drawing.bead)
        self.marker = max(NARROWEST_MARKER, MARKER_WIDTH * self.drawing.bead)  # pixels
        chain = self.drawing.chain
        middle = [
            0.5 * (CYLINDER_LENGTH if is_gear(chain.contact[min(i, chain.contacts - 1)]) else 1.0)
            for i in range(len(chain.mass))
        ]
        self.middle = scene.view.length * (np.array(middle) + np.arange(len(middle)))
        self.marked = np.isfinite(chain.mass)  # a wall has no marker

    def markers(self, motion: Motion, rows: int | slice = slice(None)) -> Array:
        """(..., beads) the middles of the markers in `rows` of the motion: pixels from the left of a frame."""
        places: Array = self.drawing.left() + self.drawing.scale * (motion.position[rows] + self.middle)
        return places[..., self.marked]

    def shoot(self, motion: Motion, row: int) -> pygame.Surface:
        """The frame of row `row` of `motion`; the next call draws on the same surface."""
        self.frame.blit(self.background, (0, 0))
        self.drawing.paint(self.frame, motion, row, self.drawing.left())
        half = MARKER_HALF_HEIGHT * self.drawing.bead
        top, height = self.line_y - half, 2 * half + 1
        for x in self.markers(motion, row).tolist():
            fill_rectangle(self.frame, BLACK, (x - self.marker / 2, top, self.marker, height))
        return self.frame

    def line(self, motion: Motion, row: int) -> Pixels:
        """(width, 3) the line of pixels of that frame through the markers: red, green, blue."""
        cut: Pixels = pixels_of(self.shoot(motion, row))[self.line_y, :, 2::-1].copy()
        return cut


def stacked(camera: Camera, motion: Motion) -> Pixels:
    """(T, width, 3) the lines of all frames, which are the kymograph; time along the first axis."""
    return np.stack([camera.line(motion, row) for row in range(len(motion.time))])
