"""A trial of mutants: in a copy of the tree one source is changed at a time, and the tests of its group run as plain Python."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from time import perf_counter

from benchmarks.mutants.groups import Group
from benchmarks.mutants.operators import Mutant

ROOT = Path(__file__).parents[2]
COPIED = ("softcradle", "physics", "scenes", "sandbox", "assets", "tests", "benchmarks", "pyproject.toml")
PATIENCE = 4.0  # times the seconds of the unchanged source, after which a mutant counts as killed
LEAST_PATIENCE = 20.0  # seconds
UNCHANGED_PATIENCE = 600.0  # seconds


class Trial:
    """A copy of the tree in `folder`, in which mutants of one group are tried.

    Attributes:
        seconds: that the tests take on the unchanged sources.
    """

    def __init__(self, folder: Path, group: Group) -> None:
        if not hasattr(os, "fork"):
            raise SystemExit("mutants are tried by processes that fork, which this system does not have")
        self.folder, self.group, self._changes = folder, group, 0
        for name in COPIED:
            source = ROOT / name
            if source.is_dir():
                shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy(source, folder / name)
        self._tests = self._test_process()
        self._run(UNCHANGED_PATIENCE)  # keeps what Python makes of the other sources
        began = perf_counter()
        failed = self._run(UNCHANGED_PATIENCE)
        if failed:
            raise RuntimeError(f"the tests fail on the unchanged sources: {failed}")
        self.seconds = perf_counter() - began

    def _test_process(self) -> subprocess.Popen[str]:
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
        environment |= {"NUMBA_DISABLE_JIT": "1", "PYTEST_ADDOPTS": "", "PYTHONPATH": str(self.folder)}
        environment |= {"SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
        command = [sys.executable, "-m", "benchmarks.mutants.test_process"]
        return subprocess.Popen(
            command, cwd=self.folder, env=environment, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )

    def close(self) -> None:
        """End the process."""
        self._tests.communicate()

    def killed_by(self, source: str, mutant: Mutant) -> str:
        """The test that fails with `mutant`, or 'timeout'; empty where it survives."""
        path = self.folder / source
        original = path.read_text(encoding="utf-8")
        try:
            self._write(path, mutant.apply(original))
            return self._run(max(LEAST_PATIENCE, PATIENCE * self.seconds))
        finally:
            self._write(path, original)

    def _write(self, path: Path, text: str) -> None:
        """Write a source with a time of its own: by size and second Python would take it for the one before."""
        path.write_text(text, encoding="utf-8")
        self._changes += 1
        os.utime(path, (self._changes, self._changes))

    def _run(self, patience: float) -> str:
        assert self._tests.stdin is not None
        assert self._tests.stdout is not None
        task = {"arguments": list(self.group.tests), "patience": patience}
        self._tests.stdin.write(json.dumps(task) + "\n")
        self._tests.stdin.flush()
        answer: str = json.loads(self._tests.stdout.readline())
        return answer
