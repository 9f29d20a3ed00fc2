"""Tests of ensembles and final states of many chains. The results must be bitwise equal to single runs, for any number
of threads.
"""

import itertools

import numpy as np
import pytest
from softcradle.physics import Chain, ChainBatch, ensemble, ensemble_ends, one_on
from softcradle.physics.contact import draft_gear, hertz, hooke, power_law
from softcradle.physics.simulation import solve

from tests.helpers.random_chains import random_collision, random_dissipative
from tests.helpers.relations import digits

CHAINS = [one_on(n, power_law(1.0, 1.0 / k)) for n in (1, 2, 4) for k in (3, 10)] + [
    Chain([1.0, 2.0, 0.5], [hertz(3.0), draft_gear(5.0, 0.2)], [0.1, 0.0]),
    Chain([1.0] * 4, power_law(1.0, 0.3, loss=0.2)),
    one_on(3, draft_gear(770.0, 0.0177), mass=0.396),
]
STARTS = [[1.0] + [0.0] * chain.contacts for chain in CHAINS]
COUNT = 40  # Number of random chains.
STEP = 1e-2  # Step [s]. With this step some chains chatter, and the energy of some chains grows without bound.


def chains_of(maker, contacts, count=COUNT):
    """Return the first `count` random chains with the given number of contacts, and the start velocities of their
    beads.
    """
    drawn = (maker(seed, 4) for seed in itertools.count())
    found = list(itertools.islice((one for one in drawn if one[0].contacts == contacts), count))
    return [chain for chain, _ in found], np.array([velocity for _, velocity in found])


def each_alone(chains, velocities, settings):
    """Yield a single run for each chain. The run uses the same settings as the ensemble uses for the chain."""
    for k, (chain, velocity) in enumerate(zip(chains, velocities, strict=True)):
        own = {name: np.broadcast_to(value, len(chains))[k].item() for name, value in settings.items()}
        yield solve(chain, velocity, samples=2, **own)


def rattling():
    """Return chains whose motions amplify errors. Most of these chains need more than one run, and the motion of some
    chains is not determined.
    """
    draw = np.random.default_rng(3)
    masses, exponents = np.exp(draw.uniform(-1, 1, (25, 6))), draw.uniform(0.02, 0.12, (25, 5))
    chains = [Chain(mass, [power_law(1.0, a) for a in few]) for mass, few in zip(masses, exponents, strict=True)]
    return chains, -np.sort(-draw.normal(size=(25, 6)))


# These contacts close and open within one step.
SHORT = [Chain([1.0, 1.0], hooke(450.0), gap=gap) for gap in (0.43, 0.44, 3.0)]
PRESSED = [Chain([1.0, 1.0, 2.0], hertz(k), [-0.1, 0.2], friction=0.1) for k in (1.0, 2.0)]
BATCHES = [  # Each entry contains chains and velocities, and the settings of the ensemble.
    *(
        (chains_of(random_collision, contacts), {"method": method, "step": STEP})
        for method in ("euler", "verlet", "yoshida4", "conserving") for contacts in (1, 3, 4)
    ),
    *(
        (chains_of(random_dissipative, contacts), {"method": method, "step": STEP, "duration": 2.0})
        for method in ("euler", "verlet", "conserving") for contacts in (1, 3, 4)
    ),
    *((chains_of(random_collision, contacts, 30), {"tolerance": 1e-6}) for contacts in (1, 3)),
    *((chains_of(random_dissipative, contacts, 12), {"duration": 2.0, "tolerance": 1e-6}) for contacts in (1, 3)),
    (rattling(), {"tolerance": 1e-6}),
    (chains_of(random_collision, 2, 20), {"duration": np.linspace(0.0, 1.0, 20), "method": "verlet"}),
    ((PRESSED, [[1.0, 0.0, 0.0]] * 2), {"method": "verlet"}),
    ((SHORT, [[1.0, 0.0]] * 3), {"method": "verlet", "step": 0.1}),
]  # fmt: skip


@pytest.mark.parametrize(("batch", "settings"), BATCHES)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_chains_end_as_they_would_alone(batch, settings):
    chains, velocities = batch
    ends = ensemble_ends(ChainBatch.of(chains), velocities, **settings)
    for k, alone in enumerate(each_alone(chains, velocities, settings)):
        assert np.array_equal(ends.final_velocity[k], alone.final_velocity), k
        assert np.array_equal(ends.velocity_error[k], alone.velocity_error, equal_nan=True), k
        assert (ends.status[k], ends.time[k]) == (alone.status, alone.time[-1]), k
        assert ends.steps[k] == alone.steps, k
        # A single run with a duration also evaluates the contacts for the sample at its end.
        if "duration" not in settings:
            assert ends.evaluations[k] == alone.evaluations, k


def test_threads_and_neighbours_change_no_result():
    exponents = np.linspace(0.3, 1.5, 1500)
    batch, told = ChainBatch(np.ones((1500, 4)), 0.0, 1.0, exponents[:, None]), []
    start = [1.0, 0.0, 0.0, 0.0]
    some = ensemble_ends(batch, start, method="verlet", step=1e-2, workers=3, progress=told.append)
    back = ChainBatch(np.ones((1500, 4)), 0.0, 1.0, exponents[::-1, None])
    other = ensemble_ends(back, start, method="verlet", step=1e-2, workers=1)
    assert np.array_equal(some.final_velocity, other.final_velocity[::-1])
    assert sum(told) == 1500
    assert len(told) > 2


def test_a_batch_is_its_chains():
    chains, _ = chains_of(random_dissipative, 3)
    batch = ChainBatch.of(chains)
    assert [batch.chain(k) for k in range(len(chains))] == chains
    assert (batch.chains, batch.contacts) == (COUNT, 3)
    assert repr(batch) == "ChainBatch(40 chains of 3 contacts)"


@pytest.mark.parametrize("workers", [1, 3, 16])
@pytest.mark.parametrize(
    "settings",
    [
        {"method": "accurate", "tolerance": 1e-6},
        {"method": "conserving"},
        {"method": "conserving", "duration": np.linspace(0.5, 2.0, 9), "step": np.geomspace(1e-3, 1e-2, 9)},
        {"method": "scipy", "tolerance": 1e-5, "duration": np.float32(0.5)},
    ],
)
def test_each_chain_moves_as_it_would_alone(settings, workers):
    """Compare an ensemble with single runs. The dense solver of the reference method uses one BLAS thread. All runs of
    a process share this setting.
    """
    found = ensemble(CHAINS, STARTS, **settings, workers=workers)
    assert [one.chain for one in found] == CHAINS
    for one, alone in zip(found, each_alone(CHAINS, STARTS, settings), strict=True):
        assert digits(one) == digits(alone)


def test_progress_counts_every_chain_once():
    told = []
    assert ensemble([], [], progress=told.append) == told == []
    ensemble(CHAINS * 20, STARTS * 20, method="conserving", step=0.01, progress=told.append)
    assert sum(told) == 20 * len(CHAINS)
    assert len(told) > 5


def test_warnings_stay_on_their_trajectory(recwarn):
    """Check that only the first chain causes a warning. The step of this chain is longer than the limit of the draft
    gear.
    """
    found = ensemble([CHAINS[-1], CHAINS[0]], [STARTS[-1], STARTS[0]], method="verlet", step=[1e-3, 1e-4])
    assert "past its limit" in str(found[0].warnings[0])
    assert not found[1].warnings
    assert not recwarn.list
