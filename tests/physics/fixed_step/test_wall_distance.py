"""Between two walls round-off does not add up: the distance of the walls stays, and with it the energy of a long run."""

from __future__ import annotations

import math

import pytest
from softcradle.physics import Chain, draft_gear, hertz, power_law

from tests.helpers.relations import simulate_quietly

BOX = [math.inf, 1.0, 2.0, 1.0, math.inf]


@pytest.mark.parametrize("law", [draft_gear(100.0, 0.05), hertz(100.0), power_law(10.0, 0.1)], ids=str)
def test_energy_and_the_distance_of_the_walls_over_a_hundred_thousand_steps(law):
    """Without this the energy of the gears was off by 3e-10 here, and by 3e-8 after ten times as many steps."""
    chain = Chain(BOX, law, gap=[0.02, 0.02, 0.02, 0.01])
    found = simulate_quietly(chain, [0.0, 1.0, 0.0, -0.3, 0.0], 3000.0, "conserving", step=0.03, samples=2)
    assert found.rate[-1].sum() == pytest.approx(0.0, abs=1e-15)
    assert found.overlap[-1].sum() == pytest.approx(found.overlap[0].sum(), abs=1e-15)
    assert found.ledger[-1] == pytest.approx(found.ledger[0], rel=2e-11)
