"""Fixtures for tests of the window.

The fixtures use the settings of a first start. The fixtures also reduce the number of garbage collections, which take
half of the test time.
"""

from collections.abc import Iterator

import pytest
from softcradle.sandbox.window import app
from softcradle.sandbox.window.theme import collect_garbage

from tests.helpers.windows import Driver, rarely

COLLECT = rarely(collect_garbage)


@pytest.fixture(autouse=True)
def own_windows(own_folder: None, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Use the settings of a first start and a new folder for files. Close all windows after the test."""
    if "freed" not in request.node.name:  # Tests of the garbage collection itself use the normal number of collections.
        monkeypatch.setattr(app, "collect_garbage", COLLECT)
    yield
    for driver in list(Driver.opened):
        driver.close()
