"""Clicks: short sounds computed from sines, one pitch a contact, louder for a faster impact."""

from __future__ import annotations

import numpy as np
import pygame

RATE = 22050  # samples a second
SECONDS = 0.06  # of a click
PITCHES = (880.0, 988.0, 1109.0, 1245.0, 1397.0, 1568.0)  # Hz
OVERTONE = 2.5  # frequency of the second sine, relative to the first
DECAY = 90.0  # 1/s
PEAK = 0.6  # of the largest sample
LEAST_VOLUME = 0.15  # of the slowest impact


class Clicks:
    """The mixer, opened on demand. pygame.error where there is none."""

    def __init__(self) -> None:
        pygame.mixer.init(frequency=RATE, size=-16, channels=1, buffer=256)
        self._sounds = [pygame.mixer.Sound(buffer=click(pitch)) for pitch in PITCHES]

    def click(self, loudness: float, contact: int) -> None:
        """Play the click of a contact; `loudness` 1 is an impact at the scene's own speed."""
        sound = self._sounds[contact % len(PITCHES)]
        sound.set_volume(min(1.0, LEAST_VOLUME + (1.0 - LEAST_VOLUME) * loudness))
        sound.play()

    def close(self) -> None:
        """Close the mixer."""
        pygame.mixer.quit()


def click(pitch: float) -> bytes:
    """Samples of a click: two sines that decay."""
    time = np.arange(round(RATE * SECONDS)) / RATE
    sines = np.sin(2 * np.pi * pitch * time) + 0.5 * np.sin(2 * np.pi * OVERTONE * pitch * time)
    return (PEAK * 32767 / 1.5 * np.exp(-DECAY * time) * sines).astype(np.int16).tobytes()
