"""Dispatch, the one caller of runners: from a Problem to the runner of its method."""

from __future__ import annotations

from functools import cache

from softcradle.physics.chain import Chain
from softcradle.physics.methods import Family, find_method
from softcradle.physics.problem import Problem, Record, Runner
from softcradle.physics.status import Status


def runner_of(method: str, chain: Chain) -> Runner:
    """The runner that carries out `method` on `chain`, imported on first use: numba, pymunk and SciPy load with theirs.

    Kernels carry friction, loss and couplers as they are; the reference has a runner of its own for them.
    """
    if is_extended(method, chain):
        from softcradle.physics.reference import dissipative_runner

        return dissipative_runner
    return _runner(find_method(method).family)


def is_extended(method: str, chain: Chain) -> bool:
    """Whether steps are those of the reference in extended precision, each of which takes milliseconds."""
    return find_method(method).family is Family.REFERENCE and bool(chain.dissipative or chain.couplers)


@cache
def _runner(family: Family) -> Runner:
    match family:
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
            from softcradle.physics.reference import scipy_runner as reference

            return reference


def run(problem: Problem) -> Record:
    """Compute the whole motion by its method; ``problem.state`` stays as it is."""
    return runner_of(problem.method, problem.chain).run(problem)


def advance(problem: Problem) -> Status:
    """Move ``problem.state`` on by the duration in place, by its method."""
    return runner_of(problem.method, problem.chain).advance(problem)
