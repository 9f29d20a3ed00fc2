"""The look ahead: the motion of a scene before it is played, for thumbnails and for the scales of its page."""

from __future__ import annotations

from softcradle.physics.methods import AUTO
from softcradle.sandbox.motion import Motion
from softcradle.scenes import Scene

ROWS = 240  # of the motion, at least
ROWS_PER_SECOND = 60.0  # of the scene as it is shown, at least
METHOD = "conserving"  # where the scene gives none: a picture needs no more digits


def motions_ahead(scene: Scene) -> list[Motion]:
    """The motion of each lane. It takes some milliseconds; its warnings are left to the badges of whoever plays the scene."""
    from softcradle.sandbox.film.scene_motion import scene_motions_quietly

    rate = max(ROWS / (scene.duration or 1.0), ROWS_PER_SECOND * scene.view.slow)
    motions, _ = scene_motions_quietly(scene, rate, method=METHOD if scene.method in (None, AUTO) else scene.method)
    return motions
