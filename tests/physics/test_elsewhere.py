"""Determinism: the same digits run for run, whatever the processor and the C library; kernels one by one.

As plain Python these are in a process of their own: compiled, each would be compiled for its test alone.
"""

import json

import numpy as np
import pytest
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

from tests.helpers.digests import FILE, NOT_OURS, digest, motions, runs, solved, states
from tests.helpers.own_process import python
from tests.helpers.paths import ROOT, plain_files
from tests.helpers.plain_kernels import COMPILED

RECORDED = json.loads(FILE.read_text())
DIGITS = [f"test_elsewhere.py::test_digits_{those}_recorded" for those in ("are_those", "of_random_runs_are_those")]
VECTORS = " ".join(name for name in __cpu_dispatch__ if __cpu_features__[name])  # that NumPy may use, by its own names
PLACES = {
    "a C library without vector instructions": (
        {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4", "NPY_DISABLE_CPU_FEATURES": VECTORS},
        DIGITS,
    ),
    "a processor without the instructions of this one": (
        {"NUMBA_CPU_NAME": "generic", "OPENBLAS_CORETYPE": "Prescott", "SOFTCRADLE_COMPILE": "first"},
        [*DIGITS, "numerics/test_exact_matrices.py"],
    ),
    "plain Python": (
        {"NUMBA_DISABLE_JIT": "1"},
        ["adaptive/test_first_root.py", "adaptive/test_yield_or_slip.py", "test_contact.py", "test_chain.py"],
    ),
}


def test_every_motion_and_every_run_has_a_digest():
    assert set(RECORDED) == {name for name, *_ in (*motions(), *runs())}


def test_digits_of_random_runs_are_those_recorded():
    ours = [(name, rest) for name, *rest in runs() if rest[-1] not in NOT_OURS]
    assert [name for name, rest in ours if solved(*rest) != RECORDED[name]] == []


@pytest.mark.parametrize(
    ("name", "chain", "velocity", "method"), list(motions()), ids=lambda value: value if isinstance(value, str) else ""
)
def test_digits_are_those_recorded(name, chain, velocity, method):
    again = digest(states(chain, velocity, method)) if method in NOT_OURS else RECORDED[name]
    assert digest(states(chain, velocity, method)) == again


def test_a_last_digit_changes_a_digest():
    rows = np.linspace(0.1, 1.0, 60)
    others = rows + np.diag(np.spacing(rows))
    assert len({digest(rows), *map(digest, others)}) == 61


MOVE_A_CONSTANT = """
from tests.helpers.digests import digest, motions, states
import importlib
room = importlib.import_module("softcradle.physics.{module}")
if {moved}:
    room.{name} = room.{name} * (1.0 + 1e-15)
chosen = {{name: rest for name, *rest in motions()}}["one-on-four/{method}"]
print(digest(states(*chosen)))
"""


@pytest.mark.parametrize(
    ("module", "name", "method"),
    [("adaptive.step_control", "SAFETY", "accurate"), ("adaptive.adaptive_loop", "TOLERANCE_PART", "radau")],
)
def test_a_constant_that_moves_by_its_last_digits_changes_a_digest(module, name, method):
    """By one part in 1e15, in a process whose kernels are plain Python, so that the constant can be replaced."""

    def told(moved):
        script = MOVE_A_CONSTANT.format(module=module, name=name, method=method, moved=moved)
        return python("-c", script, NUMBA_DISABLE_JIT="1").stdout.split()[-1]

    assert told(True) != told(False)


def passed(names, **variables):
    """What pytest says of files of tests, all of which pass, in a process with these variables."""
    words = ("-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *map(str, names))
    return python(*words, cwd=ROOT, PYTEST_ADDOPTS="", **variables).stdout


@pytest.mark.slow
@pytest.mark.parametrize(("variables", "tests"), PLACES.values(), ids=PLACES)
def test_the_same_elsewhere(variables, tests):
    passed([f"tests/physics/{name}" for name in tests], **variables)


@pytest.mark.skipif(not COMPILED, reason="they run by themselves where nothing is compiled")
@pytest.mark.parametrize("room", sorted({path.parent.name for path in plain_files()}))
def test_kernels_one_by_one(room):
    assert " skipped" not in passed([path for path in plain_files() if path.parent.name == room], NUMBA_DISABLE_JIT="1")
