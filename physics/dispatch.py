"""Dispatch, the one caller of runners: from a Problem to the runner of its method."""

from __future__ import annotations

from functools import cache

from softcradle.physics.methods import Family, find_method
from softcradle.physics.problem import Problem, Record, Runner
from softcradle.physics.status import Status


@cache
def runner_of(method: str) -> Runner:
    """The runner that carries out `method`, imported on first use: numba, pymunk and SciPy load with theirs."""
    match find_method(method).family:
        case Family.FIXED_STEP:
            from softcradle.physics.fixed_step import runner as fixed_step

            return fixed_step
        case Family.ADAPTIVE:
            from softcradle.physics import confirm

            return confirm
        case Family.PYMUNK:
            from softcradle.physics.pymunk_contacts import runner as pymunk_space

            return pymunk_space
        case Family.REFERENCE:
            from softcradle.physics.reference import runner as reference

            return reference


def run(problem: Problem) -> Record:
    """Compute the whole motion by its method; ``problem.state`` stays as it is."""
    return runner_of(problem.method).run(problem)


def advance(problem: Problem) -> Status:
    """Move ``problem.state`` on by the duration in place, by its method."""
    return runner_of(problem.method).advance(problem)
