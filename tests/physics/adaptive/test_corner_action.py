"""Tests of mode transitions at an event.

The tests cover loading branches, segments of couplers, sliding beads, contacts at rest, and missed events.
"""

import numpy as np
import pytest
from softcradle.physics import Chain, Coupler, State, draft_gear, hertz, hooke, power_law
from softcradle.physics.adaptive import step_records
from softcradle.physics.adaptive.corner_action import cross, decide, ease, open_passed, settle_bead, stop_rate
from softcradle.physics.adaptive.corner_search import guard_of, stays
from softcradle.physics.adaptive.row_graphs import of_segment, put_segment
from softcradle.physics.adaptive.step_records import ACCELERATION, Bounds
from softcradle.physics.adaptive.yield_or_slip import balance
from softcradle.physics.numerics.records import LOADED, OPEN, ORIGIN, TOUCHING

from tests.helpers.given_steps import H, Step
from tests.helpers.plain_kernels import context_of, effective_records, only_plain, records_of

pytestmark = only_plain
BOUNDS = Bounds(1e-9, 1e-10, 1e-10, 1e-11, 1e-2, 1e-13)
GEAR = draft_gear(2.0, 0.4)  # At overlap 0 the draft gear carries forces up to 0.8 N.
COUPLER = Coupler(hooke(50.0, loss=0.3), pull=hooke(80.0, loss=0.5), slack=0.1, travel=0.05, stop=1e3)
SOLID_PULL, PULL, PUSH, SOLID_PUSH = range(4)  # Segments of the coupler.


class Rows:
    """A chain at rest in which all contacts are at an event, stored as kernel records."""

    def __init__(self, chain, velocity=None):
        n = chain.contacts
        self.state = State.at_start(chain, np.zeros(n + 1) if velocity is None else velocity)
        self.chain, self.regime, self.motion = effective_records(chain, self.state)
        self.context = context_of(self.chain, self.regime, self.motion, BOUNDS, log_size=16)
        self.scratch = self.context.scratch

    def decide(self):
        decide(-1, self.context)
        return self

    def cross(self, row, side):
        cross(row, side, 0.0, self.context)


@pytest.mark.parametrize(
    ("number", "then", "overlap"), [(SOLID_PUSH, PUSH, 0.05), (SOLID_PULL, PULL, -0.15), (PULL, PUSH, -0.1)]
)
def test_an_unloading_coupler_enters_the_previous_segment(number, then, overlap):
    """Check that an unloading coupler enters the previous segment. The position of the coupler must not change. The
    position is measured in metres from the overlap at which the coupler begins to push.
    """
    rows = Rows(Chain([1.0, 1.0], COUPLER))
    put_segment(0, number, rows.regime, rows.motion)
    rows.motion.overlap[0], rows.motion.mode[0] = 0.0, TOUCHING
    ease(0, rows.regime, rows.motion)
    assert rows.regime.segment[0] == then
    assert rows.motion.overlap[0] + of_segment(rows.regime, 0, ORIGIN) == pytest.approx(overlap, abs=1e-15)
    assert rows.motion.mode[0] == (OPEN if number == PULL else LOADED)
    assert rows.regime.easing[0] == (number != PULL)


@pytest.mark.parametrize(("acceleration", "slide"), [(0.5, 1), (-0.5, -1), (1e-9, 1), (-1e-9, -1), (0.0, 0)])
@pytest.mark.parametrize("bead", [0, 1, 2])
def test_only_an_accelerated_bead_starts_to_slide(acceleration, slide, bead):
    velocity = np.array([0.3, -0.2, 0.1])
    rows = Rows(Chain([1.0, 2.0, 1.0], hertz(1.0), gap=0.1, friction=0.1), velocity)
    work = rows.scratch.work
    work[ACCELERATION, bead], work[step_records.VELOCITY] = acceleration, velocity
    settle_bead(bead, rows.chain, rows.regime, rows.motion, work)
    wanted = np.where((np.arange(3) == bead) & (slide == 0), 0.0, velocity)
    assert rows.regime.slide[bead] == slide
    assert rows.state.velocity(Chain([1.0, 2.0, 1.0], hertz(1.0))) == pytest.approx(wanted, abs=1e-15)


# `part` is the contact force as a fraction of the largest force.
@pytest.mark.parametrize(("part", "side", "mode"), [(1.0, 1, LOADED), (0.0, 0, OPEN)])
@pytest.mark.parametrize("pulls", [False, True])
def test_a_gear_that_is_still_held_at_its_bound_gives_way(part, side, mode, pulls):
    """Check that a draft gear at the limit of its holding force yields. The acceleration of the gear is 0 to the last
    digit, so otherwise the gear would be held forever. A pulling gear yields in the opposite direction.
    """
    push = -0.8 * part if pulls else 0.8 * part
    link = Coupler(hooke(50.0), pull=GEAR, slack=0.1, travel=0.05, stop=1e3) if pulls else GEAR
    rows = Rows(Chain([1.0, np.inf], link, gap=0.1 * pulls, drive=[push, 0.0]))
    if pulls:
        put_segment(0, PULL, rows.regime, rows.motion)
        rows.motion.overlap[0] = 0.0
    rows.decide()
    assert rows.motion.mode[0] == TOUCHING
    assert rows.motion.force[0] == pytest.approx(push)
    rows.cross(0, 1 - side if pulls else side)
    assert rows.motion.mode[0] == mode
    if pulls:
        assert rows.regime.segment[0] == (PULL if part else PUSH)
        assert rows.motion.force[0] == pytest.approx(push)
    else:
        assert rows.motion.overlap[0] == 0.0


@pytest.mark.parametrize("bead", [0, 1])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_bead_at_its_friction_limit_slides(bead, sign):
    chain = Chain([1.0, 2.0], hertz(1.0), gap=1.0, friction=0.1)
    drive = np.where(np.arange(2) == bead, sign * chain.bed * chain.mass, 0.0)
    rows = Rows(Chain(chain.mass, hertz(1.0), gap=1.0, friction=0.1, drive=drive)).decide()
    assert rows.regime.slide.tolist() == [0, 0]
    rows.cross(1 + bead, 1 if sign > 0 else 0)
    assert rows.regime.slide.tolist() == [sign if j == bead else 0 for j in (0, 1)]


def test_a_touching_contact_with_loss_has_no_force():
    rows = Rows(Chain([1.0, 1.0], hertz(1.0, loss=0.3))).decide()
    assert rows.motion.mode[0] == LOADED
    assert rows.motion.force[0] == rows.regime.easing[0] == 0.0


PASSED = [
    (LOADED, -1e-12, -1e-3, 0.3, OPEN, -1e-12),  # The contact opens.
    # In both cases the opening speed is too low to count. The second contact is held.
    (LOADED, -1e-12, -1e-11, 0.3, LOADED, 0.0), (TOUCHING, 0.0, 0.0, 0.3, TOUCHING, 0.0),
    # Without forces of its neighbours, the contact opens in the first case. In the second case the opening is too slow
    # to count.
    (LOADED, -1e-12, -1e-9, 0.0, OPEN, -1e-12), (LOADED, -1e-12, -1e-14, 0.0, LOADED, 0.0),
    # In the first case the event was not found. In the second case the event comes later.
    (OPEN, 1e-12, 1e-3, 0.3, LOADED, 1e-12), (OPEN, -1e-12, 1e-3, 0.3, OPEN, -1e-12),
    (OPEN, 1e-14, 0.05 * BOUNDS.wanted, 0.3, OPEN, 0.0),  # The contact closes too slowly to count.
    # The contact is at rest, but the beads do not touch.
    (LOADED, -1e-3, 0.0, 0.0, OPEN, -1e-3), (LOADED, -1e-3, 0.0, 0.3, OPEN, -1e-3),
    (OPEN, 1e-3, 0.0, 0.3, LOADED, 1e-3),
]  # fmt: skip


@pytest.mark.parametrize(("mode", "overlap", "rate", "push", "then", "at"), PASSED)
def test_contacts_that_a_step_has_carried_past_their_corner(mode, overlap, rate, push, then, at):
    rows = Rows(Chain([1.0] * 4, hertz(1.0)))
    motion = rows.motion
    motion.mode[:], motion.overlap[:], motion.force[:] = LOADED, 0.5, push
    motion.mode[1], motion.overlap[1], motion.rate[1], motion.force[1] = mode, overlap, rate, 0.0
    rows.context.trial.overlap[2] = motion.overlap
    passed = open_passed(-1, 1.0, 2.0, rows.context)
    assert passed == (mode == LOADED)
    assert (motion.mode.tolist(), motion.overlap.tolist()) == ([LOADED, then, LOADED], [0.5, at, 0.5])
    assert motion.rate[1] == (0.0 if then == LOADED and mode == LOADED else rate)
    # The rate that is set to zero counts as an error when the contact is pushed again.
    assert rows.scratch.parting[1] == (-rate if push == at == 0.0 else 0.0)


@pytest.mark.parametrize(("force", "found"), [([0.3], True), ([0.1, 0.7], True), ([0.5], False), ([0.3, -1.0], False)])
def test_a_multiplier_well_within_its_range_needs_no_guard(force, found):
    """Check that the guard function of a contact force is evaluated only if necessary. The force has the range 0 to 0.8
    N. The guard is evaluated in the half of the range next to yielding and near an opening.
    """
    step = Step(Chain([1.0, np.inf], GEAR), [0.0, 0.0], [0.0], [TOUCHING], [force])
    assert stays(0, H, step.context()) == found


def test_a_contact_that_begins_to_leave_by_round_off_begins_at_rest():
    """Check an open contact at d = 0 that closes at 1e-12 m/s because of round-off. The guard function of the contact
    must begin with slope 0 instead of the slope of this rate.
    """
    step = Step(Chain([1.0, np.inf], hertz(1.0)), [1e-12, 0.0], [0.0], [OPEN], [0.0])
    assert guard_of(0, 0, H, step.context(1e-10))[:3] == (0.0, 0.0, 0.0)
    assert guard_of(0, 0, H, step.context())[1] == pytest.approx(-1e-12 * H / 5.0)


@pytest.mark.parametrize(
    ("overlap", "rate", "found"),
    [
        ((1e-9, 2e-9, 3e-9), 0.5, True), ((1e-9, 2e-9, 3e-9), -0.5, False), ((-1e-9, 2e-9, 3e-9), 0.5, False),
        ((2e-9, 1e-9, 3e-9), 0.5, False), ((1e-9, 3e-9, 2e-9), 0.5, False),
        ((-1e-19, 1e-19, -1e-19), -1e-12, True),  # These values are round-off.
    ],
)  # fmt: skip
def test_a_growing_contact_at_rest_stays_on_its_branch(overlap, rate, found):
    """Check a loaded contact at overlap 0 and rate 0. If the overlap increases at all nodes of the step, the contact
    stays on the loading branch. The polynomial between the nodes must not matter.
    """
    step = Step(Chain([1.0, 1.0], hertz(1.0)), [0.0, 0.0], [0.0], [LOADED], [0.0])
    step.trial.overlap[:, 0], step.trial.rate[2, 0] = overlap, rate
    assert stays(0, H, step.context(1e-11)) == found


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
        # Beads that are pressed together have the largest force.
        assert (f[a[:-1] > a[1:]] == high[a[:-1] > a[1:]]).all()
        assert (f[a[:-1] < a[1:]] == low[a[:-1] < a[1:]]).all()  # Beads that are pulled apart have the smallest force.
        assert (a[inverse_mass == 0.0] == 0.0).all()
        net = load - np.append(f, 0.0) + np.append(0.0, f)
        slides = a != 0.0
        rests = ~slides & (inverse_mass > 0.0)
        assert (np.abs(net[rests]) <= give[rests] + 1e-12).all()
        inertia = a[slides] / inverse_mass[slides]
        lacks = net[slides] - inertia - np.sign(a[slides]) * give[slides]
        assert (np.abs(lacks) <= 1e-9 * (1.0 + np.abs(inertia))).all()


MASS, VELOCITY = np.array([1.0, 2.0, 0.5, 4.0, 1.5]), np.array([0.3, -0.1, 0.2, 0.5, -0.4])


def stopped(i, laws, anchor=4, beside=0, mode=LOADED):
    """Return the motion just after contact `i` has come to rest. Contact `beside` is in mode `mode`, and all other
    contacts are loaded.
    """
    chain = Chain(MASS, laws)
    data, motion = records_of(chain, State.at_start(chain, VELOCITY))
    motion.anchor[1], motion.mode[:], motion.mode[beside] = VELOCITY[anchor], LOADED, mode
    stop_rate(i, data._replace(anchor_bead=anchor), motion)
    return motion


@pytest.mark.parametrize("anchor", range(5))
@pytest.mark.parametrize("i", range(4))
def test_resting_contacts_give_beads_their_common_velocity(i, anchor):
    motion = stopped(i, hertz(1.0), anchor)
    behind = np.append(0.0, -np.cumsum(motion.rate))
    wanted = VELOCITY.copy()
    wanted[i : i + 2] = MASS[i : i + 2] @ VELOCITY[i : i + 2] / MASS[i : i + 2].sum()
    assert motion.anchor[1] + behind - behind[anchor] == pytest.approx(wanted, abs=1e-15)
    assert motion.rate[i] == 0.0


@pytest.mark.parametrize(("i", "beside"), [(2, 1), (2, 2), (2, 3), (1, 2), (0, 1), (3, 2)])
def test_next_to_a_soft_contact_only_one_contact_comes_to_rest(i, beside):
    laws = [power_law(1.0, 0.1) if k == beside else hertz(1.0) for k in range(4)]
    for motion in (stopped(i, laws), stopped(i, hertz(1.0), beside=beside, mode=TOUCHING)):
        assert motion.rate == pytest.approx(np.where(np.arange(4) == i, 0.0, -np.diff(VELOCITY)), abs=0.0)
