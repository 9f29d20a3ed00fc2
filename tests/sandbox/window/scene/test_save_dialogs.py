"""What the window saves and opens: scenes, sessions, histories, pages, screenshots."""

from itertools import product

import pygame
import pytest
from softcradle.physics import power_law
from softcradle.sandbox.session.inputs import AddBead, SetContact
from softcradle.sandbox.window.gallery.page import GalleryPage

from tests.helpers.windows import Driver
from tests.sandbox.page.conftest import page_data


def test_a_scene_is_saved_and_opened_again(driver: Driver, tmp_path) -> None:
    driver.session.apply(AddBead(0, 2))
    driver.key(pygame.K_s, pygame.KMOD_CTRL)
    driver.answer("mine.toml")
    assert driver.messages == [f"saved {tmp_path / 'mine.toml'}"]
    masses = driver.session.lanes[0].chain.mass
    driver.key(pygame.K_ESCAPE)
    assert isinstance(driver.app.page, GalleryPage)
    driver.drop_file(tmp_path / "mine.toml")
    assert driver.session.lanes[0].chain.mass == masses


def test_the_history_is_exported(driver: Driver, tmp_path) -> None:
    driver.run(60)
    driver.page.dialogs.save("export", "motion.csv")
    assert len((tmp_path / "motion.csv").read_text().splitlines()) > 60
    driver.page.dialogs.save("export", "motion.doc")
    assert (tmp_path / "motion.doc.csv").exists()
    driver.page.dialogs.save("export", "motion.npz")
    driver.page.dialogs.save("save_session", "session.npz")
    assert driver.app.settings.recent == [str(tmp_path / "session.npz")]


@pytest.mark.parametrize(("action", "frames"), [("share_page", 0), ("share_page", 60), ("live_page", 60)])
def test_what_was_played_is_shared_or_the_experiment_itself(driver: Driver, tmp_path, action: str, frames: int) -> None:
    """Before a run there is nothing but the experiment."""
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
        assert 2 <= lane["recorded"]["rows"] <= recorded.time.size + 2  # and free flight before the start


def test_a_screenshot_is_written(driver: Driver, tmp_path) -> None:
    driver.key(pygame.K_p)
    assert pygame.image.load(str(tmp_path / "one-bead-on-four.png")).get_size() == (1280, 720)


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
    driver = Driver(str(tmp_path / "bad.toml"))  # at once, in the gallery
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
