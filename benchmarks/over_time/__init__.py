"""Benchmarks for asv (airspeed velocity), from release to release; see asv.conf.json and CONTRIBUTING.md.

asv installs softcradle from a commit and measures it with the current benchmarks. They come after the installed package
on the search path, so that the checkout itself is not measured.
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2]))
