"""Tests of failed runs. If an explicit method fails, the trajectory contains the reason and recommends a better method."""

from dataclasses import replace

import numpy as np
import pytest
from softcradle.physics import METHODS, draft_gear, hertz, one_on, power_law, simulate, stable_step, step_force
from softcradle.physics.simulation import solve

from tests.helpers.random_chains import random_collision


@pytest.mark.parametrize("method", [method.name for method in METHODS if not method.set_valued])
def test_a_draft_gear_that_should_rest_is_reported_to_chatter(method):
    chain = one_on(3, draft_gear(770.0, 0.0177), mass=0.396)
    with pytest.warns(RuntimeWarning, match="chatter"):
        result = simulate(chain, [0.5, 0, 0, 0], method=method, step=1e-4)
    assert any(warning.code == "chatter" and "'conserving'" in str(warning) for warning in result.warnings)


def test_contacts_that_close_again_and_again_are_reported():
    """Check the warning about contacts that close repeatedly, with the default step. The first run has an error of 1 %
    and 35 openings. The second run has friction and as many openings.
    """
    chain, velocity = random_collision(64, 8)
    for friction, codes in ((0.0, ["returns"]), (1e-6, [])):
        run = solve(replace(chain, friction=friction), velocity, 0.3, "conserving", samples=2)
        assert [warning.code for warning in run.warnings] == codes
        assert sum(len(closed) - 1 for closed in run.contact_intervals) > 6


@pytest.mark.parametrize("contact", [hertz(1.0), power_law(1.0, 0.5), power_law(1.0, 0.1)])
@pytest.mark.parametrize("error", [1e-2, 1e-3])
def test_within_the_estimate_the_error_holds(contact, error):
    chain, velocity = one_on(2, contact), [1.0, 0.0, 0.0]
    truth = simulate(chain, velocity, tolerance=1e-10).final_velocity
    result = simulate(chain, velocity, method="verlet", step=stable_step(chain, velocity, error))
    # The documentation promises an accuracy "within a factor of a few".
    assert np.abs(result.final_velocity - truth).max() < 3 * error


def test_the_estimate_shrinks_with_the_error_and_with_the_mass():
    velocity = [1.0, 0.0, 0.0]
    for contact in (power_law(1.0, 0.1), draft_gear(1.0, 0.1), step_force(1.0)):
        chain = one_on(2, contact)
        assert stable_step(chain, velocity, 1e-4) < stable_step(chain, velocity, 1e-2)
        assert stable_step(one_on(2, contact, mass=0.1), velocity) < stable_step(chain, velocity)
