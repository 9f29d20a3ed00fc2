"""Tests of SoftChain in a pymunk Space. Energy and momentum must be conserved at 60 steps per second, with all contact
laws and after changes by the user.
"""

import copy
import itertools
import math
import pickle
from unittest.mock import Mock

import numpy as np
import pymunk
import pytest
from softcradle.physics import Chain, Contact, SoftChain, SoftContact, simulate
from softcradle.physics.contact import draft_gear, hertz, hooke, power_law, step_force
from softcradle.physics.pymunk_contacts import soft_chain

from tests.helpers.spaces import FRAME, LAWS, LOSSY, chain_row, momentum, run, total_energy

STEP = 1 / 240
LAW = hertz(100.0)


@pytest.mark.parametrize("gap", [0.0, 0.3])
@pytest.mark.parametrize("law", [*LAWS, power_law(1.0, 1 / 14), hertz(1e6), hooke(1e9)], ids=str)
def test_a_collision_at_frame_rate_conserves_energy_and_momentum(law, gap):
    """Check energy and momentum during a collision after a flight. Let X and V be the positions and velocities of the
    bodies. The energy in the contacts is computed from the positions x = X + (step/2) V.
    """
    space, bodies, chain = chain_row(law, gap)
    largest = 0.0
    for _ in range(600):
        space.step(FRAME)
        assert total_energy(bodies, chain) == pytest.approx(0.5, rel=1e-10)
        assert momentum(bodies) == pytest.approx(1.0, abs=1e-12)
        places = [body.position.x + 0.5 * FRAME * body.velocity.x for body in bodies]
        stored = sum(law.energy(1.0 - (b - a)) for a, b in itertools.pairwise(places))
        assert stored == pytest.approx(chain.energy, abs=5e-11) or gap == 0.0
        largest = max(largest, chain.energy)
    assert bodies[4].velocity.x > 0.2
    assert largest > 0.0 or law.stiffness > 1e5, "energy went through the contacts"


@pytest.mark.parametrize("law", [power_law(1.0, 0.1), power_law(1.0, 1 / 30), hertz(20.0), step_force(1.0)], ids=str)
def test_moves_as_method_conserving(law):
    """Compare a chain of bodies with the method conserving. Some overlaps are smaller than the resolution of the
    positions.
    """
    step = 0.01
    read_out = 0.5 * step  # The positions of the bodies are half a step behind their velocities.
    space, bodies, chain = chain_row(law, gap=0.3 + read_out, beads=8, masses=[1.0] * 8)
    model = Chain([1.0] * 8, law, [0.3, 0, 0, 0, 0, 0, 0])
    expected = simulate(model, [1.0] + [0.0] * 7, 1.5, "conserving", step, samples=step * np.arange(1, 151))
    for row in range(150):
        space.step(step)
        np.testing.assert_allclose(chain.overlaps, expected.overlap[row], rtol=1e-6, atol=1e-13)
        np.testing.assert_allclose([body.velocity.x for body in bodies], expected.velocity[row], rtol=0, atol=1e-11)
    if law.exponent < 0.05:
        assert 0.0 < expected.overlap[60].min() < 1e-18
        np.testing.assert_allclose(chain.overlaps, expected.overlap[-1], rtol=1e-6)


@pytest.mark.parametrize("law", [hooke(100.0), hertz(1e5), power_law(1.0, 0.1)], ids=str)
def test_a_bent_row(law):
    """Check a chain that bends by 20 degrees at every body. The cosine of this angle couples the forces. The lines
    between the bodies turn, which causes an error of second order in the step.
    """
    lost = []
    for parts in (1, 10):
        space, bodies, chain = chain_row(law, beads=6, masses=[1.0] * 6)
        for i in range(5):
            bodies[i + 1].position = bodies[i].position + pymunk.Vec2d(1.0, 0.0).rotated(0.35 * (i + 1))
        start = bodies[0].velocity = pymunk.Vec2d(1.0, 0.0).rotated(0.35)
        run(space, FRAME / parts, 240 * parts)
        total = sum((body.velocity for body in bodies), pymunk.Vec2d(0.0, 0.0))
        assert total == pytest.approx(start, abs=1e-12)
        assert bodies[5].velocity.length > 0.1
        lost.append(abs(1.0 - total_energy(bodies, chain) / 0.5))
    assert lost[0] < 1e-3
    assert lost[1] < 0.05 * lost[0]


def test_a_wall_that_moves():
    """Check a chain that a kinematic body pushes. Bodies must leave an elastic wall of speed u at the speed 2 u."""
    space, bodies, chain = chain_row(hertz(1e5), beads=2, masses=[math.inf, 1.0], gap=0.5)
    run(space, FRAME, 120)
    assert bodies[0].velocity.x == 1.0
    assert bodies[1].velocity.x == pytest.approx(2.0, rel=1e-9)
    assert chain.energy == 0.0


@pytest.mark.parametrize("law", [hertz(1e6), power_law(200.0, 0.1), draft_gear(1e4, 0.02)], ids=str)
def test_a_column_bounces_without_loss_under_gravity(law):
    space, bodies, chain = chain_row(law, gap=0.5, beads=4, direction=(0, 1), masses=[math.inf, 1, 1, 1], speed=0)
    space.gravity = 0.0, -10.0
    energy = 10.0 * (1.5 + 2.5 + 3.5)
    heights = []
    for _ in range(600):
        space.step(FRAME)
        found = total_energy(bodies[1:], chain) + 10.0 * sum(place.y for place in chain.positions[1:])
        assert found == pytest.approx(energy, abs=0.5 * 3 * 10.0 * 10.0 * FRAME**2 / 4)
        heights.append(found)
    assert np.ptp(heights) < 1e-9, "after the first half step it stays"


@pytest.mark.parametrize("step", [1 / 480, 1 / 120, 1 / 30])
@pytest.mark.parametrize("loss", [0.3, 0.75])
def test_a_column_that_loses_comes_to_rest(loss, step):
    """Check that bounces which are shorter than a step lose energy. Otherwise the bodies would reverse at each step
    forever.
    """
    law = Contact(200.0, 1e4, 1.0, loss)
    space, bodies, chain = chain_row(law, beads=4, direction=(0, 1), masses=[math.inf, 1, 1.3, 1.6], speed=0)
    space.gravity, bodies[3].velocity = (0.0, -10.0), (0.0, -1.0)
    run(space, step, round(8.0 / step))
    assert np.abs([body.velocity.y for body in bodies]).max() < 1e-6
    assert chain.forces == pytest.approx([39.0, 29.0, 16.0], rel=1e-6)
    assert [body.position.y for body in bodies] == pytest.approx(range(4), abs=2e-3)


LOSING = [(Contact(1e4, 1e3, 1.0, loss=0.75), step, 10, 1e-9) for step in (1 / 480, 1 / 120, 1 / 30)]
LOSING += [(law, 1e-3, 6000, 1e-2) for law in LOSSY.values()]


@pytest.mark.parametrize(("law", "step", "count", "allowed"), LOSING)
def test_a_collision_has_its_restitution(law, step, count, allowed):
    """Check collisions that last many steps and collisions shorter than a step."""
    space, bodies, chain = chain_row(law, beads=2, speed=0.5, masses=[1.0, 1.0])
    run(space, step, count)
    assert bodies[1].velocity.x - bodies[0].velocity.x == pytest.approx(0.5 * math.sqrt(1.0 - law.loss), rel=allowed)
    assert total_energy(bodies, chain) + chain.absorbed == pytest.approx(0.125, rel=1e-9)
    assert momentum(bodies) == pytest.approx(0.5, abs=1e-9)


def assert_energy_stays(space, bodies, chain, energy=0.5, frames=300):
    for _ in range(frames):
        space.step(FRAME)
        assert total_energy(bodies, chain) == pytest.approx(energy, rel=1e-10)


@pytest.mark.parametrize("sleeps", [False, True])
@pytest.mark.parametrize("law", [power_law(1.0, 0.1), hertz(1e6), draft_gear(1e4, 0.02)], ids=str)
def test_a_velocity_set_between_steps_adds_only_its_energy(law, sleeps):
    """Check that setting a velocity moves no body. The new velocity must not compress any contact, however stiff the
    contact is. A sleeping chain must wake.
    """
    space, bodies, chain = chain_row(law, speed=0.0)
    space.sleep_time_threshold = 0.2 if sleeps else math.inf
    run(space, FRAME, 60)
    assert total_energy(bodies, chain) == 0.0
    assert [body.is_sleeping for body in bodies] == [sleeps] * 5
    bodies[0].velocity = 1.0, 0.0
    assert_energy_stays(space, bodies, chain, frames=600)
    assert bodies[4].velocity.x > (0.3 if law.preload else 0.2)
    assert chain.energy == 0.0


def test_a_body_set_into_its_neighbour_is_pressed_from_then_on():
    space, bodies, chain = chain_row(hooke(30.0), gap=0.1)
    run(space, FRAME, 15)
    bodies[0].position, bodies[0].velocity = bodies[1].position - (0.9, 0.0), bodies[1].velocity
    run(space, FRAME, 1)
    assert chain.overlaps[0] == pytest.approx(0.1, abs=0.01)
    assert chain.forces[0] == pytest.approx(30.0 * 0.1, rel=0.05)
    assert_energy_stays(space, bodies, chain, total_energy(bodies, chain))


@pytest.mark.parametrize("law", [hertz(100.0), hertz(100.0, 0.3)], ids=str)
def test_bodies_at_one_place_do_not_push_until_they_are_moved(law):
    space, bodies, chain = chain_row(law, speed=0.0)
    for body in bodies:
        body.position = 0.0, 0.0
    run(space, FRAME, 10)
    assert [body.velocity for body in bodies] == [(0.0, 0.0)] * 5
    assert (chain.overlaps.tolist(), chain.forces.tolist()) == ([1.0] * 4, [0.0] * 4)
    bodies[4].position = 0.9, 0.0
    run(space, FRAME, 2)
    assert bodies[4].velocity.x > 0.04


def test_overlaps_follow_bodies_whose_positions_are_set():
    """Check a body that is moved a little before every step. The chain accumulates the overlaps, and the overlaps must
    agree with the positions of the bodies.
    """
    space, bodies, chain = chain_row(hooke(30.0), gap=0.1)
    for _ in range(200):
        space.step(FRAME)
        bodies[2].position += pymunk.Vec2d(0.003, 0.001)
    space.step(FRAME)
    apart = [(b - a).length for a, b in itertools.pairwise(chain.positions)]
    np.testing.assert_allclose(chain.overlaps, 1.0 - np.array(apart), atol=1e-9)


@pytest.mark.parametrize("law", [hertz(1e4), hooke(1e6), draft_gear(1e4, 0.02)], ids=str)
def test_a_body_tied_along_the_row_is_a_wall(law):
    """Check that a body bounces off a neighbour that is tied along the line of the chain. A body between a tied body
    and a wall must stay at its place.
    """
    space, bodies, chain = chain_row(law, gap=[0.3, 0.0, 0.0], beads=4, masses=[1.0, 1.0, 1.0, math.inf])
    space.add(pymunk.PinJoint(space.static_body, bodies[2], (5.0, 0.0), (0.0, 0.0)))
    run(space, FRAME, 120)
    assert bodies[0].velocity.x == pytest.approx(-1.0, rel=0.1)
    assert abs(bodies[2].velocity.x) < 0.02
    assert bodies[2].position.x == pytest.approx(2.3, abs=1e-3)
    assert np.isfinite(chain.forces).all()


@pytest.mark.parametrize("cut", [True, False])
def test_a_string_that_is_cut_or_has_no_force_holds_nothing(cut):
    space, bodies, chain = chain_row(hertz(1e4))
    string = pymunk.PinJoint(space.static_body, bodies[2], (5.0, 0.0), (0.0, 0.0))
    space.add(string)
    if cut:
        space.remove(string)
    string.max_force = math.inf if cut else 0.0
    assert_energy_stays(space, bodies, chain)


@pytest.mark.parametrize("law", [hertz(1e4), power_law(50.0, 0.1), draft_gear(1e4, 0.02)], ids=str)
def test_collisions_with_elastic_walls_add_no_energy(law):
    """Check that a collision with a wall ends in the step in which it happens. The chain must not predict another
    collision for the next step.
    """
    space, bodies, chain = chain_row(law, gap=0.1, beads=3)
    ends = [pymunk.Segment(space.static_body, (x, -1), (x, 1), 0.5) for x in (-1.2, 3.4)]
    space.add(*ends, *(pymunk.Circle(body, 0.5) for body in bodies))
    for shape in space.shapes:
        shape.elasticity = 1.0
    most = 0.0
    for _ in range(1800):
        space.step(FRAME)
        most = max(most, total_energy(bodies, chain))
    assert most < 0.5 * 1.001


@pytest.mark.parametrize("spring_first", [True, False])
def test_a_spring_and_a_mouse_joint_add_no_energy(spring_first):
    """Check the energy with a spring and with a joint of limited force on the last body. The spring is added before or
    after the chain.
    """
    space, bodies, chain = chain_row(hertz(1e4), gap=0.2)
    spring = pymunk.DampedSpring(space.static_body, bodies[0], (0, 0), (0, 0), 0.0, 20.0, 0.0)
    joint = pymunk.PivotJoint(space.static_body, bodies[4], (4.2, 0.0), (0.0, 0.0))
    joint.max_force = 5.0
    links = list(chain) if spring_first else []
    space.remove(*links)
    space.add(spring, joint, *links)
    for _ in range(1200):
        space.step(FRAME)
        energy = total_energy(bodies, chain) + 0.5 * 20.0 * chain.positions[0].length ** 2
        assert energy < 0.55
    assert energy < 0.4, "the joint takes energy"
    assert all(abs(body.velocity.y) < 1e-12 for body in bodies)


def test_a_spring_between_bodies_keeps_the_energy_at_small_steps():
    """Check a spring force that acts before the chain solves its step. The energy error must be of second order and
    must not drift.
    """
    drifts = []
    for step in (FRAME, FRAME / 8):
        space, bodies, chain = chain_row(hertz(100.0), gap=0.2, beads=3)
        spring = pymunk.DampedSpring(bodies[0], bodies[2], (0, 0), (0, 0), 2.2, 15.0, 0.0)
        space.remove(*chain)
        space.add(spring, *chain)
        energies = []
        for _ in range(round(20.0 / step)):
            space.step(step)
            apart = (chain.positions[2] - chain.positions[0]).length
            energies.append(total_energy(bodies, chain) + 7.5 * (apart - 2.2) ** 2)
        drifts.append(np.abs(np.array(energies) - 0.5).max())
        assert momentum(bodies) == pytest.approx(1.0, abs=1e-11)
    assert drifts[0] < 0.05
    assert drifts[1] < 0.05 * drifts[0]


def test_a_changing_step():
    space, bodies, chain = chain_row(power_law(1.0, 0.1), gap=0.3)
    for i in range(1500):
        space.step((0.004, 0.011, 0.016)[i % 3])
        assert total_energy(bodies, chain) == pytest.approx(0.5, rel=1e-10)
    assert bodies[4].velocity.x > 0.3


def test_contacts_and_touching_distance_changed_live():
    space, bodies, chain = chain_row(hooke(30.0), speed=0.0)
    run(space, FRAME, 5)
    chain.touching_distance = [1.1, 1.0, 1.0, 1.0]
    assert chain.overlaps == pytest.approx([0.1, 0.0, 0.0, 0.0])
    chain.contact = [hooke(60.0), *chain.contact[1:]]
    assert_energy_stays(space, bodies, chain, 0.5 * 60.0 * 0.1**2)
    assert bodies[0].velocity.x < -0.1


def test_removed_links_do_not_push():
    space, bodies, chain = chain_row(hertz(1e5), gap=0.5)
    chain.remove_from(space)
    run(space, FRAME, 60)
    assert bodies[0].position.x == pytest.approx(1.0)
    bodies[0].position = 0.0, 0.0
    space.add(*chain)
    assert_energy_stays(space, bodies, chain, frames=31)  # In these frames no contact is compressed yet.
    assert chain.forces.max() > 0.0
    chain.remove_from(space)
    assert not space.constraints
    for frames in (0, 60):
        run(space, FRAME, frames)
        assert (chain.forces.tolist(), chain.overlaps.tolist(), chain.energy) == ([0.0] * 4, [-math.inf] * 4, 0.0)


@pytest.mark.parametrize("way", ["remove_from", "as every constraint", "contacts alone"])
@pytest.mark.parametrize("law", [hertz(1e4), power_law(1.0, 0.1), draft_gear(1e3, 0.02)], ids=str)
def test_a_middle_body_dies_and_two_rows_go_on(law, way):
    """Check that the two remaining parts of a chain move like two separate chains. The results must be bitwise equal if
    the solver needs the same number of iterations.
    """
    space, (*first, dead, third, fourth, fifth), chain = chain_row(law, beads=6, masses=[1.0] * 6)
    if way == "remove_from":
        chain.remove_from(space, dead)
    else:
        space.remove(*(dead.constraints & space.constraints))
    if way == "contacts alone":
        dead.position = 2.0, 50.0
    else:
        space.remove(dead)
    parts = [chain_row(law, beads=count, masses=[1.0] * count) for count in (2, 3)]
    third.velocity = 1.0, 0.0
    for each in (space, parts[0][0], parts[1][0]):
        run(each, FRAME, 240)
    alive = [*first, third, fourth, fifth]
    expected = [body.velocity.x for part in parts for body in part[1]]
    assert [body.velocity.x for body in alive] == pytest.approx(expected, abs=1e-9)
    assert expected[1] > 0.99 or law.exponent < 1.0
    assert total_energy(alive, chain) == pytest.approx(1.0, rel=1e-10)
    assert (chain.overlaps[1:3].tolist(), chain.forces[1:3].tolist()) == ([-math.inf] * 2, [0.0] * 2)


def test_a_body_that_left_may_join_another_chain():
    space, bodies, chain = chain_row(hertz(1e3), masses=[1.0] * 5)
    chain.remove_from(space, bodies[4])
    late = pymunk.Body(1.0, math.inf)
    late.position = 5.0, 0.0
    other = SoftChain([bodies[4], late], hertz(1e3), 1.0)
    space.add(late, *other)
    assert SoftChain.of(space) == [chain, other]
    bodies[4].velocity = 1.0, 0.0
    run(space, FRAME, 120)
    assert late.velocity.x == pytest.approx(1.0, rel=1e-6)
    with pytest.raises(ValueError, match="no contacts of a body that is not in it"):
        chain.remove_from(space, late)


def frames(space, chain, count):
    """Return the state of all moving objects in each of `count` frames."""
    found = []
    for _ in range(count):
        space.step(FRAME)
        found += [(body.position, body.velocity, body.angle) for body in chain.bodies]
        found += [chain.overlaps.tolist(), chain.forces.tolist(), chain.energy, chain.absorbed]
    return found


@pytest.mark.parametrize("law", [power_law(1.0, 0.1), hertz(1e6), draft_gear(1e3, 0.02, 0.5)], ids=str)
@pytest.mark.parametrize("before", [0, 12, 40])
def test_ten_frames_rolled_back_to_the_bit(law, before):
    """Check that ten frames can be repeated with bitwise equal results. The start is restored from the state of the
    chain, from a copy of the Space, or from a pickle. This start is before the first step, during a collision, or
    after a collision.
    """
    space, _, chain = chain_row(law, gap=0.1)
    run(space, FRAME, before)
    state = pickle.loads(pickle.dumps(chain.state))
    copies = [space.copy(), copy.deepcopy(space), pickle.loads(pickle.dumps(space))]
    first = frames(space, chain, 10)
    chain.restore(state)
    assert frames(space, chain, 10) == first
    for copied in copies:
        (theirs,) = SoftChain.of(copied)
        assert theirs is not chain
        assert list(theirs) == list(copied.constraints)
        assert frames(copied, theirs, 10) == first
        theirs.restore(state)
        assert frames(copied, theirs, 10) == first


def test_a_centre_of_gravity_that_is_not_the_origin():
    space = pymunk.Space()
    bodies = [pymunk.Body(1.0, 1.0) for _ in range(3)]
    for i, body in enumerate(bodies):
        body.center_of_gravity = 0.2, 0.3
        body.position = 1.2 * i, 0.0
    bodies[0].velocity = 1.0, 0.0
    chain = SoftChain(bodies, hertz(1e4), 1.0)
    space.add(*bodies, *chain)
    assert_energy_stays(space, bodies, chain, frames=120)
    assert bodies[2].velocity.x > 0.9
    assert all(body.angular_velocity == 0.0 for body in bodies)


@pytest.mark.parametrize("i", [0, 4])
def test_a_moved_centre_of_gravity_is_reported(i):
    space, bodies, _ = chain_row(LAW)
    circle = pymunk.Circle(bodies[i], 0.5, (0.1, 0.0))
    circle.mass = 1.0
    space.add(circle)
    with pytest.raises(RuntimeError, match=f"of gravity of body {i} has moved since its SoftChain was made"):
        space.step(STEP)


def test_a_solver_error_reaches_the_caller_once(monkeypatch):
    space, bodies, _ = chain_row(hertz(1e4), gap=0.01)
    monkeypatch.setattr(soft_chain, "solve_chain_step", Mock(py_func=None, side_effect=FloatingPointError("no forces")))
    with pytest.raises(FloatingPointError, match="no forces") as caught:
        space.step(FRAME)
    assert not hasattr(caught.value, "__notes__")
    monkeypatch.setattr(soft_chain, "solve_chain_step", Mock(py_func=None, return_value=False))
    with pytest.raises(RuntimeWarning, match="did not converge"):
        space.step(FRAME)
    monkeypatch.undo()
    run(space, FRAME, 120)
    assert bodies[4].velocity.x > 0.1


def test_a_link_takes_no_force_of_its_own():
    """Check that a link rejects the attributes of a pymunk spring. These attributes would violate the energy balance or
    be ignored.
    """
    space, bodies, chain = chain_row(hertz(1e4), gap=0.1)
    of_a_spring = ("stiffness", "damping", "rest_length", "anchor_a", "anchor_b", "max_force", "force_func")
    for link, name in itertools.product(chain, of_a_spring):
        with pytest.raises(AttributeError, match=f"takes no {name}: its force is the chain's"):
            setattr(link, name, 0.1)
    assert_energy_stays(space, bodies, chain, frames=60)
    assert [link.max_force for link in chain] == [math.inf] * 4


@pytest.mark.parametrize(("name", "value"), [("velocity", (math.nan, 0.0)), ("force", (math.inf, 0.0))])
def test_a_body_that_is_nowhere_is_named_after_the_step(name, value):
    space, bodies, chain = chain_row(hertz(1e4), gap=0.1)
    run(space, FRAME, 3)
    state = chain.state
    setattr(bodies[1], name, value)
    with pytest.raises(ValueError, match=f"body 1 of a SoftChain has the {name} Vec2d"):
        space.step(FRAME)
    chain.restore(state)
    assert_energy_stays(space, bodies, chain, frames=60)
    assert bodies[4].velocity.x > 0.1


BROKEN = {
    "the first removed": (lambda space, bodies: space.remove(bodies[0]), r"body 0 .* chain.remove_from\(space, body\)"),
    "one removed": (lambda space, bodies: space.remove(bodies[2]), r"body 2 .* chain.remove_from\(space, body\)"),
    "the last removed": (lambda space, bodies: space.remove(bodies[4]), r"body 4 .* chain.remove_from\(space, body\)"),
    "two that nothing moves": (  # pymunk would set the velocities of these bodies to NaN.
        lambda _, bodies: [setattr(body, "body_type", pymunk.Body.STATIC) for body in bodies[1:3]],
        "bodies 1 and 2 are not any more; remove the contact",
    ),
    "two chains": (lambda space, bodies: space.add(*SoftChain(bodies[1:], LAW, 1.0)), "two SoftChains"),
}


@pytest.mark.parametrize(("breaks", "sentence"), BROKEN.values(), ids=BROKEN)
def test_bodies_that_no_longer_are_a_row_are_named(breaks, sentence):
    space, bodies, _ = chain_row(LAW)
    space.step(STEP)
    breaks(space, bodies)
    with pytest.raises(RuntimeError, match=sentence):
        run(space, STEP, 20)


@pytest.mark.parametrize("chained", [True, False])
def test_the_only_body_before_a_wall_removed(chained):
    """Check the error message if neither of the two bodies is in the Space any more."""
    space, ball, wall = pymunk.Space(), pymunk.Body(1, 1), pymunk.Body(body_type=pymunk.Body.STATIC)
    wall.position = 0.99, 0
    links = SoftChain([ball, wall], LAW, 1.0) if chained else [SoftContact(ball, wall, (0, 0), (0, 0), 1.0, LAW, False)]
    space.add(ball, *links)
    space.step(1e-3)
    space.remove(ball)
    with pytest.raises(RuntimeError, match="is not in the Space"):
        space.step(1e-3)


PIN, SLIDE = pymunk.PinJoint, lambda *ends: pymunk.SlideJoint(*ends, 0.0, 1.0)
# With pin joints, the cradle may lose the energy that the docstring of SoftChain states. With slide joints, the energy
# must not grow.
STRINGS = [
    (PIN, hertz(1e7), 60.0, 240, pytest.approx(0.959, abs=0.01)),
    *((SLIDE, hertz(1e6), 30.0, rate, pytest.approx(0.9, abs=0.1)) for rate in (60, 120, 240)),
]


@pytest.mark.slow
@pytest.mark.parametrize(("string", "law", "seconds", "rate", "kept"), STRINGS)
def test_a_cradle_of_pendulums_keeps_its_energy(string, law, seconds, rate, kept):
    """Check the energy of five pendulums of 1 m length. The first pendulum is released at 0.5 rad."""
    space, step = pymunk.Space(), 1.0 / rate
    space.gravity = 0, -9.81
    bodies = [pymunk.Body(1, 1e9) for _ in range(5)]
    for i, body in enumerate(bodies):
        angle = -0.5 if i == 0 else 0.0
        body.position = 0.1 * i + math.sin(angle), -math.cos(angle)
        space.add(body, string(space.static_body, body, (0.1 * i, 0), (0, 0)))
    chain = SoftChain(bodies, law, 0.1)
    space.add(*chain)

    def energy():
        heights = [1.0 + body.position.y + 0.5 * step * body.velocity.y for body in bodies]
        return total_energy(bodies, chain) + 9.81 * sum(heights)

    start = energy()
    run(space, step, round(seconds * rate))
    assert energy() / start == kept
