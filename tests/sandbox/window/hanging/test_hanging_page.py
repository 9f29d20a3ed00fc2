"""The hanging cradle: its energy, its motion, and its page."""

from __future__ import annotations

import numpy as np
import pygame
import pygame_gui
import pytest
from softcradle.sandbox.window.hanging.hanging_badges import verdict
from softcradle.sandbox.window.hanging.hanging_cradle import CHAIN, LAWS, SPRINGS
from softcradle.sandbox.window.hanging.hanging_model import HangingModel
from softcradle.sandbox.window.hanging.hanging_page import HangingPage
from softcradle.sandbox.window.hanging.hanging_picture import to_screen
from softcradle.sandbox.window.scene.scene_page import ScenePage

from tests.helpers.windows import Driver


@pytest.mark.parametrize("law", LAWS)
def test_soft_balls_on_strings_gain_no_energy(law):
    model = HangingModel(law)
    before = model.cradles[0].energy()
    model.advance(10.0)
    assert 0.9 * before < model.cradles[0].energy() < 1.02 * before


def test_a_small_exponent_makes_the_balls_swing_off_nearly_as_one_body():
    """Shortly after the first impact the four balls that were hit move alike; of steel balls only the last moves."""
    spreads = []
    for law in ("power law, alpha 1/14", "steel balls (Hertz)"):
        model = HangingModel(law)
        model.advance(0.95)
        speeds = [ball.velocity.x for ball in model.cradles[0].balls]
        spreads.append(max(speeds[1:]) - min(speeds[1:]))
    assert spreads[0] < 0.5 * spreads[1]


def test_the_hanging_page_is_driven_by_mouse_and_keys():
    driver = Driver("hanging-cradle")
    page = driver.app.page
    assert isinstance(page, HangingPage)
    driver.key(pygame.K_SPACE)
    driver.frames(30)
    assert page.model.time > 0.4
    ball = to_screen(page.pictures[1], page.model.cradles[1].places()[4])
    driver.drag(ball, (ball[0] + 60, ball[1] - 40), steps=10)
    driver.frames(20)
    assert page.model.cradles[1].places()[4][0] > 0.9
    driver.release(ball)
    driver.key(pygame.K_MINUS)
    assert page.slow == 2.0
    driver.key(pygame.K_r)
    assert page.model.time < 0.1
    driver.key(pygame.K_ESCAPE)
    assert not isinstance(driver.app.page, (HangingPage, ScenePage))
    driver.close()


def test_the_page_steps_scrubs_and_plays_on_from_an_earlier_frame():
    driver = Driver("hanging-cradle")
    page = driver.app.page
    driver.key(pygame.K_SPACE)
    driver.frames(90)
    driver.key(pygame.K_COMMA)
    assert not page.playing
    assert page.model.scrubbed
    last, time = len(page.model.frames), page.model.time
    driver.key(pygame.K_HOME)
    assert page.model.time == 0.0
    driver.key(pygame.K_PERIOD)
    assert page.model.time == pytest.approx(1 / 60)
    driver.press((page.bar.x(30), page.bar.rect.centery))
    driver.release((page.bar.x(30), page.bar.rect.centery))
    assert page.model.shown == 30
    before = page.model.moment.places
    driver.key(pygame.K_SPACE)
    driver.frames(2)
    assert len(page.model.frames) < last
    assert page.model.frames[30].places == before
    driver.frames(60)
    assert page.model.time > 0.9 * time
    driver.close()


def test_playing_on_from_an_earlier_frame_goes_as_it_went():
    """The strings and soft contacts have no memory that a frame does not hold: a swing comes back to a thousandth."""
    model = HangingModel()
    model.advance(0.4)
    model.scrub(12)
    places = HangingModel()
    places.advance(0.4)
    model.advance(0.2)
    other = places.frames[24].places
    assert np.array(model.moment.places) == pytest.approx(np.array(other), abs=1e-3)


def test_the_badge_says_which_method_fails():
    """Springs of their own, a step late each, at few steps a second: what SoftChain keeps they do not."""
    kept, lost = (HangingModel("steel balls (Hertz)", method=method, rate=60) for method in (CHAIN, SPRINGS))
    for model in (kept, lost):
        model.advance(6.0)
    assert abs(verdict(lost, 0).change) > 3.0 * abs(verdict(kept, 0).change)
    assert verdict(lost, 0).level == "bad"
    assert "SoftChain" in verdict(lost, 0).sentence
    fine = HangingModel("power law, alpha 1/14", rate=960)
    fine.advance(3.0)
    assert verdict(fine, 0).level == "good"


def test_menus_choose_method_and_steps_and_the_history_is_exported(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    driver = Driver("hanging-cradle")
    page = driver.app.page
    for field, text in (("method", SPRINGS), ("rate", "960"), ("lifted", "2"), ("law", "draft gear")):
        menu = page.controls.menus[field]
        pygame.event.post(pygame.Event(pygame_gui.UI_DROP_DOWN_MENU_CHANGED, ui_element=menu, text=text))
        driver.frames(2)
    model = page.model
    assert (model.method, model.rate, model.lifted, model.law) == (SPRINGS, 960, 2, "draft gear")
    page.model.advance(0.5)
    page.dialogs.save("export", "swing")
    rows = (tmp_path / "swing.csv").read_text().splitlines()
    assert len(rows) == len(model.frames) + 1
    assert rows[0].startswith("time_s,soft_x0_m,soft_y0_m")
    assert float(rows[-1].split(",")[0]) == pytest.approx(0.5, abs=0.02)
    driver.close()


def test_balls_that_have_passed_each_other_are_a_fault():
    model = HangingModel("power law, alpha 1/14")
    model.advance(0.1)
    assert verdict(model, 0).level == "good"
    for _ in range(60):
        model.hold(0, 4, (-0.6, -0.5))
        model.advance(1 / 60)
    model.release()
    model.advance(0.5)
    found = verdict(model, 0)
    assert found.level == "bad"
    assert "passed each other" in found.sentence
    model.scrub(3)
    assert verdict(model, 0).level == "good"  # not yet
    model.restart()
    assert verdict(model, 0).level == "good"


def test_a_kept_energy_says_how_well():
    model = HangingModel("steel balls (Hertz)", rate=240)
    model.advance(4.0)
    found = verdict(model, 0)
    assert found.level == "good"
    assert f"{100 * abs(found.change):.2g} %" in found.sentence


def test_a_picture_reads_no_more_frames_than_its_plot_shows():
    model = HangingModel(rate=60)
    model.advance(30.0)
    assert len(model.energy_shares(0, 12.0)) == 12 * 60 + 1
    assert model.energy_shares(0, 12.0)[-1][0] == model.time
    model.scrub(100)
    assert model.energy_shares(0, 12.0)[0][0] == 0.0
