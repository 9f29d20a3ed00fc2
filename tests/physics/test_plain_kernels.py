"""Kernels one by one, as plain Python in a process of their own: compiled, each would be compiled for its test alone."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests.helpers.paths import ROOT
from tests.helpers.plain_kernels import COMPILED

ROOMS = (
    "tests/physics/fixed_step/test_gradient_step.py",
    "tests/physics/fixed_step/test_checkpoint_rows.py",
    "tests/physics/numerics/test_contact_solve.py",
    "tests/physics/numerics/test_coupler_kernels.py",
    "tests/physics/adaptive/test_fallback_step.py",
    "tests/physics/adaptive/test_radau_step.py",
    "tests/physics/adaptive/test_radau_guess.py",
    "tests/physics/adaptive/test_find_event.py",
    "tests/physics/adaptive/test_guards.py",
    "tests/physics/adaptive/test_step_control.py",
)


@pytest.mark.skipif(not COMPILED, reason="they run by themselves where nothing is compiled")
def test_kernels_one_by_one() -> None:
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTEST_ADDOPTS": ""}
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *ROOMS]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-4000:]
    assert " skipped" not in done.stdout
