"""Leave out the tests that need plain Python if numba compiles the kernels. The file `test_elsewhere.py` runs these
tests in a process without compiled kernels. A test file that is named on the command line is always collected.
"""

import os
from importlib.util import find_spec

from tests.helpers.paths import plain_files

COMPILED = os.environ.get("NUMBA_DISABLE_JIT") != "1" and find_spec("numba") is not None
collect_ignore = list(map(str, plain_files())) if COMPILED else []
