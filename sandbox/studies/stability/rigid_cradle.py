"""Cradle with the rigid contacts of pymunk and elasticity 1. Such a cradle neither conserves energy nor behaves like
soft beads.

The results were measured with pymunk 7.3. The energy depends on the step, and decreases in all cases. For any step, if
one ball hits, only the last ball leaves. Touching soft contacts do not have this limit.
"""

import math

import numpy as np
import pymunk
from numpy.typing import NDArray

Array = NDArray[np.float64]

BALLS = 5
RADIUS = 20.0  # Radius of a ball in pixels, pymunk's usual unit.
LENGTH = 150.0  # Length of the pendulums [pixels].
GRAVITY = 981.0  # Acceleration of gravity [pixels/s^2].
ANGLE = math.radians(60.0)  # Initial angle of the first pendulum [rad].
DURATION = 20.0  # Duration of a simulation [s].
STEPS = (1 / 60, 1 / 600, 1 / 6000)  # Time steps [s].


def remaining_energy(step: float) -> float:
    """Return the energy of the cradle after DURATION, relative to the initial energy.

    The energy of the balls at rest is 0.
    """
    space, balls = _pendulums()
    before = _energy(balls)
    for _ in range(round(DURATION / step)):
        space.step(step)
    return _energy(balls) / before


def strike(step: float) -> Array:
    """Return the (5,) final velocities of a free ball at unit speed and of the four touching balls that it hits."""
    space = pymunk.Space()
    balls = [_ball(space, (2.0 * RADIUS * k, 0.0)) for k in range(BALLS)]
    balls[0].position = (-1.0, 0.0)
    balls[0].velocity = (1.0, 0.0)
    for _ in range(math.ceil(3.0 / step)):
        space.step(step)
    return np.array([ball.velocity.x for ball in balls])


def _pendulums() -> tuple[pymunk.Space, list[pymunk.Body]]:
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    balls = []
    for k in range(BALLS):
        x, angle = 2.0 * RADIUS * k, ANGLE if k == 0 else 0.0
        balls.append(_ball(space, (x - LENGTH * math.sin(angle), -LENGTH * math.cos(angle))))
        space.add(pymunk.PinJoint(space.static_body, balls[-1], (x, 0.0)))
    return space, balls


def _ball(space: pymunk.Space, position: tuple[float, float]) -> pymunk.Body:
    body = pymunk.Body(1.0, pymunk.moment_for_circle(1.0, 0.0, RADIUS))
    body.position = position
    circle = pymunk.Circle(body, RADIUS)
    circle.elasticity, circle.friction = 1.0, 0.0
    space.add(body, circle)
    return body


def _energy(balls: list[pymunk.Body]) -> float:
    return float(sum(0.5 * ball.velocity.length**2 + GRAVITY * (ball.position.y + LENGTH) for ball in balls))
