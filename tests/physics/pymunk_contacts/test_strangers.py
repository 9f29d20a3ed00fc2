"""Soft contacts as strangers use them: bodies removed, shared or static: an error, or it works."""

import math

import pymunk
import pytest
from softcradle.physics import SoftChain, SoftContact, hertz

from tests.helpers.spaces import chain_row, cradle, momentum, pair, run

STEP = 1 / 240
LAW = hertz(100.0)


def kinetic(bodies):
    return sum(0.5 * body.mass * body.velocity.length**2 for body in bodies)


def test_a_body_removed_whose_contact_stays():
    space, (a, b), _ = pair(native=False)
    a.velocity = 1, 0
    space.step(STEP)
    space.remove(b)
    with pytest.raises(RuntimeError, match="remove its contacts with it"):
        run(space, STEP, 20)


@pytest.mark.parametrize("gone", [0, 2, 4])
def test_a_body_removed_whose_chain_stays(gone):
    space, bodies, chain = chain_row(LAW)
    space.step(STEP)
    space.remove(bodies[gone])
    with pytest.raises(RuntimeError, match=rf"body {gone} .* chain.remove_from\(space, body\)"):
        run(space, STEP, 20)
    chain.remove_from(space, bodies[gone])
    before = momentum(bodies)
    run(space, STEP, 480)
    assert momentum(bodies) == pytest.approx(before, abs=1e-13)


@pytest.mark.parametrize("chained", [True, False])
def test_the_only_body_before_a_wall_removed(chained):
    """None of the two bodies is in the Space then, and yet it says so."""
    space, ball, wall = pymunk.Space(), pymunk.Body(1, 1), pymunk.Body(body_type=pymunk.Body.STATIC)
    wall.position = 0.99, 0
    links = SoftChain([ball, wall], LAW, 1.0) if chained else [SoftContact(ball, wall, (0, 0), (0, 0), 1.0, LAW, False)]
    space.add(ball, *links)
    space.step(1e-3)
    space.remove(ball)
    with pytest.raises(RuntimeError, match="is not in the Space"):
        space.step(1e-3)


def test_two_chains_that_share_a_body():
    space, bodies, _ = chain_row(LAW, beads=3)
    space.add(*SoftChain(bodies[1:], LAW, 1.0))
    with pytest.raises(RuntimeError, match="two SoftChains"):
        space.step(STEP)


def test_two_chains_joined_by_a_contact():
    """In small steps, for a SoftContact is symplectic Euler."""
    space, bodies, (first, _, last) = cradle(LAW, beads=4)
    space.remove(first, last)
    space.add(*SoftChain(bodies[:2], LAW, 1.0), *SoftChain(bodies[2:], LAW, 1.0))
    run(space, 1e-3, 4000)
    assert bodies[3].velocity.x > 0.5
    assert kinetic(bodies) == pytest.approx(0.5, rel=0.02)


def test_a_static_body_needs_no_place_in_the_space():
    space, ball, wall = pymunk.Space(), pymunk.Body(1, 1), pymunk.Body(body_type=pymunk.Body.STATIC)
    ball.velocity, wall.position = (1, 0), (1.5, 0)
    space.add(ball, *SoftChain([ball, wall], LAW, 1.0))
    run(space, STEP, 480)
    assert ball.velocity.x == pytest.approx(-1.0, abs=1e-12)


def swing_energy(count, seconds, step=STEP, string=pymunk.PinJoint, law=None):
    """Energy after over before of a row of pendulums of 1 m on strings, the first of them released at 0.5 rad."""
    space = pymunk.Space()
    space.gravity = 0, -9.81
    bodies = [pymunk.Body(1, 1e9) for _ in range(count)]
    for i, body in enumerate(bodies):
        angle = -0.5 if i == 0 else 0.0
        body.position = 0.1 * i + math.sin(angle), -math.cos(angle)
        space.add(body, string(space.static_body, body, (0.1 * i, 0), (0, 0)))
    chain = SoftChain(bodies, law or hertz(1e7), 0.1) if count > 1 else None
    space.add(*(chain or ()))

    def energy():
        heights = [1.0 + body.position.y + 0.5 * step * body.velocity.y for body in bodies]
        return kinetic(bodies) + 9.81 * sum(heights) + (chain.energy if chain else 0.0)

    start = energy()
    run(space, step, round(seconds / step))
    return energy() / start


@pytest.mark.slow
def test_a_cradle_on_pin_joints_loses_what_pin_joints_lose():
    """The numbers are those of the docstring of SoftChain."""
    plain, cradle = swing_energy(1, 60.0), swing_energy(5, 60.0)
    assert plain == pytest.approx(1.0 - 0.055, abs=0.005)
    assert cradle == pytest.approx(1.0 - 0.041, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("rate", [60, 120, 240])
def test_a_cradle_on_slide_joints_gains_nothing_at_sixty_steps_a_second_and_more(rate):
    assert 0.8 < swing_energy(5, 30.0, 1 / rate, lambda *ends: pymunk.SlideJoint(*ends, 0.0, 1.0), hertz(1e6)) < 1.0
