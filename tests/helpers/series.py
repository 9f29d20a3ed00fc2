"""Solvers and series of the work-precision chart, for tests that need few points or none measured."""

from dataclasses import replace

from softcradle.sandbox.studies.precision import measurement
from softcradle.sandbox.studies.precision.measurement import ChartPoint, Series, Solution, Solver, TimeLimits

SHORT_LIMITS = TimeLimits(run=0.05, series=0.05, case=1.0)


def our_solver(case, name, *finenesses):
    """The solver of that name; with `finenesses`, at these alone."""
    solver = next(solver for solver in measurement.our_solvers(case) if solver.name == name)
    return replace(solver, finenesses=finenesses) if finenesses else solver


def made_series(name, ours, *errors_and_times):
    """A series with these (error, seconds), of finenesses 1, 0.1 and so on, that nobody measured."""
    solver = Solver(name, "", [1.0] * len(errors_and_times), lambda *_: Solution(None, 0.0), ours)
    points = [ChartPoint(solver, 10.0**-k, *both, evaluations=k) for k, both in enumerate(errors_and_times)]
    return Series(solver, points)
