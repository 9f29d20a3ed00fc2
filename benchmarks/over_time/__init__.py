"""The benchmarks as asv (airspeed velocity) takes them, from release to release: see asv.conf.json and CONTRIBUTING.md.

asv installs softcradle as it was at a commit, and measures it by the benchmarks as they are now. They are found behind what is
installed, so that the checkout is not measured in its place.
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2]))
