"""The end of a motion: the clock is paused once all contacts are open for good; a key lets it go on."""

from __future__ import annotations

from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.window_page import Host

LINGER = 60  # frames that are shown after the last contact has opened: half a second


def is_over(lane: LiveLane) -> bool:
    """Whether no contact of the lane can close any more: all are open, and no beads approach each other."""
    chain, state = lane.chain, lane.state
    if chain.driven or chain.on_bed or chain.walls > 1:
        return False
    return bool((state.overlap < 0.0).all() and (state.force <= 0.0).all() and (state.rate <= 0.0).all())


class EndOfMotion:
    """Pauses a session once at the end of its motion.

    Attributes:
        enabled: whether it does.
    """

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self.enabled = True
        self._frames = 0  # for which the motion has been over

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
        if not (session.playing and all(map(is_over, session.lanes)) and session.held.lane < 0.0):
            self._frames = 0 if session.playing else self._frames
            return
        before, self._frames = self._frames, self._frames + frames
        if self.enabled and before < LINGER <= self._frames:
            session.pause()
            self.host.messages.show(_("all contacts are open for good: paused (E changes that, Space plays on)"))
