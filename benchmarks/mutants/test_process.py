"""A process with pytest and its packages loaded, which forks for each run of tests: starting anew would take most of the time.

It reads lines of JSON, {"arguments": of pytest, "patience": seconds}, and answers each by the test that fails, "timeout", or "".
"""

from __future__ import annotations

import json
import os
import signal
import sys
import tempfile
from pathlib import Path

import hypothesis  # noqa: F401
import numba  # noqa: F401
import numpy  # noqa: F401
import pytest

PYTEST = ("-x", "-q", "-p", "no:cacheprovider", "-p", "no:randomly", "-p", "no:xdist")


def run(arguments: list[str], patience: float) -> str:
    """The first test that fails, 'timeout', or '' where all pass."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "output"
        child = os.fork()
        if child == 0:
            with output.open("w") as file:
                os.dup2(file.fileno(), 1)
                os.dup2(file.fileno(), 2)
            signal.alarm(max(1, round(patience)))  # ends the child
            os._exit(pytest.main([*PYTEST, *arguments]))
        _, status = os.waitpid(child, 0)
        if os.WIFSIGNALED(status):
            return "timeout" if os.WTERMSIG(status) == signal.SIGALRM else f"signal {os.WTERMSIG(status)}"
        if os.WEXITSTATUS(status) == 0:
            return ""
        lines = [line for line in output.read_text().splitlines() if line.startswith(("FAILED", "ERROR"))]
        return lines[0].split(" - ")[0].split(" ", 1)[1] if lines else f"exit code {os.WEXITSTATUS(status)}"


def main() -> int:
    """Answer until there are no more lines."""
    for line in sys.stdin:
        task = json.loads(line)
        print(json.dumps(run(task["arguments"], task["patience"])), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
