"""The sound of a click."""

from __future__ import annotations

import numpy as np
from softcradle.sandbox.window.sound import RATE, click


def test_a_click_is_short_and_decays():
    wave = np.frombuffer(click(880.0), np.int16).astype(float)
    assert 0.03 < len(wave) / RATE < 0.2
    assert np.abs(wave[:200]).max() > 8000
    assert np.abs(wave[-100:]).max() < 0.02 * np.abs(wave).max()
