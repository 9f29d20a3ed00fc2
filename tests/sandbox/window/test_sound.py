"""The sounds: clicks, and tones of the forces."""

from __future__ import annotations

import numpy as np
import pygame
import pytest
from softcradle.sandbox.window.scene.sound import RATE, TONE_VOLUME, TONES, click, tone

from tests.helpers.windows import Driver


def test_a_click_is_short_and_decays():
    wave = np.frombuffer(click(880.0), np.int16).astype(float)
    assert 0.03 < len(wave) / RATE < 0.2
    assert np.abs(wave[:200]).max() > 8000
    assert np.abs(wave[-100:]).max() < 0.02 * np.abs(wave).max()


@pytest.mark.parametrize("pitch", TONES)
def test_a_tone_goes_on_without_a_jump(pitch):
    wave = np.frombuffer(tone(pitch), np.int16).astype(float)
    steps = np.abs(np.diff(np.concatenate((wave, wave[:2]))))
    assert steps[-2:].max() <= steps[:-2].max() + 1.0
    spectrum = np.abs(np.fft.rfft(wave))
    assert np.argmax(spectrum) * RATE / len(wave) == pytest.approx(pitch)


def test_one_key_goes_from_silence_to_clicks_to_tones_and_back(driver: Driver):
    sound = driver.page.sound
    driver.key(pygame.K_n)
    assert sound.clicks is not None
    assert sound.tones is None
    driver.key(pygame.K_n)
    driver.key(pygame.K_SPACE)
    while not (driver.session.lanes[0].state.force > 0.1).all():
        driver.frames()
    volumes = sound.tones.volumes
    assert TONE_VOLUME >= volumes[0] > volumes[1] > volumes[2] > volumes[3] > 0.0
    driver.key(pygame.K_SPACE)
    assert max(sound.tones.volumes) == 0.0
    driver.key(pygame.K_n)
    assert sound.clicks is sound.tones is None
    assert driver.messages[-1] == "sound off"
