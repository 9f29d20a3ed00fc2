"""What tests of the command share."""

import re

import pytest
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.console import set_quiet


@pytest.fixture
def softcradle(capsys):
    """A function: what the command prints for its words, on standard output and error, when it ends with `code`."""

    def run(*words, code=0):
        assert main(list(words)) == code
        return capsys.readouterr()

    yield run
    set_quiet(False)


@pytest.fixture
def one_core(monkeypatch):
    """Points of a sweep are computed here: processes would each import and load all for a few of them."""
    monkeypatch.setattr("softcradle.sandbox.sweeps.executors.cores", lambda: 1)


@pytest.fixture
def refused(softcradle):
    """A function: the one sentence of what the command says to words that it does not take."""

    def run(*words):
        out, err = softcradle(*words, code=2)
        assert out == ""
        assert re.fullmatch(r"softcradle: .+\n", err), err
        return err.removeprefix("softcradle: ").rstrip()

    return run
