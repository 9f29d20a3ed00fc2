"""Tests of event location: first roots of guard functions, and motions whose mode changes are known in closed form."""

import math
from math import comb

import numpy as np
import pytest
from scipy.interpolate import BPoly
from softcradle.physics import Chain, Contact, draft_gear, hertz, hooke, power_law
from softcradle.physics.adaptive.constants import SAFETY
from softcradle.physics.adaptive.corner_search import NONE, closes_inactive, first_root, guard_of
from softcradle.physics.numerics.law_curve import NODES
from softcradle.physics.numerics.records import LOADED, OPEN, TOUCHING

from tests.helpers.given_steps import H, Step, at_wall, thrown
from tests.helpers.plain_kernels import only_plain

pytestmark = only_plain
GEAR, LOSSY = draft_gear(2.0, 0.4), hooke(2.0, loss=0.4)  # At overlap 0 the draft gear carries forces up to 0.8 N.
PART = np.linspace(0.0, 1.0, 20001)


def value(b, x):
    """Return the value at x of the quintic polynomial with the Bernstein coefficients b."""
    return sum(b[k] * comb(5, k) * x**k * (1.0 - x) ** (5 - k) for k in range(6))


BASIS = np.array([value(one, PART) for one in np.eye(6)])


@pytest.mark.parametrize("seed", range(20))
def test_it_is_the_first_place_at_which_the_polynomial_turns_negative(seed):
    draw = np.random.default_rng(seed)
    for k in range(100):
        b = draw.normal(size=6)
        b[0] = abs(b[0])
        if k % 3 == 0:  # This polynomial begins at 0 and rises.
            b[0], b[1] = 0.0, abs(b[1])
        values = b @ BASIS
        below = np.flatnonzero(values[1:] < -1e-9)
        found = first_root(tuple(b))
        if not below.size:
            assert found == NONE or values[int(found * 20000)] < 1e-6
        else:
            assert found <= PART[below[0] + 1] + 1e-9
            assert abs(values[int(found * 20000)]) < 1e-3


def test_a_very_short_contact_is_found():
    for width in (1e-3, 1e-5, 1e-7):
        middle = 0.371
        power = (middle**2 - width**2, -2.0 * middle, 1.0)  # (x - middle)² - width²
        b = tuple(sum(comb(k, j) / comb(5, j) * power[j] for j in range(3)) for k in range(6))
        assert first_root(b) == pytest.approx(middle - width, abs=1e-9 + 1e-15 / width)
    # The root of 100 (1-x)**5 = x**5 must be found although four coefficients are zero.
    assert first_root((100.0, 0.0, 0.0, 0.0, 0.0, -1.0)) == pytest.approx(1.0 / (1.0 + 100.0**-0.2), abs=1e-13)


def test_a_polynomial_that_leaves_zero_downward_has_a_root_at_zero():
    # The polynomial is negative at once because of its slope.
    assert first_root((0.0, -1.0, 1.0, 1.0, 1.0, 1.0)) == 0.0
    # The polynomial is negative at once because of its curvature.
    assert first_root((0.0, 0.0, -1.0, 1.0, 1.0, 1.0)) == 0.0
    assert first_root((0.0, 0.0, 1.0, 1.0, 1.0, 0.0)) == NONE
    falls = (0.0, 0.0, 1.0, 1.0, 1.0, -1.0)  # The polynomial begins with a double zero, rises, and falls.
    found = first_root(falls)
    assert found > 0.5
    assert value(falls, found) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("law", "overlap", "first", "peak", "near"),
    [
        *((GEAR, 0.0, 0.2, peak, peak > SAFETY * 0.8) for peak in (0.5, 0.75, 0.79)),
        (draft_gear(0.02, 0.4), 0.0, 2e-3, 7.5e-3, True),
        # At 1 N the contact can carry forces between 0.6 N and 1 N. A tenth of this range is 0.04 N.
        (LOSSY, 0.5, 0.7, 0.95, False),
        (LOSSY, 0.5, 0.7, 0.97, True),
    ],
)
def test_a_multiplier_near_its_bound_is_examined(law, overlap, first, peak, near):
    """Check that a step is examined again at its middle if a contact force is close to its limit. The distance from the
    limit is measured relative to the range of the force.
    """
    rise = 4.0 * (peak - first)
    step = at_wall(law, 0.0, overlap, TOUCHING, [first, rise / H, -rise / H**2])
    assert step.corner()[4] == pytest.approx(0.5 if near else 1.0, abs=1e-9)


def test_a_nearly_touching_contact_is_examined():
    """Check an open contact with a small gap. The quintic and cubic polynomials of the gap differ by more than the gap
    itself. The values of the gap at both ends of the step do not show this difference.
    """
    assert at_wall(GEAR, -1.0, 0.6, LOADED, 0.8).corner()[4] == 1.0
    step = thrown(2.0, 0.5 * 4.0 / 9.8 + 1e-6)
    assert step.corner()[4] == 1.0
    # The quintic polynomial now differs from the cubic polynomial by h²/64 times this change.
    step.motion.force[0] = 3.0
    guard = guard_of(0, 0, H, step.context())
    found = step.corner()[4]
    assert 0.0 < found < 1.0
    assert BPoly(np.reshape(guard, (6, 1)), [0.0, 1.0]).derivative()(found) == pytest.approx(0.0, abs=1e-9)


def test_a_bead_thrown_at_a_ceiling_closes_when_it_is_there():
    time = (3.0 - math.sqrt(9.0 - 2 * 9.8 * 0.4)) / 9.8
    assert thrown(3.0, 0.4).find() == (0, "closes", pytest.approx(time / H, abs=1e-13 / H))
    peak = 0.5 * 9.0 / 9.8
    assert thrown(3.0, peak - 1e-9).find()[1] == "closes"  # The bead touches the wall and returns within the step.
    assert thrown(3.0, peak + 1e-9).find() == (-1, "nothing", 1.0)
    # At the end of the step the bead is already flying back.
    assert thrown(3.0, 0.4).find(landing=(0, 0))[1] == "closes"
    *_, miss, _ = thrown(3.0, 1.0).corner(landing=(0, 0))
    assert math.isnan(miss)
    row, _, _, miss, _ = thrown(5.0, 1.6).corner(landing=(0, 0))  # The bead is 0.384 m before the wall, at 1.08 m/s.
    assert row == -1
    assert miss == pytest.approx((1.6 - 5.0 * H + 4.9 * H**2) / (5.0 - 9.8 * H), abs=1e-12)


MIDDLE = float(NODES[1])
BEND = 0.65 / MIDDLE**2
CURVED = np.polynomial.Polynomial([0.2, -2.0, 1.0, 3.0])
# Each entry describes a contact at a wall: law, speed, overlap, mode, force, first event, and time of the event [s].
EVENTS = [
    (GEAR, -1.0, 0.3, LOADED, 0.8, "opens", (math.sqrt(1.0 + 2.0 * 0.8 * 0.3) - 1.0) / 0.8),
    (hooke(2.0), -1.0, 0.3, LOADED, 0.8, "opens", (math.sqrt(1.0 + 2.0 * 0.8 * 0.3) - 1.0) / 0.8),
    (Contact(0.5, 1.0, 0.5), -1.0, 0.3, LOADED, 0.8, "opens", (math.sqrt(1.0 + 2.0 * 0.8 * 0.3) - 1.0) / 0.8),
    # A law without preload that is not linear gives a force only above overlap 0.
    (hertz(2.0), -1.0, 0.3, LOADED, 0.8, "nothing", H),
    (power_law(2.0, 0.5), -1.0, 0.3, LOADED, 0.8, "nothing", H),
    # The contact force is between 0 and 0.8 N.
    (GEAR, 0.0, 0.0, TOUCHING, CURVED.coef, "opens", min(root.real for root in CURVED.roots() if root.real > 0.0)),
    (GEAR, 0.0, 0.0, TOUCHING, [0.2, -2.0], "opens", 0.1),
    (GEAR, 0.0, 0.0, TOUCHING, [0.2, 4.0], "yields", 0.15),
    (GEAR, 0.0, 0.0, TOUCHING, [0.2, 0.5], "nothing", H),
    # The force is 0.85 N at the middle stage of the step, and 0.475 N and 0.653 N at the other stages.
    (GEAR, 0.0, 0.0, TOUCHING, [0.2, 2.0 * BEND * MIDDLE / H, -BEND / H**2], "yields", H * (MIDDLE - math.sqrt(0.05 / BEND))),
    # The contact is at rest at 1 N. The loss of the contact is 0.4, so the smallest force is 0.6 N.
    (LOSSY, 0.0, 0.5, TOUCHING, [0.9, -1.0], "eases", 0.3),
    (LOSSY, 0.0, 0.5, TOUCHING, [0.9, 1.0], "yields", 0.1),
]  # fmt: skip


@pytest.mark.parametrize(("law", "speed", "overlap", "mode", "force", "kind", "time"), EVENTS)
def test_a_contact_leaves_its_branch(law, speed, overlap, mode, force, kind, time):
    row, *found = at_wall(law, speed, overlap, mode, force).find()
    assert row == (-1 if kind == "nothing" else 0)
    assert found == [kind, pytest.approx(time / H, abs=1e-10)]


@pytest.mark.parametrize(("speed", "easing"), [(0.3, 0), (-0.3, 1)])
def test_a_contact_with_loss_turns(speed, easing):
    # In reality no contact force pulls. The guard function does not check this.
    given = speed, 0.5, LOADED, 1.5 if speed > 0.0 else -1.5
    found = at_wall(hertz(2.0, loss=0.4), *given, easing=[easing]).find()
    assert found == (0, "turns", pytest.approx(0.2 / H, abs=1e-12))
    assert at_wall(hertz(2.0), *given, easing=[easing]).find()[1] == "nothing"


def on_bed(velocity, slide, drive=(0.0, 0.0)):
    chain = Chain([1.0, 1.0], hertz(2.0), gap=5.0, friction=0.1, drive=list(drive))
    step = Step(chain, velocity, [-5.0], [OPEN], [0.0], slide)
    push = np.array(drive) - chain.bed * slide  # External force that the effective chain uses.
    gained = np.where(np.array(slide) == 0, 0.0, push)
    step.data = step.data._replace(external=np.append(gained[:1] - gained[1:], gained[chain.anchor]))
    ended = np.array(velocity) + H * gained
    step.trial.rate[2] = ended[0] - ended[1]
    step.trial.anchor[1] = ended[chain.anchor]
    return step


@pytest.mark.parametrize("sign", [1, -1])
def test_a_sliding_bead_stops(sign):
    step = on_bed([0.2 * sign, 0.1 * sign], [sign, sign])
    brake = step.chain.bed[0]
    assert step.find() == (1, "stops", pytest.approx(0.1 / brake / H, abs=1e-12 / H))
    assert step.find(landing=(2, 0)) == (0, "stops", pytest.approx(0.2 / brake / H, abs=1e-12 / H))
    assert step.guard(1, 0) == (pytest.approx(0.2 - H * brake, abs=1e-14), pytest.approx(-brake))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_bead_at_rest_slips_when_its_friction_does_not_suffice(sign):
    """Apply two contact forces to a bead of 1 kg that rests on its friction bed. The difference of the forces grows
    with time until the bead slips.
    """
    chain = Chain([10.0, 1.0, 10.0], hertz(2.0), friction=0.1)
    most = chain.bed[1]
    left, right = ([0.3, 4.0], [0.3]) if sign > 0.0 else ([0.3], [0.3, 4.0])
    step = Step(chain, [0.0, 0.0, 0.0], [0.2, 0.2], [LOADED, LOADED], [left, right], slide=[0, 0, 0])
    assert step.find() == (1, "slips", pytest.approx(most / 4.0 / H, abs=1e-10 / H))
    assert step.guard(3, 1 if sign > 0.0 else 0) == pytest.approx((most - 4.0 * H, -4.0))
    # The left bead is pushed to the left. A smaller push leaves a larger reserve of friction.
    value, _ = step.guard(2, 0)
    assert value == pytest.approx(10.0 * most - 0.3 - (4.0 * H if sign > 0.0 else 0.0))
    light = Chain([10.0, 0.01, 10.0], hertz(2.0), friction=0.1)
    pushed = [[0.3, 0.04 * most / H], [0.3]]
    step = Step(light, [0.0] * 3, [0.2, 0.2], [LOADED, LOADED], pushed, slide=[0, 0, 0])
    assert step.find() == (1, "slips", pytest.approx(0.25, abs=1e-9))
    below = Step(chain, [0.0] * 3, [0.2, 0.2], [LOADED] * 2, [[0.3, 2.0 * most], [0.3, 1.0]], slide=[1, 0, 1])
    assert below.find()[1] in ("nothing", "stops")
    driven = on_bed([0.0, 1.0], [0, 1], drive=(0.95, 0.0))
    assert driven.find()[1] == "nothing"
    assert driven.guard(1, 1) == pytest.approx((driven.chain.bed[0] - 0.95, 0.0))


def test_the_earliest_event_counts():
    chain = Chain([1.0, math.inf, 1.0], GEAR)
    for first, second in ((0.1, 0.2), (0.3, 0.2)):
        step = Step(chain, [0.0] * 3, [0.0] * 2, [TOUCHING] * 2, [[0.2, -0.2 / first], [0.2, -0.2 / second]])
        time = min(first, second)
        assert step.find() == (0 if first < second else 1, "opens", pytest.approx(time / H, abs=1e-10 / H))
    step = Step(Chain([1.0, math.inf, 1.0], hertz(2.0)), [1.0, 0.0, -1.0], [-0.2] * 2, [OPEN] * 2, [0.0] * 2)
    assert step.find() == (0, "closes", pytest.approx(0.5))


def test_a_rate_or_velocity_just_outside_its_side_is_round_off():
    """Check that a rate or velocity with the wrong sign causes no event if its magnitude stays at most `slow`."""
    pressing_in = at_wall(LOSSY, -0.04, 0.5, LOADED, 0.0, easing=[0])
    assert pressing_in.find(slow=0.05)[1] == "nothing"
    assert pressing_in.find(slow=0.03)[:2] == (0, "turns")
    # The external force equals the friction force, so the bead is not accelerated.
    drive = on_bed([0.0, 0.0], [1, 1]).chain.bed[0]
    for speed, slow, kind in ((-0.04, 0.05, "nothing"), (-0.04, 0.03, "stops"), (0.04, 0.03, "nothing")):
        assert on_bed([speed, 1.0], [1, 1], drive=(drive, drive)).find(slow=slow)[1] == kind


@pytest.mark.parametrize("neighbour", [0, 2])
@pytest.mark.parametrize(("speed", "force"), [(6.0, [-60.0, 60.0 / H]), (2.0, [0.0, -60.0 / H])])
def test_a_closing_and_reopening_within_a_step_is_found(neighbour, speed, force):
    """Check a contact that overlaps only in the middle of the step. The force of a neighbouring contact causes the
    overlap and is 0 at one end of the step.
    """
    chain = Chain([math.inf, 1.0, 1.0, math.inf], hertz(2.0))
    forces = [force if i == neighbour else 0.0 for i in range(3)]
    step = Step(chain, [0.0, speed, 0.0, 0.0], [0.1, -0.1, 0.1], [LOADED, OPEN, LOADED], forces)
    assert step.trial.overlap[2, 1] < 0.0
    assert step.find()[:2] == (1, "closes")
    free = Step(chain, [0.0, speed, 0.0, 0.0], [0.1, -0.1 - speed * H, 0.1], [LOADED, OPEN, LOADED], [0.0, 0.0, 0.0])
    assert free.find() == (-1, "nothing", 1.0)


def test_a_closing_that_does_not_count():
    data = Step(Chain([1.0, 3.0, 9.0], power_law(2.0, 0.5)), [0.0] * 3, [-1.0] * 2, [OPEN] * 2, [0.0] * 2).data
    push = (1.0 + 1.0 / 3.0) * 2.0 * math.sqrt(1e-8) * 1e-8  # Change of the rate: (1/m + 1/3m) f d.
    assert closes_inactive(data, 0, math.sqrt(1.01 * push), 1e-9, 1e-9, 1e-8)
    assert not closes_inactive(data, 0, math.sqrt(0.99 * push), 1e-9, 1e-9, 1e-8)
    assert closes_inactive(data, 0, 1e-3, 1e-3, 1e-3, 1e-8)
    assert not closes_inactive(data, 0, 1e-3, 2e-3, 1e-9, 1e-8)
    assert not closes_inactive(data, 0, 1e-3, 1e-9, 2e-3, 1e-8)
    assert not closes_inactive(data, 0, 1e-3, 1e-9, 1e-9, 0.0)
    assert closes_inactive(at_wall(hertz(2.0), 1e-3, -1e-5, OPEN, 0.0).data, 0, 1.0, 1e-9, 1e-9, 0.0)
    assert not closes_inactive(at_wall(GEAR, 1e-3, -1e-5, OPEN, 0.0).data, 0, 1.0, 1e-9, 1e-9, 1e-8)


def test_a_start_at_rest_is_not_an_event():
    """Check that a contact which leaves d = 0 by round-off causes no event. Also check that a contact which external
    forces drive back opens at once.
    """
    assert at_wall(GEAR, -1e-12, 0.0, LOADED, -0.5).find(slow=1e-10)[1] == "nothing"
    assert at_wall(GEAR, 1e-12, 0.0, LOADED, 0.5).find(slow=0.0)[:2] == (0, "opens")
    sliding = on_bed([1.0, 0.0], [1, 1], drive=(0.0, 3.0))
    sliding.motion.rate[0] = 1.0 + 1e-13
    sliding.motion.anchor[1] = 1.0 if sliding.chain.anchor == 0 else -1e-13
    assert sliding.find(slow=1e-10)[1] == "nothing"
