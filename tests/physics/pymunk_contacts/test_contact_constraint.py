"""Tests of SoftContact in a pymunk Space: forces, geometry, error messages and copies. Compiled callbacks must give
bitwise the same results as Python callbacks.
"""

import copy
import math
import pickle
from unittest.mock import Mock

import pymunk
import pytest
from softcradle.physics import draft_gear, hertz, hooke, power_law
from softcradle.physics.pymunk_contacts import compiled_force
from softcradle.physics.pymunk_contacts.contact_constraint import SoftContact

from tests.helpers.spaces import LAWS, LOSS, Quadratic, cradle, pair, run


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("native", [None, False])
def test_one_step_gives_the_impulse_of_the_law(law, native):
    space, (a, b), contact = pair(0.75, law, native=native)
    space.step(0.01)
    assert contact.overlap == pytest.approx(0.25, abs=1e-15)
    assert contact.impulse == pytest.approx(0.01 * law.force(0.25), rel=1e-14)
    assert (a.velocity.x, b.velocity.x) == pytest.approx((-contact.impulse, contact.impulse / 3.0), rel=1e-14)


def test_anchors_turn_with_their_bodies():
    """Check a contact between the ends of two rotated rods. The force must act along the line between the anchors and
    turn the bodies.
    """
    space = pymunk.Space()
    a, b = pymunk.Body(1.0, 2.0), pymunk.Body(1.0, 2.0)
    a.angle, b.angle, b.position = math.pi / 2, math.pi, (1.0, 1.4)
    # The ends of the rods are at (0, 1) and (0, 1.4).
    contact = SoftContact(a, b, (1.0, 0.0), (1.0, 0.0), 0.5, hooke(10.0))
    space.add(a, b, contact)
    assert contact.overlap == pytest.approx(0.1)
    space.step(1e-6)
    impulse = 1e-6 * 10.0 * 0.1
    assert a.velocity == pytest.approx((0.0, -impulse), abs=1e-18)
    assert b.velocity == pytest.approx((0.0, impulse), abs=1e-18)
    assert a.angular_velocity == pytest.approx(0.0, abs=1e-18)
    assert b.angular_velocity == pytest.approx(-impulse / 2.0, rel=1e-9)


@pytest.mark.parametrize("native", [None, False])
def test_a_new_contact_or_distance_takes_effect_at_once(native):
    space, _, contact = pair(0.75, hooke(10.0), native=native)
    space.step(1e-9)
    contact.contact = draft_gear(20.0, 0.1)
    space.step(1e-9)
    assert contact.impulse == pytest.approx(1e-9 * (2.0 + 5.0))
    contact.touching_distance = 1.05
    space.step(1e-9)
    assert contact.impulse == pytest.approx(1e-9 * (2.0 + 6.0))
    assert contact.rest_length == 1.05
    contact.rest_length = 0.5
    space.step(1e-9)
    assert contact.impulse == 0.0
    assert contact.touching_distance == 0.5


@pytest.mark.parametrize("law", [Quadratic(), Quadratic().force])
def test_a_law_that_is_no_contact_or_a_force_func_of_the_user(law):
    space, (a, _), contact = pair(0.75, law)
    assert contact.energy == pytest.approx(100.0 * 0.25**3 / 3.0, rel=1e-9)
    space.step(1.0)
    assert (contact.impulse, a.velocity.x) == (6.25, -6.25)
    contact.contact = hooke(4.0)
    assert contact.native is not bool(compiled_force.unavailable())
    contact.force_func = lambda spring, distance: 7.0
    space.step(1.0)
    assert contact.impulse == 7.0
    assert contact.native is False


def test_errors_in_laws_reach_the_caller_of_step():
    law = Quadratic(fails_at=0.2)
    space, bodies, contacts = cradle(law, speed=0.0)

    def step_at(distance):
        for i, body in enumerate(bodies):
            body.position = distance * i, 0.0
        space.step(0.01)

    for _ in range(2):
        with pytest.raises(ZeroDivisionError, match=r"overlap 0\.25") as caught:
            step_at(0.75)
        assert caught.value.__notes__ == ["3 more callbacks failed in the same step"]
        assert bodies[0].velocity == (0.0, 0.0), "no wrong force"
        step_at(2.0)
    law.force = Mock(side_effect=KeyboardInterrupt)
    with pytest.raises(KeyboardInterrupt):
        step_at(0.75)
    for contact in contacts:
        contact.contact = hooke(10.0)
    step_at(0.75)
    assert bodies[0].velocity.x == pytest.approx(-0.01 * 10.0 * 0.25)


@pytest.mark.parametrize("native", [None, False])
@pytest.mark.parametrize("duplicate", [copy.deepcopy, lambda s: s.copy(), lambda s: pickle.loads(pickle.dumps(s))])
def test_copies_move_alike(native, duplicate):
    space, bodies, _ = cradle(power_law(2.0, 0.5), native)
    run(space, count=300)
    other = duplicate(space)
    for each in (space, other):
        run(each)
    assert [tuple(body.velocity) for body in other.bodies] == [tuple(body.velocity) for body in bodies]
    assert [contact.native for contact in other.constraints] == [contact.native for contact in space.constraints]
    assert bodies[4].velocity.x > 0.03


def test_bad_contacts_and_distances_leave_the_old_ones():
    contact = pair(law=hooke(10.0))[2]
    with pytest.raises(ValueError, match="touching_distance"):
        contact.touching_distance = math.nan
    with pytest.raises(ValueError, match="contact must be"):
        contact.contact = 10.0
    with pytest.raises(AttributeError, match="set its contact"):
        contact.stiffness = 10.0
    with pytest.raises(AttributeError, match="damper"):
        contact.damping = 1.0
    assert (contact.contact, contact.touching_distance) == (hooke(10.0), 1.0)
    assert contact.stiffness == contact.damping == 0.0


@pytest.mark.parametrize("collide", [False, True])
def test_it_replaces_the_collision_of_shapes(collide):
    """Check that only the contact pushes overlapping discs apart. The shapes must collide only if the user requests
    collisions.
    """
    space, bodies, contact = pair(0.75, hooke(1e-6))
    assert not contact.collide_bodies
    contact.collide_bodies = collide
    space.add(*[pymunk.Circle(body, 0.5) for body in bodies])
    run(space)
    assert (bodies[1].position.x - bodies[0].position.x > 0.76) is collide


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.skipif(bool(compiled_force.unavailable()), reason=compiled_force.unavailable())
def test_compiled_and_python_give_the_same_digits(law):
    ends = []
    for compiled in (True, False):
        space, bodies, contacts = cradle(law, compiled)
        assert all(contact.native is compiled for contact in contacts)
        run(space)
        ends.append([tuple(body.position) + tuple(body.velocity) for body in bodies])
    assert ends[0] == ends[1]


@pytest.mark.parametrize(
    ("law", "reason"), [(Quadratic(), "not a Contact"), (hertz(100.0, LOSS), "depends on velocities")]
)
def test_native_true_refuses_what_it_cannot_compile(law, reason):
    assert not pair(law=law)[2].native
    with pytest.raises(RuntimeError, match=f"no compiled callback .*{reason}; native=None"):
        pair(law=law, native=True)


def test_a_contact_with_loss():
    space, balls, _ = pair(law=hertz(100.0, LOSS), masses=(1.0, 1.0))
    balls[0].velocity = 1.0, 0.0
    run(space, 1e-4, 20_000)
    assert balls[1].velocity.x - balls[0].velocity.x == pytest.approx(math.sqrt(1.0 - LOSS), rel=1e-3)


def test_another_memory_layout_is_noticed(monkeypatch):
    """Check a version of pymunk with a different memory layout, which the test imitates. The compiled callback must not
    be used, and the contact must still work.
    """
    # Call the function that creates the callback without its cache.
    monkeypatch.setattr(compiled_force, "_callback", compiled_force._callback.__wrapped__)
    monkeypatch.setattr(compiled_force, "LAW_SLOT", 17)
    with pytest.raises(RuntimeError, match=r"no compiled callback .* another way; native=None"):
        pair(native=True)
    space, (a, _), contact = pair(0.75)
    space.step(1.0)
    assert contact.native is False
    assert a.velocity.x == -2.5
