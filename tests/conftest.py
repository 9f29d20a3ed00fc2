"""Settings of the whole suite: the same examples every time, no test that fails another, its order and its time."""

from __future__ import annotations

import gc
import os
import random
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, settings

from tests.helpers.own_process import children, descriptors, run_alone, runs_alone

if TYPE_CHECKING:
    from tests.helpers.windows import Driver

# never the settings of whoever runs the tests
os.environ["SOFTCRADLE_CONFIG"] = tempfile.mkdtemp(prefix="softcradle-settings-")
os.environ["LANGUAGE"] = "en"  # texts are compared in English, whatever the locale of the machine
settings.register_profile(
    "softcradle", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True
)
settings.load_profile("softcradle")


def pytest_unconfigure() -> None:
    """Leave no settings behind."""
    shutil.rmtree(os.environ["SOFTCRADLE_CONFIG"], ignore_errors=True)


def pytest_addoption(parser: pytest.Parser) -> None:
    """What `.ci/run` gives, whose time is short."""
    parser.addoption("--order", metavar="SEED", help="run files in an order that this text decides")
    parser.addoption("--until", type=float, metavar="TIME", help="begin no test after this time [s since 1970]")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Shuffle files, not the tests of one, which may share what is dear to make."""
    if seed := config.getoption("--order"):
        files = sorted({item.path for item in items})
        random.Random(seed).shuffle(files)
        places = {path: place for place, path in enumerate(files)}
        items.sort(key=lambda item: places[item.path])


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Begin no test when the time is over."""
    until = item.config.getoption("--until")
    if until and time.time() > until:
        pytest.skip("the time is over")


def pytest_itemcollected(item: pytest.Item) -> None:
    """What a test takes that runs in a process of its own is made there."""
    if runs_alone(item):
        item.fixturenames = []


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Run a test that is marked `own_process` in one, and end all that it started with it."""
    if not runs_alone(pyfuncitem):
        return None
    run_alone(pyfuncitem.nodeid)
    return True


def pytest_runtest_teardown(item: pytest.Item) -> None:
    """English again after a test that left the window in another language."""
    languages = sys.modules.get("softcradle.sandbox.languages")
    if languages is not None:
        languages.use_language("en")


@pytest.fixture(autouse=True)
def _no_leaks(request: pytest.FixtureRequest) -> Iterator[None]:
    """Judge here, not in some later test, what this one leaves: a file left open warns when it is collected."""
    if request.node.get_closest_marker("own_process"):
        yield  # all that is left ends with the process
        return
    open_before, running_before = descriptors(), children()
    yield
    running = children()
    if descriptors() - open_before or running.keys() - running_before.keys():
        gc.collect()
        assert not [one for one in descriptors() - open_before if "socket:" in one], "sockets are left open"
        left = {number: command for number, command in children().items() if number not in running_before}
        assert not left, "processes are left"


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
