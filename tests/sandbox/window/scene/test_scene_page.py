"""The scene page, driven by posted events: time, slow motion, contact events, sound, kernels that are being loaded."""

import numpy as np
import pygame
import pytest
from softcradle.physics.fixed_step.runner import TIERS
from softcradle.sandbox.session.inputs import SetFriction
from softcradle.sandbox.window import kernel_warmup
from softcradle.sandbox.window.scene.page import joined
from softcradle.sandbox.window.scene.sound import RATE, TONE_VOLUME, TONES, click, tone

from tests.helpers.windows import Driver

SHIFT = pygame.KMOD_SHIFT


def test_the_timeline_and_keys_look_back_and_playing_on_starts_a_new_branch(driver: Driver) -> None:
    driver.run(200)
    last = driver.session.history.last
    line = driver.page.timeline
    y = line.rect.centery
    driver.pull((line.x(last), y), (line.x(last // 3), y))
    assert abs(driver.session.frame - last // 3) <= 2
    assert driver.session.scrubbed
    assert not driver.session.playing
    last = driver.session.history.last
    driver.key(pygame.K_HOME)
    driver.key(pygame.K_PERIOD, SHIFT)  # to the next contact event
    before, after = driver.session.history.snapshot(driver.session.frame - 1), driver.session.lanes[0].state
    assert before.states[0].overlap[0] <= 0.0 < after.overlap[0]
    assert abs(after.time - 1.0) < 0.02  # the striker flies 1 m at 1 m/s
    driver.key(pygame.K_MINUS)  # slower, which drops no frame
    assert driver.session.history.last == last
    driver.run(3)
    assert driver.session.slow == 5.0
    assert driver.session.history.last < last


def test_keys_and_the_slider_set_the_slow_motion(driver: Driver) -> None:
    assert driver.session.slow == driver.session.scene.view.slow
    driver.key(pygame.K_MINUS)
    assert driver.session.slow == 5.0
    driver.key(pygame.K_EQUALS)
    assert driver.session.slow == 2.0
    slider = driver.page.time_controls.slider
    driver.pull(slider.sliding_button.rect.center, (slider.rect.right - 5, slider.rect.centery))
    assert driver.session.slow > 500.0
    driver.press((slider.rect.left + 3 * slider.rect.width // 4, slider.rect.centery))  # on its track
    driver.frames(2)
    assert 40.0 < driver.session.slow < 80.0
    driver.move((slider.rect.right, slider.rect.centery), (1, 0, 0))
    driver.frames(2)
    assert driver.session.slow == 1000.0
    driver.release((slider.rect.right, slider.rect.centery))
    for _ in range(20):
        driver.key(pygame.K_EQUALS)
    assert driver.session.slow == 0.01  # faster than real time
    driver.run(10)
    assert driver.session.time > 5.0


def test_friction_whose_kernels_are_not_loaded_pauses_a_clock_too_fast_for_plain_python(monkeypatch) -> None:
    driver = Driver("one-on-four")
    monkeypatch.setattr(TIERS["fixed-step"], "_loaded", False)
    monkeypatch.setattr(kernel_warmup, "PLAIN_FRAME", 0)
    driver.session.apply(SetFriction(0, 0.1))
    driver.session.play()
    driver.frames(3)
    assert driver.page.editor.preparing
    frame = driver.session.frame
    driver.frames(3)
    assert driver.session.frame == frame
    monkeypatch.undo()
    driver.frames(3)
    assert not driver.page.editor.preparing
    assert driver.session.frame > frame


def test_no_two_actions_have_one_name():
    with pytest.raises(ValueError, match="two actions are called undo"):
        joined({"undo": print, "redo": print}, {"undo": print})


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
    assert np.argmax(np.abs(np.fft.rfft(wave))) * RATE / len(wave) == pytest.approx(pitch)


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
