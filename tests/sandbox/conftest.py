"""Fixtures for tests of the command."""

import re

import pytest
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.console import set_quiet


@pytest.fixture
def softcradle(capsys):
    """Return a function that runs the command, checks its exit code `code`, and returns its standard output and error."""

    def run(*words, code=0):
        assert main(list(words)) == code
        return capsys.readouterr()

    yield run
    set_quiet(False)


@pytest.fixture
def one_core(monkeypatch):
    """Compute points of a sweep in this process. Child processes would need longer for imports than for a few points."""
    monkeypatch.setattr("softcradle.sandbox.sweeps.executors.cores", lambda: 1)


@pytest.fixture
def refused(softcradle):
    """Return a function that runs the command with wrong arguments and returns its error sentence."""

    def run(*words):
        out, err = softcradle(*words, code=2)
        assert out == ""
        assert re.fullmatch(r"softcradle: .+\n", err), err
        return err.removeprefix("softcradle: ").rstrip()

    return run
