"""Tests of collisions in a pymunk Space. The tests cover steps that are too long, bodies that pass through each other,
and contacts with loss at rest.
"""

import copy
import itertools
import math
import pickle
import re
import warnings

import numpy as np
import pymunk
import pytest
from softcradle.physics import Contact, SoftChain, SoftContact, draft_gear, hertz, hooke, power_law, step_force
from softcradle.physics.pymunk_contacts import compiled_force
from softcradle.physics.pymunk_contacts.soft_chain import VISIBLE_ERROR

from benchmarks import soft_chains
from tests.helpers.spaces import FRAME, chain_row, run

pytestmark = pytest.mark.filterwarnings("default::RuntimeWarning")
MASS, BALL = math.pi * 20.0**2, 20.0  # Mass [kg] and radius [m] of a ball with a radius of 20 pixels and density 1.
EVERY_LAW = [
    hertz(1e4),
    hooke(1e4),
    power_law(50.0, 0.1),
    draft_gear(1e3, 0.05),
    step_force(20.0),
    Contact(0.0, 1e5, 3.0),
]


def warned(space, step, count):
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        run(space, step, count)
    return [str(one.message) for one in said]


@pytest.mark.parametrize("loss", [0.0, 0.36])
def test_a_chain_warns_once_of_a_step_that_is_too_long_for_a_blow(loss):
    space, bodies, chain = chain_row(hertz(1e6, loss), gap=0.5)
    assert warned(space, FRAME, 25) == [], "the bodies have not met"
    (sentence,) = warned(space, FRAME, 60)
    assert "SoftChain with step 0.0167 s is past its limit of about" in sentence
    assert "at 1 m/s" in sentence
    assert "chain.substeps(dt, speed)" in sentence
    bodies[0].velocity = 2.0, 0.0
    assert warned(space, FRAME, 60) == [], "once for each law in a Space"
    steps = int(re.search(r"take (\d+) steps", sentence)[1])
    assert steps == chain.substeps(FRAME, 1.0)


def test_the_warning_of_a_chain_names_the_calling_line():
    space, *_ = chain_row(hertz(1e6))
    with pytest.warns(RuntimeWarning, match="SoftChain") as said:
        space.step(FRAME)
    assert said[0].filename == __file__
    space, *_ = chain_row(hertz(1e6))
    with warnings.catch_warnings(action="error"), pytest.raises(RuntimeWarning, match="past its limit"):
        space.step(FRAME)


@pytest.mark.parametrize("law", EVERY_LAW, ids=str)
def test_substeps_of_a_chain_are_silent(law):
    space, _, chain = chain_row(law, gap=0.01)
    substeps = chain.substeps(FRAME, 1.0)
    assert warned(space, FRAME / substeps, 60 * substeps) == []
    assert chain.substeps(FRAME, 1.0, VISIBLE_ERROR / 100.0) in range(10 * (substeps - 1), 10 * substeps + 1)


def test_changed_speeds_steps_and_laws_are_checked_again():
    space, bodies, chain = chain_row(Contact(0.0, 1e4, 3.0), beads=2)
    step = FRAME / chain.substeps(FRAME, 1.0)
    assert warned(space, step, 2000) == []

    def strike(speed):
        bodies[0].position = bodies[1].position - (1.05, 0.0)
        bodies[0].velocity = bodies[1].velocity + pymunk.Vec2d(speed, 0.0)

    strike(20.0)
    (sentence,) = warned(space, step, 300)
    assert "at 20 m/s" in sentence
    chain.contact = hertz(1e9)
    strike(1.0)
    assert len(warned(space, step, 300)) == 1


def test_overlapping_bodies_count_as_a_blow_of_their_speed():
    space, bodies, _ = chain_row(hooke(1e6), beads=2, speed=0.0)
    bodies[1].position = 0.99, 0.0
    (sentence,) = warned(space, FRAME, 1)
    assert f"at {math.sqrt(1e6 * 0.01**2 * (1.0 + 1.0 / 1.1)):.3g} m/s" in sentence


def test_a_chain_whose_body_has_no_mass_yet_has_no_substeps():
    with pytest.raises(ValueError, match="body 0 of a SoftChain has no mass yet"):
        SoftChain([pymunk.Body(), pymunk.Body(1, 1)], hertz(1.0), 1.0).substeps(FRAME, 1.0)


def test_recommended_substeps_keep_the_velocity_error():
    """Simulate random chains in which every contact closes once, with and without loss."""
    for allowed, seeds in ((VISIBLE_ERROR, range(60)), (0.01, range(20))):
        found = soft_chains.errors(seeds, allowed)
        assert len(found) >= len(seeds) / 4
        assert [(error, seed) for error, seed in found if error > allowed] == []
    assert max(soft_chains.errors(range(30), 1.0))[0] > VISIBLE_ERROR, "longer steps are worse"


def cradle_on_strings(law, rate, angle=math.pi / 6, string=0.25, pitch=0.0408, mass=0.261):
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    bodies = [pymunk.Body(mass, math.inf) for _ in range(5)]
    for i, body in enumerate(bodies):
        a = -angle if i == 0 else 0.0
        body.position = pitch * i + string * math.sin(a), -string * math.cos(a)
        space.add(body, pymunk.PinJoint(space.static_body, body, (pitch * i, 0.0), (0.0, 0.0)))
    chain = SoftChain(bodies, law, 0.04)
    space.add(*chain)
    return space, bodies, chain


@pytest.mark.parametrize("e", [1.0, 0.8])
def test_substeps_make_a_cradle_with_loss_accurate(e):
    """Compare the speed of the last ball with its exact value v0 ((1 + e) / 2)**4, where v0 = sqrt(2 g L (1 - cos
    30°)).
    """
    law = hooke(1e5, loss=1.0 - e * e)
    v0 = math.sqrt(2.0 * 9.81 * 0.25 * (1.0 - math.cos(math.pi / 6.0)))
    right = v0 * ((1.0 + e) / 2.0) ** 4
    assert len(warned(cradle_on_strings(law, 240)[0], 1 / 240, 108)) == 1
    space, bodies, chain = cradle_on_strings(law, 240)
    substeps, fastest = chain.substeps(1 / 240, v0), 0.0
    for _ in range(108 * substeps):
        space.step(1 / 240 / substeps)
        fastest = max(fastest, bodies[4].velocity.x)
    assert fastest == pytest.approx(right, abs=VISIBLE_ERROR * v0)


# In the following tests, the contact is too soft for the collision. The overlap would exceed the touching distance.

PIXEL_LAWS = [hertz(1e3), hertz(1e4), hooke(1e4), power_law(1e5, 0.5), Contact(1e3, 1e3, 2.0), step_force(1e5)]


def pixel_row(law, kind, balls=2, speed=377.0, native=None, mass=MASS):
    """Return a chain of balls with a radius of 20 pixels and the number of steps per frame. The first ball moves."""
    space = pymunk.Space()
    bodies = [pymunk.Body(mass * (1.0 + 0.3 * i), math.inf) for i in range(balls)]
    for i, body in enumerate(bodies):
        body.position = (2.0 * BALL + (10.0 if i else 0.0)) * i, 0.0
    bodies[0].velocity = speed, 0.0
    space.add(*bodies)
    if kind == "chain":
        links = [*SoftChain(bodies, law, 2.0 * BALL)]
        return space, bodies, links[0].chain.substeps(FRAME, speed), links
    links = [SoftContact(a, b, (0, 0), (0, 0), 2.0 * BALL, law, native) for a, b in itertools.pairwise(bodies)]
    return space, bodies, links[0].substeps(FRAME, speed), links


def stiffer(law, sentence):
    """Return the contact law that a warning recommends."""
    if found := re.search(r"hold with preload=(\S+), stiffness=(\S+)\. ", sentence):
        return Contact(float(found[1]), float(found[2]), law.exponent, law.loss)
    return Contact(0.0, float(re.search(r"hold with a stiffness of (\S+)\. ", sentence)[1]), law.exponent, law.loss)


@pytest.mark.parametrize("balls", [2, 4])
@pytest.mark.parametrize("law", PIXEL_LAWS, ids=str)
@pytest.mark.parametrize(("kind", "native"), [("chain", None), ("contact", None), ("contact", False)])
def test_bodies_that_pass_through_each_other_give_one_warning(kind, native, law, balls):
    space, bodies, steps, links = pixel_row(law, kind, balls, native=native)
    space.add(*links)
    said = warned(space, FRAME / steps, 120 * steps)
    assert bodies[0].position.x > bodies[1].position.x, "they have passed"
    (sentence,) = [one for one in said if "passed through each other" in one]
    assert "touching distance of 40 m" in sentence
    better = stiffer(law, sentence)
    assert better.stiffness > law.stiffness or better.preload > law.preload
    space, bodies, steps, links = pixel_row(better, kind, balls, native=native)
    space.add(*links)
    assert warned(space, FRAME / steps, 120 * steps) == []
    assert all(a.position.x < b.position.x for a, b in itertools.pairwise(bodies))


@pytest.mark.parametrize("kind", ["chain", "contact"])
def test_the_recommended_stiffness_stops_random_blows(kind):
    random, passed = np.random.default_rng(5), 0
    for _ in range(25):
        law = Contact(
            0.0, 10.0 ** random.uniform(1.0, 4.0), float(random.uniform(0.3, 2.5)), float(random.choice([0.0, 0.4]))
        )
        balls, speed, mass = (
            int(random.integers(2, 5)),
            float(random.uniform(50.0, 500.0)),
            float(random.uniform(10.0, 2000.0)),
        )
        space, bodies, steps, links = pixel_row(law, kind, balls, speed, mass=mass)
        space.add(*links)
        said = [one for one in warned(space, FRAME / steps, 60 * steps) if "passed through" in one]
        if not said:
            assert all(a.position.x < b.position.x for a, b in itertools.pairwise(bodies))
            continue
        passed += 1
        space, bodies, steps, links = pixel_row(stiffer(law, said[0]), kind, balls, speed, mass=mass)
        space.add(*links)
        assert [one for one in warned(space, FRAME / steps, 60 * steps) if "passed through" in one] == []
        assert all(a.position.x < b.position.x for a, b in itertools.pairwise(bodies))
    assert passed > 8


def test_the_warning_for_a_user_defined_law_names_the_missing_force():
    def my_spring(overlap):
        return 1e3 * overlap

    space, bodies, _, links = pixel_row(my_spring, "contact")
    space.add(*links)
    (sentence,) = [one for one in warned(space, FRAME / 8, 960) if "passed through" in one]
    times = float(re.search(r"hold with a force (\S+) times as large", sentence)[1])
    assert "my_spring" in sentence
    space, bodies, _, links = pixel_row(lambda d: 1e3 * times * d, "contact")
    space.add(*links)
    run(space, FRAME / 64, 120 * 64)
    assert bodies[0].position.x < bodies[1].position.x


def test_a_ball_that_falls_through_the_floor_is_named():
    """Drop a ball that is too heavy for its contact. No overlap gives a force as large as its weight."""
    for kind in ("chain", "contact"):
        space, ball, floor = pymunk.Space(), pymunk.Body(10.0, math.inf), pymunk.Body(body_type=pymunk.Body.STATIC)
        space.gravity, ball.position = (0.0, -900.0), (0.0, 25.0)
        law = hooke(100.0)
        links = (
            [SoftContact(ball, floor, (0, 0), (0, 0), 20.0, law)]
            if kind == "contact"
            else [*SoftChain([ball, floor], law, 20.0)]
        )
        space.add(ball, *links)
        (sentence,) = warned(space, FRAME / 8, 400)
        assert "passed through each other" in sentence
        better = stiffer(law, sentence)
        ball.position, ball.velocity = (0.0, 25.0), (0.0, 0.0)
        space.remove(*links)
        links = (
            [SoftContact(ball, floor, (0, 0), (0, 0), 20.0, better)]
            if kind == "contact"
            else [*SoftChain([ball, floor], better, 20.0)]
        )
        space.add(*links)
        assert warned(space, FRAME / 8, 400) == []
        assert ball.position.y > 0.0


def test_a_pass_within_one_step_asks_for_shorter_steps():
    for kind in ("chain", "contact"):
        space, _, _, links = pixel_row(hertz(1e12), kind, speed=3500.0)
        space.add(*links)
        (sentence,) = [one for one in warned(space, FRAME, 3) if "passed" in one]
        assert "within one step, though the contact between them is stiff enough: take shorter steps" in sentence


def test_glancing_blows_and_moved_bodies_give_no_warning():
    space, bodies, _ = chain_row(hooke(1e3), beads=3, speed=0.0)
    # The user moves the body to the other side of its neighbour and back again.
    for place in ((5.0, 0.0), (-3.0, 0.2), (0.0, 0.0)):
        bodies[0].position = place
        assert warned(space, 1e-3, 20) == []
    for links in ("chain", "contact"):
        space, a, b = pymunk.Space(), pymunk.Body(1, math.inf), pymunk.Body(1, math.inf)
        a.position, b.position, a.velocity = (0.0, 0.6), (2.0, 0.0), (3.0, 0.0)
        space.add(
            a,
            b,
            *(
                [SoftContact(a, b, (0, 0), (0, 0), 1.0, hooke(5.0))]
                if links == "contact"
                else SoftChain([a, b], hooke(5.0), 1.0)
            ),
        )
        assert warned(space, 1e-3, 2000) == []
        assert a.position.x > b.position.x, "soft balls may glide past each other"


# The following tests check contacts with loss at rest.


@pytest.mark.parametrize(
    "law", [hooke(2000.0, loss=0.5), hertz(5e4, loss=0.3), draft_gear(1e3, 0.02, loss=0.4)], ids=str
)
@pytest.mark.parametrize("rate", [240, 960])
def test_a_lossy_contact_at_rest_carries_the_weight(law, rate):
    space = pymunk.Space()
    space.gravity = 15.0, 0.0
    box, wall = pymunk.Body(2.0, math.inf), pymunk.Body(body_type=pymunk.Body.STATIC)
    box.position, wall.position = (0.47, 0.0), (1.0, 0.0)
    contact = SoftContact(box, wall, (0, 0), (0, 0), 0.5, law)
    space.add(box, contact)
    run(space, 1 / rate, 10 * rate)
    for _ in range(8):
        space.step(1 / rate)
        assert contact.impulse * rate == pytest.approx(30.0, rel=1e-9)
    assert abs(box.velocity.x) < 1e-12
    assert law.force(contact.overlap) * (1.0 - law.loss) - 1e-9 <= 30.0 <= law.force(contact.overlap) + 1e-9
    held = contact.overlap
    # Within the range given by the loss, the contact carries a different load at the same overlap.
    load = (1.0 - 0.5 * law.loss) * law.force(held)
    space.gravity = 0.5 * load, 0.0
    run(space, 1 / rate, rate)
    assert contact.impulse * rate == pytest.approx(load, rel=1e-9)
    assert contact.overlap == pytest.approx(held, abs=(load + 30.0) / 2.0 / rate**2)


@pytest.mark.parametrize("order", [1, -1])
def test_a_column_of_lossy_contacts_comes_to_rest_in_any_order(order):
    space, floor = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.STATIC)
    space.gravity = 0.0, -10.0
    bodies = [pymunk.Body(1.0 + 0.3 * i, math.inf) for i in range(4)]
    for i, body in enumerate(bodies):
        body.position = 0.0, 1.02 * (i + 1)
    contacts = [
        SoftContact(a, b, (0, 0), (0, 0), 1.0, hooke(2e4, 0.6)) for a, b in itertools.pairwise([floor, *bodies])
    ]
    space.add(*bodies, *contacts[::order])
    run(space, 1 / 960, 960 * 8)
    assert max(body.velocity.length for body in bodies) < 1e-9
    above = [sum(body.mass for body in bodies[i:]) for i in range(4)]
    assert [contact.impulse * 960 for contact in contacts] == pytest.approx([10.0 * mass for mass in above], rel=1e-6)


@pytest.mark.parametrize("loss", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("law", [hertz, hooke])
def test_the_restitution_of_a_lossy_contact_is_first_order_in_the_step(law, loss):
    wrong = []
    for parts in (1, 8):
        space, a, b = pymunk.Space(), pymunk.Body(1.0, math.inf), pymunk.Body(1.7, math.inf)
        b.position, a.velocity = (1.01, 0.0), (1.0, 0.0)
        contact = SoftContact(a, b, (0, 0), (0, 0), 1.0, law(1e4, loss))
        space.add(a, b, contact)
        substeps = contact.substeps(FRAME, 1.0) * parts
        run(space, FRAME / substeps, 60 * substeps)
        wrong.append(abs(b.velocity.x - a.velocity.x - math.sqrt(1.0 - loss)))
    assert wrong[0] < 0.03
    assert wrong[1] < 0.005


@pytest.mark.parametrize("duplicate", [copy.deepcopy, lambda s: s.copy(), lambda s: pickle.loads(pickle.dumps(s))])
def test_copies_of_a_lossy_contact_move_alike(duplicate):
    space = pymunk.Space()
    space.gravity = 0.0, -10.0
    ball, floor = pymunk.Body(1.0, math.inf), pymunk.Body(body_type=pymunk.Body.STATIC)
    ball.position = 0.0, 1.1
    space.add(ball, floor, SoftContact(ball, floor, (0, 0), (0, 0), 1.0, hooke(1e4, 0.5)))
    for _ in range(20):
        run(space, 1e-3, 17)
        other = duplicate(space)
        for each in (space, other):
            run(each, 1e-3, 40)
        assert [tuple(b.velocity) + tuple(b.position) for b in other.bodies] == [
            tuple(b.velocity) + tuple(b.position) for b in space.bodies
        ]


# The following tests check mistakes of users.


def test_contacts_whose_bodies_are_not_in_the_space_are_named():
    bodies = [pymunk.Body(1.0, 1.0) for _ in range(3)]
    for i, body in enumerate(bodies):
        body.position = 0.9 * i, 0.0
    space = pymunk.Space()
    chain = SoftChain(bodies, hertz(100.0), 1.0)
    space.add(*chain)
    for _ in range(2):
        with pytest.raises(RuntimeError, match=r"its bodies are not: space.add\(\*chain.bodies\)"):
            space.step(FRAME)
    space.add(*bodies)
    run(space, FRAME, 60)
    assert bodies[2].velocity.x > 0.0
    other = pymunk.Space()
    a, b = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    b.position = 0.9, 0.0
    other.add(SoftContact(a, b, (0, 0), (0, 0), 1.0, hertz(100.0)))
    with pytest.raises(RuntimeError, match="a body of a SoftContact is not in the Space: add it"):
        other.step(FRAME)


def test_links_by_index():
    _, bodies, chain = chain_row(hertz(100.0))
    links = list(chain)
    assert [chain[0], chain[3], chain[-1]] == [links[0], links[3], links[3]]
    assert (chain[1].a, chain[1].b) == (bodies[1], bodies[2])
    with pytest.raises(IndexError):
        chain[4]


def test_contacts_refuse_to_step_back_in_time():
    space, *_ = chain_row(hertz(100.0))
    with pytest.raises(ValueError, match=r"SoftChain cannot step back.*dt must be > 0, not -0.01.*chain.restore"):
        space.step(-0.01)
    space, a, b = pymunk.Space(), pymunk.Body(1, 1), pymunk.Body(1, 1)
    b.position = 0.95, 0.0
    space.add(a, b, SoftContact(a, b, (0, 0), (0, 0), 1.0, hooke(100.0)))
    with pytest.raises(ValueError, match=r"SoftContact cannot step back in time: dt must be > 0, not -0.01"):
        space.step(-0.01)


def test_no_compiled_callback_is_lost_to_deep_contacts():
    """Check a contact with a large overlap in which the balls do not pass through each other. The compiled callback
    must give bitwise the same results as the Python callback.
    """
    if reason := compiled_force.unavailable():
        pytest.skip(reason)
    ends = []
    for native in (True, False):
        space, a, b = pymunk.Space(), pymunk.Body(1, 1), pymunk.Body(1, 1)
        b.position, a.velocity = (1.05, 0.0), (1.0, 0.0)
        contact = SoftContact(a, b, (0, 0), (0, 0), 1.0, hooke(1.0), native=native)
        space.add(a, b, contact)
        run(space, 1e-2, 115)
        assert contact.overlap > 0.5
        run(space, 1e-2, 400)
        ends.append((*a.position, *a.velocity, *b.velocity))
    assert ends[0] == ends[1]


def test_both_names_of_the_touching_distance_are_accepted():
    bodies = [pymunk.Body(1, 1), pymunk.Body(1, 1)]
    for name in ("touching_distance", "touching_distances"):
        assert SoftChain(bodies, hertz(1.0), **{name: 2.0}).touching_distance.tolist() == [2.0]
    with pytest.raises(ValueError, match="needs its touching_distance"):
        SoftChain(bodies, hertz(1.0))
