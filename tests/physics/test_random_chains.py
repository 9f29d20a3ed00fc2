"""Relations that hold on any chain: up to 40 contacts of any kind, masses over 4 decades, gaps, a wall, 3 clusters."""

import math

import pytest
from hypothesis import assume, given, settings
from softcradle.physics import simulate
from softcradle.physics.scales import contact_scales, default_step

from tests.helpers import relations
from tests.helpers.random_chains import collisions
from tests.helpers.relations import FIXED_STEP, assert_momentum, assert_sound, simulate_quietly

# energy error of `conserving`, for the root of the steps: the worst of 12 800 random collisions had a third of it, half of
# them had 1e-15
ENERGY_ROUND_OFF = 1e-10
TOLERANCE = 1e-6
NEWTON = 2.5e-3  # of the tolerance: momentum that a step of radau may lose, for so much Newton's iteration leaves


@pytest.fixture(scope="module", autouse=True)
def few_steps():
    """Light beads between heavy ones may bounce thousands of times: a run that takes so long gives up here, and says so."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("softcradle.physics.reference.runner.MOST_PHASES", 200)
        patch.setattr("softcradle.physics.reference.phases.MOST_EVALUATIONS", 20_000)
        patch.setattr("softcradle.physics.adaptive.usual_budget.MOST_STEPS", 5_000)
        yield


@pytest.mark.parametrize("method", relations.LIVE, ids=lambda method: method.name)
@given(collisions())
@settings(max_examples=60)
def test_fixed_steps_keep_momentum_and_stay_finite(method, collision):
    """At their own default step; larger ones may blow up on stiff chains where the exponent is above 1."""
    chain, velocity = collision
    step = default_step(chain, velocity)
    found = simulate_quietly(chain, velocity, 3000 * step, method.name, samples=31)
    assert_sound(found)
    assert_momentum(found, velocity)


@pytest.mark.parametrize("parts", [3, 30, 1000])
@pytest.mark.parametrize("method", [m for m in FIXED_STEP if m.set_valued], ids=lambda method: method.name)
@given(collision=collisions())
@settings(max_examples=60)
def test_energy_is_exact_at_any_step(method, parts, collision):
    """To round-off, which light beads and steps of thousands of the shortest contact times multiply."""
    chain, velocity = collision
    step = float(contact_scales(chain, velocity)[1].max()) / parts
    found = simulate(chain, velocity, 3 * parts * step, method.name, step, samples=31)  # a warning is an error
    assert_sound(found)
    assert_momentum(found, velocity)
    assert relations.energy_error(found, velocity) < ENERGY_ROUND_OFF * math.sqrt(found.steps + 1)


@pytest.mark.slow
@pytest.mark.parametrize("method", [*relations.KERNELS, "scipy"])
@given(collision=collisions(most=8))
@settings(max_examples=30)
def test_adaptive_methods_end_with_the_beads_in_order(method, collision):
    """Or with a warning, as chains do whose light beads bounce thousands of times."""
    chain, velocity = collision
    # alone, dop853 is for contacts that are not soft: on others it takes steps in which they swing
    assume(method != "dop853" or all(contact.exponent >= 1.0 for contact in chain.contact))
    found = simulate_quietly(chain, velocity, None, method, tolerance=TOLERANCE, samples=31)
    assert_sound(found)
    if not found.warnings:
        assert_momentum(found, velocity, TOLERANCE * (1.0 + NEWTON * found.steps))
        assert relations.energy_error(found, velocity) < relations.MOST_ENERGY * TOLERANCE
        assert relations.separating(found.final_velocity, 10.0 * TOLERANCE * relations.closing_speed(velocity))
