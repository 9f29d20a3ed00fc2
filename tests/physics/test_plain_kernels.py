"""Kernels one by one, as plain Python in a process of their own: compiled, each would be compiled for its test alone."""

import pytest

from tests.helpers.own_process import python
from tests.helpers.paths import ROOT, plain_files
from tests.helpers.plain_kernels import COMPILED


@pytest.mark.skipif(not COMPILED, reason="they run by themselves where nothing is compiled")
@pytest.mark.parametrize("room", sorted({path.parent.name for path in plain_files()}))
def test_kernels_one_by_one(room: str) -> None:
    files = [str(path) for path in plain_files() if path.parent.name == room]
    words = ("-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *files)
    assert " skipped" not in python(*words, cwd=ROOT, NUMBA_DISABLE_JIT="1", PYTEST_ADDOPTS="").stdout
