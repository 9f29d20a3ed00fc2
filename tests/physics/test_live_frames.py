"""Tests of interrupted runs. Each frame has a step budget. Long runs pause to handle signals, and a pause must not
change the result.
"""

import numpy as np
import pytest
from softcradle.physics import Chain, Contact, State, advance, one_on, simulate
from softcradle.physics.contact import power_law
from softcradle.physics.simulation import solve
from softcradle.physics.status import Status

from tests.helpers.motions import CASES, LONG_ROW, digits_of, runs
from tests.helpers.relations import KERNELS, struck, total_energy

SOFT = one_on(4, power_law(1.0, 0.1))
RUBS = Chain(np.ones(4), [power_law(1.0, 0.1)] * 3, friction=0.02)
LOSES = Chain(np.ones(4), [Contact(0.0, 1.0, 0.5, loss=0.3)] * 3, friction=0.02)


@pytest.mark.parametrize("chain", [SOFT, RUBS, LOSES], ids=["soft", "rubs", "loses"])
@pytest.mark.parametrize("method", [*KERNELS, "scipy"])
def test_conserving_finishes_a_frame_that_runs_out_of_steps(chain, method):
    state, frame = State.at_start(chain, struck(chain)), 0.5
    with pytest.warns(RuntimeWarning, match=f"{method} gave up at t = .*3 steps.*; conserving moved on from there"):
        advance(chain, state, frame, method, most_steps=3)
    assert state.time == frame
    assert total_energy(chain, state) + state.absorbed.sum() == pytest.approx(0.5, abs=1e-8)
    fine = simulate(chain, struck(chain), frame, method="accurate", samples=2)
    np.testing.assert_allclose(state.velocity(chain), fine.final_velocity, atol=0.01)
    assert state.status.gave_up
    assert state.warnings
    advance(chain, state, frame, method, tolerance=1e-6)
    assert not state.status.gave_up
    assert state.warnings == ()


@pytest.mark.parametrize(("chain", "method"), [(RUBS, "radau"), (LOSES, "radau"), *((SOFT, one) for one in KERNELS)])
@pytest.mark.parametrize("steps", [1, 2, 5, 20, 60])
def test_a_run_whose_budget_ends_reaches_its_end(chain, method, steps, monkeypatch):
    """Check that a run reaches its end although its step budget is exhausted. With friction, the budget can also end
    between two changes of the friction.
    """
    exact = solve(chain, struck(chain), None, method, None, 11, 1e-8)
    monkeypatch.setattr("softcradle.physics.adaptive.usual_budget.MOST_STEPS", steps)
    monkeypatch.setattr("softcradle.physics.adaptive.usual_budget.MOST_FOLLOWED", 0)
    found = solve(chain, struck(chain), None, method, None, 11, 1e-8)
    (warning,) = found.warnings
    assert "the step budget ended at t = " in warning.sentence
    assert found.status == Status.BUDGET_SPENT
    assert warning.code == "budget"
    assert (np.abs(found.final_velocity - exact.final_velocity) <= found.velocity_error).all()
    assert found.time.size == 11
    assert found.ledger[-1] == pytest.approx(found.ledger[0], rel=1e-6)


FIXED = "verlet", "conserving"
PAUSED = [*runs(CASES, ("accurate",)), *(("a long row", one) for one in FIXED)]
# If forces depend on time, round-off decides where steps end, so these motions are left out.
PAUSED += runs([name for name in CASES if not CASES[name].chain.timed], FIXED)


@pytest.mark.parametrize(("name", "method"), PAUSED)
def test_the_digits_of_a_run_do_not_depend_on_its_pauses(name, method, monkeypatch):
    """Check that results are bitwise equal whatever the pauses are. Some pauses are at breakpoints of forces. At a
    breakpoint, adaptive methods determine friction and yielding again.
    """
    case = CASES.get(name, LONG_ROW)
    whole = digits_of(case, method)
    for steps in (1,) if method == "accurate" else (1, 2, 7, 50):
        monkeypatch.setattr("softcradle.physics.fixed_step.runner.PAUSE", steps * case.chain.contacts)
        monkeypatch.setattr("softcradle.physics.adaptive.runner.PAUSE", steps)
        assert digits_of(case, method) == whole
