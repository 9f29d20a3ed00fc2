"""A contact that closes and opens within one explicit step leaves no flag: the run looks up after its flight all the same."""

from __future__ import annotations

import pytest
from softcradle.physics import Chain, TimedForce, hooke, simulate, step_force
from softcradle.physics.status import Status

STEP = 0.1  # s
STIFF = 450.0  # N/m: two beads of 1 kg are in contact for about a step
GAP = 0.43  # m: at 1 m/s the contact closes and opens between two ends of steps
MOST = 20  # steps that a run may take: it flies to the contact in five, and is apart again

CHAINS = {
    "free": Chain([1.0, 1.0], hooke(STIFF), gap=GAP),
    "one bead brakes": Chain([1.0, 1.0], hooke(STIFF), gap=GAP, brakes=TimedForce(0, 0.0, 1e-3)),
    "long": Chain([1.0] * 80, hooke(STIFF), gap=[GAP] + [1.0] * 78),
}


@pytest.mark.parametrize("chain", CHAINS.values(), ids=CHAINS)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_run_ends_soon_after_a_contact_that_no_step_shows(chain):
    ahead = [1.0] * (chain.contacts - 1)  # the beads beyond, which nobody reaches
    found = simulate(chain, [1.0, 0.0, *ahead], method="verlet", step=STEP, samples=2)
    assert found.final_velocity[0] < 0.5  # it has struck
    assert found.contact_intervals[0] == ()
    assert found.status == Status.SEPARATED
    assert found.steps <= MOST


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_flights_end_where_their_steps_are_no_longer_counted():
    """Chatter leaves these beads with rates of round-off, by which they part for 1e18 steps and would meet again."""
    masses = [30.302047757650957, 0.06879557626047945, 33.32308902031443, 5.314720953392335]
    chain = Chain(masses, step_force(3.477215654725435))
    start = [-0.14915296, -0.14915296, -0.43683214, -0.43683214]
    found = simulate(chain, start, method="verlet", step=1e-2, samples=2)
    assert found.final_velocity @ masses == pytest.approx(sum(m * v for m, v in zip(masses, start, strict=True)))
    assert 0 < found.steps < 2**63
