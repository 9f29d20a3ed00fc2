"""Tests in a process of their own, and what a test leaves behind: nothing that starts processes can fail another test."""

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
    """Python with these words, in a process of its own, which ends well unless that is not wanted; variables in capitals."""
    variables = {name: options.pop(name) for name in list(options) if name.isupper()}
    command, environment = [sys.executable, *words], {**env, **variables}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, **options)
    assert not check or done.returncode == 0, (done.stdout + done.stderr)[-4000:]
    return done


# s: far more than an answer takes on a loaded machine, and far less than work of which a test hears that it is stopped
ANSWER = 180.0


def until(condition: Callable[[], object], process: subprocess.Popen[Any]) -> None:
    """Wait for what a process is to bring about while it runs."""
    end = time.monotonic() + ANSWER
    while not condition():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < end
        time.sleep(0.05)


INSIDE = "SOFTCRADLE_OWN_PROCESS"  # set in the process of a test
LONGEST = 900.0  # s, far beyond what any takes on a busy machine: one that hangs ends, with all that it started
# What goes on after a test on purpose: Python keeps one of each of the first two; the third compiles kernels for all to come.
SHARED = ("multiprocessing.resource_tracker", "multiprocessing.forkserver", "compile_and_unlock")


def descriptors() -> set[str]:
    """Descriptors of this process with what they are open on; empty where the system does not tell."""
    found = set()
    for entry in Path("/proc/self/fd").glob("*"):
        with suppress(OSError):  # that of this very listing
            found.add(f"{entry.name} {entry.readlink()}")
    return found


def children() -> dict[int, str]:
    """Commands of processes that this one has started and that run, by number; empty where the system does not tell."""
    numbers = [number for entry in Path("/proc/self/task").glob("*/children") for number in _read(entry).split()]
    commands = {int(number): _command(number) for number in numbers}
    return {number: said for number, said in commands.items() if said and not any(name in said for name in SHARED)}


def _command(number: str) -> str:
    """The command of a process that runs; one that has just been started has none for a moment."""
    while not (command := _read(Path(f"/proc/{number}/cmdline"))):
        if _read(Path(f"/proc/{number}/stat")).rpartition(")")[2][1:2] in ("", "Z", "X"):
            return ""
        time.sleep(0.001)
    return command.replace("\0", " ")


def _read(path: Path) -> str:
    """The text of a file, or none where the thread or process that it tells of has just ended."""
    with suppress(OSError):
        return path.read_text(encoding="utf-8", errors="replace")
    return ""


def runs_alone(item: pytest.Item) -> bool:
    """Whether a test is to run in a process of its own, and this is not the one."""
    return INSIDE not in os.environ and item.get_closest_marker("own_process") is not None


def run_alone(test: str) -> None:
    """Do a test in a process and session of its own, which is then killed as a whole."""
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
    """Kill the session of a process, which all are in that it has started and that have not left it."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    if process.stdout is not None:
        process.stdout.close()
