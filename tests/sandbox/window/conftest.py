"""What all tests of the window share: settings of a first start, and rare collections of garbage, which take half of the time."""

from collections.abc import Iterator

import pytest
from softcradle.sandbox.window import app
from softcradle.sandbox.window.theme import collect_garbage

from tests.helpers.windows import Driver, rarely

COLLECT = rarely(collect_garbage)


@pytest.fixture(autouse=True)
def own_windows(own_folder: None, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Settings of the first start, which keys change, a folder for what is written, and no window that stays open."""
    if "freed" not in request.node.name:  # but for the tests of the collection itself
        monkeypatch.setattr(app, "collect_garbage", COLLECT)
    yield
    for driver in list(Driver.opened):
        driver.close()
