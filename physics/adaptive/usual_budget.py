"""The usual budget of an adaptive run: steps after which a motion rattles more than it determines."""

from __future__ import annotations

from typing import Any

from softcradle.physics.adaptive.step_records import ALLOWED, DOP853, ERROR_EXPONENT, RADAU
from softcradle.physics.problem import MOST_STEPS, Problem
from softcradle.physics.scales import contact_scales

CONTACT_STEPS = 120_000  # steps times contacts, rejected steps included: the budget of a short chain, about 0.1 s
STEPS_A_CONTACT = 60  # more steps for each contact, for waves pass through long chains one contact after another
STEPS_A_CONTACT_TIME = 400  # more steps for each of the longest contact times in the duration
USUAL_TOLERANCE = 1e-8  # below it the budget grows as the number of steps does


def usual_budget(contacts: int, tolerance: float, passes: Any) -> Any:
    """Steps of motions whose durations are `passes` times their longest contact times, a number or (C,); 0 without duration."""
    budget = CONTACT_STEPS / contacts + STEPS_A_CONTACT * (contacts + 16) + STEPS_A_CONTACT_TIME * passes
    finer = max(USUAL_TOLERANCE / tolerance, 1.0) ** ERROR_EXPONENT[RADAU]
    return budget * finer


def usual_steps(problem: Problem) -> int:
    """The usual budget of a run."""
    passes = 0.0
    if problem.duration is not None:
        passes = problem.duration / contact_scales(problem.chain, problem.state.velocity(problem.chain))[1].max()
    return min(int(usual_budget(problem.chain.contacts, problem.tolerance, passes)), MOST_STEPS)


def step_budget(problem: Problem) -> int:
    """Steps, rejected ones included, after which a motion rattles more than it determines; or what the problem allows."""
    if problem.most_steps is not None:
        return problem.most_steps
    if ALLOWED[problem.method] == DOP853:  # alone it follows the oscillations of soft contacts, however many
        return MOST_STEPS
    if problem.budget is not None:
        return problem.budget
    return usual_steps(problem)
