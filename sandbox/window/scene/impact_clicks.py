"""Clicks at impacts, on and off by a key; they are off until somebody turns them on."""

from __future__ import annotations

import pygame
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.sound import Clicks
from softcradle.sandbox.window.window_page import Host

MOST_AT_ONCE = 4  # impacts of one picture that sound


class ImpactClicks:
    """The sound of a session; `clicks` is None while it is off."""

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self.clicks: Clicks | None = None

    def toggle(self) -> None:
        """Turn the clicks on or off."""
        if self.clicks is not None:
            self.close()
            self.host.messages.show("clicks off")
            return
        try:
            self.clicks = Clicks()
        except pygame.error as error:
            self.host.messages.show(f"there is no sound here: {error}", warning=True)
        else:
            self.host.messages.show("clicks on")

    def update(self) -> None:
        """Sound the impacts of the last tick."""
        if self.clicks is not None and self.session.playing:
            speed = max(lane.setup.speed for lane in self.session.lanes)
            for impact in self.session.impacts[:MOST_AT_ONCE]:
                self.clicks.click(impact.speed / speed, impact.contact)

    def close(self) -> None:
        """Close the mixer."""
        if self.clicks is not None:
            self.clicks.close()
            self.clicks = None
