"""Opening: names, files, texts and standard input."""

from __future__ import annotations

import io
import locale
import os
from pathlib import Path

import pygame
import pytest
from pygame_gui.core.utility import translate
from softcradle.sandbox.session.shared_text import shared_text
from softcradle.sandbox.window.gallery.page import GalleryPage

from softcradle import scenes
from tests.helpers.windows import Driver

pytestmark = pytest.mark.usefixtures("own_folder")


@pytest.mark.parametrize("form", ["text", "toml", "shared"])
def test_a_scene_is_read_from_standard_input_or_the_command_line(form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = scenes.load("galilean")
    text = scene.to_toml() if form == "toml" else shared_text(scene)
    monkeypatch.setattr("sys.stdin", io.StringIO(text))
    driver = Driver(text if form == "text" else "-")
    assert driver.session.scene == scene
    driver.close()


def test_a_broken_file_is_a_message_in_the_gallery_at_once(tmp_path: Path) -> None:
    (tmp_path / "bad.toml").write_text("title = 3")
    driver = Driver(str(tmp_path / "bad.toml"))
    assert isinstance(driver.app.page, GalleryPage)
    assert any("bad.toml" in text for text in driver.messages)
    assert not any("np." in text for text in driver.messages)
    driver.close()


def test_the_chooser_of_files_opens_where_the_locale_is_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LC_ALL", "xx_YY")
    used = locale.setlocale(locale.LC_ALL)
    driver = Driver()
    driver.app.settings.language = "en"
    driver.app.next_language()
    driver.key(pygame.K_o, pygame.KMOD_CTRL)
    driver.click(driver.app.dialog.buttons["Datei wählen ..."].rect.center)
    driver.frames(2)
    assert driver.app.dialog.window.cancel_button.text == "pygame-gui.Cancel"
    assert translate("pygame-gui.Cancel") == "Abbrechen"
    assert (locale.setlocale(locale.LC_ALL), os.environ["LC_ALL"]) == (used, "xx_YY")
    driver.close()
