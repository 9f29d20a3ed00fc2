"""Parts of the window on their own: keys, time axis, sheet of ink, places, thumbnails, sound."""

from __future__ import annotations

import warnings

import numpy as np
import pygame
import pytest
from softcradle.physics import METHODS
from softcradle.sandbox.film.scene_motion import scene_motions, scene_motions_quietly
from softcradle.sandbox.session import Session
from softcradle.sandbox.session.history_slices import history_slices
from softcradle.sandbox.session.inputs import AddBead, SetFriction
from softcradle.sandbox.window.gallery import thumbnails
from softcradle.sandbox.window.hanging.hanging_cradle import LAWS, Hanging
from softcradle.sandbox.window.hanging.hanging_page import HangingPage
from softcradle.sandbox.window.kernel_warmup import Warmer
from softcradle.sandbox.window.keys import BINDINGS, CTRL, SHIFT, action_of
from softcradle.sandbox.window.page_geometry import geometry
from softcradle.sandbox.window.plots.scrolling_surface import Sheet
from softcradle.sandbox.window.plots.time_axis import TimeSpan
from softcradle.sandbox.window.scene.editable_parameters import number
from softcradle.sandbox.window.scene.scene_page import Play
from softcradle.sandbox.window.sound import RATE, click

from softcradle import scenes
from tests.helpers.windows import Driver


def test_every_key_means_one_thing_and_every_action_is_offered():
    keys = [key for binding in BINDINGS for key in binding.keys]
    assert len(keys) == len(set(keys))
    driver = Driver("one-on-four")
    offered = set(driver.app.actions) | set(driver.play.actions)
    assert {binding.action for binding in BINDINGS} == offered
    driver.close()


def test_modifiers_tell_keys_apart():
    assert action_of(pygame.K_s, pygame.KMOD_LCTRL) == "save_scene"
    assert action_of(pygame.K_s, pygame.KMOD_RMETA | pygame.KMOD_SHIFT) == "save_session"
    assert action_of(pygame.K_s, 0) is None
    assert action_of(pygame.K_r, pygame.KMOD_ALT) is None
    assert action_of(pygame.K_MINUS, SHIFT) == "slower"  # where a layout has the sign on the shifted key
    assert action_of(pygame.K_MINUS, CTRL) == "smaller"


def test_time_axis_stands_still_until_it_must_move():
    span = TimeSpan(8.0, 400)
    span.follow(7.0)
    assert span.left == 0
    span.follow(9.0)
    assert span.x(9.0) == pytest.approx(0.92 * 400, abs=1.0)
    assert span.time(span.x(9.0)) == pytest.approx(9.0)
    span.follow(0.0)
    assert span.left == 0


class Columns:
    """Ink that writes the number of the column into its pixels, and counts what it is asked for."""

    def __init__(self):
        self.asked = []

    def __call__(self, first, last):
        self.asked += range(first, last)
        made = pygame.Surface((last - first, 4), 0, 32)
        for x in range(last - first):
            made.fill(((first + x) % 256, 1, 0), (x, 0, 1, 4))
        return made


def shown(sheet):
    return [tuple(sheet.surface.get_at((x, 0)))[:2] for x in range(sheet.width)]


def test_sheet_shows_every_column_in_its_place_whatever_the_scrolling():
    ground = pygame.Surface((50, 4), 0, 32)
    ink = Columns()
    sheet = Sheet(ground, ink)
    for left, first, last in ((0, 0.0, 20.5), (0, 0.0, 49.9), (30, 0.0, 70.0), (10, 5.0, 70.0), (200, 150.0, 240.0)):
        sheet.scroll(left)
        for _ in range(20):
            sheet.update(first, last, True, 10)
        for x, pixel in enumerate(shown(sheet)):
            column = left + x
            assert pixel == ((column % 256, 1) if int(first) <= column <= int(last) else (0, 0))


def test_sheet_does_no_more_than_it_is_allowed_and_nothing_twice_when_idle():
    ink = Columns()
    sheet = Sheet(pygame.Surface((50, 4), 0, 32), ink)
    sheet.update(0.0, 49.0, True, 10)
    assert len(ink.asked) <= 12
    for _ in range(10):
        sheet.update(0.0, 49.0, False, 10)
    ink.asked.clear()
    sheet.update(0.0, 49.0, False, 10)
    assert ink.asked == []


def test_sheet_forgets_a_branch_that_was_cut_off():
    ink = Columns()
    sheet = Sheet(pygame.Surface((50, 4), 0, 32), ink)
    for _ in range(10):
        sheet.update(0.0, 40.0, True, 10)
    sheet.cut(20)
    sheet.update(0.0, 21.0, True, 10)
    assert shown(sheet)[22:] == [(0, 0)] * 28


@pytest.mark.parametrize("size", [(800, 480), (1280, 720), (2560, 1440)])
@pytest.mark.parametrize("rows", [[], [3], [3, 2], [4, 4]])
@pytest.mark.parametrize("lanes", [1, 2])
@pytest.mark.parametrize("side", [True, False])
def test_nothing_on_the_page_overlaps_or_leaves_the_window(size, rows, lanes, side):
    places = geometry(size, size[1] / 720, lanes, rows, side)
    boxes = [places.top, places.foot, *places.stages, *(rect for row in places.plots for rect in row)]
    boxes += [places.loupes] * bool(places.loupes.height) + [places.side] * bool(places.side.width)
    for k, box in enumerate(boxes):
        assert pygame.Rect((0, 0), size).contains(box)
        assert box.collidelist(boxes[k + 1 :]) == -1


def test_history_is_read_thinned_and_across_changes_of_the_row():
    session = Session(scenes.load("one-on-four"))
    session.step_frames(700)
    session.apply(AddBead(0, 5, 1.0))
    session.step_frames(50)
    whole = list(history_slices(session.history, 0, 0, session.history.last, 10**6))
    assert sum(len(rows.time) for rows in whole) == session.history.last + 1
    assert {rows.velocity.shape[1] for rows in whole} == {5, 6}
    thin = list(history_slices(session.history, 0, 0, session.history.last, 100))
    assert 90 <= sum(len(rows.time) for rows in thin) <= 130
    moment = session.history.snapshot(600)
    row = next(history_slices(session.history, 0, 600, 600, 1))
    assert np.array_equal(row.velocity[0], moment.states[0].velocity(row.chain))
    energy = row.energy.sum()
    assert energy == pytest.approx(0.5, rel=1e-9)


def test_thumbnail_of_another_scene_has_another_file():
    scene = scenes.load("one-on-four")
    other = scene.model_copy(update={"title": "Another"})
    assert thumbnails.cached_path(scene) == thumbnails.cached_path(scenes.load("one-on-four"))
    assert thumbnails.cached_path(scene) != thumbnails.cached_path(other)


def test_a_cache_that_cannot_be_written_is_done_without(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("SOFTCRADLE_CACHE", str(tmp_path / "file" / "cache"))
    scene = scenes.load("one-on-four")
    assert thumbnails.read(scene) is None
    thumbnails.keep(scene, pygame.Surface((4, 4)))
    assert thumbnails.read(scene) is None


def test_a_look_ahead_leaves_the_warning_filters_alone(monkeypatch):
    """It runs on a thread; filters are those of all threads. What a film says of the same motion is not lost."""
    scene = scenes.load("one-on-four").model_copy(update={"method": "euler", "step": 1e-3})
    with pytest.warns(RuntimeWarning):
        told = scene_motions(scene, 2000.0)

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a thread has touched the warnings")

    for name in ("catch_warnings", "simplefilter", "filterwarnings", "warn"):
        monkeypatch.setattr(warnings, name, refuse)
    tracks, sentences = scene_motions_quietly(scene, 2000.0)
    assert sentences
    assert np.array_equal(tracks[0].position, told[0].position)
    assert thumbnails.motion(scene)


def test_a_scene_waits_for_the_kernels_of_what_rubs():
    warmer = Warmer()
    smooth, rough = Session(scenes.load("one-on-four")).lanes, Session(scenes.load("train-cut")).lanes
    assert rough[0].chain.dissipative
    assert not warmer.can_move(smooth)
    warmer.start()
    assert warmer.complete.wait(300.0)
    warmer.stop()
    assert warmer.can_move(smooth)
    assert warmer.can_move(rough)
    warmer._warm.discard((rough[0].setup.method, True))
    assert warmer.can_move(smooth)
    assert not warmer.can_move(rough)
    assert warmer.can_move(rough, "yoshida4"), "what is refused is not waited for"


def test_what_comes_to_rub_while_kernels_are_compiled_pauses_the_clock():
    driver = Driver("one-on-four")
    driver.app.warmer._warm -= {(method.name, True) for method in METHODS}
    driver.session.apply(SetFriction(0, 0.1))
    driver.session.play()
    driver.frames(3)
    assert driver.play.waiting
    frame = driver.session.frame
    driver.frames(3)
    assert driver.session.frame == frame
    driver.app.warmer._warm |= {(method.name, True) for method in METHODS}
    driver.frames(3)
    assert not driver.play.waiting
    assert driver.session.frame > frame
    driver.close()


def test_click_is_a_short_sound_that_dies_away():
    wave = np.frombuffer(click(880.0), np.int16).astype(float)
    assert 0.03 < len(wave) / RATE < 0.2
    assert np.abs(wave[:200]).max() > 8000
    assert np.abs(wave[-100:]).max() < 0.02 * np.abs(wave).max()


@pytest.mark.parametrize("law", LAWS)
def test_soft_balls_on_strings_gain_no_energy(law):
    model = Hanging(law)
    before = model.cradles[0].energy()
    model.advance(10.0)
    assert 0.9 * before < model.cradles[0].energy() < 1.02 * before


def test_a_small_exponent_makes_the_balls_swing_off_nearly_as_one_body():
    """Shortly after the first blow: the four that were hit move on alike; of steel balls the last alone does."""
    spreads = []
    for law in ("power law, alpha 1/14", "steel balls (Hertz)"):
        model = Hanging(law)
        model.advance(0.95)
        speeds = [ball.velocity.x for ball in model.cradles[0].balls]
        spreads.append(max(speeds[1:]) - min(speeds[1:]))
    assert spreads[0] < 0.5 * spreads[1]


def test_hanging_page_is_played_by_hand():
    driver = Driver("hanging-cradle")
    page = driver.app.page
    assert isinstance(page, HangingPage)
    driver.key(pygame.K_SPACE)
    driver.frames(30)
    assert page.model.time > 0.4
    from softcradle.sandbox.window.hanging.hanging_picture import to_screen

    ball = to_screen(page.stages[1], page.model.cradles[1].places()[4])
    driver.drag(ball, (ball[0] + 60, ball[1] - 40), steps=10)
    driver.frames(20)
    assert page.model.cradles[1].places()[4][0] > 0.9
    driver.release(ball)
    driver.key(pygame.K_MINUS)
    assert page.slow == 2.0
    driver.key(pygame.K_r)
    assert page.model.time < 0.1
    driver.key(pygame.K_ESCAPE)
    assert not isinstance(driver.app.page, (HangingPage, Play))
    driver.close()


@pytest.mark.parametrize(
    ("text", "value"), [("0,5", 0.5), ("1/14", 1 / 14), ("\N{MINUS SIGN}2e-3", -2e-3), (" 7 ", 7.0)]
)
def test_numbers_are_read_as_people_type_them(text, value):
    assert number(text) == value


@pytest.mark.parametrize("text", ["", "x", "1/0", "1/", "--1"])
def test_what_is_no_number_is_refused(text):
    with pytest.raises(ValueError):  # noqa: PT011 - whatever it says, the inspector names the field and the text
        number(text)
