"""Tests of contacts that are tables of segments. All methods must follow the same graph, the energy balance must be
correct, and wrong graphs must be rejected.
"""

import math

import numpy as np
import pytest
from softcradle.physics.methods import METHODS, find_method, refusal_of
from softcradle.physics.segments import PiecewiseContact, Segment, SegmentTable

from examples.largest_force import LargestForce
from examples.two_stage_buffer import TwoStageBuffer
from softcradle import Chain, Contact, Coupler, OwnLaw, Trajectory, draft_gear, hooke, one_on, power_law
from tests.helpers.relations import fineness, simulate_quietly

CARRY = [method.name for method in METHODS if method.couplers]
GEAR = Contact(0.3, 3.0, 1.3, loss=0.4)
LINK = Coupler(GEAR, pull=GEAR, slack=0.1, travel=0.2, stop=50.0)
ELASTIC = Coupler(Contact(0.3, 3.0, 1.3), pull=Contact(0.2, 2.0, 1.5), slack=0.1, travel=0.2, stop=50.0)


def accuracy(method: str) -> float:
    """Return the allowed error of `method` with the steps and tolerances of this file. The error is relative to the
    speed, the force or the energy.
    """
    found = find_method(method)
    return 1e-7 if found.adaptive else {1: 1e-2}.get(found.order, 1e-3)


def motion(chain: Chain, velocity: list[float], duration: float, method: str, step: float = 1e-3) -> Trajectory:
    return simulate_quietly(chain, velocity, duration, method, samples=201, **fineness(method, step, tolerance=1e-9))


@pytest.mark.parametrize("method", CARRY)
def test_a_contact_with_a_largest_force_against_its_closed_form(method):
    """Compare a contact with a largest force with its closed form. The contact is a preloaded spring up to this force
    and then a constant force. The energy balance must include its potential energy.
    """
    preload, stiffness, most, speed = 0.2, 2.0, 1.0, 2.0
    crush = LargestForce(draft_gear(stiffness, preload / stiffness), most=most)
    way = (most - preload) / stiffness
    at_yield = math.sqrt(speed**2 - 2.0 * preload * way - stiffness * way**2)
    swing, begin = math.sqrt(stiffness), preload / stiffness
    first = (math.atan2(swing * (way + begin), at_yield) - math.atan2(swing * begin, speed)) / swing
    turn, error = first + at_yield / most, accuracy(method)
    found = motion(Chain([1.0, math.inf], crush), [speed, 0.0], 2.5 * turn, method)
    # Sample 80 is at the turning point.
    assert found.overlap[80, 0] == pytest.approx(way + at_yield**2 / 2.0 / most, abs=error)
    assert found.force.max() == pytest.approx(most, abs=1e-12)
    assert found.velocity[80, 0] == pytest.approx(0.0, abs=error)
    assert found.final_velocity[0] == pytest.approx(-speed, abs=error)
    ((closed, opened),) = found.contact_intervals[0]
    assert (closed, opened) == (pytest.approx(0.0, abs=1e-9), pytest.approx(2.0 * turn, abs=error))
    stored = np.array([way * (preload + 0.5 * stiffness * way) + most * (d - way) for d in found.overlap[40:120, 0]])
    np.testing.assert_allclose(found.contact_energy[40:120], stored, rtol=1e-12)
    np.testing.assert_allclose(found.ledger, found.ledger[0], rtol=error)


@pytest.mark.parametrize("link", [LINK, ELASTIC], ids=["with loss", "elastic"])
@pytest.mark.parametrize("method", CARRY)
def test_a_coupler_with_slack_and_stop_does_the_same_by_each_method(method, link):
    """Check that all methods agree on a coupler with slack and stops. The coupler is pushed into its stop, moves back
    through the slack, and is pulled into the other stop.
    """
    chain, velocity = Chain([1.0, 1.5, 1.0], link, gap=[0.0, 0.05]), [3.0, 0.0, -1.0]
    if refusal_of(method, chain):
        assert link.loss
        assert method == "yoshida4"
        return
    truth, found = (motion(chain, velocity, 3.0, name) for name in ("accurate", method))
    assert truth.overlap.max() > link.travel
    assert truth.overlap.min() < -link.slack - link.travel
    error = accuracy(method)
    np.testing.assert_allclose(found.velocity, truth.velocity, atol=10.0 * error)
    np.testing.assert_allclose(found.overlap, truth.overlap, atol=10.0 * error)
    np.testing.assert_allclose(found.ledger, found.ledger[0], rtol=error)
    assert found.absorbed_by_contacts[-1] == pytest.approx(truth.absorbed_by_contacts[-1], abs=10.0 * error)


@pytest.mark.parametrize(
    "law", [hooke(20.0), power_law(20.0, 1.5), power_law(2.0, 0.5), draft_gear(20.0, 0.05)], ids=str
)
@pytest.mark.parametrize("method", [method.name for method in METHODS])
def test_a_user_defined_law_that_is_a_power_law_moves_as_one(method, law):
    velocity = [1.0, 0.0, 0.0]
    own = OwnLaw(lambda overlap: law.preload + law.stiffness * overlap**law.exponent)
    plain, found = (motion(one_on(2, contact), velocity, 2.0, method) for contact in (law, own))
    error = 1e-6 if find_method(method).adaptive else 1e-9  # With fixed steps the two motions agree at each step.
    np.testing.assert_allclose(found.velocity, plain.velocity, atol=error)
    np.testing.assert_allclose(found.ledger, plain.ledger, atol=error)


@pytest.mark.parametrize("method", [name for name in CARRY if find_method(name).dissipative])
def test_a_contact_of_two_stages_dissipates_its_part_of_the_energy(method):
    """Check the example of the documentation. A body bounces off a wall with sqrt(1 - loss) of its speed. The largest
    overlap is checked as well.
    """
    buffer, speed = TwoStageBuffer(soft=1.0, hard=10.0, change=0.5, hysteresis=0.36), 2.0
    found = motion(Chain([1.0, math.inf], buffer), [speed, 0.0], 3.0, method)
    depth = (
        0.5 + (math.sqrt(0.25 + 10.0 * (speed**2 - 0.25)) - 0.5) / 10.0
    )  # Solution of soft change²/2 + force x + hard x²/2 = v²/2.
    error = accuracy(method)
    assert found.overlap.max() == pytest.approx(depth, abs=1e-3)  # The largest overlap is between two samples.
    assert found.final_velocity[0] == pytest.approx(-0.8 * speed, abs=error)
    assert found.absorbed_by_contacts[-1] == pytest.approx(0.36 * 0.5 * speed**2, abs=2.0 * error)
    np.testing.assert_allclose(found.ledger, found.ledger[0], rtol=error)


def test_one_segment_is_the_contact_itself():
    """Check that a graph with a single power law gives bitwise the same motion as the power law. The kernels treat the
    graph and the power law in the same way.
    """
    contact = Contact(0.1, 3.0, 1.5)
    rows = SegmentTable(contact.segments)
    for method in CARRY:
        plain, found = (motion(one_on(2, law), [1.0, 0.0, 0.0], 1.0, method) for law in (contact, rows))
        assert np.array_equal(plain.velocity, found.velocity), method


ONE = Segment(1.0, 0.0, 0.0, 2.0, 1.0)
WRONG = {
    "begins at 1": ([ONE._replace(origin=1.0)], "must have a segment that pushes from overlap 0 on"),
    "order": ([ONE, ONE._replace(side=-1.0, origin=-1.0)], "from left to right, pulling segments first"),
    "a hole": ([ONE._replace(length=1.0), ONE._replace(origin=2.0)], "ends at 1 m, and the next begins at 2 m"),
    "a fall": ([ONE._replace(length=1.0), ONE._replace(origin=1.0)], "the force falls from 2 to 0 N at 1 m"),
    "no end": ([ONE._replace(length=1.0)], "the last segment must have the length inf, not 1 m"),
    "a slope": ([ONE._replace(length=1.0), Segment(1.0, 1.0, 2.0, 0.0, 1.0, stop=-1.0)], "falls on the segment from 1 m on"),
    "a table": ([OwnLaw(lambda d: d).segments[0]._replace(loss=0.5)], "must be the only one, and without loss"),
}  # fmt: skip


@pytest.mark.parametrize(("segments", "sentence"), WRONG.values(), ids=WRONG)
def test_segments_that_are_not_a_monotone_graph_are_refused(segments, sentence):
    with pytest.raises(ValueError, match=sentence):
        Chain([1.0, 1.0], SegmentTable(tuple(segments)))


def test_a_contact_without_segments_is_refused():
    with pytest.raises(NotImplementedError, match="class PiecewiseContact must define segments"):
        Chain([1.0, 1.0], PiecewiseContact())


def test_force_and_energy_of_a_graph_are_those_of_its_gears():
    overlaps = np.array([-0.7, -0.2, -0.05, 0.0, 0.1, 0.2, 0.5])
    loading = [-GEAR.force(0.6) - 50.0 * 0.4, -GEAR.force(0.1), 0.0, 0.0, GEAR.force(0.1), GEAR.force(0.2)]
    loading.append(GEAR.force(0.5) + 50.0 * 0.3)
    unloading = [0.6 * GEAR.force(d) for d in (0.6, 0.1, 0.0, 0.0, 0.1, 0.2, 0.5)]
    stop = np.array([-50.0 * 0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 50.0 * 0.3])
    np.testing.assert_allclose(LINK.force(overlaps), loading, atol=1e-12)
    np.testing.assert_allclose(LINK.released(overlaps), np.sign(overlaps) * unloading + stop, atol=1e-12)
    stored = [GEAR.energy(d) for d in (0.6, 0.1, 0.0, 0.0, 0.1, 0.2, 0.5)]
    np.testing.assert_allclose(LINK.energy(overlaps), np.array(stored) + stop**2 / 100.0, atol=1e-12)
    assert LINK.force(0.1) == GEAR.force(0.1)
    assert isinstance(LINK.energy(0.1), float)


def test_a_trajectory_file_keeps_the_segments(tmp_path):
    crush = LargestForce(draft_gear(2.0, 0.1), most=1.0)
    found = motion(Chain([1.0, 1.0], crush), [2.0, 0.0], 1.0, "verlet")
    found.save(tmp_path / "crush.npz")
    again = Trajectory.load(tmp_path / "crush.npz")
    assert again.chain.contact == (SegmentTable(tuple(crush.segments)),)
    np.testing.assert_array_equal(again.contact_energy, found.contact_energy)
