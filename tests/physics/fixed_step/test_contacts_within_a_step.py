"""A contact that closes and opens within one explicit step leaves no flag: the run looks up after its flight all the same."""

from __future__ import annotations

import pytest
from softcradle.physics import Chain, TimedForce, hooke, simulate
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
