"""The scene page, driven by posted events: time, slow motion, contact events, sound, kernels that are being loaded."""

from __future__ import annotations

import pygame
import pytest
from softcradle.physics.fixed_step.runner import TIERS
from softcradle.sandbox.session.inputs import SetFriction
from softcradle.sandbox.window import kernel_warmup
from softcradle.sandbox.window.scene.page import joined

from tests.helpers.windows import Driver

SHIFT = pygame.KMOD_SHIFT
pytestmark = pytest.mark.usefixtures("own_folder")


def test_space_plays_and_pauses_and_r_restarts(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(30)
    assert driver.session.playing
    assert driver.session.time > 0.1
    driver.key(pygame.K_SPACE)
    stopped = driver.session.time
    driver.frames(5)
    assert driver.session.time == stopped
    driver.key(pygame.K_r)
    assert driver.session.time == 0.0


def test_the_timeline_scrubs_and_playing_on_starts_a_new_branch(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(200)
    last = driver.session.history.last
    line = driver.page.timeline
    y = line.rect.centery
    driver.drag((line.x(last), y), (line.x(last // 3), y))
    driver.release((line.x(last // 3), y))
    assert abs(driver.session.frame - last // 3) <= 2
    assert driver.session.scrubbed
    assert not driver.session.playing
    driver.key(pygame.K_SPACE)
    driver.frames(3)
    assert driver.session.history.last < last


def test_keys_and_the_slider_set_the_slow_motion(driver: Driver) -> None:
    assert driver.session.slow == driver.session.scene.view.slow
    driver.key(pygame.K_MINUS)
    assert driver.session.slow == 5.0
    driver.key(pygame.K_EQUALS)
    assert driver.session.slow == 2.0
    slider = driver.page.time_controls.slider
    assert slider is not None
    driver.drag(slider.sliding_button.rect.center, (slider.rect.right - 5, slider.rect.centery))
    driver.release((slider.rect.right - 5, slider.rect.centery))
    assert driver.session.slow > 500.0


def test_another_slow_motion_while_scrubbed_drops_no_frame(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(60)
    driver.key(pygame.K_HOME)
    last = driver.session.history.last
    driver.key(pygame.K_MINUS)
    assert driver.session.history.last == last
    driver.key(pygame.K_SPACE)
    assert driver.session.slow == 5.0


def test_a_key_scrubs_to_the_next_contact_event(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(200)
    driver.key(pygame.K_HOME)
    driver.key(pygame.K_PERIOD, SHIFT)
    before, after = driver.session.history.snapshot(driver.session.frame - 1), driver.session.lanes[0].state
    assert before.states[0].overlap[0] <= 0.0 < after.overlap[0]
    assert abs(after.time - 1.0) < 0.02  # the striker flies 1 m at 1 m/s


def test_friction_whose_kernels_are_not_loaded_pauses_a_clock_too_fast_for_plain_python(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    driver = Driver("one-on-four")
    monkeypatch.setattr(TIERS["fixed-step-dissipative"], "_loaded", False)
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
    driver.close()


def test_no_two_actions_have_one_name():
    with pytest.raises(ValueError, match="two actions are called undo"):
        joined({"undo": print, "redo": print}, {"undo": print})
