"""The stages that Newton's iteration of radau begins from: powers of a time, flights and pushes."""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, Contact, State, draft_gear, hertz, hooke, power_law
from softcradle.physics.adaptive.constants import MOST_GUESSED
from softcradle.physics.adaptive.radau import first_guess, set_pushed, time_since_onset
from softcradle.physics.adaptive.step_records import empty_trial
from softcradle.physics.numerics.law_curve import NODES
from softcradle.physics.numerics.records import FROZEN, LOADED, OPEN, TOUCHING

from tests.helpers.plain_kernels import only_plain, records_of

pytestmark = only_plain
SOFT = power_law(2.0, 0.5)


def guessed(chain, state, mode, h):
    data, _, motion = records_of(chain, state)
    motion.mode[:] = mode
    trial = empty_trial(chain.contacts)
    first_guess(h, data, motion, trial)
    return trial


def pressed(chain, velocity, overlap):
    """A chain whose contacts have these overlaps, with the forces that their laws give them."""
    state = State.at_start(chain, velocity)
    state.overlap[:] = overlap
    state.force[:] = [law.force(d) for law, d in zip(chain.contact, state.overlap, strict=True)]
    return chain, state


def test_guesses():
    laws = [hooke(3.0), draft_gear(2.0, 0.4), SOFT]
    chain, state = pressed(Chain([1.0] * 4, laws), [0.5, 0.1, 0.2, 0.0], [0.2, 0.0, 0.25])
    state.force[1] = 0.3
    found = guessed(chain, state, [LOADED, TOUCHING, LOADED], 0.1)
    flown = 0.2 + 0.1 * NODES * 0.4
    assert found.overlap[:, 0] == pytest.approx(flown)
    assert found.force[:, 0] == pytest.approx(3.0 * flown)
    assert (found.overlap[:, 1] == 0.0).all()
    assert (found.force[:, 1] == 0.3).all()
    state.overlap[0], state.force[0] = -1.0, 0.0
    found = guessed(chain, state, [OPEN, FROZEN, LOADED], 0.1)
    assert found.overlap[:, 0] == pytest.approx(-1.0 + 0.1 * NODES * 0.4)
    assert (found.force[:, 0] == 0.0).all()
    assert (found.force[:, 1] == 0.3).all()


def test_a_soft_contact_goes_on_as_a_power_of_the_time_since_its_onset():
    """Driven alone from rest at t = 0, d = w t: the guess is d (1 + h c/t), exact; one that it pushes has its own growth."""
    chain, state = pressed(Chain([1.0, 1.0, 1.0], SOFT), [1.0, 0.0, 0.0], [0.4, 0.01])
    state.rate[:] = 0.8, 0.06  # onset 0.5 s ago; the second grows as t**3
    found = guessed(chain, state, [LOADED, LOADED], 0.2)
    part = 1.0 + 0.2 * NODES / 0.5
    assert found.overlap[:, 0] == pytest.approx(0.4 * part)
    assert found.overlap[:, 1] == pytest.approx(0.01 * part**3)
    assert found.force == pytest.approx(2.0 * np.sqrt(found.overlap))


def test_a_contact_at_rest_is_pushed_by_its_neighbour():
    force, overlap = np.zeros((3, 2)), np.zeros((3, 2))
    chain = Chain([1.0, 0.25, 1.0], SOFT)
    data, _, _ = records_of(chain, State.at_start(chain, [0.0, 0.0, 0.0]))
    set_pushed(0.1, data, 1, 1, 1, 3.0, overlap, force)
    flown = 0.5 * (0.1 * NODES[1]) ** 2 * 4.0 * 3.0
    assert force[1, 1] == pytest.approx(2.0 * math.sqrt(flown))
    assert overlap[1, 1] == pytest.approx(flown)
    set_pushed(10.0, data, 1, 2, 1, 3.0, overlap, force)
    assert force[2, 1] == pytest.approx(2.4)
    assert overlap[2, 1] == pytest.approx(1.44)
    set_pushed(10.0, data, 1, 0, 1, 0.0, overlap, force)
    assert force[0, 1] == 0.0


def test_the_onset_is_that_of_the_contact_that_pushes_most_however_little():
    law = np.array([[0.0, 2.0, 0.5], [0.0, 2.0, 0.5], [0.0, 2.0, 1.5]])
    mode = np.full(3, LOADED)
    overlap, rate, force = np.array([0.01, 0.04, 0.5]), np.array([0.1, 0.2, 0.1]), np.array([0.2, 0.4, 0.7])
    assert time_since_onset(law, mode, overlap, rate, force) == pytest.approx(0.2)
    assert time_since_onset(law, mode, overlap, -rate, force) == pytest.approx(-0.2)
    assert time_since_onset(law, mode, overlap, np.array([0.1, 1.0, 0.1]), force) == pytest.approx(0.04)
    assert time_since_onset(law, mode, overlap, np.array([0.1, 0.0, 0.1]), force) == pytest.approx(0.1)
    assert time_since_onset(law, np.full(3, OPEN), overlap, rate, force) == 1e30


def test_a_soft_contact_that_will_be_apart_within_the_step_flies_there():
    found = guessed(*pressed(Chain([1.0, 1.0], SOFT), [-0.45, 0.0], 1e-4), [LOADED], 1e-3)
    flown = 1e-4 - 0.45e-3 * NODES
    apart = flown <= 0.0
    assert found.overlap[:, 0] == pytest.approx(flown)
    assert (found.force[apart, 0] == 0.0).all()
    assert found.force[~apart, 0] == pytest.approx(2.0 * np.sqrt(flown[~apart]))
    # the force of a light bead turns it before the contact opens
    found = guessed(*pressed(Chain([1.0, 1.0 / 9.0], SOFT), [-0.4, 0.0], 0.25), [LOADED], 1.0)
    assert found.overlap[2, 0] == pytest.approx(0.25 * math.exp(-2.0 * MOST_GUESSED))
    # the force above a preload falls to a third, no further
    found = guessed(*pressed(Chain([1.0, 1.0], Contact(1.0, 2.0, 0.1)), [-9.0, 0.0], 1e-4), [LOADED], 1e-3)
    assert found.overlap[2, 0] == pytest.approx(1e-4 * math.exp(-10.0 * MOST_GUESSED))
    assert found.force[2, 0] == pytest.approx(1.0 + 2.0 * 1e-4**0.1 * math.exp(-MOST_GUESSED))


def test_a_guessed_force_grows_so_much_at_the_most():
    found = guessed(*pressed(Chain([1.0, 1.0], SOFT), [100.0, 0.0], 0.25), [LOADED], 0.2)
    assert found.force[:, 0] == pytest.approx(math.exp(MOST_GUESSED))
    assert found.overlap[:, 0] == pytest.approx(0.25 * math.exp(2.0 * MOST_GUESSED))


@pytest.mark.parametrize("first", [0, 2])
def test_contacts_at_rest_are_pushed_one_after_another(first):
    """The bead between two contacts flies under the force of the one that is loaded, from the left or from the right."""
    chain, state = pressed(Chain([1.0, 2.0, 2.0, 1.0], hertz(5.0)), [0.0] * 4, 0.3 * np.eye(3)[first])
    h = 0.1
    found = guessed(chain, state, [LOADED] * 3, h)
    loaded = state.force[first]
    assert found.overlap[:, first] == pytest.approx(0.3)
    assert found.force[:, first] == pytest.approx(loaded)
    flown = 0.5 * (h * NODES) ** 2 * 0.5 * loaded
    assert found.overlap[:, 1] == pytest.approx(flown)
    assert found.force[:, 1] == pytest.approx(5.0 * flown**1.5)
    further = 0.5 * (h * NODES) ** 2 * 0.5 * found.force[:, 1]
    assert found.overlap[:, 2 - first] == pytest.approx(further)


def test_beads_at_rest_are_pushed_by_a_force_from_outside():
    for sign in (1.0, -1.0):
        chain = Chain([1.0, 3.0, 1.0], hertz(5.0), drive=[2.0 * sign, -3.0 * sign, 0.0])
        found = guessed(chain, State.at_start(chain, [0.0] * 3), [LOADED] * 2, 0.1)
        push = (2.0 + 1.0) / (1.0 + 1.0 / 3.0)
        flown = 0.5 * (0.1 * NODES) ** 2 * push / 3.0
        assert found.overlap[:, 0] == pytest.approx(flown if sign > 0.0 else 0.0)
        assert found.force[:, 0] == pytest.approx(5.0 * flown**1.5 if sign > 0.0 else 0.0)
