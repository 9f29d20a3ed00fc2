"""The sound of a scene: clicks at impacts and, optionally, a tone for the force of each contact. All sounds are made of
sines.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pygame
from softcradle.sandbox.languages import _
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.page import Host

RATE = 22050  # Sample rate in samples per second.
SECONDS = 0.06  # Duration of a click in seconds.
PITCHES = (880.0, 988.0, 1109.0, 1245.0, 1397.0, 1568.0)  # Pitches of the clicks in Hz.
OVERTONE = 2.5  # Frequency of the second sine, relative to the first.
DECAY = 90.0  # Decay rate of a click in 1/s.
PEAK = 0.6  # Peak of a click, as a fraction of the largest possible sample.
LEAST_VOLUME = 0.15  # Volume of the slowest impact, as a fraction of full volume.
# Pitches of the tones in Hz. Neighbouring pitches are about a third apart, so the tones sound well together.
TONES = 131.0, 165.0, 196.0, 247.0, 294.0, 349.0, 440.0, 523.0
# Duration in seconds of a tone before it repeats. A tone contains whole periods, because all TONES are whole numbers.
TONE_SECONDS = 1.0
TONE_VOLUME = 0.3  # Volume of a tone at the largest force. It is low enough that the sum of all tones does not clip.
TONE_CURVE = 0.5  # Exponent of the loudness as a function of the force. An exponent below 1 makes small forces audible.
CLICK_CHANNELS = 8  # Number of mixer channels for impacts.


class Clicks:
    """The sounds of impacts. The constructor opens the mixer and raises pygame.error if the system has no sound."""

    def __init__(self) -> None:
        pygame.mixer.init(frequency=RATE, size=-16, channels=1, buffer=256)
        pygame.mixer.set_num_channels(CLICK_CHANNELS + len(TONES))
        pygame.mixer.set_reserved(len(TONES))
        self._sounds = [pygame.mixer.Sound(buffer=click(pitch)) for pitch in PITCHES]

    def click(self, loudness: float, contact: int) -> None:
        """Play the click of a contact. `loudness` is 1 for an impact at the closing speed of the scene."""
        sound = self._sounds[contact % len(PITCHES)]
        sound.set_volume(min(1.0, LEAST_VOLUME + (1.0 - LEAST_VOLUME) * loudness))
        sound.play()


class ForceTones:
    """Tones for the forces of the first contacts, one tone per contact. They use the reserved channels of the open
    mixer.

    Attributes:
        volumes: present volumes of the tones.
    """

    def __init__(self) -> None:
        self.volumes = [0.0] * len(TONES)
        self._channels = [pygame.mixer.Channel(k) for k in range(len(TONES))]
        for channel, pitch in zip(self._channels, TONES, strict=True):
            channel.play(pygame.mixer.Sound(buffer=tone(pitch)), loops=-1)
            channel.set_volume(0.0)

    def sound(self, shares: Sequence[float]) -> None:
        """Set the volume of each tone. `shares` are the forces of the contacts as fractions of the largest force."""
        for k, channel in enumerate(self._channels):
            share = min(max(shares[k], 0.0), 1.0) if k < len(shares) else 0.0
            self.volumes[k] = TONE_VOLUME * share**TONE_CURVE
            channel.set_volume(self.volumes[k])


def click(pitch: float) -> bytes:
    """Return the samples of a click. It consists of two decaying sines."""
    time = np.arange(round(RATE * SECONDS)) / RATE
    sines = np.sin(2 * np.pi * pitch * time) + 0.5 * np.sin(2 * np.pi * OVERTONE * pitch * time)
    return (PEAK * 32767 / 1.5 * np.exp(-DECAY * time) * sines).astype(np.int16).tobytes()


def tone(pitch: float) -> bytes:
    """Return the samples of a tone: a sine with a soft octave. Both have whole periods, so the tone repeats without a
    break.
    """
    time = np.arange(round(RATE * TONE_SECONDS)) / RATE
    sines = np.sin(2 * np.pi * pitch * time) + 0.3 * np.sin(4 * np.pi * pitch * time)
    return (PEAK * 32767 / 1.3 * sines).astype(np.int16).tobytes()


MOST_AT_ONCE = 4  # Largest number of impacts in one frame that make a sound.


class SceneSound:
    """The sound of a session. One key switches from silence to clicks, to clicks with tones, and back to silence.

    The scene makes sounds while the clock runs. `activity` returns the state of the clock.

    Attributes:
        clicks: clicks of impacts, or None while the sound is off.
        tones: tones of the forces, or None while they are off.
    """

    def __init__(self, host: Host, session: Session, activity: Callable[[], str]) -> None:
        self.host, self.session, self.activity = host, session, activity
        self.clicks: Clicks | None = None
        self.tones: ForceTones | None = None

    def toggle(self) -> None:
        """Switch to the next sound: clicks, clicks with tones of the forces, or silence."""
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
            self.host.messages.show(_("sound is not available: {error}", error=error), warning=True)

    def update(self, greatest_force: float) -> None:
        """Play the impacts of the last tick, and set the tones to the present forces.

        The forces are relative to `greatest_force` [N], the largest force of the scene.
        """
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
