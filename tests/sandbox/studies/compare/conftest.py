"""What the tests of comparisons share: the command with its JSON, and its refusals."""

import json

import pytest
from softcradle.sandbox.cli.main import main


@pytest.fixture
def compared(capsys):
    """A function: the JSON that `softcradle compare` prints for its arguments."""

    def run(*arguments):
        assert main(["compare", *arguments, "--json"]) == 0
        printed, errors = capsys.readouterr()
        assert errors.strip() == ""  # the progress bar of a film leaves an empty line
        return json.loads(printed)

    return run


@pytest.fixture
def refused(capsys):
    """A function: the sentence with which `softcradle compare` refuses its arguments."""

    def run(*arguments):
        assert main(["compare", *arguments]) == 2
        printed, errors = capsys.readouterr()
        assert printed == ""
        assert errors.startswith("softcradle: ")
        assert errors.count("\n") == 1
        assert "Traceback" not in errors
        return errors

    return run
