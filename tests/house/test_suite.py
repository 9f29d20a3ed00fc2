"""Tests of the test suite. If a test leaves something behind, only this test must fail. The options for the order of
tests and for the time limit must work.
"""

import os
import subprocess
import sys
import time
from types import SimpleNamespace

import pytest

from tests import conftest
from tests.helpers.own_process import end_all_of
from tests.helpers.paths import ROOT

LEAVING = """
import socket, subprocess, sys
kept = []

def test_a_process():
    kept.append(subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1000)"]))

def test_a_connection():
    kept.append(socket.socket())

def test_nothing():
    pass
"""


@pytest.mark.skipif(not os.path.exists("/proc/self/fd"), reason="this system does not tell what a process has")
def test_only_the_test_that_leaks_fails(tmp_path):
    """Run the tests in LEAVING with the settings of this suite. Compare the outcomes that pytest prints with the
    expected outcomes.
    """
    (tmp_path / "test_a.py").write_text(LEAVING, encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-v", "-n", "0", "-p", "tests.conftest", "-p", "no:cacheprovider"]
    command += ["--rootdir", str(tmp_path), "-c", os.devnull, str(tmp_path)]
    variables = os.environ | {"PYTHONPATH": str(ROOT), "PYTEST_ADDOPTS": ""}
    with subprocess.Popen(command, env=variables, stdout=subprocess.PIPE, text=True, start_new_session=True) as process:
        lines = [line.split() for line in process.stdout if "::" in line]
        end_all_of(process)
    found = [(line[1], line[0].rpartition("::")[2]) for line in lines]
    assert [test for outcome, test in found if outcome == "ERROR"] == ["test_a_process", "test_a_connection"]
    assert ("PASSED", "test_nothing") in found


def collected(seed):
    """Return the names of two tests of each of eight files. The text `seed` determines their order."""
    items = [SimpleNamespace(path=file, number=number) for file in "abcdefgh" for number in (1, 2)]
    conftest.pytest_collection_modifyitems(SimpleNamespace(getoption={"--order": seed}.get), items)
    return [(item.path, item.number) for item in items]


def test_files_are_in_an_order_that_a_text_decides():
    assert collected("x") == collected("x") != collected("y")
    assert collected("x")[::2] == [(file, 1) for file, number in collected("x") if number == 2]
    assert collected(None) == sorted(collected("x"))


def test_none_begins_after_the_end():
    until = {"--until": 1.0}
    item = SimpleNamespace(config=SimpleNamespace(getoption=until.get))
    with pytest.raises(pytest.skip.Exception, match="time is over"):
        conftest.pytest_runtest_setup(item)
    until["--until"] = time.time() + 1e6
    conftest.pytest_runtest_setup(item)
