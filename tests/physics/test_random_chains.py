"""Relations that hold on any chain: up to 40 contacts of any kind, masses over 4 decades, gaps, a wall, 3 clusters."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest
import softcradle.physics.adaptive.runner
import softcradle.physics.reference.phases
import softcradle.physics.reference.runner
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from softcradle.physics import Chain, Contact, draft_gear, hertz, hooke, power_law, simulate, step_force
from softcradle.physics.scales import contact_scales, default_step

from tests.helpers.relations import (
    ADAPTIVE,
    EPSILON,
    FIXED_STEP,
    LIVE,
    SET_VALUED,
    kinetic_energy,
    momentum,
    momentum_scale,
    separating,
)

LAWS = (
    lambda draw: power_law(draw(), 1 / 14),
    lambda draw: power_law(draw(), 0.1 * draw() ** 0.5),
    lambda draw: hooke(draw()),
    lambda draw: hertz(draw()),
    lambda draw: step_force(draw()),
    lambda draw: draft_gear(draw(), 0.1 * draw()),
    lambda draw: Contact(draw(), draw(), min(3.0, 0.3 * draw())),
    lambda draw: Contact(0.0, draw(), min(3.0, 0.5 * draw())),
)


def random_collision(seed, most):
    """(chain, velocity): up to three clusters, each of one velocity, or every bead its own; at most one wall.

    From a seed, because lists drawn by hypothesis repeat themselves and mostly fly apart.
    """
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, most + 1))

    def strength():
        return float(10.0 ** rng.uniform(-1, 1))

    def law():
        return LAWS[rng.integers(len(LAWS))](strength)

    mass = 10.0 ** rng.uniform(-2, 2, n + 1) if rng.random() < 0.5 else np.full(n + 1, strength())
    contacts = law() if rng.random() < 0.5 else [law() for _ in range(n)]
    cluster = np.sort(rng.integers(0, 3, n + 1))
    fastest_first = -np.sort(-rng.uniform(-1, 1, 3))
    velocity = fastest_first[cluster] if rng.random() < 0.7 else rng.uniform(-1, 1, n + 1)
    gap = np.where(np.diff(cluster) > 0, rng.choice([0.0, 0.1, 1.0], n), 0.0)
    if rng.random() < 0.3:
        wall = int(rng.choice([0, n]))
        mass[wall], velocity[wall] = math.inf, 0.0
    return Chain(mass, contacts, gap), velocity


def collisions(most=40):
    return st.integers(0, 2**32 - 1).map(lambda seed: random_collision(seed, most))


def closing(velocity):
    return float(np.ptp(velocity)) or 1.0


def resting_wall(chain):
    return chain.walls > 0


def energy_error(found, velocity):
    """Largest error of the energy over the run, relative to the kinetic energy that there was to exchange."""
    energy = found.kinetic_energy + found.contact_energy
    scale = kinetic_energy(found.chain, np.abs(velocity)) or 1.0
    return float(np.abs(energy - energy[0]).max()) / scale


def assert_momentum(found, velocity, tolerance=0.0):
    """To round-off; to the tolerance in adaptive methods, where a contact that arrives slower than that comes to rest."""
    if resting_wall(found.chain):
        return
    before = momentum(found.chain, velocity)
    scale = max(momentum_scale(found.chain, row) for row in found.velocity)
    # velocities are sums over the row, and rounding errors add up over the steps as a random walk
    round_off = 1000 * EPSILON * math.sqrt(found.steps + 1) * (found.chain.contacts + 1) * scale
    assert abs(momentum(found.chain, found.final_velocity) - before) < round_off + 10 * tolerance * scale
    assert np.abs(found.momentum - before).max() < round_off + 10 * tolerance * scale


def assert_sane(found):
    for array in (found.position, found.velocity, found.overlap, found.force, found.final_velocity):
        assert np.isfinite(array).all()
    for intervals in found.contact_intervals:
        times = [time for interval in intervals for time in interval]
        assert times == sorted(times)
    assert (found.force >= 0.0).all()  # contacts only push


def run(*arguments, **options):
    """simulate, in which a run that gives up says so in `warnings` alone."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return simulate(*arguments, **options)


@pytest.fixture(scope="module", autouse=True)
def patience():
    """Light beads between heavy ones may bounce thousands of times; the reference need not follow all of them here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(softcradle.physics.reference.runner, "MOST_PHASES", 200)
        patch.setattr(softcradle.physics.reference.phases, "MOST_EVALUATIONS", 20_000)
        patch.setattr(softcradle.physics.adaptive.runner, "MOST_STEPS", 5_000)
        yield


@pytest.mark.parametrize("method", LIVE, ids=lambda method: method.name)
@given(collisions())
@settings(max_examples=60)
def test_fixed_steps_keep_momentum_and_stay_finite(method, collision):
    """At their own default step; larger ones may blow up on stiff chains where the exponent is above 1."""
    chain, velocity = collision
    step = default_step(chain, velocity)
    found = run(chain, velocity, 3000 * step, method.name, samples=31)
    assert_sane(found)
    assert_momentum(found, velocity)


@pytest.mark.parametrize("parts", [3, 30, 1000])
@pytest.mark.parametrize("method", [m for m in FIXED_STEP if m.set_valued], ids=lambda method: method.name)
@given(collision=collisions())
@settings(max_examples=60)
def test_exact_energy_at_any_step(method, parts, collision):
    chain, velocity = collision
    step = float(contact_scales(chain, velocity)[1].max()) / parts
    found = simulate(chain, velocity, 3 * parts * step, method.name, step, samples=31)  # a warning is an error
    assert_sane(found)
    assert_momentum(found, velocity)
    assert energy_error(found, velocity) < 1e-11


@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda method: method.name)
@given(collision=collisions(most=8))
@settings(max_examples=30)
def test_adaptive_methods_end_with_the_beads_in_order(method, collision):
    chain, velocity = collision
    # alone, dop853 is for contacts that are not soft: on others it takes steps in which they swing
    assume(method.name != "dop853" or all(contact.exponent >= 1.0 for contact in chain.contact))
    found = run(chain, velocity, None, method.name, tolerance=1e-6, samples=31)
    assert_sane(found)
    # every step of radau leaves what Newton leaves, 2.5e-3 of the tolerance, and a rattle takes thousands of them
    assert_momentum(found, velocity, tolerance=1e-6 * (1.0 + 2.5e-3 * found.steps))
    if not found.warnings:  # a chain whose light beads bounce thousands of times may be given up or off, and says so
        assert energy_error(found, velocity) < 1e-5
        assert separating(found.final_velocity, 1e-5 * closing(velocity))


@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda method: method.name)
@given(collision=collisions(most=5))
@settings(max_examples=25)
def test_adaptive_methods_agree_with_themselves(method, collision):
    """Two tolerances give one motion, over a time in which round-off is not yet the seed of another."""
    chain, velocity = collision
    end = float(contact_scales(chain, velocity)[1].min())
    one, other = (run(chain, velocity, end, method.name, tolerance=tol, samples=9) for tol in (1e-5, 1e-7))
    if not (one.warnings or other.warnings):
        assert np.abs(one.velocity - other.velocity).max() < 1e-3 * closing(velocity)


@pytest.mark.parametrize("method", SET_VALUED, ids=lambda method: method.name)
@given(collision=collisions(most=5))
@settings(max_examples=25)
def test_set_valued_methods_agree_with_the_reference(method, collision):
    chain, velocity = collision
    end = float(contact_scales(chain, velocity)[1].min())
    exact = run(chain, velocity, end, "scipy", tolerance=1e-6, samples=9)
    fine = {"tolerance": 1e-7} if method.adaptive else {"step": end / 20000}
    found = run(chain, velocity, end, method.name, samples=9, **fine)
    if not (exact.warnings or found.warnings):
        assert np.abs(found.velocity - exact.velocity).max() < 3e-3 * closing(velocity)
