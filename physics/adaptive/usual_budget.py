"""Step budget of an adaptive run. A motion that needs more steps is chattering, and following each bounce adds no
accuracy.
"""

from __future__ import annotations

import math

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
# Largest number of contact forces evaluated in a run whose errors are amplified, about three seconds. Rows of hundreds
# of gears with gaps chatter, and each of their steps ends at an event, which takes ten times the usual evaluations.
MOST_FORCES = 2e8
# Predicted steps above which a run with a duration ends early, as a multiple of its largest budget. Such a budget would
# end long before the motion, so it is better to let `conserving` follow the motion from now on.
MOST_PREDICTED = 3.0
LONGER = 1.1  # Smallest growth of the budget during a run that is worth another call of the kernel
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


class GrowingBudget:
    """Step budget of one run. It grows with the time reached and with the number of impacts at full speed.

    Attributes:
        steps: the present budget: number of steps, including rejected ones.
    """

    def __init__(self, problem: Problem, time: float) -> None:
        self.problem, self.steps = problem, step_budget(problem, time)
        self._extended: tuple[int, float] | None = None  # steps and time [s] of the run at the last extension

    def extend(self, steps: int, time: float, impacts: int, amplified: bool) -> bool:
        """Return True if a run that has used its budget of `steps` at `time` [s] may continue, with a larger budget.

        The budget at most doubles. The steps per time since the last extension then show if the run can reach its end.
        If its errors are `amplified`, impacts at full speed do not add to the budget.
        """
        allowed = step_budget(self.problem, time) + (0 if amplified else followed_steps(self.problem, impacts))
        left, futile = self.problem.end - time, False
        if self._extended is not None and math.isfinite(left):
            rate = (steps - self._extended[0]) / (time - self._extended[1]) if time > self._extended[1] else math.inf
            futile = rate * left > MOST_PREDICTED * (MOST_LASTING + (0 if amplified else MOST_FOLLOWED))
        if futile or allowed <= LONGER * self.steps:
            return False
        self.steps, self._extended = min(allowed, 2 * self.steps), (steps, time)
        return True

    def exceeds_cost(self, forces: int, amplified: bool) -> bool:
        """Return whether a run with amplified errors has evaluated too many contact `forces`."""
        return amplified and self.problem.most_steps is None and forces > MOST_FORCES
