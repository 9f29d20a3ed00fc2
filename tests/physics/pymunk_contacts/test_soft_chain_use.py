"""SoftChain in a changing Space: bodies moved, contacts changed, joints, shapes, sleep."""

import itertools
import math

import numpy as np
import pymunk
import pytest
from softcradle.physics import SoftChain, draft_gear, hertz, hooke, power_law

from tests.helpers.spaces import FRAME, chain_row, momentum, run, total_energy


@pytest.mark.parametrize("law", [power_law(1.0, 0.1), hertz(1e6), draft_gear(1e4, 0.02)], ids=str)
def test_a_velocity_set_between_steps_adds_its_energy_alone(law):
    """It moves no body, so it may press no contact, however stiff."""
    space, bodies, chain = chain_row(law, speed=0.0)
    run(space, FRAME, 10)
    assert total_energy(bodies, chain) == 0.0
    bodies[0].velocity = 1.0, 0.0
    for _ in range(600):
        space.step(FRAME)
        assert total_energy(bodies, chain) == pytest.approx(0.5, rel=1e-10)
    assert bodies[4].velocity.x > 0.2
    assert chain.energy == 0.0


def test_a_velocity_changed_during_a_collision():
    space, bodies, chain = chain_row(hooke(30.0), gap=0.1)
    run(space, FRAME, 15)
    stored = chain.energy
    assert stored > 0.01
    bodies[2].velocity += pymunk.Vec2d(-1.0, 0.0)
    energy = sum(0.5 * body.mass * body.velocity.dot(body.velocity) for body in bodies) + stored
    for _ in range(600):
        space.step(FRAME)
        assert total_energy(bodies, chain) == pytest.approx(energy, rel=1e-10)


def test_a_body_moved_away_and_back():
    space, bodies, chain = chain_row(hooke(30.0), gap=0.1)
    run(space, FRAME, 15)
    assert chain.overlaps[0] > 0.0
    bodies[0].position = -5.0, 0.0
    bodies[0].velocity = 0.0, 0.0
    run(space, FRAME, 1)
    assert chain.overlaps[0] == pytest.approx(-5.0, abs=0.2)
    assert chain.forces[0] == 0.0
    run(space, FRAME, 100)
    bodies[0].position = bodies[1].position - (0.9, 0.0)
    bodies[0].velocity = bodies[1].velocity
    run(space, FRAME, 1)
    assert chain.overlaps[0] == pytest.approx(0.1, abs=0.01)
    assert chain.forces[0] == pytest.approx(30.0 * 0.1, rel=0.05)
    energy = total_energy(bodies, chain)
    run(space, FRAME, 300)
    assert total_energy(bodies, chain) == pytest.approx(energy, rel=1e-10)
    assert energy > 0.15


def test_overlaps_follow_bodies_whose_positions_are_set():
    """A body moved a little in every step: the overlaps that the chain sums up stay those of the positions."""
    space, bodies, chain = chain_row(hooke(30.0), gap=0.1)
    for _ in range(200):
        space.step(FRAME)
        bodies[2].position += pymunk.Vec2d(0.003, 0.001)
    space.step(FRAME)
    places = chain.positions
    apart = [(b - a).length for a, b in itertools.pairwise(places)]
    np.testing.assert_allclose(chain.overlaps, 1.0 - np.array(apart), atol=1e-9)


@pytest.mark.parametrize("law", [hertz(1e4), hooke(1e6), draft_gear(1e4, 0.02)], ids=str)
def test_a_body_tied_along_the_row_is_a_wall(law):
    """A body that strikes it comes back, and one between it and a real wall stays."""
    space, bodies, chain = chain_row(law, gap=[0.3, 0.0, 0.0], beads=4, masses=[1.0, 1.0, 1.0, math.inf])
    space.add(pymunk.PinJoint(space.static_body, bodies[2], (5.0, 0.0), (0.0, 0.0)))
    run(space, FRAME, 120)
    assert bodies[0].velocity.x == pytest.approx(-1.0, rel=0.1)
    assert abs(bodies[2].velocity.x) < 0.02
    assert bodies[2].position.x == pytest.approx(2.3, abs=1e-3)
    assert np.isfinite(chain.forces).all()


@pytest.mark.parametrize("spring_first", [True, False])
def test_a_spring_and_a_mouse_joint_add_no_energy(spring_first):
    """A spring before or after the chain in the Space, and a joint of limited force on the last body."""
    space, bodies, chain = chain_row(hertz(1e4), gap=0.2)
    spring = pymunk.DampedSpring(space.static_body, bodies[0], (0, 0), (0, 0), 0.0, 20.0, 0.0)
    joint = pymunk.PivotJoint(space.static_body, bodies[4], (4.2, 0.0), (0.0, 0.0))
    joint.max_force = 5.0
    if spring_first:
        space.remove(*chain)
        space.add(spring, joint, *chain)
    else:
        space.add(spring, joint)

    def energy():
        stretch = chain.positions[0].length
        return total_energy(bodies, chain) + 0.5 * 20.0 * stretch**2

    largest = 0.0
    for _ in range(1200):
        space.step(FRAME)
        largest = max(largest, energy())
    assert largest < 0.55
    assert energy() < 0.4, "the joint takes energy"
    assert all(abs(body.velocity.y) < 1e-12 for body in bodies)


def test_a_spring_between_bodies_keeps_the_energy_at_small_steps():
    """Another force in the Space, kicked before the chain solves: second-order in the step, without a drift."""
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


def test_contacts_changed_live():
    space, bodies, chain = chain_row(hooke(30.0), gap=0.1)
    run(space, FRAME, 15)
    before, overlaps = total_energy(bodies, chain), chain.overlaps
    chain.contacts = [hooke(60.0), *chain.contacts[1:]]
    energy = total_energy(bodies, chain)
    assert energy == pytest.approx(before + 0.5 * 30.0 * max(overlaps[0], 0.0) ** 2, rel=1e-12)
    run(space, FRAME, 300)
    assert total_energy(bodies, chain) == pytest.approx(energy, rel=1e-10)
    assert energy > before


def test_touching_distances_changed_live():
    space, bodies, chain = chain_row(hooke(30.0), speed=0.0)
    run(space, FRAME, 5)
    chain.touching_distances = [1.1, 1.0, 1.0, 1.0]
    assert chain.overlaps == pytest.approx([0.1, 0.0, 0.0, 0.0])
    run(space, FRAME, 300)
    assert total_energy(bodies, chain) == pytest.approx(0.5 * 30.0 * 0.1**2, rel=1e-10)
    assert bodies[0].velocity.x < -0.1


def test_taken_out_and_added_again():
    space, bodies, chain = chain_row(hertz(1e5), gap=0.5)
    space.remove(*chain)
    assert not space.constraints
    run(space, FRAME, 60)
    assert bodies[0].position.x == pytest.approx(1.0)
    bodies[0].position = 0.0, 0.0
    space.add(*chain)
    run(space, FRAME, 120)
    assert bodies[4].velocity.x > 0.5
    assert total_energy(bodies, chain) == pytest.approx(0.5, rel=1e-10)


def test_neighbours_do_not_collide_twice():
    """Shapes of neighbours are left to the chain; other shapes collide with them."""
    space, bodies, chain = chain_row(hooke(30.0), gap=0.1)
    for body in bodies:
        ball = pymunk.Circle(body, 0.5)
        ball.elasticity = 1.0
        space.add(ball)
    wall = pymunk.Segment(space.static_body, (6.0, -1.0), (6.0, 1.0), 0.0)
    wall.elasticity = 1.0
    space.add(wall)
    fastest = 0.0
    for _ in range(400):
        space.step(FRAME)
        fastest = max(fastest, bodies[4].velocity.x)
        assert total_energy(bodies, chain) == pytest.approx(0.5, rel=0.02)
    assert fastest > 0.5
    assert momentum(bodies) < -0.5, "the wall has reversed the momentum"


def test_sleep_and_wake():
    space, bodies, chain = chain_row(draft_gear(1e4, 0.02), speed=0.0)
    space.sleep_time_threshold = 0.2
    run(space, FRAME, 60)
    assert all(body.is_sleeping for body in bodies)
    bodies[0].velocity = 1.0, 0.0
    run(space, FRAME, 120)
    assert bodies[4].velocity.x > 0.3
    assert total_energy(bodies, chain) == pytest.approx(0.5, rel=1e-10)


def test_a_centre_of_gravity_that_is_not_the_origin():
    space = pymunk.Space()
    bodies = [pymunk.Body(1.0, 1.0) for _ in range(3)]
    for i, body in enumerate(bodies):
        body.center_of_gravity = 0.2, 0.3
        body.position = 1.2 * i, 0.0
    bodies[0].velocity = 1.0, 0.0
    chain = SoftChain(bodies, hertz(1e4), 1.0)
    space.add(*bodies, *chain)
    run(space, FRAME, 120)
    assert total_energy(bodies, chain) == pytest.approx(0.5, rel=1e-10)
    assert bodies[2].velocity.x > 0.9
    assert all(body.angular_velocity == 0.0 for body in bodies)
