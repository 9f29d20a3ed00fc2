"""Step budget of an adaptive run.

If a motion needs more steps, its contacts chatter. Following each single bounce would not improve the accuracy.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.step_records import ALLOWED, DOP853, ERROR_EXPONENT, RADAU
from softcradle.physics.problem import MOST_STEPS, Problem
from softcradle.physics.scales import scales_at

# Budget of a short chain: number of steps times number of contacts. Rejected steps count. This budget takes about 0.1
# s.
CONTACT_STEPS = 120_000
# Additional steps for each contact of a chain. A wave passes through a long chain from contact to contact.
STEPS_A_CONTACT = 60
STEPS_A_CONTACT_TIME = 400  # Additional steps for each contact time (the longest of the chain) in the duration
# Largest number of additional steps because of the duration. These steps take some seconds. If a motion has more
# bounces, the method `conserving` finishes it.
MOST_LASTING = 1e6
# Additional steps for each impact at full speed (see FULL_SPEED). The number applies to USUAL_TOLERANCE and to motions
# with small error amplification. Hard spheres (computing pi by counting collisions) need 10 to 40 steps per impact with
# dop853. radau needs hundreds if the spheres are much faster than the speed scale.
STEPS_AN_IMPACT = 500
# Largest number of additional steps because of impacts. These steps take about ten seconds for a short chain.
MOST_FOLLOWED = 5_000_000
# Largest number of contact forces evaluated in a run whose errors are amplified. These evaluations take about three
# seconds. Trains of hundreds of draft gears with gaps chatter: each of their steps ends at an event, which takes ten
# times the usual evaluations.
MOST_FORCES = 2e8
# Ratio of the predicted steps to the largest budget above which a run with a duration ends early. The budget of such a
# run would end long before the motion. Therefore the method `conserving` takes over immediately.
MOST_PREDICTED = 3.0
# Smallest factor by which the budget must grow. With a smaller growth, another call of the kernel would not pay.
LONGER = 1.1
# Tolerance below which the step budget grows. The budget grows in proportion to the expected number of steps.
USUAL_TOLERANCE = 1e-8


def usual_budget(contacts: int, tolerance: float) -> int:
    """Return the step budget for a motion without a fixed duration."""
    budget = CONTACT_STEPS / contacts + STEPS_A_CONTACT * (contacts + 16)
    return int(min(budget * _finer(tolerance), MOST_STEPS))


def _finer(tolerance: float) -> float:
    """Return the expected number of steps, divided by the expected number at USUAL_TOLERANCE."""
    return float(max(USUAL_TOLERANCE / tolerance, 1.0) ** ERROR_EXPONENT[RADAU])


def _lasting(problem: Problem, time: float) -> int:
    """Return the additional steps for a motion of fixed duration that has reached `time` [s].

    These steps suffice for contacts that are struck repeatedly at the speed ``problem.scale``. The result is at most
    MOST_LASTING.
    """
    if problem.duration is None or time == problem.state.time:
        return 0
    longest = scales_at(problem.chain, problem.scale)[1].max()
    steps = STEPS_A_CONTACT_TIME * _finer(problem.tolerance) * (time - problem.state.time) / longest
    return int(min(steps, MOST_LASTING))


def usual_steps(problem: Problem, time: float) -> int:
    """Return the usual step budget of a run up to `time` [s].

    The run gets the same budget again after each breakpoint of the forces over time.
    """
    budget = usual_budget(problem.chain.contacts, problem.tolerance) * (1 + len(problem.chain.knots))
    return budget + _lasting(problem, time)


def followed_steps(problem: Problem, impacts: int) -> int:
    """Return the steps that are allowed beyond the usual budget after `impacts` impacts at full speed.

    A frame of live use gets no additional steps.
    """
    if problem.most_steps is not None:
        return 0
    return int(min(STEPS_AN_IMPACT * _finer(problem.tolerance) * impacts, MOST_FOLLOWED))


def step_budget(problem: Problem, time: float) -> int:
    """Return the step budget of a run up to `time` [s]. When a run has used its budget, it gives up. Rejected steps
    count.
    """
    if problem.most_steps is not None:
        return problem.most_steps
    # dop853 follows every oscillation of soft contacts, the other methods do not.
    if ALLOWED[problem.method] == DOP853:
        return MOST_STEPS + _lasting(problem, time)
    if problem.budget is not None:
        return problem.budget
    return usual_steps(problem, time)


class GrowingBudget:
    """Step budget of one run. The budget grows with the time reached and with the number of impacts at full speed.

    Attributes:
        steps: the current budget, a number of steps. Rejected steps count.
    """

    def __init__(self, problem: Problem, time: float) -> None:
        self.problem, self.steps = problem, step_budget(problem, time)
        # Number of steps and time [s] at the last extension of the budget
        self._extended: tuple[int, float] | None = None

    def extend(self, steps: int, time: float, impacts: int, amplified: bool) -> bool:
        """Extend the budget of a run that has used its `steps` at `time` [s]. Return True if the run may continue.

        The budget at most doubles. The progress since the last extension shows if the run can reach its end. If the
        motion has `amplified` its errors, impacts at full speed do not add to the budget.
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
        """Return True if a run with `amplified` errors has evaluated too many contact `forces`."""
        return amplified and self.problem.most_steps is None and forces > MOST_FORCES
