"""Tests that the user does not lose work.

The tests check undo and questions before edits or files are discarded. The tests also check interrupted drags, and
films that are being recorded.
"""

import os
import signal
from itertools import product
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pygame
import pytest
from softcradle.physics import power_law
from softcradle.sandbox.draw.text import width
from softcradle.sandbox.session.inputs import Drag, Drop, SetContact, SetMass
from softcradle.sandbox.session.replay import Replay
from softcradle.sandbox.session.snapshots import NOTHING_HELD
from softcradle.sandbox.window.gallery.page import GalleryPage
from softcradle.sandbox.window.settings import settings_path
from softcradle.sandbox.window.unsaved_scene import UnsavedFile, left_over, unsaved_paths
from softcradle.scenes import load

from tests.helpers.windows import Driver
from tests.sandbox.page.conftest import page_data

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT


def edited(driver: Driver) -> None:
    driver.click(driver.bead(2))
    driver.key(pygame.K_a)


@pytest.mark.parametrize("end", ["killed", "crash"])
def test_unsaved_edits_are_offered_at_the_next_start(driver, monkeypatch, end) -> None:
    edited(driver)
    driver.frames(90)
    assert unsaved_paths()
    driver.page.dialogs.save("save_scene", "mine")
    driver.frames(90)
    assert not unsaved_paths()
    driver.key(pygame.K_a)
    driver.frames(90)
    for mass in range(2, 92):  # Drag a slider for a longer time than the delay after which edits are written to a file.
        driver.session.apply(SetMass(0, 0, float(mass)), gesture=True)
        driver.frames()
    driver.frames(70)
    driver.page.actions["slower"]()
    driver.frames(90)
    masses, slow = driver.session.lanes[0].chain.mass, driver.session.slow
    if end == "killed":
        driver.app.quit(killed=True)
        driver.close()
    else:
        monkeypatch.setattr(driver.app, "frame", Mock(side_effect=RuntimeError("a fault")))
        pygame.event.post(pygame.Event(pygame.KEYUP, key=pygame.K_a))
        with pytest.raises(RuntimeError, match="a fault"):
            driver.app.run()
    again = Driver()
    assert again.app.dialog.title == "An unsaved scene"
    again.key(pygame.K_RETURN)
    assert (again.session.lanes[0].chain.mass, again.session.slow) == (masses, slow)
    assert again.page.unsaved
    assert again.app.settings.recent == [str(Path("mine.toml").resolve())]
    again.app.quit()
    again.close()
    assert not [*settings_path().parent.glob("*unsaved*")]


def written(number: int) -> UnsavedFile:
    """Return a file with unsaved edits of a window that has ended. A larger `number` means a newer file."""
    file = UnsavedFile()
    file.write(load("one-on-four").model_copy(update={"title": f"scene {number}"}).to_toml())
    os.utime(file.path, (number, number))
    file.release()
    return file


@pytest.mark.parametrize("leave", ["quit", "page", "edit"])
def test_an_ignored_unsaved_scene_is_offered_again(leave: str) -> None:
    kept = written(1)
    driver = Driver("one-on-four")
    assert driver.app.dialog.title == "An unsaved scene"
    driver.key(pygame.K_ESCAPE)
    if leave == "page":
        driver.key(pygame.K_ESCAPE)
        assert isinstance(driver.app.page, GalleryPage)
    if leave == "edit":
        edited(driver)
        driver.frames(90)
        assert len(unsaved_paths()) == 2
        driver.page.dialogs.save("save_scene", "mine")
        driver.frames(90)
    driver.app.quit()
    driver.close()
    assert unsaved_paths() == [kept.path]
    again = Driver()
    again.key(pygame.K_RETURN)
    assert again.page.title == "scene 1"


def test_the_newest_unsaved_scene_is_offered_first() -> None:
    files = [written(number).path for number in (2, 3, 1)]
    no_scene = settings_path().with_name("unsaved.toml")  # Earlier versions used this file name.
    no_scene.write_text("title =")
    os.utime(no_scene, (0, 0))
    for path in (files[1], files[0], files[2]):
        assert path in unsaved_paths()
        driver = Driver()
        driver.key(pygame.K_RIGHT)
        driver.key(pygame.K_RETURN)  # The Return key confirms the button "Discard it".
        driver.close()
        assert path not in unsaved_paths()
    driver = Driver()
    driver.key(pygame.K_RETURN)
    assert any("not valid TOML" in text for text in driver.messages)
    driver.app.quit()
    driver.close()
    assert unsaved_paths() == [no_scene]


def test_the_edits_of_a_window_that_runs_are_no_other_windows(driver: Driver) -> None:
    edited(driver)
    driver.frames(90)
    (own,) = unsaved_paths()
    second = Driver()
    assert second.app.dialog is None
    assert left_over() is None
    second.app.quit()
    second.close()
    assert unsaved_paths() == [own]
    # Closing the application releases the file with the unsaved edits, like the end of a killed process.
    driver.app.close()
    found = left_over()
    assert found.path == own
    found.release()


def test_buttons_undo_and_redo_edits(driver: Driver) -> None:
    driver.play(60)
    last, buttons = driver.session.history.last, driver.page.toolbar.buttons
    edited(driver)
    driver.key(pygame.K_DELETE)
    for button, contacts in (("undo", 5), ("undo", 4), ("redo", 5), ("redo", 4)):
        driver.click(buttons[button].rect.center)
        assert driver.session.lanes[0].chain.contacts == contacts
        assert driver.session.history.last == last
    driver.key(pygame.K_z, CTRL | SHIFT)
    assert "nothing to redo" in driver.messages
    slider = driver.page.inspector.controls["mass"].slider.sliding_button.rect
    driver.pull(slider.center, (slider.centerx - 60, slider.centery))  # The whole drag of a slider is one undo step.
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
def test_edits_are_not_lost_unasked(driver: Driver, leave) -> None:
    edited(driver)
    page = driver.app.page
    driver.key(pygame.K_ESCAPE)
    Path("other.toml").write_text(driver.session.scene.to_toml())
    leave(driver)
    assert driver.app.page is page
    assert driver.app.running
    assert driver.app.dialog is not None
    driver.key(pygame.K_ESCAPE)  # Escape closes the question and keeps the current page.
    assert driver.app.page is page
    leave(driver)
    driver.key(pygame.K_RETURN)  # The Return key confirms the button "Save ...".
    driver.answer("kept")
    assert Path("kept.toml").exists()
    driver.key(pygame.K_ESCAPE)
    assert isinstance(driver.app.page, GalleryPage)
    driver.key(pygame.K_ESCAPE)
    assert driver.app.running  # In the gallery, Escape does not quit the program.


def test_a_file_is_replaced_only_after_a_question(driver, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    driver.page.dialogs.save("save_scene", "~/mine")
    assert driver.messages == ["saved ~/mine.toml"]
    mine = tmp_path / "mine.toml"
    mine.write_text("precious")
    driver.page.dialogs.save("save_scene", "mine")
    driver.key(pygame.K_ESCAPE)
    assert mine.read_text() == "precious"
    driver.page.dialogs.save("save_scene", "mine")
    driver.click(driver.app.dialog.buttons["Replace"].rect.center)
    assert mine.read_text() != "precious"


@pytest.mark.parametrize("away", [pygame.WINDOWMINIMIZED, pygame.WINDOWFOCUSLOST, pygame.MOUSEMOTION, pygame.KEYDOWN])
def test_a_bead_released_without_an_event_is_let_go(driver: Driver, away: int) -> None:
    driver.key(pygame.K_SPACE)
    x, y = driver.bead(4)
    driver.drag((x, y), (x + 60, y))
    assert driver.session.held.lane == 0.0
    if away == pygame.KEYDOWN:
        driver.key(pygame.K_F7)  # The key F7 opens a menu, which receives the release of the mouse button.
        driver.release((x + 60, y))
    else:
        driver.post(away, pos=(x, y), rel=(0, 0), buttons=(0, 0, 0))
        driver.post(pygame.WINDOWRESTORED)
    assert driver.page.pointer.pressed is None
    assert driver.session.held == NOTHING_HELD


def test_an_inactive_window_does_no_work(driver: Driver) -> None:
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
    driver.frames(20)
    driver.resize((1600, 900))
    driver.frames(20)
    driver.click(driver.page.toolbar.buttons["film"].rect.center)
    assert any("saved" in text and "mine.mp4" in text for text in driver.messages)
    with av.open(str(tmp_path / "mine.mp4")) as film:
        pictures = [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]
    assert 15 <= len(pictures) <= 25  # The film contains every second frame of the window.
    assert driver.page.film.seconds == pytest.approx(len(pictures) / 30)
    corners = [picture[-20:, -20:] for picture in pictures]
    # The first and the last picture both contain the lower right corner of the page.
    assert np.abs(corners[0].astype(int) - corners[-1]).mean() < 20


@pytest.mark.parametrize("name", ["one-on-four", "cradle"])
def test_the_button_of_a_film_says_stop_and_the_time(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    driver = Driver(name)
    page = driver.app.page
    page.dialogs.save("film", "mine.mp4")
    driver.frames(1)
    button, texts = page.toolbar.buttons["film"], []
    assert button.text == "Stop 0:00"
    with monkeypatch.context() as watched:
        watched.setattr(page, "build", Mock(side_effect=AssertionError("made anew")))
        watched.setattr(button.drawable_shape, "set_text", texts.append)
        driver.frames(3 * 60 + 3)
        room = button.rect.width
        page.film.seconds = 59 * 60 + 59
        driver.frames()
    # The text of the button is drawn once per second.
    assert texts == ["Stop 0:01", "Stop 0:02", "Stop 0:03", "Stop 59:59"]
    assert width(button.text, 13 * driver.app.unit, bold=True) < room == button.rect.width
    driver.click(button.rect.center)
    assert "film" not in page.toolbar.buttons
    page.dialogs.save("film", "second.mp4")
    monkeypatch.setattr(page.film.film, "add", Mock(side_effect=OSError("no room is left")))
    driver.frames(3)  # The error ends the recording of the film.
    assert "film" not in page.toolbar.buttons
    assert "the film stopped: no room is left" in driver.messages
    assert any("second.mp4" in text for text in driver.messages)  # The part of the film before the error is saved.
    page.dialogs.save("film", "third.mp4")
    driver.frames(10)
    driver.key(pygame.K_ESCAPE)  # Leaving the page ends the recording and writes the film.
    assert Path("third.mp4").exists()


@pytest.mark.own_process  # A signal that is not handled would end the test process.
@pytest.mark.parametrize("number", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.slow)])
def test_a_signal_while_filming_keeps_the_film(driver: Driver, monkeypatch, number: signal.Signals) -> None:
    import av

    edited(driver)  # Because of this edit, closing the window would normally ask a question.
    driver.page.dialogs.save("film", "mine.mp4")
    driver.frames(20)
    signals = iter([number] * 9)
    monkeypatch.setattr(driver.page, "update", lambda seconds: signal.raise_signal(next(signals)))
    driver.app.run()
    with av.open("mine.mp4") as film:
        assert sum(1 for _ in film.decode(video=0)) >= 5


def test_a_saved_session_replays_with_the_same_digits(driver: Driver, tmp_path: Path) -> None:
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
    # The text is in the footer, so it does not cover beads or forces.
    assert driver.page.view.places.footer.contains(said.rect)
    driver.key(pygame.K_SPACE)
    frame = driver.session.frame
    driver.frames(5)
    assert (driver.page.clock.activity(), driver.session.frame) == ("paused", frame)
    for name in ["restart", *["forward"] * 100, *["back"] * 3]:
        driver.page.actions[name]()
    assert driver.session.frame == 97
    driver.page.actions["slower"]()
    # The motion continues from the newest frame with slower motion. Meanwhile, the pointer holds a bead.
    driver.run(5)
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


def test_history_and_screenshot_are_saved(driver: Driver, tmp_path, monkeypatch) -> None:
    driver.run(60)
    driver.page.dialogs.save("export", "motion.csv")
    assert len((tmp_path / "motion.csv").read_text().splitlines()) > 60
    driver.page.dialogs.save("export", "motion.doc")
    assert (tmp_path / "motion.doc.csv").exists()
    driver.page.dialogs.save("export", "motion.npz")
    driver.page.dialogs.save("save_session", "session.npz")
    assert driver.app.settings.recent == [str(tmp_path / "session.npz")]
    driver.key(pygame.K_p)
    assert pygame.image.load(str(tmp_path / "one-bead-on-four.png")).get_size() == (1280, 720)
    # The replaced function imitates a user without a home folder.
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)
    driver.key(pygame.K_p)
    assert driver.messages[-1] == f"saved {tmp_path / 'one-bead-on-four-2.png'}"


@pytest.mark.parametrize(("action", "frames"), [("share_page", 0), ("share_page", 60), ("live_page", 60)])
def test_a_motion_or_an_experiment_is_shared(driver: Driver, tmp_path, action: str, frames: int) -> None:
    driver.session.apply(SetContact(0, 1, power_law(3.0, 0.3)))
    driver.session.step_frames(frames)
    driver.app.act(action)
    driver.key(pygame.K_RETURN)
    page = tmp_path / "one-bead-on-four.html"
    assert f"saved {page}" in driver.messages
    text = page.read_text(encoding="utf-8")
    (lane,) = page_data(text)["lanes"]
    if action == "live_page" or not frames:
        assert 'id="kernels"' in text
        assert lane["spec"]["law"][3:6] == [0.0, 3.0, 0.3]
    else:
        recorded = driver.session.trajectory(0)
        assert recorded.time[-1] == driver.session.time > 0.0
        # The recorded motion includes samples of free flight before the start.
        assert 2 <= lane["recorded"]["rows"] <= recorded.time.size + 2


def test_a_bad_file_gives_a_message_and_no_crash(driver: Driver, tmp_path) -> None:
    page = driver.app.page
    bad = {"bad.toml": "title = 3", "broken.toml": "title = [", "bad.npz": "no", "picture.jpg": "no", "none.toml": ""}
    for name, content in bad.items():
        if content:
            (tmp_path / name).write_text(content)
        driver.drop_file(tmp_path / name)
        assert driver.app.page is page
        assert name in driver.messages[-1]
        assert driver.app.messages.visible[-1].warning
    # If the file is given at the start, the window opens the gallery and shows a message.
    driver = Driver(str(tmp_path / "bad.toml"))
    assert isinstance(driver.app.page, GalleryPage)
    assert any("bad.toml" in text for text in driver.messages)


LONG_NAMES = "x" * 300, "a" * 250 + "/" + "b" * 270, "~" * 400, "there/" + "é" * 200
NO_NAMES = "..", "/", "~nobody-at-all/\0", "\0", *LONG_NAMES


def test_a_name_that_no_file_can_have_is_refused_in_a_sentence(driver: Driver) -> None:
    driver.run(5)
    for saving, text in product(("save_scene", "save_session", "export", "share_page", "live_page", "film"), NO_NAMES):
        driver.app.messages.visible.clear()
        driver.page.dialogs.save(saving, text)
        driver.frames()
        assert driver.messages[-1].startswith(("cannot write", f"{text} is a folder")), (saving, text)
        assert not driver.page.dialogs.film.recording
    page = driver.page
    for text in (name for name in NO_NAMES if name not in ("..", "/")):
        for take in (driver.app.open, lambda text: page.tools.data._take_typed(text + ".csv")):
            driver.app.messages.visible.clear()
            take(text)
            driver.frames()
            assert driver.messages
            assert driver.page is page


def test_saved_files_are_reported(tmp_path: Path) -> None:
    driver = Driver("steel-and-soft")
    driver.run(30)
    driver.page.dialogs.save("export", "motion.csv")
    assert "motion-1.csv and " in driver.messages[-1]
    driver.page.dialogs.save("film", "mine.mp4")
    driver.frames(20)
    driver.key(pygame.K_ESCAPE)
    assert any("mine.mp4" in text for text in driver.messages)


def test_a_pull_is_one_step_of_its_replay_too(driver: Driver, tmp_path: Path) -> None:
    for k in range(20):
        driver.session.apply(Drag(0, 2, 0.1 * k), gesture=True)
        driver.session.step_frames(1)
    driver.session.apply(Drop())
    driver.session.save_recording(tmp_path / "pulled.npz")
    replay = Replay.load(tmp_path / "pulled.npz")
    assert replay.run()
    assert len(replay.session.undo_stack.done) == 1
