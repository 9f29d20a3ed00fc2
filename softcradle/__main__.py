# PYTHON_ARGCOMPLETE_OK
"""The `softcradle` command, also run by `python -m softcradle`."""

import os
import signal
import sys


def main() -> int:
    """Run the command and return its exit code; Ctrl+C during the import of its modules prints one line, as it does
    later.
    """
    usual = signal.getsignal(signal.SIGINT)
    if usual is signal.default_int_handler:  # a shell lets background commands ignore Ctrl+C
        signal.signal(signal.SIGINT, _leave)
    from softcradle.sandbox.cli.main import main as run

    signal.signal(signal.SIGINT, usual)
    return run()


def _leave(*_: object) -> None:
    """End at once, because an exception in the middle of an import may be replaced by another one."""
    os.write(2, b"softcradle: interrupted\n")
    os._exit(130)


if __name__ == "__main__":
    sys.exit(main())
