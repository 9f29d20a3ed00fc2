"""Many chains at once: the digits of one at a time, whatever the number of threads."""

import numpy as np
import pytest
from softcradle.physics import Chain, draft_gear, ensemble, hertz, one_on, power_law, simulate

CHAINS = [one_on(n, power_law(1.0, 1.0 / k)) for n in (1, 2, 4) for k in (3, 10)] + [
    Chain([1.0, 2.0, 0.5], [hertz(3.0), draft_gear(5.0, 0.2)], [0.1, 0.0]),
    one_on(3, draft_gear(770.0, 0.0177), mass=0.396),
]
STARTS = [[1.0] + [0.0] * chain.contacts for chain in CHAINS]


@pytest.mark.parametrize("method", ["accurate", "conserving"])
@pytest.mark.parametrize("workers", [1, 3, 16])
def test_each_chain_moves_as_it_would_alone(method, workers):
    found = ensemble(CHAINS, STARTS, method=method, tolerance=1e-6, workers=workers)
    assert len(found) == len(CHAINS)
    for chain, start, one in zip(CHAINS, STARTS, found, strict=True):
        alone = simulate(chain, start, method=method, tolerance=1e-6, samples=2)
        assert one.chain == chain
        assert np.array_equal(one.final_velocity, alone.final_velocity)
        assert one.contact_intervals == alone.contact_intervals
        assert (one.steps, one.evaluations) == (alone.steps, alone.evaluations)


def test_durations_and_steps_may_differ_from_chain_to_chain():
    durations, steps = np.linspace(0.5, 2.0, len(CHAINS)).tolist(), np.geomspace(1e-3, 1e-2, len(CHAINS)).tolist()
    for k, one in enumerate(ensemble(CHAINS, STARTS, durations, "conserving", steps)):
        alone = simulate(CHAINS[k], STARTS[k], durations[k], "conserving", steps[k], samples=2)
        assert np.array_equal(one.velocity, alone.velocity)
        assert one.time[-1] == durations[k]


def test_progress_counts_every_chain_once():
    told = []
    ensemble(CHAINS * 20, STARTS * 20, method="conserving", step=0.01, progress=told.append)
    assert sum(told) == 20 * len(CHAINS)
    assert len(told) > 5


def test_warnings_stay_on_their_trajectory(recwarn):
    """The step is past the limit on the draft gear; the chain beside it is well."""
    found = ensemble([CHAINS[-1], CHAINS[0]], [STARTS[-1], STARTS[0]], method="verlet", step=[1e-3, 1e-4])
    assert "past its limit" in str(found[0].warnings[0])
    assert not found[1].warnings
    assert not recwarn.list


def test_nothing_is_an_ensemble_too():
    assert ensemble([], []) == []


def test_the_reference_gives_the_same_digits_beside_itself():
    """Its dense solves keep to one thread of BLAS, a number that all runs of a process share."""
    chains = [Chain([1.0] * n, power_law(1.0, 0.3, loss=0.2)) for n in (2, 3, 4)]
    starts = [[1.0, *[0.0] * chain.contacts] for chain in chains]
    found = ensemble(chains, starts, method="scipy", tolerance=1e-5, workers=3)
    for chain, start, one in zip(chains, starts, found, strict=True):
        alone = simulate(chain, start, method="scipy", tolerance=1e-5, samples=2)
        assert np.array_equal(one.final_velocity, alone.final_velocity)
