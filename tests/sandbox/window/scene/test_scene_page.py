"""Tests of the scene page with simulated mouse and keyboard events.

The tests check time, slow motion and sound. The tests also check the drawing of beads, forces, marks and labels, and
the scrolling of plots.
"""

import math
import re
from unittest.mock import Mock

import numpy as np
import pygame
import pytest
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.session.inputs import SetVelocity
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.story.numbers import MINUS
from softcradle.sandbox.window.scene.sound import RATE, TONE_VOLUME, TONES, click, tone
from softcradle.scenes import Scene

from tests.helpers.drawn_text import colliding
from tests.helpers.windows import Driver


def test_the_timeline_goes_back_and_playing_starts_a_new_branch(driver: Driver) -> None:
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
    # Shift and the full stop go to the next time at which a contact opens or closes.
    driver.key(pygame.K_PERIOD, pygame.KMOD_SHIFT)
    before, after = driver.session.history.snapshot(driver.session.frame - 1), driver.session.lanes[0].state
    assert before.states[0].overlap[0] <= 0.0 < after.overlap[0]
    assert abs(after.time - 1.0) < 0.02  # The striker moves 1 m with 1 m/s before it hits the next bead.
    driver.key(pygame.K_MINUS)  # Slowing down the motion does not drop stored frames.
    assert driver.session.history.last == last
    driver.run(3)
    assert driver.session.slow == 5.0
    assert driver.session.history.last < last


def test_keys_and_slider_set_the_slow_motion(driver: Driver) -> None:
    assert driver.session.slow == driver.session.scene.view.slow
    driver.key(pygame.K_MINUS)
    assert driver.session.slow == 5.0
    driver.key(pygame.K_EQUALS)
    assert driver.session.slow == 2.0
    slider = driver.page.time_controls.slider
    driver.pull(slider.sliding_button.rect.center, (slider.rect.right - 5, slider.rect.centery))
    assert driver.session.slow > 500.0
    # Press the mouse button on the track of the slider, next to its handle.
    driver.press((slider.rect.left + 3 * slider.rect.width // 4, slider.rect.centery))
    driver.frames(2)
    assert 40.0 < driver.session.slow < 80.0
    driver.move((slider.rect.right, slider.rect.centery), (1, 0, 0))
    driver.frames(2)
    assert driver.session.slow == 1000.0
    driver.release((slider.rect.right, slider.rect.centery))
    driver.key(pygame.K_EQUALS, times=20)
    assert driver.session.slow == 0.01  # A value below 1 means that the motion is faster than real time.
    driver.run(10)
    assert driver.session.time > 5.0
    scene = driver.session.scene
    # A scene can have a value that is outside the range of the slider.
    for slow, slower, faster in ((5000.0, 5000.0, 1000.0), (0.001, 0.01, 0.001)):
        for key, expected in ((pygame.K_MINUS, slower), (pygame.K_EQUALS, faster)):
            driver.page.show_scene(scene.model_copy(update={"view": scene.view.model_copy(update={"slow": slow})}))
            driver.frames(2)
            driver.key(key)
            assert driver.session.slow == expected


def test_sounds_have_no_jumps():
    wave = np.frombuffer(click(880.0), np.int16).astype(float)
    assert 0.03 < len(wave) / RATE < 0.2
    assert np.abs(wave[:200]).max() > 8000
    assert np.abs(wave[-100:]).max() < 0.02 * np.abs(wave).max()
    for pitch in TONES:
        wave = np.frombuffer(tone(pitch), np.int16).astype(float)
        steps = np.abs(np.diff(np.concatenate((wave, wave[:2]))))
        assert steps[-2:].max() <= steps[:-2].max() + 1.0
        assert np.argmax(np.abs(np.fft.rfft(wave))) * RATE / len(wave) == pytest.approx(pitch)


def test_one_key_changes_the_sound(driver: Driver):
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


def test_a_motion_is_not_over_while_couplers_may_pull() -> None:
    gear = {"law": "preloaded", "preload": 1.0, "stiffness": 10.0, "exponent": 1.0}
    wagons = {"beads": 3, "velocity": [-0.5, 0.0, 0.5]}
    lane = {**wagons, "contact": {"law": "coupler", "push": gear, "pull": gear, "slack": 0.5}}
    session = Session(Scene.model_validate({"title": "Wagons that go apart", "duration": 5.0, "lanes": [lane]}))
    while not (session.lanes[0].state.force < 0.0).any():
        assert not session.lanes[0].over
        session.step_frames(1)
    assert not session.lanes[0].over


def test_a_motion_is_over_after_its_last_force() -> None:
    force = {"beads": 0, "time": [0.5, 1.0, 1.0], "force": [-1.0, -1.0, 0.0]}
    lane = {"velocity": [0.0, 1.0], "contact": {"law": "hertz", "stiffness": 1.0}, "forces": [force]}
    session = Session(Scene.model_validate({"title": "Apart", "lanes": [lane]}))
    for frames, over in ((59, False), (62, True)):
        session.step_frames(frames)
        assert session.lanes[0].over == over
    stiff = {"law": "hertz", "stiffness": 1e6}  # With these stiff contacts, two beads end at rest except for round-off.
    for velocity, gap, frames in (([-1.0, 0.0, 0.0], 0.0, 0), ([1.0, 0.0, 0.0], 0.1, 60)):
        lane = {"velocity": velocity, "contact": stiff, "gap": gap}
        session = Session(Scene.model_validate({"title": "Two rest", "lanes": [lane]}))
        session.step_frames(frames)
        assert session.lanes[0].over


def test_a_replay_clicks_as_the_run_did(driver: Driver, tmp_path) -> None:
    live, replayed = Mock(), Mock()
    driver.key(pygame.K_n)
    driver.page.sound.clicks.click = live
    driver.play_to_the_end()
    driver.page.dialogs.save("save_session", "played")
    driver.drop_file(tmp_path / "played.npz")
    driver.key(pygame.K_n)
    driver.page.sound.clicks.click = replayed
    driver.until(lambda: driver.page.replay.done, most=900)
    assert live.mock_calls == replayed.mock_calls != []


def has_colour(driver: Driver, points, colour) -> bool:
    return all(driver.app.surface.get_at((round(x), round(y)))[:3] == tuple(colour) for x, y in points)


def in_sight(driver: Driver) -> bool:
    lane = driver.page.view.lanes[0]
    rect = lane.drawing.rect
    return bool((lane.edges >= rect.left).all() and (lane.edges + lane.drawing.bead <= rect.right + 1).all())


def test_the_view_is_zoomed_dragged_and_fitted(driver: Driver) -> None:
    def counted() -> list[pygame.Rect]:
        high = driver.page.view.lanes[0].drawing.ground - 14
        return [one.rect for one in driver.texts() if one.text == "5" and abs(one.rect.centery - high) < 4]

    rect, slow = driver.page.view.lanes[0].drawing.rect, driver.session.slow
    point = (rect.left + rect.width // 4, rect.top + 30)
    place = driver.page.view.metres_at(point)
    for turn in (-1, -1, -1, 1):
        driver.wheel(point, turn)
        assert driver.page.view.metres_at(point) == pytest.approx(place, abs=1e-6)
    assert driver.session.slow == slow
    before = float(driver.page.view.lanes[0].edges[0])
    driver.pull(point, (point[0] - 3 * rect.width, point[1]))
    assert driver.page.view.lanes[0].edges[0] == pytest.approx(before - 3 * rect.width, abs=3)
    assert not in_sight(driver)
    (arrow,) = counted()
    assert arrow.left < rect.left + 30
    driver.click(driver.page.time_controls.buttons["fit"].rect.center)
    assert in_sight(driver)
    assert not counted()
    driver.page.clock.end.toggle()
    driver.session.apply(SetVelocity(0, 0, 4.0))
    driver.key(pygame.K_SPACE)
    for _ in range(20):
        driver.frames(30)
        assert in_sight(driver)  # The view changes automatically, so all beads stay visible.
    assert driver.session.time > 4.0
    lane = {"velocity": [1e-6, 0.0], "contact": {"law": "hertz", "stiffness": 1.0}}
    small = Scene.model_validate({"title": "Micrometres", "lanes": [lane], "view": {"length": 1e-6}})
    driver.page.show_scene(small)
    before = driver.page.view.lanes[0].drawing.bead
    driver.key(pygame.K_UP)
    assert driver.page.view.lanes[0].drawing.bead >= before


def test_marks_of_rigid_clusters_are_of_the_beads_that_there_are(driver: Driver) -> None:
    driver.play(240)
    assert len(driver.page.view.lanes[0].drawing.ends) == 4
    driver.select("bead", 4)
    driver.key(pygame.K_DELETE)
    # Eq. (5) applies to the three beads that are hit, so only these beads have marks.
    assert driver.page.view.lanes[0].drawing.ends == (True, False, False)


@pytest.mark.parametrize("name", ["train-shunting", "train-braking", "train-cut"])
def test_force_labels_of_a_train_fit(name: str) -> None:
    driver, seen = Driver(name), 0
    for _ in range(12):
        driver.session.step_frames(40)
        driver.frames(2)
        lane = driver.page.view.lanes[0]
        texts = [one for one in driver.texts() if lane.drawing.rect.collidepoint(one.rect.center)]
        assert any(re.fullmatch(r"contact force \([kM]N\)", one.text) for one in texts)
        above = [one for one in texts if one.rect.bottom <= lane.drawing.bar_base]
        forces = [one for one in above if re.fullmatch(rf"{MINUS}?[\d.]+", one.text)]
        seen = max(seen, len(forces))
        assert not [pair for pair in colliding(texts) if {*pair} & {one.text for one in forces}]
    assert seen > 2


@pytest.mark.parametrize("lab", [False, True], ids=["explore", "lab"])
def test_every_force_of_a_row_is_written_at_every_scale(lab: bool) -> None:
    driver = Driver("one-on-four", lab=lab)
    driver.session.step_frames(600)
    force = np.concatenate([part.force for part in driver.session.history_slices(0, 600)])
    driver.session.scrub_frame(1 + int(force.max(axis=1).argmax()))
    for driver.app.scale in (1.0, 1.5, 2.0):
        driver.frames(2)
        assert {"0.92", "0.71", "0.47", "0.24"} <= {one.text for one in driver.texts()}


def test_seven_plots_of_two_lanes_are_scrolled_to() -> None:
    driver = Driver("beads-against-gear")
    board, view = driver.page.board, driver.page.view
    board.chosen = board.available()
    driver.frames(2)
    assert len(board.shown) >= 7
    driver.app.scale = 1.5
    driver.frames(2)
    assert len(view.rows) < view.row_count
    seen = set(board.keys)
    for _ in range(view.row_count):
        driver.wheel(view.plots_area().center, -1)
        seen |= set(board.keys)
    assert seen == {(name, lane) for name in board.shown for lane in (0, 1)}


def test_a_selection_has_the_shape_of_its_body() -> None:
    driver = Driver("draft-gear-one-on-three")
    driver.select("bead", 1)
    lane, gap = driver.page.view.lanes[0], 4
    rect, corner = lane.drawing.body_shape(1, float(lane.edges[1]))
    assert 2 * corner < rect.width
    frame = rect.inflate(2 * gap, 2 * gap)
    assert has_colour(driver, [(frame.centerx, frame.top), (frame.left, frame.centery)], tones.foreground)
    driver.app.act("law_all")  # After this action, all contacts follow a power law and the beads are drawn as circles.
    driver.frames(2)
    lane = driver.page.view.lanes[0]
    rect, corner = lane.drawing.body_shape(1, float(lane.edges[1]))
    assert 2 * corner == pytest.approx(rect.width, abs=1)
    radius = corner + gap - 1
    turns = [pygame.Vector2(radius, 0).rotate_rad(turn) for turn in (-0.8, -1.6, -2.4)]
    assert has_colour(driver, [rect.center + turn for turn in turns], tones.foreground)


def test_a_wall_is_made_of_any_bead_and_freed_again(driver: Driver) -> None:
    driver.click(driver.bead(4))
    for text, mass in (("turn into a wall", math.inf), ("back into a bead", 1.0)):
        driver.click(next(one for one in driver.page.inspector.buttons if one.text == text).rect.center)
        assert driver.session.lanes[0].chain.mass[4] == mass


def test_the_control_in_focus_has_a_ring(driver: Driver) -> None:
    driver.move((700, 300))
    for _ in range(4):
        driver.key(pygame.K_TAB)
        rect = driver.app.focus.control.rect.inflate(6, 6)
        edges = (rect.centerx, rect.top), (rect.left, rect.centery), (rect.centerx, rect.bottom - 1)
        assert has_colour(driver, edges, tones.foreground)
