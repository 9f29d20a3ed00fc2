"""Tests of determinism. Results must be bitwise equal in every run, on every processor and with every C library. The
tests of kernels are also run in plain Python.
"""

import json

import pytest
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

from tests.helpers.digests import FILE, NOT_OURS, digest, motions, runs, solved, states
from tests.helpers.own_process import python
from tests.helpers.paths import ROOT, plain_files
from tests.helpers.plain_kernels import COMPILED

RECORDED = json.loads(FILE.read_text())
MOTIONS = {name: rest for name, *rest in motions()}
LONG = {f"train-starting/{method}" for method in ("conserving", "verlet", "euler")}
DIGITS = [f"test_elsewhere.py::test_digits_{those}_recorded" for those in ("are_those", "of_random_runs_are_those")]
# Processor features that NumPy can use, with the names that NumPy gives them.
VECTORS = " ".join(name for name in __cpu_dispatch__ if __cpu_features__[name])
PLACES = {
    "a C library without vector instructions": (
        {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4", "NPY_DISABLE_CPU_FEATURES": VECTORS},
        DIGITS,
    ),
    "a processor without the instructions of this one": (
        {"NUMBA_CPU_NAME": "generic", "OPENBLAS_CORETYPE": "Prescott", "SOFTCRADLE_COMPILE": "first"},
        [*DIGITS, "numerics/test_elementary.py"],
    ),
    "plain Python": (
        {"NUMBA_DISABLE_JIT": "1"},
        [
            "adaptive/test_corner_search.py", "adaptive/test_corner_action.py", "adaptive/test_step_control.py",
            "test_contact.py", "test_chain.py", "pymunk_contacts/test_contact_constraint.py",
        ],
    ),
}  # fmt: skip


def test_every_motion_and_every_run_has_a_digest():
    assert set(RECORDED) == {*MOTIONS, *(name for name, *_ in runs())}


def test_digits_of_random_runs_are_those_recorded():
    ours = [(name, rest) for name, *rest in runs() if rest[-1] not in NOT_OURS]
    assert [name for name, rest in ours if solved(*rest) != RECORDED[name]] == []


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n in LONG else n for n in MOTIONS])
def test_digits_are_those_recorded(name):
    again = digest(states(*MOTIONS[name])) if MOTIONS[name][-1] in NOT_OURS else RECORDED[name]
    assert digest(states(*MOTIONS[name])) == again


def passed(names, **variables):
    """Run pytest for the given test files in a process with the given environment variables. Return its output. All
    tests must pass.
    """
    words = ("-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *map(str, names))
    return python(*words, cwd=ROOT, PYTEST_ADDOPTS="", **variables).stdout


@pytest.mark.slow
@pytest.mark.parametrize(("variables", "tests"), PLACES.values(), ids=PLACES)
def test_the_same_elsewhere(variables, tests):
    passed([f"tests/physics/{name}" for name in tests], **variables)


@pytest.mark.skipif(not COMPILED, reason="they run by themselves where nothing is compiled")
def test_kernels_one_by_one():
    assert " skipped" not in passed(plain_files(), NUMBA_DISABLE_JIT="1")
