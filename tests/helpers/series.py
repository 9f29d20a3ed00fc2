"""Solvers and data series of the work-precision chart. The solvers and series are for tests that need few measured
points or only invented points.
"""

from dataclasses import replace

from softcradle.sandbox.studies.precision import measurement
from softcradle.sandbox.studies.precision.measurement import ChartPoint, Series, Solution, Solver, TimeLimits

SHORT_LIMITS = TimeLimits(run=0.05, series=0.05, case=1.0)


def our_solver(case, name, *finenesses):
    """Return the solver with the given name. If `finenesses` are given, the solver uses only these step sizes or
    tolerances.
    """
    solver = next(solver for solver in measurement.our_solvers(case) if solver.name == name)
    return replace(solver, finenesses=finenesses) if finenesses else solver


def made_series(name, ours, *errors_and_times):
    """Return a data series of invented points (error, seconds). The step sizes or tolerances of the points are 1, 0.1
    and so on.
    """
    solver = Solver(name, "", [1.0] * len(errors_and_times), lambda *_: Solution(None, 0.0), ours)
    points = [ChartPoint(solver, 10.0**-k, *both, evaluations=k) for k, both in enumerate(errors_and_times)]
    return Series(solver, points)
