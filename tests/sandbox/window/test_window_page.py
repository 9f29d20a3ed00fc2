"""The real application, driven by posted events: open, play, drag, scrub, edit, switch method, quit."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pygame
import pytest
from softcradle.sandbox.session.inputs import SetStep
from softcradle.sandbox.window.scene.lane_cards import RED
from softcradle.sandbox.window.scene.lane_view import Pick

from tests.helpers.windows import Driver

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT
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


def test_frames_forward_and_back(driver: Driver) -> None:
    for _ in range(3):
        driver.key(pygame.K_PERIOD)
    assert driver.session.frame == 3
    driver.key(pygame.K_COMMA)
    assert driver.session.frame == 2
    assert driver.session.history.last == 3


def test_timeline_scrubs_and_playing_on_starts_a_new_branch(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(200)
    last = driver.session.history.last
    line = driver.play.timeline
    y = line.rect.centery
    driver.drag((line.x(last), y), (line.x(last // 3), y))
    driver.release((line.x(last // 3), y))
    assert abs(driver.session.frame - last // 3) <= 2
    assert driver.session.scrubbed
    assert not driver.session.playing
    driver.key(pygame.K_SPACE)
    driver.frames(3)
    assert driver.session.history.last < last


def test_slow_motion_by_keys_and_slider(driver: Driver) -> None:
    assert driver.session.slow == driver.session.scene.view.slow
    driver.key(pygame.K_MINUS)
    assert driver.session.slow == 5.0
    driver.key(pygame.K_EQUALS)
    assert driver.session.slow == 2.0
    slider = driver.play.transport.slider
    assert slider is not None
    driver.drag(slider.sliding_button.rect.center, (slider.rect.right - 5, slider.rect.centery))
    driver.release((slider.rect.right - 5, slider.rect.centery))
    assert driver.session.slow > 500.0


def test_looking_back_at_another_speed_drops_nothing(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(60)
    driver.key(pygame.K_HOME)
    last = driver.session.history.last
    driver.key(pygame.K_MINUS)
    assert driver.session.history.last == last
    driver.key(pygame.K_SPACE)
    assert driver.session.slow == 5.0


def test_a_bead_is_placed_while_paused(driver: Driver) -> None:
    x, y = driver.bead(0)
    before = driver.session.lanes[0].position.copy()
    driver.drag((x, y), (x - 60, y))
    driver.release((x - 60, y))
    after = driver.session.lanes[0].position
    assert after[0] < before[0]
    assert after[0] - before[0] == pytest.approx(driver.play.scenery.views[0].metres(-60), rel=0.05)
    assert np.array_equal(after[1:], before[1:])


def test_a_bead_is_pulled_and_thrown_while_running(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.frames(5)
    x, y = driver.bead(4)
    driver.drag((x, y), (x + 120, y), steps=25)
    pulled = driver.session.lanes[0].velocity[4]
    assert pulled > 0.2
    driver.release((x + 120, y))
    thrown = driver.session.lanes[0].velocity[4]
    driver.frames(10)
    assert driver.session.lanes[0].velocity[4] == pytest.approx(thrown, rel=1e-6)
    assert driver.session.health(0).level == "good"  # the work of the hand is booked


def test_a_typed_mass_and_a_slider_are_felt_in_the_next_frame(driver: Driver) -> None:
    driver.click(driver.bead(2))
    control = driver.play.inspector.controls["mass"]
    driver.click(control.entry.rect.center)
    control.entry.set_text("")
    driver.type("2.5")
    driver.key(pygame.K_RETURN)
    assert driver.session.lanes[0].chain.mass[2] == 2.5
    slider = driver.play.inspector.controls["mass"].slider
    driver.press(slider.sliding_button.rect.center)
    driver.move((slider.rect.left + 30, slider.rect.centery), (1, 0, 0))
    driver.frames(2)
    assert driver.session.lanes[0].chain.mass[2] < 0.1
    driver.release((slider.rect.left + 30, slider.rect.centery))


def test_a_number_that_is_none_is_said(driver: Driver) -> None:
    driver.click(driver.bead(2))
    control = driver.play.inspector.controls["mass"]
    driver.click(control.entry.rect.center)
    control.entry.set_text("")
    driver.type("-1")
    driver.key(pygame.K_RETURN)
    assert driver.session.lanes[0].chain.mass[2] == 1.0
    assert any("mass must be > 0" in text for text in driver.said)


def test_keys_do_not_act_while_a_number_is_typed(driver: Driver) -> None:
    driver.click(driver.bead(2))
    driver.click(driver.play.inspector.controls["mass"].entry.rect.center)
    driver.type("r a")
    assert driver.session.lanes[0].chain.contacts == 4
    assert not driver.session.playing
    driver.key(pygame.K_ESCAPE)
    assert not driver.play.typing
    driver.key(pygame.K_a)
    assert driver.session.lanes[0].chain.contacts == 5


def test_beads_are_added_and_removed(driver: Driver) -> None:
    driver.click(driver.bead(4))
    driver.key(pygame.K_a)
    assert driver.session.lanes[0].chain.contacts == 5
    assert driver.play.pick == Pick(0, "bead", 5)
    driver.key(pygame.K_DELETE)
    driver.frames()
    assert driver.session.lanes[0].chain.contacts == 4
    assert driver.play.pick == Pick(0, "bead", 4)


def test_a_locked_piston_brings_the_usual_cradle_back(driver: Driver) -> None:
    driver.key(pygame.K_l)  # nothing selected: all of them
    driver.key(pygame.K_SPACE)
    driver.frames(330)
    velocity = driver.session.lanes[0].velocity
    assert velocity[4] > 0.9  # the last flies off
    assert abs(velocity[0]) < 0.15


def test_law_of_one_contact_and_of_all(driver: Driver) -> None:
    driver.key(pygame.K_RIGHT)
    driver.key(pygame.K_RIGHT)
    assert driver.play.pick == Pick(0, "contact", 0)
    driver.key(pygame.K_g)
    assert [law.preload > 0.0 for law in driver.session.lanes[0].chain.contact] == [True, False, False, False]
    driver.key(pygame.K_g, SHIFT)
    assert all(law.preload > 0.0 for law in driver.session.lanes[0].chain.contact)


def test_method_menu_switches_live_and_the_badge_turns_red(driver: Driver) -> None:
    menu = driver.play.cards.menus[0]
    driver.key(pygame.K_SPACE)
    driver.click(menu.rect.center)
    driver.frames(3)
    options = menu.menu_states["expanded"].options_selection_list
    item = next(one for one in options.item_list_container.elements if one.text == "euler")
    driver.click(item.rect.center)
    driver.frames(5)
    assert driver.session.lanes[0].setup.method == "euler"


def test_badge_turns_red_with_a_sentence_when_the_method_is_past_its_limit() -> None:
    driver = Driver("draft-gear-one-on-three")
    for key in (pygame.K_m, pygame.K_EQUALS, pygame.K_EQUALS, pygame.K_EQUALS):
        driver.key(key)
    driver.session.apply(SetStep(None, 0.01))
    driver.key(pygame.K_SPACE)
    driver.frames(60)
    health = driver.play.cards.health[0]
    assert driver.session.lanes[0].setup.method == "euler"
    assert health.level == "bad"
    card = driver.play.cards.rects[0]
    assert driver.app.surface.get_at((card.centerx, card.top))[:3] == RED
    driver.close()


def test_help_covers_the_page_and_is_closed_by_a_key(driver: Driver) -> None:
    driver.key(pygame.K_F1)
    assert driver.app.help
    driver.key(pygame.K_SPACE)
    assert not driver.session.playing
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.help


def test_window_is_resized_scaled_and_its_panel_hidden(driver: Driver) -> None:
    for size in ((1000, 600), (1920, 1080), (800, 480), (1280, 720)):
        pygame.display.set_mode(size, pygame.RESIZABLE)
        pygame.event.post(pygame.Event(pygame.VIDEORESIZE, size=size, w=size[0], h=size[1]))
        driver.frames(3)
        assert driver.app.size == size
    for key in (pygame.K_EQUALS, pygame.K_EQUALS, pygame.K_MINUS, pygame.K_0):
        driver.key(key, CTRL)
    assert driver.app.scale == 1.0
    wide = driver.play.places.stages[0].width
    driver.key(pygame.K_i)
    assert driver.play.places.stages[0].width > wide


def test_sound_is_off_until_asked_for(driver: Driver) -> None:
    assert driver.play.keeping.clicks is None
    assert pygame.mixer.get_init() is None
    driver.key(pygame.K_n)
    if driver.play.keeping.clicks is None:
        assert any("no sound" in text for text in driver.said)
        return
    driver.key(pygame.K_SPACE)
    driver.frames(150)
    driver.key(pygame.K_n)
    assert pygame.mixer.get_init() is None


def test_quitting_ends_the_loop(driver: Driver) -> None:
    pygame.event.post(pygame.Event(pygame.QUIT))
    driver.app.run()
    assert not driver.app.running


def test_late_physics_slows_the_clock_and_says_so(driver: Driver) -> None:
    driver.key(pygame.K_SPACE)
    driver.session.pacer.budget = 0.0
    driver.frames(60)
    assert driver.session.pacer.clock_ratio < 0.95
    assert math.isfinite(driver.session.time)


RUBBING = """
title = "Rubbing"
[[lanes]]
beads = [1, 2]
contact = {law = "draft_gear", stiffness = 100.0, precompression = 0.1, loss = 0.5}
velocity = 1.0
friction = 0.1
drive = [0.5, 0.0, 0.0]
"""


def test_bed_drive_and_loss_have_their_sliders_where_the_scene_has_them(tmp_path: Path) -> None:
    (tmp_path / "rubbing.toml").write_text(RUBBING.replace("[[lanes]]", "duration = 5.0\n[[lanes]]"))
    driver = Driver(str(tmp_path / "rubbing.toml"))
    driver.click(driver.bead(0))
    controls = driver.play.inspector.controls
    for key, value in (("friction", 0.25), ("drive", 0.75)):
        driver.click(controls[key].entry.rect.center)
        controls[key].entry.set_text(f"{value}")
        driver.key(pygame.K_RETURN)
    chain = driver.session.lanes[0].chain
    assert (chain.friction, chain.drive) == (0.25, (0.75, 0.0, 0.0))
    driver.key(pygame.K_ESCAPE)  # out of the entry
    driver.key(pygame.K_RIGHT)
    assert driver.play.pick == Pick(0, "contact", 0)
    slider = driver.play.inspector.controls["loss"].slider.sliding_button.rect
    driver.drag(slider.center, (slider.centerx + 400, slider.centery))
    driver.release((slider.centerx + 400, slider.centery))
    driver.frames(2)
    assert driver.session.lanes[0].chain.contact[0].loss == 0.95
    driver.key(pygame.K_SPACE)
    driver.frames(120)
    assert driver.session.health(0).energy_error < 1e-9
    driver.close()


def test_an_ordinary_bead_has_no_bed_and_no_drive(driver: Driver) -> None:
    driver.click(driver.bead(0))
    assert set(driver.play.inspector.controls) == {"mass", "velocity"}
