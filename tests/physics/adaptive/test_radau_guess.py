"""Tests of the first guess for Newton's iteration in the method radau.

The guess extrapolates an overlap in one of three ways. The overlap is a power of the time since the contact closed, or
the beads fly freely, or a force pushes them.
"""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, Contact, draft_gear, hertz, hooke, power_law
from softcradle.physics.adaptive.constants import MOST_GUESSED, ROUND_OFF
from softcradle.physics.adaptive.radau import SHORT_EXPONENT, exp_near, first_guess, log_grown, time_since_onset
from softcradle.physics.adaptive.step_records import empty_trial
from softcradle.physics.numerics.law_curve import NODES
from softcradle.physics.numerics.records import FROZEN, LOADED, OPEN, TOUCHING

from tests.helpers.plain_kernels import only_plain, pressed, signed_force

pytestmark = only_plain
SOFT = power_law(2.0, 0.5)


def guessed(h, data, motion):
    trial = empty_trial(motion.rate.size)
    first_guess(h, data, motion, trial)
    return trial


def test_short_logarithms_are_accurate_enough_for_a_guess():
    """Check that four terms of the series of the logarithm are accurate enough, and that e**x has all digits."""
    for x in [*np.linspace(-1.0, 1.0, 41) * SHORT_EXPONENT, -0.7, -0.04, 0.04, 3.0]:
        left_out = 0.21 * abs(x) ** 5 if abs(x) < SHORT_EXPONENT else 0.0
        assert log_grown(x) == pytest.approx(math.log1p(x), rel=1e-15, abs=left_out)
        assert exp_near(x) == pytest.approx(math.exp(x), rel=5e-16, abs=0.0)
    assert log_grown(-1.5) == pytest.approx(math.log(ROUND_OFF))


def test_guesses():
    laws = [hooke(3.0), draft_gear(2.0, 0.4), SOFT]
    data, motion = pressed(Chain([1.0] * 4, laws), [0.5, 0.1, 0.2, 0.0], [0.2, 0.0, 0.25])
    motion.force[1], motion.mode[1] = 0.3, TOUCHING
    found = guessed(0.1, data, motion)
    flown = 0.2 + 0.1 * NODES * 0.4
    assert found.overlap[:, 0] == pytest.approx(flown)
    assert found.force[:, 0] == pytest.approx(3.0 * flown)
    assert (found.overlap[:, 1] == 0.0).all()
    assert (found.force[:, 1] == 0.3).all()
    motion.overlap[0], motion.force[0], motion.mode[:2] = -1.0, 0.0, (OPEN, FROZEN)
    found = guessed(0.1, data, motion)
    assert found.overlap[:, 0] == pytest.approx(-1.0 + 0.1 * NODES * 0.4)
    assert (found.force[:, 0] == 0.0).all()
    assert (found.force[:, 1] == 0.3).all()


def test_only_resting_contacts_without_preload_are_pushed():
    """Check a contact between two contacts that push, and a contact under an external force.

    The guess pushes a contact only if it is at rest at overlap 0 without a preload. Other contacts keep their rate. A
    soft contact with the overlap 1e-300 m keeps its overlap and force.
    """
    for law in (hooke(3.0), hertz(4.0), SOFT, Contact(1.0, 2.0, 0.5), draft_gear(2.0, 0.4)):
        for d, w in ((0.0, 0.3), (0.0, -0.3), (-0.1, 0.3), *([(0.0, 0.0)] if law.preload else [])):
            chain = Chain([1.0] * 4, [hertz(5.0), law, hertz(5.0)], drive=[0.0, 1.0, 0.0, 0.0])
            data, motion = pressed(chain, [0.0] * 4, [0.3, d, 0.3])
            flown = d + 0.1 * NODES * w
            first, *force = [signed_force(law.preload, law.stiffness, law.exponent, x) for x in (d, *flown)]
            motion.rate[1], motion.force[1] = w, first
            found = guessed(0.1, data, motion)
            assert found.overlap[:, 1] == pytest.approx(flown, abs=1e-15)
            assert found.force[:, 1] == pytest.approx(force)
    data, motion = pressed(Chain([1.0, 1.0], SOFT), [0.2, 0.0], [1e-300])
    motion.force[0] = 0.3
    found = guessed(0.1, data, motion)
    assert (found.overlap == 1e-300).all()
    assert (found.force == 0.3).all()


@pytest.mark.parametrize("preload", [0.0, 0.5])
@pytest.mark.parametrize("part", [0.99, 1.01])
def test_an_unloading_soft_contact_keeps_its_rate_if_its_force_is_small(preload, part):
    """Check an unloading contact next to a stronger contact. The unloading contact keeps its rate if it would open
    within two radians of its oscillation.
    """
    data, motion = pressed(Chain([1.0, 0.7, 1.3], [SOFT, Contact(preload, 2.0, 0.5)]), [0.0] * 3, [0.4, 0.01])
    frequency, h = math.sqrt((1.0 / 0.7 + 1.0 / 1.3) * 0.5 * 2.0 / math.sqrt(0.01)), 0.1
    motion.rate[:] = 0.8, -part * 0.5 * frequency * 0.01
    found = guessed(h, data, motion)
    own, paced = 0.01 + h * NODES * motion.rate[1], 0.01 * (1.0 + h * NODES / 0.5) ** (motion.rate[1] * 0.5 / 0.01)
    assert found.overlap[:, 1] == pytest.approx(own if part > 1.0 else paced, rel=1e-7)
    assert found.force[:, 1] == pytest.approx(preload + 2.0 * np.sqrt(found.overlap[:, 1]), rel=1e-12)


@pytest.mark.parametrize("h", [0.002, 0.2])
def test_a_soft_contact_goes_on_as_a_power_of_the_time_since_its_onset(h):
    """Check a soft contact that is driven from rest at t = 0 and has the overlap d = w t. The guess d (1 + h c/t) is
    then exact. The overlap of a neighbouring contact grows with another power of the time.
    """
    data, motion = pressed(Chain([1.0, 1.0, 1.0], SOFT), [1.0, 0.0, 0.0], [0.4, 0.01])
    motion.rate[:] = 0.8, 0.06  # The first contact closed 0.5 s ago. The overlap of the second contact grows as t**3.
    found = guessed(h, data, motion)
    part = 1.0 + h * NODES / 0.5
    assert found.overlap[:, 0] == pytest.approx(0.4 * part, rel=1e-9)
    assert found.overlap[:, 1] == pytest.approx(0.01 * part**3, rel=1e-9)
    assert found.force == pytest.approx(2.0 * np.sqrt(found.overlap), rel=1e-9)


def test_the_onset_belongs_to_the_contact_that_pushes_most():
    law = np.array([[0.0, 2.0, 0.5], [0.0, 2.0, 0.5], [0.0, 2.0, 1.5]])
    mode = np.full(3, LOADED)
    overlap, rate, force = np.array([0.01, 0.04, 0.5]), np.array([0.1, 0.2, 0.1]), np.array([0.2, 0.4, 0.7])
    assert time_since_onset(law, mode, overlap, rate, force) == pytest.approx(0.2)
    assert time_since_onset(law, mode, overlap, -rate, force) == pytest.approx(-0.2)
    assert time_since_onset(law, mode, overlap, np.array([0.1, 1.0, 0.1]), force) == pytest.approx(0.04)
    assert time_since_onset(law, mode, overlap, np.array([0.1, 0.0, 0.1]), force) == pytest.approx(0.1)
    assert time_since_onset(law, np.full(3, OPEN), overlap, rate, force) == 1e30
    # In these cases the third contact has the largest force. The function must ignore the third contact, because it is
    # not soft or does not overlap.
    for row, d in (([0.0, 2.0, 1.0], 0.5), ([0.8, 2.0, 0.5], 0.0), ([1.8, 2.0, 0.5], -0.5)):
        law[2], overlap[2] = row, d
        assert time_since_onset(law, mode, overlap, rate, force) == pytest.approx(0.2)


def test_a_soft_contact_that_will_be_apart_within_the_step_flies_there():
    for h in (2.0**-10, 2.0**-12):  # With the second value of h, the contact opens at the very end of the step.
        found = guessed(h, *pressed(Chain([1.0, 1.0], SOFT), [-0.5, 0.0], 2.0**-13))
        flown = 2.0**-13 - 0.5 * h * NODES
        apart = flown <= 0.0
        assert apart[2]
        assert found.overlap[:, 0] == pytest.approx(flown)
        assert (found.force[apart, 0] == 0.0).all()
        assert found.force[~apart, 0] == pytest.approx(2.0 * np.sqrt(flown[~apart]))
    # The second bead is light, so the contact force reverses the relative motion before the contact opens.
    found = guessed(1.0, *pressed(Chain([1.0, 1.0 / 9.0], SOFT), [-0.4, 0.0], 0.25))
    assert found.overlap[2, 0] == pytest.approx(0.25 * math.exp(-2.0 * MOST_GUESSED))
    # The guess reduces the part of the force above the preload at most to a third.
    found = guessed(1e-3, *pressed(Chain([1.0, 1.0], Contact(1.0, 2.0, 0.1)), [-9.0, 0.0], 1e-4))
    assert found.overlap[2, 0] == pytest.approx(1e-4 * math.exp(-10.0 * MOST_GUESSED))
    assert found.force[2, 0] == pytest.approx(1.0 + 2.0 * 1e-4**0.1 * math.exp(-MOST_GUESSED))
    # The guess increases the force of a loading contact at most by the same factor.
    found = guessed(0.2, *pressed(Chain([1.0, 1.0], SOFT), [100.0, 0.0], 0.25))
    assert found.force[:, 0] == pytest.approx(math.exp(MOST_GUESSED))
    assert found.overlap[:, 0] == pytest.approx(0.25 * math.exp(2.0 * MOST_GUESSED))


@pytest.mark.parametrize("first", [0, 2])
@pytest.mark.parametrize("h", [0.1, 10.0])
def test_contacts_at_rest_are_pushed_one_after_another(first, h):
    """Check a bead between a loaded contact and a contact at rest. The loaded contact is on its left or on its right.

    The guess moves the bead freely under the force of the loaded contact. The free motion ends when the other contact
    balances four fifths of this force.
    """
    data, motion = pressed(Chain([1.0, 2.0, 2.0, 1.0], hertz(5.0)), [0.0] * 4, 0.3 * np.eye(3)[first])
    found = guessed(h, data, motion)
    assert found.overlap[:, first] == pytest.approx(0.3)
    assert found.force[:, first] == pytest.approx(motion.force[first])
    for i, push in ((1, motion.force[first]), (2 - first, found.force[:, 1])):
        flown = np.minimum(0.5 * (h * NODES) ** 2 * 0.5 * push, (0.8 * push / 5.0) ** (1.0 / 1.5))
        assert found.overlap[:, i] == pytest.approx(flown)
        assert found.force[:, i] == pytest.approx(5.0 * flown**1.5)


def test_beads_at_rest_are_pushed_by_a_force_from_outside():
    for sign in (1.0, -1.0):
        chain = Chain([1.0, 3.0, 1.0], hertz(5.0), drive=[2.0 * sign, -3.0 * sign, 0.0])
        data, motion = pressed(chain, [0.0] * 3, 0.0)
        found = guessed(0.1, data._replace(knots=data.knots._replace(bend=np.array([7.0, -7.0, 7.0]))), motion)
        push = (2.0 + 1.0 + 0.1 * NODES * 7.0 * sign) / (1.0 + 1.0 / 3.0)
        flown = 0.5 * (0.1 * NODES) ** 2 * push / 3.0
        assert found.overlap[:, 0] == pytest.approx(flown if sign > 0.0 else 0.0)
        assert found.force[:, 0] == pytest.approx(5.0 * flown**1.5 if sign > 0.0 else 0.0)
