"""What tests of the command share."""

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
