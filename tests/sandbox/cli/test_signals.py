"""Tests of Ctrl+C and SIGTERM during long calculations and during the compilation of kernels.

The process must print one line and no traceback, and must return the right exit code.
"""

import contextlib
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from softcradle.physics.numerics.float_bits import COMPILED

from tests.helpers.own_process import ANSWER, until
from tests.helpers.paths import ROOT

pytestmark = [pytest.mark.slow, pytest.mark.skipif(os.name != "posix", reason="signals are others there")]
LONG_RUN = """
import sys
from softcradle import one_on, power_law, simulate
chain = one_on(400, power_law(1.0, 0.1))
simulate(chain, [1] + [0] * 400, method=sys.argv[1], step=1e-3, duration=1.0)
print("begun", flush=True)
simulate(chain, [1] + [0] * 400, method=sys.argv[1], step=1e-9, duration=0.09)
"""
MANY_CHAINS = """
import sys
import numpy as np
from softcradle import ChainBatch, ensemble_ends
batch = ChainBatch(np.ones((200_000, 5)), 0.0, 1.0, 0.1)
ensemble_ends(ChainBatch(np.ones((9, 5)), 0.0, 1.0, 0.1), [1, 0, 0, 0, 0], 0.1, sys.argv[1], 1e-3)
print("begun", flush=True)
ensemble_ends(batch, [1, 0, 0, 0, 0], 1.0, sys.argv[1], 1e-6)
"""
STUDY = """
scene = "one-on-four"
measures = ["final_velocity"]
[set]
method = "conserving"
step = 1e-7
[grid]
"lanes.0.contact.alpha" = {between = [0.05, 1], count = 2000}
"""

LOADING = """
import runpy, signal, sys
class Interrupted:
    def find_spec(name, *_):
        if name == "softcradle.sandbox.cli.main":
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Interrupted)
runpy.run_module("softcradle", run_name="__main__")
"""


def begin(*words: str, folder: Path, **environment: str) -> subprocess.Popen[str]:
    """Start a process that handles Ctrl+C in the same way as a Python program in a terminal.

    A shell disables this handler in background processes.
    """
    return subprocess.Popen(
        [sys.executable, *words],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)} | environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),  # noqa: PLW1509
    )


def told(process: subprocess.Popen[str], number: int) -> list[str]:
    if number == signal.SIGINT:  # A terminal sends Ctrl+C to all child processes of a command.
        os.killpg(process.pid, number)
    else:
        process.send_signal(number)
    try:
        return process.communicate(timeout=ANSWER)[1].splitlines()
    finally:
        process.kill()


@pytest.mark.skipif(not COMPILED, reason="plain Python hears everything")
@pytest.mark.parametrize("program", [LONG_RUN, MANY_CHAINS])
@pytest.mark.parametrize("method", ["verlet", "conserving"])
def test_a_compiled_run_hears_it(program, method, tmp_path):
    process = begin("-c", program, method, folder=tmp_path)
    assert process.stdout.readline() == "begun\n"
    time.sleep(0.5)  # Wait until the process executes a compiled kernel.
    assert told(process, signal.SIGINT)[-1] == "KeyboardInterrupt"
    assert process.returncode == -signal.SIGINT


@pytest.mark.parametrize(("number", "word"), [(signal.SIGINT, "interrupted"), (signal.SIGTERM, "terminated")])
@pytest.mark.parametrize("command", ["warm verlet", "sweep study.toml", "figures softness -o out"])
def test_a_command_hears_it_while_kernels_are_compiled(command, number, word, tmp_path):
    pytest.importorskip("numba")
    (tmp_path / "study.toml").write_text(STUDY)
    cache = tmp_path / "cache"
    process = begin("-m", "softcradle", *command.split(), folder=tmp_path, NUMBA_CACHE_DIR=str(cache))
    until(lambda: list(cache.rglob("*.compiling")), process)
    lines = told(process, number)
    assert process.returncode == 128 + number, lines
    assert lines[-1] == f"softcradle: {word}"
    assert all(line.startswith("softcradle: ") for line in lines)
    # Kill the background process that still compiles kernels for the ended command.
    for lock in cache.rglob("*.compiling"):
        with contextlib.suppress(ProcessLookupError):  # The process may have ended by itself.
            os.kill(int(lock.read_text().split()[0]), signal.SIGKILL)


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGTERM])
def test_a_command_that_is_ended_leaves_no_part_of_a_file(number, tmp_path):
    words = ["run", "one-on-four", "--method", "euler", "--step", "1e-8", "-o", "out.npz"]
    process = begin("-m", "softcradle", *words, folder=tmp_path)
    until(lambda: list(tmp_path.iterdir()), process)
    assert told(process, number) == ["softcradle: terminated"]
    assert (process.returncode, list(tmp_path.iterdir())) == (128 + number, [])


def test_a_command_hears_it_while_its_modules_are_loaded(tmp_path):
    process = begin("-c", LOADING, folder=tmp_path)
    assert process.communicate(timeout=ANSWER) == ("", "softcradle: interrupted\n")
    assert process.returncode == 130


@pytest.mark.parametrize("executor", [["-q"], ["--threads"]])
def test_a_sweep_keeps_its_points_and_says_so(executor, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY.replace("step = 1e-7", "step = 1e-3"))
    process = begin("-m", "softcradle", "sweep", "study.toml", "--chunk", "0.1", *executor, folder=tmp_path)
    kept = tmp_path / "out" / "study.zarr.partial"
    until(lambda: list(kept.glob("points/%3Astatus/0")), process)
    lines = told(process, signal.SIGINT)
    assert process.returncode == 130, "\n".join(lines)
    assert lines[-1] == "softcradle: interrupted"
    assert re.search(r"point(s are| is) kept in out/study\.zarr\.partial", lines[-2])
    assert not [line for line in lines if "Traceback" in line]
