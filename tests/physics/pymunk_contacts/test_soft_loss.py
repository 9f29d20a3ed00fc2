"""SoftContact and SoftChain with loss: what comes back, what is absorbed, and no compiled callback."""

from __future__ import annotations

import math

import pymunk
import pytest
from softcradle.physics import SoftChain, SoftContact, draft_gear, hertz, power_law, step_force

LOSS = 0.8
LAWS = {
    "draft gear": draft_gear(770.0, 0.0177, LOSS),
    "Hertz": hertz(1.0, LOSS),
    "power law": power_law(1.0, 0.1, LOSS),
    "step": step_force(1.0, LOSS),
}


def space_of(make, speed=1.0):
    """Two balls that touch, the first one moving, and the constraints that `make` gives for them."""
    space = pymunk.Space()
    balls = [pymunk.Body(1, math.inf) for _ in range(2)]
    for i, ball in enumerate(balls):
        ball.position = i, 0
    balls[0].velocity = speed, 0
    made = make(balls)
    space.add(*balls, *made)
    return space, balls, made


def test_a_soft_contact_with_loss():
    space, balls, made = space_of(lambda b: [SoftContact(*b, (0, 0), (0, 0), 1.0, hertz(100.0, LOSS))])
    assert not made[0].native
    for _ in range(20_000):
        space.step(1e-4)
    assert balls[1].velocity.x - balls[0].velocity.x == pytest.approx(math.sqrt(0.2), rel=1e-3)
    with pytest.raises(RuntimeError, match="depends on velocities"):
        SoftContact(*balls, (0, 0), (0, 0), 1.0, hertz(100.0, LOSS), native=True)


@pytest.mark.parametrize("law", LAWS)
def test_a_soft_chain_with_loss(law):
    space, balls, (link,) = space_of(lambda b: list(SoftChain(b, LAWS[law], 1.0)), 0.5)
    for _ in range(10_000):
        space.step(1e-3)
    chain = link.chain
    assert balls[1].velocity.x - balls[0].velocity.x == pytest.approx(0.5 * math.sqrt(0.2), rel=1e-2)
    kinetic = sum(0.5 * ball.mass * ball.velocity.length**2 for ball in balls)
    assert kinetic + chain.energy + chain.absorbed == pytest.approx(0.125, rel=1e-9)
