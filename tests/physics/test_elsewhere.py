"""Tests in processes of their own: no digit depends on the processor, the C library or compiled kernels; kernels one by one.

As plain Python these are in a process of their own: compiled, each would be compiled for its test alone.
"""

import pytest
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

from tests.helpers.own_process import python
from tests.helpers.paths import ROOT, plain_files
from tests.helpers.plain_kernels import COMPILED

VECTORS = " ".join(name for name in __cpu_dispatch__ if __cpu_features__[name])  # that NumPy may use, by its own names
PLACES = {
    "a C library without vector instructions": (
        {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4", "NPY_DISABLE_CPU_FEATURES": VECTORS},
        ("test_digests.py",),
    ),
    "a processor without the instructions of this one": (
        {"NUMBA_CPU_NAME": "generic", "OPENBLAS_CORETYPE": "Prescott", "SOFTCRADLE_COMPILE": "first"},
        ("test_digests.py", "numerics/test_exact_matrices.py"),
    ),
    "plain Python": (
        {"NUMBA_DISABLE_JIT": "1"},
        ("adaptive/test_first_root.py", "adaptive/test_yield_or_slip.py", "test_contact.py", "test_chain.py"),
    ),
}


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
