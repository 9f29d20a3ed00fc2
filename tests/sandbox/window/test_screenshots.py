"""Pictures for the README are those of the very first start, whatever the person who makes them has chosen."""

from __future__ import annotations

import sys

import pytest
from softcradle.sandbox.window.settings import Settings, settings_path

from tools import screenshots

pytestmark = pytest.mark.usefixtures("own_folder")


def test_a_person_s_settings_are_neither_shown_nor_changed(monkeypatch, tmp_path):
    Settings(theme="dark", recent=["/a/scene.toml"]).save()
    before, found = settings_path().read_bytes(), []

    def save_all(folder):
        found.append((folder, Settings.load(), settings_path()))
        Settings(theme="dark").save()

    monkeypatch.setattr(screenshots, "save_all", save_all)
    monkeypatch.setattr(screenshots, "save_thumbnails", lambda: None)
    monkeypatch.setattr(sys, "argv", ["screenshots", str(tmp_path / "pictures")])
    screenshots.main()
    ((folder, settings, path),) = found
    assert folder == tmp_path / "pictures"
    assert settings == Settings()
    assert path != settings_path()
    assert not path.exists()
    assert settings_path().read_bytes() == before
