"""Tests of the scales of a chain: its default step, and the contacts that stay at overlap 0."""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, simulate
from softcradle.physics.contact import draft_gear, hertz, hooke, step_force
from softcradle.physics.scales import default_step, stays_touching

HARD, START = step_force(4800.0), [1.0, 0.0, 0.0, 0.0]
LAWS = [step_force(1.6), HARD, step_force(1.6)]


@pytest.mark.parametrize(
    ("chain", "velocity", "stays"),
    [
        (Chain([1.0] * 4, LAWS), START, [False, True, False]),
        (Chain([1.0] * 4, [hertz(100.0), draft_gear(1e5, 0.1), hertz(100.0)]), START, [False, True, False]),
        (Chain([1.0] * 3 + [math.inf], [hertz(100.0), HARD, HARD]), START, [False, True, True]),
        (Chain([1.0] * 4, [HARD, LAWS[0], HARD]), START, [False, False, False]),  # A bead hits the hard contact.
        # The beads of the hard contact collide with each other.
        (Chain([1.0] * 4, LAWS, gap=[0.0, 0.1, 0.0]), START, [False] * 3),
        # The beads of the hard contact approach each other from the start.
        (Chain([1.0] * 4, LAWS), [1.0, 1.0, 0.0, 0.0], [False] * 3),
        # The other contacts push with larger forces.
        (Chain([1.0] * 4, [hooke(1e9), HARD, hooke(1e9)]), START, [False] * 3),
        (Chain([1.0] * 4, LAWS, drive=[9e3, 0.0, 0.0, 0.0]), START, [False] * 3),
        (Chain([1.0] * 4, LAWS, friction=0.1), START, [False] * 3),
        # Moving walls can do any amount of work on the beads.
        (Chain([math.inf, 1.0, 1.0, math.inf], LAWS), START, [False] * 3),
        (Chain([1.0] * 4, HARD), [0.0] * 4, [False] * 3),
    ],
)
def test_contacts_that_stay_touching(chain, velocity, stays):
    assert stays_touching(chain, velocity).tolist() == stays
    if any(stays):
        found = simulate(chain, velocity, 5.0, samples=300)
        assert found.overlap[:, stays].max() <= 0.0


def test_a_contact_that_stays_touching_does_not_shorten_the_default_step():
    """Check a contact with a preload of 4.8 kN next to contacts with forces of 1.6 N. In an earlier version, the run
    took 1e7 steps.
    """
    chain = Chain([1.0] * 4, LAWS)
    # With explicit methods the hard contact chatters. In a live motion, a user can press the contact.
    assert default_step(chain, START) < 1e-6
    assert default_step(chain, START, touching=True) > 1e-4
    found = simulate(chain, START, method="conserving", samples=2)
    assert found.steps < 10_000
    assert not found.warnings
    truth = simulate(chain, START, samples=2)
    assert np.abs(found.final_velocity - truth.final_velocity).max() < 1e-4
