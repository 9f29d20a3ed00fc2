"""What all tests of the window share: settings of a first start, and rare collections of garbage, which take half of the time."""

import itertools
from collections.abc import Iterator

import pytest
from softcradle.sandbox.window import app
from softcradle.sandbox.window.theme import collect_garbage

from tests.helpers.windows import Driver

REBUILDS = 20  # of which one collects; a process of tests has a large heap to search

_calls = itertools.count(1)


@pytest.fixture(autouse=True)
def own_windows(own_folder: None) -> Iterator[None]:
    """Settings of the first start, which keys change, a folder for what is written, and no window that stays open."""
    yield
    for driver in list(Driver.opened):
        driver.close()


@pytest.fixture(autouse=True)
def rare_collections(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Collect at every twentieth rebuild, but in the tests of the collection itself."""
    if "freed" not in request.node.name:
        monkeypatch.setattr(app, "collect_garbage", lambda: collect_garbage() if next(_calls) % REBUILDS == 0 else None)
