"""Settings of the whole suite: hypothesis draws the same examples every time and never fails for slowness."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, settings

if TYPE_CHECKING:
    from tests.helpers.windows import Driver

os.environ["SOFTCRADLE_CONFIG"] = tempfile.mkdtemp(
    prefix="softcradle-settings-"
)  # never those of whoever runs the tests
os.environ["LANGUAGE"] = "en"  # texts are compared in English, whatever the locale of the machine
settings.register_profile(
    "softcradle", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True
)
settings.load_profile("softcradle")


def pytest_runtest_teardown(item: pytest.Item) -> None:
    """English again after a test that left the window in another language."""
    languages = sys.modules.get("softcradle.sandbox.languages")
    if languages is not None:
        languages.use_language("en")


@pytest.fixture
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder and a cache of one's own, for what the window writes."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SOFTCRADLE_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("SOFTCRADLE_CONFIG", str(tmp_path / "config"))


@pytest.fixture
def driver() -> Iterator[Driver]:
    """The real application with a scene open, driven by posted events."""
    from tests.helpers.windows import Driver

    made = Driver("one-on-four")
    yield made
    made.close()
