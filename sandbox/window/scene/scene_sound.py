"""The sound of a scene: clicks at impacts and, as an option, tones of the forces; silent until somebody turns it on."""

from __future__ import annotations

import pygame
from softcradle.sandbox.languages import _
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.sound import Clicks, ForceTones
from softcradle.sandbox.window.window_page import Host

MOST_AT_ONCE = 4  # impacts of one picture that sound


class SceneSound:
    """The sound of a session, switched by one key from silence to clicks, to clicks and tones, and back.

    Attributes:
        clicks: of impacts; None while it is silent.
        tones: of the forces; None while they are off.
    """

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self.clicks: Clicks | None = None
        self.tones: ForceTones | None = None

    def toggle(self) -> None:
        """Go on to the next: clicks, clicks and tones of the forces, silence."""
        if self.tones is not None:
            self.close()
            self.host.messages.show(_("sound off"))
            return
        try:
            if self.clicks is None:
                self.clicks = Clicks()
                self.host.messages.show(_("clicks at impacts"))
            else:
                self.tones = ForceTones()
                self.host.messages.show(_("clicks at impacts, and a tone for the force of each contact"))
        except pygame.error as error:
            self.host.messages.show(_("there is no sound here: {error}", error=error), warning=True)

    def update(self, greatest_force: float) -> None:
        """Sound the impacts of the last tick, and the forces now relative to the greatest of the scene [N]."""
        playing = self.session.playing
        if self.clicks is not None and playing:
            speed = max(lane.setup.speed for lane in self.session.lanes)
            for impact in self.session.impacts[:MOST_AT_ONCE]:
                self.clicks.click(impact.speed / speed, impact.contact)
        if self.tones is not None:
            forces = self.session.lanes[0].state.force / greatest_force
            self.tones.sound(forces.tolist() if playing else ())

    def close(self) -> None:
        """Close the mixer."""
        if self.tones is not None:
            self.tones.close()
            self.tones = None
        if self.clicks is not None:
            self.clicks.close()
            self.clicks = None
