"""Steps that are much too long blow a motion up; what moves is then no number any more, but nothing ends in an exception."""

from __future__ import annotations

import numpy as np
import pytest
from softcradle.physics import Chain, State, advance, hooke, power_law


@pytest.mark.parametrize("contact", [hooke(1e9), power_law(1e6, 2.0)], ids=["hooke", "power law"])
def test_live_frames_go_on(contact):
    chain = Chain([1.0, 1.0, 1.0], contact, drive=[1.0, 0.0, -1.0])
    state = State.at_start(chain, [1.0, 0.0, 0.0])
    deepest = 0.0
    with np.errstate(all="ignore"):
        for _ in range(400):
            advance(chain, state, 1.0, "pymunk", step=0.1)
            deepest = max(deepest, float(np.nanmax(np.abs(state.overlap), initial=0.0)))
    assert deepest > 1e30 or not np.isfinite(state.overlap).all()
