"""The end of a motion: the clock is paused once all contacts are open for good and the beads are apart; a key lets it go on."""

from __future__ import annotations

from collections.abc import Callable

from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.session.lane_setup import FRAME_RATE
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.window_page import Host

APART = 2.0  # lengths of a bead: a gap in every lane is that wide when it ends
LEAST_FRAMES = FRAME_RATE // 2  # that are shown after the last contact has opened
MOST_FRAMES = 5 * FRAME_RATE  # likewise, where beads part slowly


def is_over(lane: LiveLane) -> bool:
    """Whether no contact of the lane can close any more: all are open, and no beads approach each other."""
    chain, state = lane.chain, lane.state
    if chain.driven or chain.on_bed or chain.walls > 1:
        return False
    return bool((state.overlap < 0.0).all() and (state.force <= 0.0).all() and (state.rate <= 0.0).all())


class EndOfMotion:
    """Pauses a session once at the end of its motion, and calls `ended`.

    Attributes:
        enabled: whether it does.
        reached: whether the end of this motion has come, paused or not.
    """

    def __init__(self, host: Host, session: Session, ended: Callable[[], None]) -> None:
        self.host, self.session, self.ended = host, session, ended
        self.enabled = True
        self._frames, self.reached = 0, False  # frames for which the motion has been over

    def toggle(self) -> None:
        """Pause at the end, or go on."""
        self.enabled = not self.enabled
        text = (
            N_("the clock pauses when all contacts are open for good")
            if self.enabled
            else N_("the clock does not pause")
        )
        self.host.messages.show(_(text))

    def update(self, frames: int) -> None:
        """After a tick of so many frames."""
        session = self.session
        if not session.playing:
            return
        if not all(map(is_over, session.lanes)) or session.held.lane >= 0.0:
            self._frames, self.reached = 0, False
            return
        self._frames += frames
        if not self.reached and (self._apart or self._frames >= MOST_FRAMES) and self._frames >= LEAST_FRAMES:
            self.reached = True
            if self.enabled:
                session.pause()
                self.ended()

    @property
    def _apart(self) -> bool:
        """Whether a gap of every lane is wide enough to be seen."""
        least = -APART * self.session.scene.view.length
        return all(float(lane.state.overlap.min()) <= least for lane in self.session.lanes)
