"""Benchmarks for asv (airspeed velocity), which compares releases; see asv.conf.json and CONTRIBUTING.md.

asv installs softcradle from a commit and measures it with the current benchmarks. The benchmarks come after the
installed package on the search path. The checkout itself is therefore not measured.
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2]))
