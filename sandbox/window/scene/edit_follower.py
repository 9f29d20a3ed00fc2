"""Scales that follow edits: after the last edit of a gesture the edited scene is run ahead, behind the window."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from softcradle.sandbox.draw.shared_scales import scales_of
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.look_ahead import motions_ahead
from softcradle.sandbox.window.plots.live_scales import LiveScales, estimated_scales
from softcradle.sandbox.window.window_page import Host
from softcradle.scenes import Scene

EDIT_SECONDS = 0.3  # after which no other edit of the gesture is waited for


class EditFollower:
    """Gives `scales` of the edited scene, and calls `changed`."""

    def __init__(self, host: Host, session: Session, scales: LiveScales, changed: Callable[[], None]) -> None:
        self.host, self.session, self.scales, self.changed = host, session, scales, changed
        self._age: float | None = None  # seconds since the edit that scales are to follow

    def notice(self) -> None:
        """There was an edit."""
        self._age = 0.0

    @property
    def pending(self) -> bool:
        """Whether scales are still to follow an edit."""
        return self._age is not None

    def update(self, seconds: float) -> None:
        """Begin a run ahead where it is time."""
        if self._age is None:
            return
        self._age += seconds
        if self._age > EDIT_SECONDS:
            self._age = None
            try:
                scene = self.session.to_scene()
            except ValueError:  # what no scene file can say keeps the scales that it has
                return
            self.host.warmup.submit(partial(self._take, scene), partial(motions_ahead, scene))

    def _take(self, scene: Scene, motions: object) -> None:
        """Take the scales, estimated where the run has failed; where there was another edit, those of that one are to come."""
        if not self.pending:
            found = scales_of(scene, motions) if isinstance(motions, list) else estimated_scales(scene, self.session)
            self.scales.take(found)
            self.changed()
