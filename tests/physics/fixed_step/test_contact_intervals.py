"""When contacts close and open under fixed steps: within a few steps of where the reference locates it, on random chains."""

from __future__ import annotations

import numpy as np
import pytest
from softcradle.physics import Chain, draft_gear, hertz, hooke, power_law, simulate

STEPS = 2000  # to the crossing of the largest gap
SLACK = 2.5  # steps a contact by which a time may differ: in explicit steps a push passes one contact in two steps


def test_a_contact_that_touches_later_is_not_closed_from_the_start_of_the_run():
    """Steps are taken in runs until a contact switches; its time belongs to the last step of the run, not to the first."""
    chain = Chain([1] * 4, draft_gear(100, 0.05), gap=[0, 0.02, 0])
    found = simulate(chain, [1, 0, 0, 0], method="conserving", step=1e-3, samples=2)
    (closed, _), *_ = found.contact_intervals[2]
    assert closed == pytest.approx(0.076, abs=1.5e-3)


def random_chain(seed: int) -> tuple[Chain, np.ndarray, float]:
    """A chain with gaps before its inner contacts, its start velocities, and a duration of two crossings of its gaps."""
    draw = np.random.default_rng(seed)
    n = int(draw.integers(2, 6))
    laws = [
        draft_gear(draw.uniform(50.0, 200.0), draw.uniform(0.01, 0.1)),
        hertz(200.0),
        hooke(100.0),
        power_law(5.0, 0.5),
    ]
    kind = seed % 5
    contacts = [laws[kind if kind < 4 else int(draw.integers(4))] for _ in range(n)]
    gaps = np.where(draw.random(n) < 0.5, 0.0, draw.uniform(0.005, 0.05, n))
    gaps[0] = 0.0
    velocity = np.zeros(n + 1)
    velocity[0] = draw.uniform(0.5, 2.0)
    return Chain(draw.uniform(0.5, 2.0, n + 1), contacts, gaps), velocity, 0.1 / velocity[0] + 0.05


def first_closings(chain: Chain, velocity: np.ndarray, duration: float, method: str, step: float | None) -> np.ndarray:
    """(n,) when each contact first closes [s]; inf where it does not."""
    found = simulate(chain, velocity, duration, method, step, samples=2)
    return np.array([intervals[0][0] if intervals else np.inf for intervals in found.contact_intervals])


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_first_closings_are_those_of_the_reference(seed):
    """An explicit step takes no force at overlap 0: with a preload, what touches closes late."""
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
