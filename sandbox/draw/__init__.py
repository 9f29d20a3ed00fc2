"""Drawing: a scene, the motions of its lanes and a row of them in, pixels out; it knows of no window, film or clock.

motions = [motion_of(trajectory) for trajectory in trajectories]  # one for each lane
draw(surface, scene, motions, row)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.draw.shared_scales import Scales, longest_lead, motion_of, scales_of
from softcradle.sandbox.motion import Motion
from softcradle.scenes import Scene

if TYPE_CHECKING:
    import pygame
    from softcradle.sandbox.draw.scene_picture import Picture

__all__ = ["Picture", "Scales", "draw", "longest_lead", "motion_of", "scales_of"]


def draw(
    surface: pygame.Surface, scene: Scene, motions: Sequence[Motion], row: int, scales: Scales | None = None
) -> None:
    """Draw row `row` of the motions of `scene` on `surface`; for many rows, a :class:`Picture` is faster."""
    from softcradle.sandbox.draw.scene_picture import Picture

    Picture(scene, motions, surface.get_size(), scales=scales).paint(surface, row)


def __getattr__(name: str) -> Any:
    """Picture needs pygame; pages, which need scales and motions alone, do without."""
    if name != "Picture":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from softcradle.sandbox.draw.scene_picture import Picture

    return Picture
