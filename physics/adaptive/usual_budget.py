"""The usual budget of an adaptive run: steps after which a motion rattles more than it determines."""

from __future__ import annotations

from softcradle.physics.adaptive.step_records import ALLOWED, DOP853, ERROR_EXPONENT, RADAU
from softcradle.physics.problem import MOST_STEPS, Problem
from softcradle.physics.scales import scales_at

CONTACT_STEPS = 120_000  # steps times contacts, rejected steps included: the budget of a short chain, about 0.1 s
STEPS_A_CONTACT = 60  # more steps for each contact, for waves pass through long chains one contact after another
STEPS_A_CONTACT_TIME = 400  # more steps for each of the longest contact times in the duration
MOST_LASTING = 1e6  # of these, some seconds: what bounces more often is carried to its end by `conserving`
# More steps for each impact at full speed (see FULL_SPEED) of a motion whose errors hardly grow, at the usual tolerance. Hard
# spheres (pi from collisions) take 10 to 40 by dop853; radau takes hundreds if they are much faster than the scale.
STEPS_AN_IMPACT = 500
# Largest number of these, about ten seconds of a short chain
MOST_FOLLOWED = 5_000_000
USUAL_TOLERANCE = 1e-8  # below it the budget grows as the number of steps does


def usual_budget(contacts: int, tolerance: float) -> int:
    """Steps of a motion without a duration."""
    budget = CONTACT_STEPS / contacts + STEPS_A_CONTACT * (contacts + 16)
    return int(min(budget * _finer(tolerance), MOST_STEPS))


def _finer(tolerance: float) -> float:
    """Times the steps at the usual tolerance."""
    return float(max(USUAL_TOLERANCE / tolerance, 1.0) ** ERROR_EXPONENT[RADAU])


def _lasting(problem: Problem, time: float) -> int:
    """More steps of a motion with a duration that has lasted until `time` [s].

    They are for contacts that are struck at ``problem.scale``: bounces at it never take so many, as long as they go on for
    MOST_LASTING.
    """
    if problem.duration is None or time == problem.state.time:
        return 0
    longest = scales_at(problem.chain, problem.scale)[1].max()
    steps = STEPS_A_CONTACT_TIME * _finer(problem.tolerance) * (time - problem.state.time) / longest
    return int(min(steps, MOST_LASTING))


def usual_steps(problem: Problem, time: float) -> int:
    """The usual budget of a run until `time` [s], after the start and after each knot of its forces anew."""
    budget = usual_budget(problem.chain.contacts, problem.tolerance) * (1 + len(problem.chain.knots))
    return budget + _lasting(problem, time)


def followed_steps(problem: Problem, impacts: int) -> int:
    """Return the steps allowed beyond the usual budget for so many `impacts` at full speed; none for a frame of live use."""
    if problem.most_steps is not None:
        return 0
    return int(min(STEPS_AN_IMPACT * _finer(problem.tolerance) * impacts, MOST_FOLLOWED))


def step_budget(problem: Problem, time: float) -> int:
    """Steps by `time` [s], rejected ones included, above which a motion rattles more than it determines; or what is allowed."""
    if problem.most_steps is not None:
        return problem.most_steps
    if ALLOWED[problem.method] == DOP853:  # alone it follows the oscillations of soft contacts, however many
        return MOST_STEPS + _lasting(problem, time)
    if problem.budget is not None:
        return problem.budget
    return usual_steps(problem, time)
