"""Nothing is lost: edits are undone, redone and asked for, files are not replaced unasked, drags end, films are written."""

import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pygame
import pytest
from softcradle.sandbox.draw.text import width
from softcradle.sandbox.session.inputs import SetMass
from softcradle.sandbox.session.snapshots import NOTHING_HELD
from softcradle.sandbox.window.gallery.page import GalleryPage
from softcradle.sandbox.window.settings import unsaved_path

from tests.helpers.windows import Driver

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


def edited(driver: Driver) -> None:
    driver.click(driver.bead(2))
    driver.key(pygame.K_a)


def test_a_window_that_is_killed_offers_its_edits_at_the_next_start_unless_they_are_saved(driver: Driver) -> None:
    edited(driver)
    driver.frames(90)
    assert unsaved_path().exists()
    driver.page.dialogs.save("save_scene", "mine")
    driver.frames(90)
    assert not unsaved_path().exists()
    driver.key(pygame.K_a)
    driver.frames(90)
    for mass in range(2, 92):  # a slider that is dragged for longer than the file waits
        driver.session.apply(SetMass(0, 0, float(mass)), gesture=True)
        driver.frames()
    driver.frames(70)
    driver.page.actions["slower"]()
    driver.frames(90)
    masses, slow = driver.session.lanes[0].chain.mass, driver.session.slow
    driver.app.quit(killed=True)
    driver.close()
    again = Driver()
    assert again.app.dialog.title == "An unsaved scene"
    again.key(pygame.K_RETURN)
    assert (again.session.lanes[0].chain.mass, again.session.slow) == (masses, slow)
    assert again.page.unsaved
    assert again.app.settings.recent == [str(Path("mine.toml").resolve())]
    again.close()  # by hand
    assert not unsaved_path().exists()


def test_keys_and_buttons_undo_and_redo_and_the_motion_stays(driver: Driver) -> None:
    driver.play(60)
    last, buttons = driver.session.history.last, driver.page.toolbar.buttons
    assert not buttons["undo"].is_enabled
    edited(driver)
    driver.key(pygame.K_DELETE)
    assert driver.session.lanes[0].chain.contacts == 4
    driver.key(pygame.K_z, CTRL)
    assert driver.session.lanes[0].chain.contacts == 5
    driver.click(buttons["undo"].rect.center)
    assert driver.session.lanes[0].chain.contacts == 4
    assert driver.session.history.last == last
    driver.key(pygame.K_y, CTRL)
    driver.click(buttons["redo"].rect.center)
    assert driver.session.lanes[0].chain.contacts == 4
    assert not buttons["redo"].is_enabled
    driver.key(pygame.K_z, CTRL | SHIFT)
    assert "nothing to redo" in driver.messages
    slider = driver.page.inspector.controls["mass"].slider.sliding_button.rect
    driver.pull(slider.center, (slider.centerx - 60, slider.centery))  # a drag is one step
    bead = driver.page.editor.selection.index
    assert driver.session.lanes[0].chain.mass[bead] < 0.5
    driver.key(pygame.K_z, CTRL)
    assert driver.session.lanes[0].chain.mass[bead] == 1.0


WAYS = {
    "escape": lambda driver: driver.key(pygame.K_ESCAPE),
    "button": lambda driver: driver.click((40, 24)),
    "quit": lambda driver: driver.key(pygame.K_q, CTRL),
    "drop": lambda driver: driver.drop_file("other.toml"),
    "close": lambda driver: driver.post(pygame.QUIT),
}


@pytest.mark.parametrize("leave", WAYS.values(), ids=WAYS)
def test_edits_are_not_lost_unasked(driver: Driver, leave: Callable[[Driver], None]) -> None:
    edited(driver)
    page = driver.app.page
    driver.key(pygame.K_ESCAPE)
    Path("other.toml").write_text(driver.session.scene.to_toml())
    leave(driver)
    assert driver.app.page is page
    assert driver.app.running
    assert driver.app.dialog is not None
    driver.key(pygame.K_ESCAPE)  # stay
    assert driver.app.page is page
    driver.page.dialogs.save("save_scene", "kept")
    driver.key(pygame.K_ESCAPE)
    assert isinstance(driver.app.page, GalleryPage)
    driver.key(pygame.K_ESCAPE)
    assert driver.app.running  # Esc does not quit


def test_the_question_saves_or_discards(driver: Driver, tmp_path: Path) -> None:
    edited(driver)
    driver.page.leave()
    driver.key(pygame.K_RETURN)  # Save ...
    driver.answer("mine")
    assert (tmp_path / "mine.toml").exists()
    driver.key(pygame.K_DELETE)
    driver.page.leave()
    driver.key(pygame.K_LEFT)
    driver.key(pygame.K_RETURN)  # Discard them
    assert isinstance(driver.app.page, GalleryPage)


def test_a_file_is_replaced_only_when_asked_for_and_a_folder_of_the_home_is_understood(driver, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    driver.page.dialogs.save("save_scene", "~/mine")
    assert driver.messages == ["saved ~/mine.toml"]
    mine = tmp_path / "mine.toml"
    mine.write_text("precious")
    driver.page.dialogs.save("save_scene", "mine")
    assert mine.read_text() == "precious"
    driver.key(pygame.K_ESCAPE)
    assert mine.read_text() == "precious"
    driver.page.dialogs.save("save_scene", "mine")
    driver.click(driver.app.dialog.buttons["Replace"].rect.center)
    assert mine.read_text() != "precious"


def test_del_while_a_bead_is_dragged_lets_it_go(driver: Driver) -> None:
    for bead in (4, 2, 0):
        x, y = driver.bead(bead)
        driver.drag((x, y), (x + 30, y))
        driver.key(pygame.K_DELETE)
        driver.frames(3)
        assert driver.page.pointer.pressed is None
        driver.release((x + 30, y))
    assert driver.session.lanes[0].chain.contacts == 1


@pytest.mark.parametrize("away", [pygame.WINDOWMINIMIZED, pygame.WINDOWFOCUSLOST, pygame.MOUSEMOTION, pygame.KEYDOWN])
def test_a_bead_let_go_where_no_event_tells_does_not_stick(driver: Driver, away: int) -> None:
    driver.key(pygame.K_SPACE)
    x, y = driver.bead(4)
    driver.drag((x, y), (x + 60, y))
    assert driver.session.held.lane == 0.0
    if away == pygame.KEYDOWN:
        driver.key(pygame.K_F7)  # a menu, which takes the release of the button
        driver.release((x + 60, y))
    else:
        driver.post(away, pos=(x, y), rel=(0, 0), buttons=(0, 0, 0))
        driver.post(pygame.WINDOWRESTORED)
    driver.frames(2)
    assert driver.page.pointer.pressed is None
    assert driver.session.held == NOTHING_HELD


def test_nothing_moves_while_minimised_and_a_paused_window_needs_no_frames(driver: Driver) -> None:
    driver.frames(150)
    assert driver.app.still
    driver.run(120)
    assert not driver.app.still
    driver.post(pygame.WINDOWMINIMIZED)
    frame = driver.session.frame
    driver.frames(10)
    assert driver.session.frame == frame
    assert driver.app.still
    driver.post(pygame.WINDOWRESTORED)
    driver.frames(10)
    assert driver.session.frame > frame


def test_a_film_keeps_all_of_a_window_that_is_resized(driver: Driver, tmp_path: Path) -> None:
    import av

    driver.page.dialogs.save("film", "mine.mp4")
    driver.frames(1)
    assert driver.page.toolbar.buttons["film"].text == "Stop 0:00"
    driver.frames(20)
    driver.resize((1600, 900))
    driver.frames(20)
    driver.click(driver.page.toolbar.buttons["film"].rect.center)
    assert any("saved" in text and "mine.mp4" in text for text in driver.messages)
    with av.open(str(tmp_path / "mine.mp4")) as film:
        pictures = [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]
    assert 15 <= len(pictures) <= 25  # every other one
    corners = [picture[-20:, -20:] for picture in pictures]
    assert np.abs(corners[0].astype(int) - corners[-1]).mean() < 20  # the foot of the page is in both


@pytest.mark.parametrize("name", ["one-on-four", "hanging-cradle"])
def test_the_button_of_a_film_says_stop_and_the_time(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    driver = Driver(name)
    page = driver.app.page
    page.dialogs.save("film", "mine.mp4")
    driver.frames(1)
    button, texts = page.toolbar.buttons["film"], []
    with monkeypatch.context() as watched:
        watched.setattr(page, "build", Mock(side_effect=AssertionError("made anew")))
        watched.setattr(button.drawable_shape, "set_text", texts.append)
        driver.frames(3 * 60 + 3)
        room = button.rect.width
        page.film.seconds = 59 * 60 + 59
        driver.frames()
    assert texts == ["Stop 0:01", "Stop 0:02", "Stop 0:03", "Stop 59:59"]  # drawn once a second
    assert width(button.text, 13 * driver.app.unit, bold=True) < room == button.rect.width
    driver.click(button.rect.center)
    assert "film" not in page.toolbar.buttons
    page.dialogs.save("film", "second.mp4")
    monkeypatch.setattr(page.film.film, "add", Mock(side_effect=OSError("no room is left")))
    driver.frames(3)  # the film stops by itself
    assert "film" not in page.toolbar.buttons
    assert "the film stopped: no room is left" in driver.messages
    assert any("second.mp4" in text for text in driver.messages)  # what there was until then
    page.dialogs.save("film", "third.mp4")
    driver.frames(10)
    driver.key(pygame.K_ESCAPE)  # leaving writes it
    assert Path("third.mp4").exists()


FILMING = """
from softcradle.sandbox.window.app import App
app = App((640, 480), "one-on-four")
for _ in range(20):
    app.frame(1 / 60)
app.page.dialogs.save("film", "mine.mp4")
for _ in range(20):
    app.frame(1 / 60)
app.page.after_frame = lambda surface, seconds, record=app.page.after_frame: (
    record(surface, seconds), print("filming", flush=True)
)
app.run()
"""


@pytest.mark.parametrize("number", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.slow)])
def test_a_signal_while_filming_keeps_the_film(tmp_path: Path, number: signal.Signals) -> None:
    import av

    command = [sys.executable, "-c", FILMING]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as process:
        while "filming" not in process.stdout.readline():
            assert process.poll() is None
        process.send_signal(number)
        process.communicate()
        assert process.returncode == 0
    with av.open(str(tmp_path / "mine.mp4")) as film:
        assert sum(1 for _ in film.decode(video=0)) >= 5


def test_a_session_is_saved_and_replayed_with_the_same_digits_and_can_be_paused(driver: Driver, tmp_path: Path) -> None:
    driver.run(40)
    x, y = driver.bead(4)
    driver.pull((x, y), (x + 80, y), steps=20)
    driver.session.apply(SetMass(0, 1, 2.0))
    driver.frames(20)
    overlap, last = driver.session.lanes[0].state.overlap.copy(), driver.session.history.last
    driver.page.dialogs.save("save_session", "played")
    driver.drop_file(tmp_path / "played.npz")
    driver.frames(5)
    assert driver.page.clock.activity() == "replaying"
    said = next(one for one in driver.texts() if one.text.startswith("replay, frame"))
    assert driver.page.view.places.footer.contains(said.rect)  # on no bead and no force
    driver.key(pygame.K_SPACE)
    frame = driver.session.frame
    driver.frames(5)
    assert (driver.page.clock.activity(), driver.session.frame) == ("paused", frame)
    for name in ["restart", *["forward"] * 100, *["back"] * 3]:
        driver.page.actions[name]()
    assert driver.session.frame == 97
    driver.page.actions["slower"]()
    driver.run(5)  # from the newest frame on, slower, and a bead is held
    assert 100 < driver.session.frame < 108
    assert driver.session.held.bead == 4.0
    driver.until(lambda: driver.page.replay.done, most=800)
    assert driver.page.replay.diverged is None
    assert not driver.page.unsaved
    assert any("agrees" in text for text in driver.messages)
    assert np.array_equal(driver.session.history.snapshot(last).states[0].overlap, overlap)
    driver.page.actions["restart"]()
    driver.run(10)
    driver.session.apply(SetMass(0, 0, 2.0))
    driver.frames(20)
    assert driver.page.clock.note() == (f"replay left at frame {driver.session.frame} of {last}", False)
