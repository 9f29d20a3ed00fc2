# PYTHON_ARGCOMPLETE_OK
"""The `softcradle` command, which `python -m softcradle` is too."""

import os
import signal
import sys


def main() -> int:
    """Run the command and return its exit code; Ctrl+C while its modules are loaded is told in a line as later on."""
    usual = signal.getsignal(signal.SIGINT)
    if usual is signal.default_int_handler:  # a shell lets commands behind it ignore Ctrl+C
        signal.signal(signal.SIGINT, _leave)
    from softcradle.sandbox.cli.main import main as run

    signal.signal(signal.SIGINT, usual)
    return run()


def _leave(*_: object) -> None:
    """End at once: an exception in the middle of an import may come out of it as another one."""
    os.write(2, b"softcradle: interrupted\n")
    os._exit(130)


if __name__ == "__main__":
    sys.exit(main())
