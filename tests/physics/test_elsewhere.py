"""What may not depend on the processor, on the functions of the C library, nor on compiled kernels: every digit."""

import pytest
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

from tests.helpers.own_process import python
from tests.helpers.paths import ROOT

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


@pytest.mark.slow
@pytest.mark.parametrize(("variables", "tests"), PLACES.values(), ids=PLACES)
def test_the_same_elsewhere(variables, tests):
    files = [f"tests/physics/{name}" for name in tests]
    python("-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *files, cwd=ROOT, PYTEST_ADDOPTS="", **variables)
