"""What is decided at a switch: accelerations and forces, by the conditions that define them; a contact that comes to rest."""

import numpy as np
import pytest
from softcradle.physics import Chain, State, hertz, power_law
from softcradle.physics.adaptive.corner_action import stop_rate
from softcradle.physics.adaptive.yield_or_slip import balance
from softcradle.physics.numerics.records import LOADED, TOUCHING

from tests.helpers.plain_kernels import only_plain, records_of

pytestmark = only_plain


def random_rows(seed):
    draw = np.random.default_rng(seed)
    n = int(draw.integers(1, 9))
    inverse_mass = 10.0 ** draw.uniform(-1, 1, n + 1)
    inverse_mass[draw.random(n + 1) < 0.15] = 0.0
    load = draw.normal(size=n + 1) * draw.integers(0, 2, n + 1)
    give = np.where((draw.random(n + 1) < 0.5) & (inverse_mass > 0.0), draw.uniform(0, 1, n + 1), 0.0)
    low = np.where(draw.random(n) < 0.5, 0.0, draw.uniform(0, 1, n))
    high = low + np.where(draw.random(n) < 0.7, draw.uniform(0, 1, n), 0.0)
    return inverse_mass, load, give, low, high


@pytest.mark.parametrize("first", range(0, 2000, 100))
def test_the_conditions_of_a_bounded_multiplier_hold(first):
    for seed in range(first, first + 100):
        inverse_mass, load, give, low, high = random_rows(seed)
        n = low.size
        a, f = np.zeros(n + 1), np.zeros(n)
        balance(inverse_mass, load, give, low, high, a, f, np.zeros((2, n + 1)), np.zeros((2, 4 * n + 8)))
        assert ((low <= f) & (f <= high)).all()
        assert (f[a[:-1] > a[1:]] == high[a[:-1] > a[1:]]).all()  # pressed together: all they can carry
        assert (f[a[:-1] < a[1:]] == low[a[:-1] < a[1:]]).all()  # drawn apart: the least
        assert (a[inverse_mass == 0.0] == 0.0).all()
        net = load - np.append(f, 0.0) + np.append(0.0, f)
        slides = a != 0.0
        rests = ~slides & (inverse_mass > 0.0)
        assert (np.abs(net[rests]) <= give[rests] + 1e-12).all()
        inertia = a[slides] / inverse_mass[slides]
        lacks = net[slides] - inertia - np.sign(a[slides]) * give[slides]
        assert (np.abs(lacks) <= 1e-9 * (1.0 + np.abs(inertia))).all()


def test_beads_that_move_as_one_have_equal_accelerations():
    """Three beads behind a wall of force: a push of 1 N on the first, multipliers up to 2 N between them."""
    a, f = np.zeros(3), np.zeros(2)
    low, high = np.zeros(2), np.full(2, 2.0)
    balance(np.ones(3), np.array([1.0, 0.0, 0.0]), np.zeros(3), low, high, a, f, np.zeros((2, 3)), np.zeros((2, 16)))
    assert a[0] == a[1] == a[2] == pytest.approx(1.0 / 3.0)
    np.testing.assert_allclose(f, [2.0 / 3.0, 1.0 / 3.0], rtol=1e-15)


MASS, VELOCITY = np.array([1.0, 2.0, 0.5, 4.0, 1.5]), np.array([0.3, -0.1, 0.2, 0.5, -0.4])


@pytest.mark.parametrize("anchor", range(5))
@pytest.mark.parametrize("i", range(4))
def test_beads_whose_contact_comes_to_rest_take_the_velocity_of_their_centre_of_mass(i, anchor):
    chain = Chain(MASS, hertz(1.0))
    data, _, motion = records_of(chain, State.at_start(chain, VELOCITY))
    data, motion.mode[:] = data._replace(anchor_bead=anchor), LOADED
    motion.anchor[1] = VELOCITY[anchor]
    stop_rate(i, data, motion)
    behind = np.append(0.0, -np.cumsum(motion.rate))
    wanted = VELOCITY.copy()
    wanted[i : i + 2] = MASS[i : i + 2] @ VELOCITY[i : i + 2] / MASS[i : i + 2].sum()
    assert motion.anchor[1] + behind - behind[anchor] == pytest.approx(wanted, abs=1e-15)
    assert motion.rate[i] == 0.0


@pytest.mark.parametrize(("i", "beside"), [(2, 1), (2, 2), (2, 3), (1, 2), (0, 1), (3, 2)])
def test_beside_a_soft_or_touching_contact_it_alone_comes_to_rest(i, beside):
    laws = [hertz(1.0)] * 4
    laws[beside] = power_law(1.0, 0.1)
    for contacts, mode in ((laws, LOADED), (hertz(1.0), TOUCHING)):
        chain = Chain(MASS, contacts)
        data, _, motion = records_of(chain, State.at_start(chain, VELOCITY))
        before = motion.rate.copy()
        motion.mode[:] = LOADED
        motion.mode[beside] = mode
        stop_rate(i, data, motion)
        assert motion.rate == pytest.approx(np.where(np.arange(4) == i, 0.0, before), abs=0.0)
