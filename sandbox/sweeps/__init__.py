"""Sweeps: a scene or a function over many points, measured, on one machine or many, kept on disk as it goes."""

from softcradle.sandbox.sweeps.measure_table import Measure
from softcradle.sandbox.sweeps.run_sweep import sweep
from softcradle.sandbox.sweeps.sample_points import Axis, grid, latin_hypercube, listed, sobol

__all__ = ["Axis", "Measure", "grid", "latin_hypercube", "listed", "sobol", "sweep"]
