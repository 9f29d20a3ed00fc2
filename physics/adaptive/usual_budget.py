"""Step budget of an adaptive run. A motion that needs more steps is chattering, and following each bounce adds no
accuracy.
"""

from __future__ import annotations

from softcradle.physics.adaptive.step_records import ALLOWED, DOP853, ERROR_EXPONENT, RADAU
from softcradle.physics.problem import MOST_STEPS, Problem
from softcradle.physics.scales import scales_at

# Budget of a short chain: steps (including rejected ones) times contacts. It takes about 0.1 s.
CONTACT_STEPS = 120_000
# Additional steps for each contact, because waves pass through long chains one contact after another
STEPS_A_CONTACT = 60
STEPS_A_CONTACT_TIME = 400  # Additional steps for each longest contact time within the duration
# Largest number of these, some seconds of computing. The method `conserving` finishes motions with more bounces.
MOST_LASTING = 1e6
# Additional steps for each impact at full speed (see FULL_SPEED), at USUAL_TOLERANCE and for motions with small error
# amplification. Hard spheres (computing pi by counting collisions) need 10 to 40 steps each with dop853. radau needs
# hundreds if the spheres are much faster than the speed scale.
STEPS_AN_IMPACT = 500
# Largest number of these steps, about ten seconds for a short chain
MOST_FOLLOWED = 5_000_000
USUAL_TOLERANCE = 1e-8  # Tolerance below which the budget grows in proportion to the expected number of steps


def usual_budget(contacts: int, tolerance: float) -> int:
    """Return the step budget of a motion without a duration."""
    budget = CONTACT_STEPS / contacts + STEPS_A_CONTACT * (contacts + 16)
    return int(min(budget * _finer(tolerance), MOST_STEPS))


def _finer(tolerance: float) -> float:
    """Return the expected number of steps relative to that at USUAL_TOLERANCE."""
    return float(max(USUAL_TOLERANCE / tolerance, 1.0) ** ERROR_EXPONENT[RADAU])


def _lasting(problem: Problem, time: float) -> int:
    """Return the additional steps of a motion with a duration that has lasted until `time` [s].

    This is enough for contacts that are struck again and again at the speed ``problem.scale``, up to a total of
    MOST_LASTING steps.
    """
    if problem.duration is None or time == problem.state.time:
        return 0
    longest = scales_at(problem.chain, problem.scale)[1].max()
    steps = STEPS_A_CONTACT_TIME * _finer(problem.tolerance) * (time - problem.state.time) / longest
    return int(min(steps, MOST_LASTING))


def usual_steps(problem: Problem, time: float) -> int:
    """Return the usual step budget of a run until `time` [s]. It is granted again after each breakpoint of the forces
    over time.
    """
    budget = usual_budget(problem.chain.contacts, problem.tolerance) * (1 + len(problem.chain.knots))
    return budget + _lasting(problem, time)


def followed_steps(problem: Problem, impacts: int) -> int:
    """Return the steps that are allowed beyond the usual budget after `impacts` impacts at full speed; 0 for a frame of
    live use.
    """
    if problem.most_steps is not None:
        return 0
    return int(min(STEPS_AN_IMPACT * _finer(problem.tolerance) * impacts, MOST_FOLLOWED))


def step_budget(problem: Problem, time: float) -> int:
    """Return the number of steps by `time` [s], including rejected ones, after which a run gives up."""
    if problem.most_steps is not None:
        return problem.most_steps
    if ALLOWED[problem.method] == DOP853:  # as the only method it follows every oscillation of soft contacts
        return MOST_STEPS + _lasting(problem, time)
    if problem.budget is not None:
        return problem.budget
    return usual_steps(problem, time)
