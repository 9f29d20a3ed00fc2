"""A frame of live use has a limit of steps: beyond it `conserving` finishes the frame, with a status and a warning."""

from __future__ import annotations

import re
import warnings

import numpy as np
import pytest
import softcradle.physics.adaptive.runner
from softcradle.physics import METHODS, Chain, Contact, State, advance, one_on, power_law, simulate
from softcradle.physics.simulation import move, solve

from tests.helpers.relations import total_energy

SOFT = one_on(4, power_law(1.0, 0.1))
WITH_FRICTION = Chain(np.ones(4), [power_law(1.0, 0.1)] * 3, friction=0.02)
WITH_LOSS = Chain(np.ones(4), [Contact(0.0, 1.0, 0.5, loss=0.3)] * 3, friction=0.02)
ADAPTIVE = [method.name for method in METHODS if method.adaptive]


def _struck(chain: Chain) -> State:
    return State.at_start(chain, np.eye(1, chain.contacts + 1)[0])


@pytest.mark.parametrize("chain", [SOFT, WITH_FRICTION, WITH_LOSS], ids=["soft", "friction", "loss"])
@pytest.mark.parametrize("method", ADAPTIVE)
def test_conserving_finishes_a_frame_with_a_warning(chain, method):
    state, frame = _struck(chain), 0.5
    with pytest.warns(RuntimeWarning, match=f"{method} gave up .*; conserving moved on from there"):
        advance(chain, state, frame, method, most_steps=3)
    assert state.time == frame
    assert total_energy(chain, state) + state.absorbed.sum() == pytest.approx(0.5, abs=1e-8)
    fine = simulate(chain, np.eye(1, chain.contacts + 1)[0], frame, method="accurate", samples=2)
    np.testing.assert_allclose(state.velocity(chain), fine.final_velocity, atol=0.01)


@pytest.mark.parametrize("method", ADAPTIVE)
def test_a_frame_with_enough_steps_clears_old_warnings(method):
    state = _struck(SOFT)
    move(SOFT, state, 0.01, method, None, 1e-6, 3)
    assert state.status.gave_up
    assert state.warnings
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        advance(SOFT, state, 0.5, method, tolerance=1e-6)
    assert not state.status.gave_up
    assert state.warnings == ()


@pytest.mark.parametrize("chain", [WITH_FRICTION, WITH_LOSS], ids=["friction", "loss"])
@pytest.mark.parametrize("steps", [1, 2, 5, 20, 60])
def test_giving_up_between_changes_of_stick_and_slip_is_a_value(chain, steps, monkeypatch):
    """Before the first sample of the margins, between two, or while a change is located."""
    monkeypatch.setattr(softcradle.physics.adaptive.runner, "MOST_STEPS", steps)
    found = solve(chain, np.eye(1, chain.contacts + 1)[0], None, "radau", None, 11, 1e-8)
    (warning,) = found.warnings
    assert found.status.gave_up
    assert warning.code == "gave-up"
    assert re.match("radau gave up at t = .*; take method 'conserving'", str(warning))
    assert np.isfinite(found.velocity).all()
    assert found.time.size <= 11


def test_a_limit_below_one_step_is_refused():
    with pytest.raises(ValueError, match="most_steps must be at least 1, not 0"):
        advance(SOFT, _struck(SOFT), 0.1, "radau", most_steps=0)
