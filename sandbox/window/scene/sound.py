"""The sound of a scene: clicks at impacts and, as an option, tones of the forces, all computed from sines."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pygame
from softcradle.sandbox.languages import _
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.page import Host

RATE = 22050  # samples a second
SECONDS = 0.06  # of a click
PITCHES = (880.0, 988.0, 1109.0, 1245.0, 1397.0, 1568.0)  # Hz
OVERTONE = 2.5  # frequency of the second sine, relative to the first
DECAY = 90.0  # 1/s
PEAK = 0.6  # of the largest sample
LEAST_VOLUME = 0.15  # of the slowest impact
# Hz, of the first contacts: thirds, so that they sound together
TONES = 131.0, 165.0, 196.0, 247.0, 294.0, 349.0, 440.0, 523.0
TONE_SECONDS = 1.0  # of a tone before it begins again: whole periods, for all of TONES are whole numbers
TONE_VOLUME = 0.3  # of the greatest force, so that all of them together do not clip
TONE_CURVE = 0.5  # exponent of the loudness over the force: small forces are heard too
CLICK_CHANNELS = 8  # of the mixer, for impacts


class Clicks:
    """The mixer, opened on demand. pygame.error where there is none."""

    def __init__(self) -> None:
        pygame.mixer.init(frequency=RATE, size=-16, channels=1, buffer=256)
        pygame.mixer.set_num_channels(CLICK_CHANNELS + len(TONES))
        pygame.mixer.set_reserved(len(TONES))
        self._sounds = [pygame.mixer.Sound(buffer=click(pitch)) for pitch in PITCHES]

    def click(self, loudness: float, contact: int) -> None:
        """Play the click of a contact; `loudness` 1 is an impact at the scene's own speed."""
        sound = self._sounds[contact % len(PITCHES)]
        sound.set_volume(min(1.0, LEAST_VOLUME + (1.0 - LEAST_VOLUME) * loudness))
        sound.play()


class ForceTones:
    """A tone for each of the first contacts, on the reserved channels of the open mixer.

    Attributes:
        volumes: of the tones at present.
    """

    def __init__(self) -> None:
        self.volumes = [0.0] * len(TONES)
        self._channels = [pygame.mixer.Channel(k) for k in range(len(TONES))]
        for channel, pitch in zip(self._channels, TONES, strict=True):
            channel.play(pygame.mixer.Sound(buffer=tone(pitch)), loops=-1)
            channel.set_volume(0.0)

    def sound(self, shares: Sequence[float]) -> None:
        """Let each contact sound by its share of the greatest force."""
        for k, channel in enumerate(self._channels):
            share = min(max(shares[k], 0.0), 1.0) if k < len(shares) else 0.0
            self.volumes[k] = TONE_VOLUME * share**TONE_CURVE
            channel.set_volume(self.volumes[k])


def click(pitch: float) -> bytes:
    """Samples of a click: two sines that decay."""
    time = np.arange(round(RATE * SECONDS)) / RATE
    sines = np.sin(2 * np.pi * pitch * time) + 0.5 * np.sin(2 * np.pi * OVERTONE * pitch * time)
    return (PEAK * 32767 / 1.5 * np.exp(-DECAY * time) * sines).astype(np.int16).tobytes()


def tone(pitch: float) -> bytes:
    """Samples of a tone: whole periods of a sine with a soft octave, so that it can be played on and on."""
    time = np.arange(round(RATE * TONE_SECONDS)) / RATE
    sines = np.sin(2 * np.pi * pitch * time) + 0.3 * np.sin(4 * np.pi * pitch * time)
    return (PEAK * 32767 / 1.3 * sines).astype(np.int16).tobytes()


MOST_AT_ONCE = 4  # impacts of one picture that sound


class SceneSound:
    """The sound of a session, switched by one key from silence to clicks, to clicks and tones, and back.

    It sounds while the clock runs: `activity` names what that does.

    Attributes:
        clicks: of impacts; None while it is silent.
        tones: of the forces; None while they are off.
    """

    def __init__(self, host: Host, session: Session, activity: Callable[[], str]) -> None:
        self.host, self.session, self.activity = host, session, activity
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
        playing = self.activity() != "paused"
        if self.clicks is not None and playing:
            speed = max(lane.setup.speed for lane in self.session.lanes)
            for impact in self.session.impacts[:MOST_AT_ONCE]:
                self.clicks.click(impact.speed / speed, impact.contact)
        if self.tones is not None:
            forces = self.session.lanes[0].state.force / greatest_force
            self.tones.sound(forces.tolist() if playing else ())

    def close(self) -> None:
        """Close the mixer."""
        if self.clicks is not None:
            pygame.mixer.quit()
            self.clicks = self.tones = None
