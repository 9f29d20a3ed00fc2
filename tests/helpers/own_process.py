"""Run tests in their own process, and find processes and files that a test leaves behind. A test that starts processes
then cannot disturb another test.
"""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from subprocess import CompletedProcess
from typing import Any

import pytest

from tests.helpers.paths import ROOT


def python(
    *words: str, check: bool = True, env: Mapping[str, str] = os.environ, **options: Any
) -> CompletedProcess[str]:
    """Run Python with the given arguments in a new process. Keywords in capitals are environment variables.

    Unless `check` is false, fail if the exit code is not 0.
    """
    variables = {name: options.pop(name) for name in list(options) if name.isupper()}
    command, environment = [sys.executable, *words], {**env, **variables}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, **options)
    assert not check or done.returncode == 0, (done.stdout + done.stderr)[-4000:]
    return done


# Longest time [s] to wait for an answer of a process. The limit is much longer than an answer takes on a busy machine.
# The limit is much shorter than the work that a test interrupts.
ANSWER = 180.0


def until(condition: Callable[[], object], process: subprocess.Popen[Any]) -> None:
    """Wait until `condition` is true while `process` runs. Fail if the process ends or ANSWER seconds pass."""
    end = time.monotonic() + ANSWER
    while not condition():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < end
        time.sleep(0.05)


INSIDE = "SOFTCRADLE_OWN_PROCESS"  # Name of the environment variable that is set in the process of a test.
# Time limit [s] of a test in its own process. The limit is far longer than any test takes on a busy machine. A test
# that exceeds the limit is killed together with its child processes.
LONGEST = 900.0
# Commands of processes that may continue after a test. Python keeps one process of each of the first two kinds. The
# last kind compiles kernels for later tests.
SHARED = (
    "multiprocessing.resource_tracker",
    "loky.backend.resource_tracker",
    "multiprocessing.forkserver",
    "compile_and_unlock",
)


def descriptors() -> set[str]:
    """Return the file descriptors of this process with their targets. The set is empty if the system does not have the
    folder /proc.
    """
    found = set()
    for entry in Path("/proc/self/fd").glob("*"):
        with suppress(OSError):  # The descriptor that belongs to this listing is already closed.
            found.add(f"{entry.name} {entry.readlink()}")
    return found


def children() -> dict[int, str]:
    """Return the commands of the running child processes by process number. The result is empty if the system does not
    have the folder /proc.
    """
    numbers = [number for entry in Path("/proc/self/task").glob("*/children") for number in _read(entry).split()]
    commands = {int(number): _command(number) for number in numbers}
    return {number: said for number, said in commands.items() if said and not any(name in said for name in SHARED)}


def _command(number: str) -> str:
    """Return the command of a running process, or an empty text if the process has ended. For a moment, the command of
    a new process is empty.
    """
    while not (command := _read(Path(f"/proc/{number}/cmdline"))):
        if _read(Path(f"/proc/{number}/stat")).rpartition(")")[2][1:2] in ("", "Z", "X"):
            return ""
        time.sleep(0.001)
    return command.replace("\0", " ")


def _read(path: Path) -> str:
    """Return the text of a file in /proc. Return an empty text if the thread or process of the file has just ended."""
    with suppress(OSError):
        return path.read_text(encoding="utf-8", errors="replace")
    return ""


def runs_alone(item: pytest.Item) -> bool:
    """Return True if the test needs its own process and the present process is a different one."""
    return INSIDE not in os.environ and item.get_closest_marker("own_process") is not None


def run_alone(test: str) -> None:
    """Run a test in its own process and session. Afterwards kill all processes of the session."""
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", test]
    process = subprocess.Popen(
        command, cwd=ROOT, env=os.environ | {INSIDE: "1", "PYTEST_ADDOPTS": ""}, start_new_session=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip
    try:
        said, _ = process.communicate(timeout=LONGEST)
    except subprocess.TimeoutExpired:
        said = f"not done after {LONGEST:.0f} s"
    finally:
        end_all_of(process)
    if process.returncode == 0 and (skipped := re.search(r"^SKIPPED \[1\] \S+ (.*)", said, re.MULTILINE)):
        pytest.skip(skipped[1])
    if process.returncode != 0 or not re.search(r"^\d+ passed", said.splitlines()[-1]):
        pytest.fail(said, pytrace=False)


def end_all_of(process: subprocess.Popen[str]) -> None:
    """Kill the session of a process, which contains all descendants that have not left the session."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    if process.stdout is not None:
        process.stdout.close()
