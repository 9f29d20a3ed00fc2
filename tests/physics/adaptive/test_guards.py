"""Guards of events where they come near to zero, and at the end of a step."""

import math

import numpy as np
import pytest
from scipy.interpolate import BPoly
from softcradle.physics import Chain, draft_gear, hertz, hooke
from softcradle.physics.adaptive.constants import SAFETY
from softcradle.physics.adaptive.corner_search import guard_of
from softcradle.physics.numerics.records import LOADED, TOUCHING

from tests.helpers.given_steps import H, Step, thrown
from tests.helpers.plain_kernels import only_plain

pytestmark = only_plain


def at_wall(law, speed, overlap, mode, force, **more):
    """A step of a bead of 1 kg with one contact, that with a wall."""
    return Step(Chain([1.0, math.inf], law), [speed, 0.0], [overlap], [mode], [force], **more)


@pytest.mark.parametrize("peak", [0.75, 0.5, 0.79])
@pytest.mark.parametrize("scale", [1.0, 1e-2])
def test_a_guard_that_comes_near_is_looked_at_where_it_does(peak, scale):
    """A multiplier within 0 and 0.8 N, or a hundredth of that, with a peak at half the step."""
    force = np.array([0.2, 4.0 * (peak - 0.2) / H, -4.0 * (peak - 0.2) / H**2])
    step = at_wall(draft_gear(2.0 * scale, 0.4), 0.0, 0.0, TOUCHING, scale * force)
    assert step.corner()[4] == pytest.approx(0.5 if peak > SAFETY * 0.8 else 1.0, abs=1e-9)


@pytest.mark.parametrize(("peak", "near"), [(0.95, False), (0.97, True)])
def test_how_near_is_a_part_of_the_range_of_a_multiplier(peak, near):
    """With a loss of 0.4 a spring that stands at 1 N carries from 0.6 N on: a tenth of that range is 0.04 N."""
    force = [0.7, 4.0 * (peak - 0.7) / H, -4.0 * (peak - 0.7) / H**2]
    step = at_wall(hooke(2.0, loss=0.4), 0.0, 0.5, TOUCHING, force)
    assert step.corner()[4] == pytest.approx(0.5 if near else 1.0, abs=1e-9)


def test_a_loaded_contact_is_near_no_switch():
    assert at_wall(draft_gear(2.0, 0.4), -1.0, 0.6, LOADED, 0.8).corner()[4] == 1.0


def test_an_open_contact_that_nearly_touches_is_looked_at():
    """Both ends tell less than what lies between: where quintic and cubic disagree by more than the gap that is left."""
    step = thrown(2.0, 0.5 * 4.0 / 9.8 + 1e-6)
    assert step.corner()[4] == 1.0
    step.motion.force[0] = 3.0  # so the quintic differs from the cubic by h²/64 times the difference
    guard = guard_of(0, 0, H, step.data, step.regime, step.motion, step.trial, 0.0, step.work)
    found = step.corner()[4]
    assert 0.0 < found < 1.0
    assert BPoly(np.reshape(guard, (6, 1)), [0.0, 1.0]).derivative()(found) == pytest.approx(0.0, abs=1e-9)


def test_guards_and_slopes_at_the_end():
    gear = draft_gear(2.0, 0.4)
    touching = at_wall(gear, 0.0, 0.0, TOUCHING, [0.2, 0.5, -0.7])
    force, slope = touching.forces[0](H), touching.forces[0].deriv()(H)
    assert touching.guard(0, 0) == pytest.approx((force, slope))
    assert touching.guard(0, 1) == pytest.approx((0.8 - force, -slope))
    assert at_wall(gear, -1.0, 0.3, LOADED, 0.8).guard(0, 0) == pytest.approx((0.3 - H - 0.4 * H * H, -1.0 - 0.8 * H))
    assert thrown(3.0, 0.4).guard(0, 0) == pytest.approx((0.4 - 3.0 * H + 4.9 * H * H, -3.0 + 9.8 * H))
    for sign in (1.0, -1.0):
        turning = at_wall(hertz(2.0, loss=0.4), 0.3 * sign, 0.5, LOADED, 1.5 * sign, easing=[int(sign < 0.0)])
        assert turning.guard(0, 1) == pytest.approx((0.3 - 1.5 * H, -1.5))
    stands = at_wall(hooke(2.0, loss=0.4), 0.0, 0.5, TOUCHING, [0.9, -1.0])
    assert stands.guard(0, 0) == pytest.approx((0.9 - H - 0.6, -1.0))
