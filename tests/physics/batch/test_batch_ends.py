"""The ends of very many chains: to the last digit those of `simulate`."""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, ChainBatch, Coupler, OwnLaw, TimedForce, ensemble_ends, one_on
from softcradle.physics.contact import hertz, hooke, power_law
from softcradle.physics.simulation import solve
from softcradle.physics.status import Status

from tests.helpers.random_chains import random_collision, random_dissipative

CHAINS = 40
STEP = 1e-2  # s: some chains chatter, some blow up


def chains_of(maker, contacts, count=CHAINS):
    """The first `count` random chains with so many contacts, and their start velocities."""
    found, seed = [], 0
    while len(found) < count:
        chain, velocity = maker(seed, 4)
        seed += 1
        if chain.contacts == contacts:
            found.append((chain, velocity))
    return [chain for chain, _ in found], np.array([velocity for _, velocity in found])


def require_same(chains, velocities, ends, **settings):
    for k, chain in enumerate(chains):
        own = {name: value[k] if isinstance(value, np.ndarray) else value for name, value in settings.items()}
        alone = solve(chain, velocities[k], samples=2, **own)
        assert np.array_equal(ends.final_velocity[k], alone.final_velocity), k
        assert np.array_equal(ends.velocity_error[k], alone.velocity_error, equal_nan=True), k
        assert (ends.status[k], ends.time[k]) == (alone.status, alone.time[-1]), k
        assert ends.steps[k] == alone.steps, k
        if "duration" not in own:  # a sample at the end evaluates contacts, too
            assert ends.evaluations[k] == alone.evaluations, k


@pytest.mark.parametrize("contacts", [1, 3, 4])
@pytest.mark.parametrize(
    ("method", "maker", "duration"),
    [(method, random_collision, None) for method in ("euler", "verlet", "yoshida4", "conserving")]
    + [(method, random_dissipative, 2.0) for method in ("euler", "verlet", "conserving")],
)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_collisions_and_chains_with_beds_losses_and_drives_end_as_they_would_alone(method, maker, duration, contacts):
    chains, velocities = chains_of(maker, contacts)
    assert maker is random_collision or any(chain.drive for chain in chains)
    settings = {"method": method, "step": STEP, **({"duration": duration} if duration else {})}
    require_same(chains, velocities, ensemble_ends(ChainBatch.of(chains), velocities, **settings), **settings)


@pytest.mark.parametrize("contacts", [1, 3])
def test_adaptive_methods_end_as_they_would_alone(contacts):
    """Some of these rattle, or errors grow in them: more than one run decides."""
    chains, velocities = chains_of(random_collision, contacts, 30)
    ends = ensemble_ends(ChainBatch.of(chains), velocities, tolerance=1e-6)
    require_same(chains, velocities, ends, tolerance=1e-6)
    chains, velocities = chains_of(random_dissipative, contacts, 12)
    ends = ensemble_ends(ChainBatch.of(chains), velocities, 2.0, tolerance=1e-6)
    require_same(chains, velocities, ends, duration=2.0, tolerance=1e-6)


def test_chains_that_rattle_end_as_they_would_alone():
    """Errors have grown in most of these, so more than one run decides, and some are not determined."""
    draw = np.random.default_rng(3)
    masses, exponents = np.exp(draw.uniform(-1, 1, (25, 6))), draw.uniform(0.02, 0.12, (25, 5))
    chains = [Chain(mass, [power_law(1.0, a) for a in few]) for mass, few in zip(masses, exponents, strict=True)]
    velocities = -np.sort(-draw.normal(size=(25, 6)))
    require_same(chains, velocities, ensemble_ends(ChainBatch.of(chains), velocities, tolerance=1e-6), tolerance=1e-6)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_default_steps_and_durations_are_those_of_each_chain():
    chains, velocities = chains_of(random_collision, 2, 20)
    durations = np.linspace(0.0, 1.0, len(chains))
    ends = ensemble_ends(ChainBatch.of(chains), velocities, durations, "verlet")
    require_same(chains, velocities, ends, duration=durations, method="verlet")
    pressed = [Chain([1.0, 1.0, 2.0], hertz(k), [-0.1, 0.2], friction=0.1) for k in (1.0, 2.0)]
    ends = ensemble_ends(ChainBatch.of(pressed), [1.0, 0.0, 0.0], method="verlet")
    require_same(pressed, [[1.0, 0.0, 0.0]] * 2, ends, method="verlet")


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_contact_that_no_step_shows_ends_a_chain_as_it_does_alone():
    chains = [Chain([1.0, 1.0], hooke(450.0), gap=gap) for gap in (0.43, 0.44, 3.0)]
    ends = ensemble_ends(ChainBatch.of(chains), [1.0, 0.0], method="verlet", step=0.1)
    require_same(chains, [[1.0, 0.0]] * 3, ends, method="verlet", step=0.1)
    assert (ends.status == Status.SEPARATED).all()
    assert ends.steps.max() < 50


def test_threads_and_neighbours_change_nothing_and_progress_counts_every_chain():
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
    assert (batch.chains, batch.contacts) == (CHAINS, 3)
    assert repr(batch) == "ChainBatch(40 chains of 3 contacts)"


ONES = np.ones((3, 3))
GEAR = Coupler(hooke(1.0), hooke(1.0))
BATCH = ChainBatch(ONES, 0.0, 1.0, 0.5)
REFUSED = {
    "couplers": (lambda: ChainBatch.of([Chain([1, 1], GEAR)]), "not couplers: take ensemble"),
    "own laws": (lambda: ChainBatch.of([Chain([1, 1], OwnLaw(lambda d: d))]), "not laws of your own: take ensemble"),
    "forces": (lambda: ChainBatch.of([Chain([1, 1], hertz(1), forces=TimedForce(0, [0, 1], [0, 1]))]), "forces over time"),
    "brakes": (lambda: ChainBatch.of([Chain([1, 1], hertz(1), brakes=TimedForce(0, 0, 1))]), "not brakes: take ensemble"),
    "lengths": (lambda: ChainBatch.of([one_on(1, hertz(1)), one_on(2, hertz(1))]), "of one length, not of 1 and 2"),
    "no chains": (lambda: ChainBatch.of([]), "at least one chain"),
    "one row": (lambda: ChainBatch([1, 1], 0, 1, 1), r"of shape \(chains, beads\), not \(2,\)"),
    "a shape": (lambda: ChainBatch(ONES, 0, [1, 2, 3, 4], 1), r"stiffness must fit the shape \(3, 2\)"),
    "no number": (lambda: ChainBatch(ONES, 0, math.nan, 1), "stiffness must be 0 or from 1e-30 to 1e"),
    "no force": (lambda: ChainBatch(ONES, 0, 0, 1), "would never push"),
    "an exponent": (lambda: ChainBatch(ONES, 0, 1, 11), "exponent must be from 1e-06 to 10, not 11.0"),
    "a mass": (lambda: ChainBatch(0 * ONES, 0, 1, 1), "every mass"),
    "two walls": (lambda: ChainBatch(math.inf * ONES, 0, 1, 1), "two walls side by side"),
    "a loss": (lambda: ChainBatch(ONES, 0, 1, 1, loss=1), "loss must be >= 0 and below 1, not 1.0"),
    "no batch": (lambda: ensemble_ends([one_on(2, hertz(1))], [1, 0, 0]), "batch must be a ChainBatch"),
    "auto": (lambda: ensemble_ends(BATCH, [1, 0, 0], method="auto"), "'auto' is for simulate"),
    "pymunk": (lambda: ensemble_ends(BATCH, [1, 0, 0], method="pymunk"), "not 'pymunk': take ensemble"),
    "a step": (lambda: ensemble_ends(BATCH, [1, 0, 0], step=1.0), "chooses its own steps"),
    "steps": (lambda: ensemble_ends(BATCH, [1, 0, 0], None, "verlet", [1, 2]), "3 chains need 3 steps or one"),
    "no step": (lambda: ensemble_ends(BATCH, [1, 0, 0], None, "verlet", 0.0), "every step must be a finite number > 0"),
    "a tolerance": (lambda: ensemble_ends(BATCH, [1, 0, 0], tolerance=0.0), "tolerance must be from 1e-16"),
    "velocities": (lambda: ensemble_ends(BATCH, [1, 0]), r"3 chains of 3 beads need velocities of shape \(3, 3\) or \(3,\)"),
    "a velocity": (lambda: ensemble_ends(BATCH, [1, 0, math.nan]), "every velocity must be a finite number"),
    "workers": (lambda: ensemble_ends(BATCH, [1, 0, 0], workers=0), "workers must be at least 1, not 0"),
    "friction": (
        lambda: ensemble_ends(ChainBatch(ONES, 0, 1, 1, friction=0.1), [1, 0, 0], method="yoshida4"), "carries neither bed"
    ),
    "a drive": (
        lambda: ensemble_ends(ChainBatch(ONES, 0, 1, 1, drive=[1, 0, 0]), [1, 0, 0]), "a driven chain may never come apart"
    ),
    "walls": (lambda: ensemble_ends(ChainBatch([[math.inf, 1, math.inf]], 0, 1, 1), [0, 1, 0]), "two walls may never come apart"),
    "a depth": (lambda: ensemble_ends(ChainBatch(ONES, 0, 1e-30, 1e-3), [1e30, 0, 0]), "would be pressed by about"),
}  # fmt: skip


@pytest.mark.parametrize(("wrong", "sentence"), REFUSED.values(), ids=REFUSED)
def test_what_no_batch_holds_is_refused_in_a_sentence(wrong, sentence):
    with pytest.raises(ValueError, match=sentence):
        wrong()
