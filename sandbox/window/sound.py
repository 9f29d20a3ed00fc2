"""Clicks: short sounds made from numbers, one pitch a contact, as loud as the impact is fast."""

from __future__ import annotations

import numpy as np
import pygame

RATE, SECONDS = 22050, 0.06
PITCHES = (880.0, 988.0, 1109.0, 1245.0, 1397.0, 1568.0)  # Hz
DECAY = 90.0  # 1/s


class Clicks:
    """The mixer, opened on demand. pygame.error where there is none."""

    def __init__(self) -> None:
        pygame.mixer.init(frequency=RATE, size=-16, channels=1, buffer=256)
        self._sounds = [pygame.mixer.Sound(buffer=click(pitch)) for pitch in PITCHES]

    def click(self, loudness: float, contact: int) -> None:
        """Sound an impact; `loudness` 1 is the scene's own speed."""
        sound = self._sounds[contact % len(PITCHES)]
        sound.set_volume(min(1.0, 0.15 + 0.85 * loudness))
        sound.play()

    def close(self) -> None:
        """Let go of the mixer."""
        pygame.mixer.quit()


def click(pitch: float) -> bytes:
    """Samples of a knock: a tone and its fifth that die away."""
    time = np.arange(round(RATE * SECONDS)) / RATE
    wave = np.exp(-DECAY * time) * (np.sin(2 * np.pi * pitch * time) + 0.5 * np.sin(2 * np.pi * 2.5 * pitch * time))
    return (0.6 * 32767 / 1.5 * wave).astype(np.int16).tobytes()
