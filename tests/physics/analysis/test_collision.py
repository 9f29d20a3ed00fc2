"""Tests of the quantities that describe a collision. These quantities are compared with quadruple-precision solutions,
closed forms, and each other.
"""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, Coupler, TimedForce, cluster_on_cluster, one_on, simulate
from softcradle.physics.analysis import closed_forms, measures
from softcradle.physics.analysis.closed_forms import critical_speed, one_on_one, rigid_collision, rigid_stroke
from softcradle.physics.analysis.collision import collide, measured
from softcradle.physics.analysis.ringing import ringing
from softcradle.physics.contact import draft_gear, hertz, hooke, power_law, step_force

from tests.helpers.truth import ELASTIC, GEARS

GEAR, MASS = draft_gear(770.0, 0.0177), 0.396


@pytest.mark.parametrize("case", ELASTIC + GEARS, ids=lambda case: case.name)
def test_against_the_truth(case):
    found = measured(collide(case.chain, case.start))
    assert found.struck == case.struck
    assert found.contact_time == pytest.approx(case.contact_time, rel=1e-8)
    assert [c.peak_force for c in found.contacts] == pytest.approx(list(case.peak_force), rel=1e-5)
    targets = case.final[case.struck + 1 :]
    assert found.rigidity == pytest.approx(np.ptp(targets) / targets.mean(), abs=1e-6)
    mass = np.array(case.chain.mass)
    passed = [(mass * (case.final - case.start))[k + 1 :].sum() for k in range(case.chain.contacts)]
    assert [c.momentum for c in found.contacts] == pytest.approx(passed, rel=1e-7)
    # Let e be the coefficient of restitution. The share 1 - e**2 of the approach energy stays inside the clusters. If
    # there is only one striker, all of this energy is in the target cluster.
    strikers = case.struck + 1
    first, second = mass[:strikers].sum(), mass[strikers:].sum()
    approach = 0.5 * first * second / (first + second) * (case.start[0] - case.start[-1]) ** 2
    share = found.energy_inside * 0.5 * (mass * case.start**2).sum() / approach
    lost = 1.0 - found.restitution**2
    # The collision of two beads with two beads is symmetric.
    assert lost == pytest.approx(share if strikers == 1 else 2.0 * share, abs=1e-7)


@pytest.mark.parametrize("share", [0.3, 0.99])
def test_gears_below_the_critical_speed_are_rigid(share):
    chain = one_on(3, GEAR, MASS)
    speed = share * critical_speed(GEAR, chain.mass, 1)
    found = measured(collide(chain, [speed, 0.0, 0.0, 0.0]))
    stroke = rigid_stroke(GEAR, chain.mass, 1, speed)
    assert found.final_velocity == pytest.approx(tuple(rigid_collision(chain.mass, 1, speed)), abs=1e-9)
    assert (found.speed_ratio, found.speed_margin) == pytest.approx((share, 1.0 - share))
    assert (found.rigidity, found.rigidity_at_detachment) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert found.restitution == pytest.approx(1.0, abs=1e-9)
    assert (found.momentum_deficit, found.energy_deficit) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert (found.absorbed_by_contacts, found.absorbed_by_bed) == (0.0, 0.0)
    assert found.contact_time == pytest.approx(stroke.contact_time, rel=1e-9)
    assert found.peak_force == pytest.approx(stroke.peak_force, rel=1e-6)
    # According to Eq. (5), all beads have the same acceleration.
    accelerations = [contact.peak_acceleration for contact in found.contacts]
    assert accelerations == pytest.approx([stroke.peak_force / (3 * MASS)] * 3, rel=1e-6)
    for inner in found.contacts[1:]:
        assert inner.loaded == 0.0
        assert inner.touching == pytest.approx(stroke.contact_time, rel=1e-9)


def test_a_coupler_is_loaded_for_as_long_as_it_is_pulled_out():
    push, pull = draft_gear(20.0, 0.05), draft_gear(30.0, 0.04)
    chain = Chain([1.0, 3.0], Coupler(push, pull=pull, slack=0.1))
    found = simulate(chain, [0.0, 1.0], 1.2)  # The contact is first pulled, then pushed.
    loaded = one_on_one(pull, 0.75, 1.0).contact_time + one_on_one(push, 0.75, 1.0).contact_time
    assert measures.dwell(found, 0)[0] == pytest.approx([1.1 - loaded, 0.0, loaded], abs=3e-3)


def test_softer_is_more_rigid_in_every_measure():
    found = [measured(collide(one_on(4, power_law(1.0, a)), [1, 0, 0, 0, 0])) for a in (1.5, 0.5, 0.1, 1 / 14)]
    for name, falls in (("rigidity", True), ("energy_inside", True), ("restitution", False)):
        values = [getattr(one, name) for one in found]
        assert values == sorted(values, reverse=falls), name
    during, after = found[-1].rigidity_at_detachment, found[-1].rigidity
    assert during < after < 0.25  # The velocities diverge after the beads separate, see Sec. IV of the paper.
    shares, ends = [contact.transmitted for contact in found[2].contacts], found[2].final_velocity
    assert shares == sorted(shares, reverse=True)
    # The other values are the momentum that is not reflected.
    assert (shares[0], shares[-1]) == pytest.approx((1.0 - ends[0], ends[-1]), rel=1e-6)


def test_a_longer_way_to_the_target_changes_nothing():
    near, far = Chain([1, 1, 1], power_law(1.0, 0.2)), Chain([1, 1, 1], power_law(1.0, 0.2), [0.7, 0.0])
    a, b = (measured(collide(chain, [1, 0, 0])) for chain in (near, far))
    assert b.detachment == pytest.approx(a.detachment + 0.7, rel=1e-8)
    assert b.contact_time == pytest.approx(a.contact_time, rel=1e-8)
    assert b.contacts[1].open == pytest.approx(a.contacts[1].open, abs=1e-7)
    assert b.rigidity == pytest.approx(a.rigidity, rel=1e-6)


def test_a_contact_far_shorter_than_the_run_is_measured():
    law = hertz(1e9)
    found = measured(collide(Chain([1, 1, 1], [law, hertz(1.0)], [0.0, 1.0]), [1.0, 0.0, 0.0]))
    assert found.peak_force == pytest.approx(one_on_one(law, 0.5, 1.0).peak_force, rel=2e-3)


def test_a_force_that_jumps_passes_its_momentum_on_a_bed_too():
    free, on_bed = (Chain([10, 0.1, 10], step_force(100.0), [0.0, 0.5], friction=friction) for friction in (0.0, 1e-9))
    # The light bead collides eleven times.
    a, b = (measured(collide(chain, [1.0, 0.0, 0.0])) for chain in (free, on_bed))
    assert [c.momentum for c in b.contacts] == pytest.approx([c.momentum for c in a.contacts], rel=1e-3)


def test_against_a_wall():
    found = measured(collide(Chain([1, 1, math.inf], hertz(2.0), [0.0, 0.5]), [1.0, 1.0, 0.0]))
    assert found.struck == 1
    assert found.rigidity is None  # There is only a wall behind the contact that is hit.
    assert found.peak_acceleration is None
    # A small part of the momentum oscillates inside the cluster.
    assert found.contacts[1].momentum == pytest.approx(4.0, rel=0.02)
    assert 0.9 < found.restitution <= 1.0


def test_measures_without_mean_velocity_or_approach():
    assert math.isinf(measures.rigidity([-1.0, 1.0]))
    with pytest.raises(ValueError, match="no two neighbours approach"):
        measured(simulate(one_on(2, hertz(1.0)), [0, 0, 1]))


def test_loss_of_one_on_one_is_its_restitution():
    found = measured(collide(one_on(1, draft_gear(770.0, 0.0177, loss=0.64), MASS), [1.0, 0.0]))
    assert found.restitution == pytest.approx(0.6, abs=2e-3)  # The expected restitution is sqrt(1 - loss).
    # The loss refers to the energy of the approaching beads, which is half of the total energy.
    assert found.absorbed_by_contacts == pytest.approx(0.5 * 0.64, rel=1e-2)
    assert found.absorbed_by_bed == 0.0
    assert found.momentum_deficit == pytest.approx(0.0, abs=1e-9)
    assert found.energy_deficit == pytest.approx(found.absorbed_by_contacts, rel=1e-2)


def test_the_bed_takes_momentum():
    friction, speed, way = 0.2, 1.0, 0.05
    trajectory = collide(Chain([MASS] * 4, GEAR, [way, 0.0, 0.0], friction=friction), [speed, 0.0, 0.0, 0.0])
    found = measured(trajectory)
    left = 0.5 * MASS * (trajectory.velocity[-1] ** 2).sum() / (0.5 * MASS * speed**2)
    assert found.absorbed_by_bed == pytest.approx(1.0 - left, rel=1e-9)
    assert found.rigidity == pytest.approx(0.0, abs=1e-9)
    # Beads that rest side by side without a force do not count as touching.
    assert found.contacts[1].touching == pytest.approx(found.contact_time, rel=2e-3)
    impact = math.sqrt(speed**2 - 2.0 * friction * 9.80665 * way)
    free = measured(collide(one_on(3, GEAR, MASS), [impact, 0.0, 0.0, 0.0]))
    assert found.contact_time == pytest.approx(free.contact_time, rel=0.2)
    # Friction with the bed acts on up to four beads while the striker is in contact.
    most = 4.0 * friction * 9.80665 * found.contact_time / impact
    assert 0.2 * most < found.momentum_deficit < most
    assert 0.0 < found.energy_deficit < 0.5
    assert found.restitution < free.restitution
    gained = 3.0 * MASS * measures.interpolated(trajectory, trajectory.velocity, found.detachment)[1]
    # All three targets slide while the striker pushes them.
    taken = 3.0 * friction * MASS * 9.80665 * found.contact_time
    assert found.momentum == pytest.approx(gained + taken, rel=2e-3)
    assert found.contacts[2].momentum == pytest.approx((gained + taken) / 3.0, rel=2e-3)


def test_the_scaling_variable_of_the_spread_is_that_of_one_on_n_alike():
    """Check that equal scaling variables give equal spreads of the velocities for any n and alpha. The scaling variable
    is None for chains of other kinds.
    """
    found = []
    for n, inverse in ((4, 10.0), (8, 16.0 * math.log(9.0 / measures.spread_variable(4, 0.1)))):
        chain = one_on(n, power_law(1.0, 1.0 / inverse))
        found.append(measured(collide(chain, [1.0] + [0.0] * n)))
    assert [one.spread_variable for one in found] == pytest.approx([measures.spread_variable(4, 0.1)] * 2)
    assert found[1].rigidity == pytest.approx(found[0].rigidity, rel=0.1)
    assert (found[0].speed_ratio, found[0].speed_margin) == (None, None)
    others = [
        (one_on(3, power_law(1.0, 0.1), [1.0, 1.0, 2.0, 1.0]), [1, 0, 0, 0]),
        (cluster_on_cluster(2, 2, power_law(1.0, 0.1)), [1, 1, 0, 0]),
        (one_on(3, GEAR), [0.1, 0, 0, 0]),
        (one_on(3, (power_law(1.0, 0.1), power_law(1.0, 0.1), hertz(1.0))), [1, 0, 0, 0]),
        (one_on(1, power_law(1.0, 0.1)), [1, 0]),
        (Chain([1] * 4, power_law(1.0, 0.1), gap=[0, 0.3, 0.3]), [1, 0, 0, 0]),
    ]
    assert [measured(collide(chain, start)).spread_variable for chain, start in others] == [None] * 6


@pytest.mark.parametrize(
    "changes", [{"gap": [0, 0.3, 0.3]}, {"gap": [-0.3, 0, 0]}, {"drive": [0.1, 0, 0, 0]}, {"friction": 0.1}]
)
def test_clusters_that_are_apart_or_pushed_have_no_critical_speed(changes):
    """Check that the critical speed is not defined for four draft gears with gaps or initial pressure. These clusters
    are not rigid at any speed.
    """
    chain = Chain([1.0] * 4, GEAR, **changes)
    assert closed_forms.speed_ratio(chain, 0, 0.1) is None
    assert closed_forms.speed_ratio(Chain([1.0] * 4, GEAR, gap=[0.3, 0, 0]), 0, 0.1) > 0.0


PULLED, SOFT = (Coupler(hooke(1e3), gear, slack=0.1) for gear in (hooke(1e3), power_law(1e3, 0.5)))
CARRIED = [(PULLED, "accurate"), (lambda overlap: 100.0 * overlap, "accurate"), (SOFT, "conserving")]


@pytest.mark.parametrize(("law", "method"), CARRIED)
def test_couplers_and_user_defined_laws_are_measured(law, method):
    """Check that critical speed and scaling variable are None for couplers and user-defined laws. The method `accurate`
    rejects pulling gears with an exponent below 1.
    """
    run = collide(one_on(2, law), [1, 0, 0], 0.5, samples=101)
    found = measured(run)
    assert run.method == method
    assert (found.speed_ratio, found.speed_margin, found.spread_variable) == (None, None, None)
    assert found.contacts[0].transmitted > 0.5
    assert sum(found.final_velocity) == pytest.approx(1.0)


@pytest.mark.parametrize("first", [0.0, 2.0])
def test_momentum_is_that_passed_within_the_samples(first):
    """Compare the transmitted momentum with the integral of the contact force. External forces act on both sides of the
    contact, and the samples cover only a part of the run.
    """
    forces = [TimedForce(0, [0.0, 4.0], [0.0, 2.0]), TimedForce(1, 0.0, -0.5)]
    chain = Chain([1.0, 2.0], hooke(10.0), drive=[1.0, -0.5], forces=forces)
    found = simulate(chain, [0.0, 0.0], 10.0, samples=np.linspace(first, 5.0, 5001))
    passed = np.trapezoid(found.force[:, 0], found.time)
    assert measures.impulses(found, 0) == pytest.approx([passed], rel=1e-5)


def test_inner_contacts_of_small_exponents_ring_about_their_branch():
    trajectory = collide(one_on(2, power_law(1.0, 1 / 20)), [1, 0, 0], samples=20_001)
    assert measured(trajectory).contacts[1].turns >= 7
    assert measured(collide(one_on(2, power_law(1.0, 1 / 10)), [1, 0, 0])).contacts[0].turns == 1
    struck = simulate(trajectory.chain, [1, 0, 0], trajectory.contact_intervals[1][0][1], samples=20_001)
    found = ringing(struck.time, struck.force[:, 1])
    assert found.period == pytest.approx(2.0 * math.pi * measures.response_times(struck)[1], rel=0.03)
    assert 0.0 < found.amplitude < 1e-4
    assert abs(found.decay) * found.period < 1.0  # The oscillation lasts for many periods.
    told, alone = (found.period, found.amplitude, found.decay), measured(struck).contacts[1]
    assert (alone.ringing_period, alone.ringing_amplitude, alone.ringing_decay) == pytest.approx(told)


def test_the_evanescent_mode_reaches_no_deeper_than_n_alpha():
    for n, alpha in ((4, 0.1), (6, 0.1), (8, 0.05)):
        found = measured(collide(one_on(n, power_law(1.0, alpha)), [1.0] + [0.0] * n))
        assert 0.1 * n * alpha < found.penetration_depth < n * alpha
    assert measured(collide(one_on(2, power_law(1.0, 0.1)), [1, 0, 0])).penetration_depth is None
    softer_inside = one_on(3, [power_law(1.0, 0.1), power_law(1.0, 0.1), hooke(0.2)])
    assert measured(collide(softer_inside, [1, 0, 0, 0])).penetration_depth is None
