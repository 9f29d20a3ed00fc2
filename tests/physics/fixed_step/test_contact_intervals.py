"""Tests of closing and opening times of contacts in runs with fixed steps. The times must be within a few steps of the
reference times. The chains are random.
"""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, TimedForce, draft_gear, hertz, hooke, power_law, step_force
from softcradle.physics.status import Status

from tests.helpers.relations import simulate_quietly

STEPS = 2000  # Number of steps in the time in which the first bead crosses the largest gap.
# Allowed difference of a closing time, in steps per contact. With explicit steps, a push takes two steps to pass a
# contact.
SLACK = 2.5


def random_chain(seed: int) -> tuple[Chain, np.ndarray, float]:
    """Return a random chain with gaps in front of its inner contacts, its start velocities, and a duration. The
    duration is the time that a bead needs to cross the gaps twice.
    """
    draw = np.random.default_rng(seed)
    n = int(draw.integers(2, 6))
    gear = draft_gear(draw.uniform(50.0, 200.0), draw.uniform(0.01, 0.1))
    laws = [gear, hertz(200.0), hooke(100.0), power_law(5.0, 0.5)]
    kind = seed % 5
    contacts = [laws[kind if kind < 4 else int(draw.integers(4))] for _ in range(n)]
    gaps = np.where(draw.random(n) < 0.5, 0.0, draw.uniform(0.005, 0.05, n))
    gaps[0] = 0.0
    velocity = np.zeros(n + 1)
    velocity[0] = draw.uniform(0.5, 2.0)
    return Chain(draw.uniform(0.5, 2.0, n + 1), contacts, gaps), velocity, 0.1 / velocity[0] + 0.05


def first_closings(chain: Chain, velocity: np.ndarray, duration: float, method: str, step: float | None) -> np.ndarray:
    """Return the times [s] at which the contacts first close, as an array of shape (n,). The time is infinite for a
    contact that never closes.
    """
    found = simulate_quietly(chain, velocity, duration, method, step, samples=2)
    return np.array([intervals[0][0] if intervals else np.inf for intervals in found.contact_intervals])


@pytest.mark.parametrize("seed", [*range(20), *(pytest.param(k, marks=pytest.mark.slow) for k in range(20, 40))])
def test_first_closings_are_those_of_the_reference(seed):
    """Compare the first closing times with the reference.

    Explicit steps use a force of 0 at overlap 0, so contacts with a preload that start at overlap 0 close late. Chains
    with a preload are therefore tested only with the method conserving.
    """
    chain, velocity, duration = random_chain(seed)
    gears = any(contact.preload > 0.0 for contact in chain.contact)
    step = duration / STEPS
    slack = SLACK * chain.contacts * step
    exact = first_closings(chain, velocity, duration, "scipy", None)
    for method in ("conserving",) if gears else ("conserving", "verlet", "euler"):
        found = first_closings(chain, velocity, duration, method, step)
        both = np.isfinite(exact) & np.isfinite(found)
        assert (both == np.isfinite(exact))[~(exact > duration - slack)].all(), method
        assert np.abs(found[both] - exact[both]).max(initial=0.0) <= slack, method


STIFF = 450.0  # Stiffness [N/m]. Two beads of 1 kg are in contact for about one step of 0.1 s.
GAP = 0.43  # Gap [m]. At a speed of 1 m/s the contact closes and opens between the two ends of one step.
CHAINS = {
    "free": Chain([1.0, 1.0], hooke(STIFF), gap=GAP),
    "one bead brakes": Chain([1.0, 1.0], hooke(STIFF), gap=GAP, brakes=TimedForce(0, 0.0, 1e-3)),
    "long": Chain([1.0] * 80, hooke(STIFF), gap=[GAP] + [1.0] * 78),
}


@pytest.mark.parametrize("chain", CHAINS.values(), ids=CHAINS)
def test_a_run_ends_soon_after_a_contact_that_no_step_shows(chain):
    ahead = [1.0] * (chain.contacts - 1)  # The bead that is hit does not reach the beads behind it.
    found = simulate_quietly(chain, [1.0, 0.0, *ahead], method="verlet", step=0.1, samples=2)
    assert found.final_velocity[0] < 0.5  # The first bead has hit the second bead.
    assert found.contact_intervals[0] == ()
    assert found.status == Status.SEPARATED
    assert found.steps <= 20  # The first bead reaches the contact in five steps. Afterwards the beads separate.


def test_endless_flights_are_ended():
    """Check beads that separate at speeds of the size of round-off after many bounces. Without a limit, the beads would
    separate for 1e18 steps and then meet again.
    """
    masses = [30.302047757650957, 0.06879557626047945, 33.32308902031443, 5.314720953392335]
    chain = Chain(masses, step_force(3.477215654725435))
    start = [-0.14915296, -0.14915296, -0.43683214, -0.43683214]
    found = simulate_quietly(chain, start, method="verlet", step=1e-2, samples=2)
    assert found.final_velocity @ masses == pytest.approx(sum(m * v for m, v in zip(masses, start, strict=True)))
    assert 0 < found.steps < 2**63


@pytest.mark.parametrize("law", [draft_gear(100.0, 0.05), hertz(100.0), hooke(1.0), power_law(10.0, 0.1)], ids=str)
def test_energy_is_conserved_over_a_hundred_thousand_steps(law):
    """Check the correction of round-off in the energy. Without the correction, the energy of the draft gears had an
    error of 3e-10. After ten times as many steps, the error was 3e-8.
    """
    chain = Chain([math.inf, 1.0, 2.0, 1.0, math.inf], law, gap=[0.02, 0.02, 0.02, 0.01])
    found = simulate_quietly(chain, [0.0, 1.0, 0.0, -0.3, 0.0], 3000.0, "conserving", step=0.03, samples=2)
    assert found.rate[-1].sum() == pytest.approx(0.0, abs=1e-15)
    assert found.overlap[-1].sum() == pytest.approx(found.overlap[0].sum(), abs=1e-15)
    assert found.ledger[-1] == pytest.approx(found.ledger[0], rel=2e-11)
