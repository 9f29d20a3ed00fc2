"""What all tests of the window share: settings of a first start, and rare collections of garbage, which take half of the time."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest
from softcradle.sandbox.window import app
from softcradle.sandbox.window.theme import collect_garbage

REBUILDS = 20  # of which one collects; a process of tests has a large heap to search

_calls = itertools.count(1)


@pytest.fixture(autouse=True)
def own_settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Settings of the first start: keys change them."""
    monkeypatch.setenv("SOFTCRADLE_CONFIG", str(tmp_path / "config"))


@pytest.fixture(autouse=True)
def rare_collections(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Collect at every twentieth rebuild, but in the tests of the collection itself."""
    if "cleanup" not in request.path.name and "freed" not in request.node.name:
        monkeypatch.setattr(app, "collect_garbage", lambda: collect_garbage() if next(_calls) % REBUILDS == 0 else None)
