"""Tests of the step budget of adaptive runs. A run ends early if its budget cannot be enough. Other runs may continue."""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, draft_gear, hertz, hooke, one_on, power_law, step_force
from softcradle.physics.adaptive import usual_budget
from softcradle.physics.adaptive.usual_budget import MOST_FORCES, GrowingBudget
from softcradle.physics.problem import Problem
from softcradle.physics.state import State
from softcradle.physics.status import Status

from tests.helpers.relations import simulate_quietly, struck


def problem_of(chain: Chain, duration: float | None, velocity=None) -> Problem:
    start = State.at_start(chain, struck(chain) if velocity is None else velocity)
    return Problem(chain, start, "accurate", duration, tolerance=1e-8, samples=2)


BOUNCES = Chain([math.inf, 1.0, math.inf], hooke(1e4), gap=1.0)


def test_a_budget_at_most_doubles() -> None:
    budget = GrowingBudget(problem_of(BOUNCES, 1e9, [0.0, 1.0, 0.0]), 0.0)
    first = budget.steps
    assert budget.extend(first, 1e6, 0, amplified=False)
    assert budget.steps == 2 * first


@pytest.mark.parametrize("amplified", [False, True])
@pytest.mark.parametrize(("part", "continues"), [(0.9, True), (1.1, False)])
def test_a_budget_ends_if_the_last_steps_predict_too_many(part: float, continues: bool, amplified: bool) -> None:
    """Check a run that takes 1000 steps in the last second. From this rate, the number of remaining steps is predicted.
    The predicted number is `part` times the largest allowed prediction.
    """
    largest = usual_budget.MOST_LASTING + (0 if amplified else usual_budget.MOST_FOLLOWED)
    left = part * usual_budget.MOST_PREDICTED * largest / 1000.0
    budget = GrowingBudget(problem_of(BOUNCES, 1e4 + 1.0 + left, [0.0, 1.0, 0.0]), 0.0)
    # The first extension of the budget is always granted, because a motion can be fast only at its beginning.
    assert budget.extend(50_000, 1e4, 0, amplified)
    assert budget.extend(51_000, 1e4 + 1.0, 0, amplified) == continues


def test_a_run_without_a_duration_predicts_nothing() -> None:
    budget = GrowingBudget(problem_of(one_on(2, hertz(1.0)), None), 0.0)
    assert not budget.extend(budget.steps, 1.0, 0, amplified=True)
    assert budget.extend(budget.steps, 1.0, 10**6, amplified=False)


def test_only_amplified_errors_limit_the_cost() -> None:
    budget = GrowingBudget(problem_of(BOUNCES, 1.0, [0.0, 1.0, 0.0]), 0.0)
    assert budget.exceeds_cost(int(MOST_FORCES) + 1, amplified=True)
    assert not budget.exceeds_cost(int(MOST_FORCES) - 1, amplified=True)
    assert not budget.exceeds_cost(int(MOST_FORCES) + 1, amplified=False)


def row_with_gaps(n: int) -> tuple[Chain, np.ndarray]:
    """Return a chattering chain and the velocities of its beads. The contacts of the chain are constant forces, draft
    gears and draft gears with loss. Some contacts have gaps. Three beads hit the chain.
    """
    draw = np.random.default_rng([99, 3])
    mass = 10 ** draw.uniform(-0.5, 0.5, n + 1)
    laws = (step_force(1.0), draft_gear(50.0, 0.02), draft_gear(50.0, 0.02, 0.3))
    contact = [laws[int(draw.integers(3))] for _ in range(n)]
    gap = np.where(draw.random(n) < 0.2, 0.01, 0.0)
    return Chain(mass, contact, gap), np.r_[np.ones(3), np.zeros(n - 2)]


def test_a_chattering_row_ends_by_its_cost(monkeypatch) -> None:
    """Check that the run of a chattering chain of draft gears ends early. With 500 gears the run took 28 s and needed
    10 times the usual number of evaluations per step.
    """
    chain, velocity = row_with_gaps(30)
    whole = simulate_quietly(chain, velocity, 6.0, tolerance=1e-4, samples=2)
    monkeypatch.setattr(usual_budget, "MOST_FORCES", 5e5)
    found = simulate_quietly(chain, velocity, 6.0, tolerance=1e-4, samples=2)
    assert found.status == Status.BUDGET_SPENT
    assert found.evaluations < 0.5 * whole.evaluations
    momentum = chain.finite_mass @ velocity
    assert chain.finite_mass @ found.final_velocity == pytest.approx(momentum, rel=1e-9)


def test_a_row_that_does_not_amplify_errors_is_followed_at_any_cost(monkeypatch) -> None:
    monkeypatch.setattr(usual_budget, "MOST_FORCES", 1.0)
    chain = one_on(30, hertz(1.0))
    assert simulate_quietly(chain, struck(chain), tolerance=1e-6, samples=2).status == Status.SEPARATED


def test_a_bead_pressed_on_a_wall_is_not_followed_in_vain() -> None:
    """Check that a run of 43 million steps ends early. The largest possible budget of 1.1 million steps would not be
    enough.
    """
    chain = Chain([1.0, math.inf], power_law(1.27, 0.113), drive=[0.036, 0.0])
    found = simulate_quietly(chain, [0.0, 0.0], 2.0, samples=2, tolerance=1e-6)
    assert found.status == Status.BUDGET_SPENT
    assert found.steps < 4e5
    assert abs(found.final_velocity[0]) <= found.velocity_error[0] < 1e-5
