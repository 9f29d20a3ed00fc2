"""Tests that need plain Python are collected only there, by `test_elsewhere.py`. If a file is named, it is always
collected.
"""

import os
from importlib.util import find_spec

from tests.helpers.paths import plain_files

COMPILED = os.environ.get("NUMBA_DISABLE_JIT") != "1" and find_spec("numba") is not None
collect_ignore = list(map(str, plain_files())) if COMPILED else []
