"""A row of one's own, the example of the documentation: a segment more, nothing else."""

import math

import pytest

from examples.largest_force import LargestForce
from softcradle import Chain, draft_gear, simulate


@pytest.mark.parametrize("method", ["accurate", "radau", "dop853"])
def test_a_contact_with_a_largest_force_against_its_closed_form(method):
    """A bead thrown at a wall: a preloaded spring to the largest force, then a steady one; way, time and velocity are exact."""
    preload, stiffness, most, speed = 0.2, 2.0, 1.0, 2.0
    crush = LargestForce(draft_gear(stiffness, preload / stiffness), most=most)
    way = (most - preload) / stiffness
    at_yield = math.sqrt(speed**2 - 2.0 * preload * way - stiffness * way**2)
    swing, begin = math.sqrt(stiffness), preload / stiffness
    first = (math.atan2(swing * (way + begin), at_yield) - math.atan2(swing * begin, speed)) / swing
    turn = first + at_yield / most
    found = simulate(Chain([1.0, math.inf], crush), [speed, 0.0], 2.5 * turn, method, tolerance=1e-10, samples=[turn])
    assert found.overlap[0, 0] == pytest.approx(way + at_yield**2 / 2.0 / most, abs=1e-8)
    assert found.force[0, 0] == pytest.approx(most, abs=1e-12)
    assert found.velocity[0, 0] == pytest.approx(0.0, abs=1e-8)
    assert found.final_velocity[0] == pytest.approx(-speed, abs=1e-8)
    ((closed, opened),) = found.contact_intervals[0]
    assert (closed, opened) == (0.0, pytest.approx(2.0 * turn, abs=1e-8))
    assert found.ledger == pytest.approx(found.ledger[0], abs=1e-8)
