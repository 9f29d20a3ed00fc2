"""Sweeps compute a scene or a function at many points, measure each simulation, and store the results on disk.

The points are computed on this machine or on a cluster.
"""

from softcradle.sandbox.sweeps.measure_table import Measure
from softcradle.sandbox.sweeps.run_sweep import sweep
from softcradle.sandbox.sweeps.sample_points import Axis, grid, latin_hypercube, listed, sobol

__all__ = ["Axis", "Measure", "grid", "latin_hypercube", "listed", "sobol", "sweep"]
