"""Drawing: a scene, its history and a time in, pixels out. Nothing here knows of windows, films or clocks.

tracks = [motion_of(trajectory) for trajectory in trajectories]     # one a lane
draw(surface, scene, tracks, row)                                  # row of the history: the state that is drawn
"""

from __future__ import annotations

from collections.abc import Sequence

import pygame
from softcradle.sandbox.draw.drawable_trajectory import longest_lead, motion_of
from softcradle.sandbox.draw.scene_picture import Picture
from softcradle.sandbox.draw.shared_scales import Scales, scales_of
from softcradle.sandbox.motion import Motion
from softcradle.scenes import Scene

__all__ = ["Picture", "Scales", "draw", "longest_lead", "motion_of", "scales_of"]


def draw(
    surface: pygame.Surface, scene: Scene, tracks: Sequence[Motion], row: int, scales: Scales | None = None
) -> None:
    """Draw one moment of `scene` on `surface`; a :class:`Picture` draws many of them faster."""
    Picture(scene, tracks, surface.get_size(), scales=scales).paint(surface, row)
