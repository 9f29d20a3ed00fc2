"""Settings of the whole test suite: fixed random examples, checks that a test leaves nothing behind, test order and
time limit.
"""

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

# The tests use an empty settings folder, never the settings of the person who runs them.
os.environ["SOFTCRADLE_CONFIG"] = tempfile.mkdtemp(prefix="softcradle-settings-")
os.environ["LANGUAGE"] = "en"  # Tests compare texts in English, whatever the locale of the machine.
settings.register_profile(
    "softcradle", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True
)
settings.load_profile("softcradle")


def pytest_unconfigure() -> None:
    """Delete the settings folder of the tests."""
    shutil.rmtree(os.environ["SOFTCRADLE_CONFIG"], ignore_errors=True)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options that `.ci/run` uses: an order of the files and a time limit."""
    parser.addoption("--order", metavar="SEED", help="run files in an order that this text decides")
    parser.addoption("--until", type=float, metavar="TIME", help="begin no test after this time [s since 1970]")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Shuffle the test files if `--order` is given. Tests of one file stay together, because they can share costly
    results.
    """
    if seed := config.getoption("--order"):
        files = sorted({item.path for item in items})
        random.Random(seed).shuffle(files)
        places = {path: place for place, path in enumerate(files)}
        items.sort(key=lambda item: places[item.path])


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip the test if the time given by `--until` has passed."""
    until = item.config.getoption("--until")
    if until and time.time() > until:
        pytest.skip("the time is over")


def pytest_itemcollected(item: pytest.Item) -> None:
    """Remove the fixtures of a test that runs in its own process: that process creates them."""
    if runs_alone(item):
        item.fixturenames = []


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Run a test that is marked `own_process` in a new process, and kill everything that it started."""
    if not runs_alone(pyfuncitem):
        return None
    run_alone(pyfuncitem.nodeid)
    return True


def pytest_runtest_teardown(item: pytest.Item) -> None:
    """Switch back to English, because a test may have changed the language of the window."""
    languages = sys.modules.get("softcradle.sandbox.languages")
    if languages is not None:
        languages.use_language("en")


@pytest.fixture(autouse=True)
def _no_leaks(request: pytest.FixtureRequest) -> Iterator[None]:
    """Fail the test that leaves sockets or child processes open. Collect garbage, so that this test gets the warnings
    of its open files.
    """
    if request.node.get_closest_marker("own_process"):
        yield  # The open files and child processes end with the test's own process.
        return
    open_before, running_before, zarr_before = descriptors(), children(), zarr_runs()
    yield
    running = children()
    if descriptors() - open_before or running.keys() - running_before.keys():
        gc.collect()
        left_open = [one for one in descriptors() - open_before if "socket:" in one]
        assert not left_open or zarr_runs() > zarr_before, "sockets are left open"
        left = {number: command for number, command in children().items() if number not in running_before}
        assert not left, "processes are left"


def zarr_runs() -> bool:
    """Return True if Zarr has been used. From its first use it keeps a thread with two sockets."""
    module = sys.modules.get("zarr.core.sync")
    return module is not None and module.loop[0] is not None


@pytest.fixture
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Use a new folder and a new cache for the files that the window writes."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SOFTCRADLE_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("SOFTCRADLE_CONFIG", str(tmp_path / "config"))


@pytest.fixture
def driver() -> Iterator[Driver]:
    """Return a driver of the real application with a scene open. It works by posted events."""
    from tests.helpers.windows import Driver

    made = Driver("one-on-four")
    yield made
    made.close()
