"""Fixtures that run the command `softcradle` in tests."""

import re

import pytest
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.console import set_quiet


@pytest.fixture
def softcradle(capsys):
    """Return a function that runs the command `softcradle` with the given words.

    The function checks that the exit code is `code`. The function returns the standard output and the standard error.
    """

    def run(*words, code=0):
        assert main(list(words)) == code
        return capsys.readouterr()

    yield run
    set_quiet(False)


@pytest.fixture
def one_core(monkeypatch):
    """Compute the points of a parameter sweep in the process of the test.

    Child processes would spend more time on imports than on a few points.
    """
    monkeypatch.setattr("softcradle.sandbox.sweeps.executors.cores", lambda: 1)


@pytest.fixture
def refused(softcradle):
    """Return a function that runs the command with wrong arguments and returns the error message."""

    def run(*words):
        out, err = softcradle(*words, code=2)
        assert out == ""
        assert re.fullmatch(r"softcradle: .+\n", err), err
        return err.removeprefix("softcradle: ").rstrip()

    return run
