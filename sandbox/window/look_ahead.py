"""The look ahead: the motion of a scene before it is played, for thumbnails and for the scales of its page."""

from __future__ import annotations

from softcradle.physics.methods import AUTO, Family, find_method
from softcradle.sandbox.motion import Motion
from softcradle.scenes import Scene

ROWS = 240  # of the motion, at least
ROWS_PER_SECOND = 60.0  # of the scene as it is shown, at least
METHOD = "conserving"  # where the scene gives none, or one that runs in Python alone: a picture needs no more digits
IN_PYTHON = (Family.PYMUNK, Family.REFERENCE)  # of which a step takes up to a thousand times as long
# steps times contacts of a lane, some 0.2 s: a run ahead that the window waits for takes no more
MOST_AT_ONCE = 1_000_000
MOST_BEHIND = 6_000_000  # likewise of one on a thread, some seconds: scales are not worth more


def motions_ahead(scene: Scene, most: int = MOST_BEHIND) -> list[Motion]:
    """The motion of each lane, near enough for a picture; its warnings are left to the badges of whoever plays the scene.

    Most scenes take some milliseconds. Raises GaveUpError where a lane takes more than `most` steps times contacts.
    """
    from softcradle.sandbox.film.scene_motion import scene_motions_quietly

    rate = max(ROWS / (scene.duration or 1.0), ROWS_PER_SECOND * scene.view.slow)
    method = scene.method if scene.method not in (None, AUTO) else METHOD
    if find_method(method).family in IN_PYTHON:
        method = METHOD
    motions, _ = scene_motions_quietly(scene, rate, method=method, most=most)
    return motions
