"""What all tests of the window share: garbage is collected now and then, as it takes half of the time of a rebuilt page."""

from __future__ import annotations

import itertools

import pytest
from softcradle.sandbox.window import app
from softcradle.sandbox.window.theme import collect_garbage

REBUILDS = 20  # of which one collects; a process of tests has a large heap to search

_calls = itertools.count(1)


@pytest.fixture(autouse=True)
def rare_collections(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Collect at every twentieth rebuild, but in the tests of the collection itself."""
    if "cleanup" not in request.path.name and "freed" not in request.node.name:
        monkeypatch.setattr(app, "collect_garbage", lambda: collect_garbage() if next(_calls) % REBUILDS == 0 else None)
