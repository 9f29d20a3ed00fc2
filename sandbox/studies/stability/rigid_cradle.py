"""The cautionary row: a cradle of pymunk's own rigid contacts, elasticity 1, neither keeps its energy nor is soft.

Measured with pymunk 7.3: the energy depends on the step, and is lost rather than gained; and however small the step, the
blow of one ball leaves with the last one alone, which is no limit of any soft contact that touches.
"""

from __future__ import annotations

import math

import numpy as np
import pymunk
from numpy.typing import NDArray

Array = NDArray[np.float64]

BALLS, RADIUS, LENGTH = 5, 20.0, 150.0  # pixels, pymunk's usual unit
GRAVITY, ANGLE = 981.0, math.radians(60.0)  # pixels/s^2; from which the first ball is let go
SECONDS = 20.0
STEPS = (1 / 60, 1 / 600, 1 / 6000)  # [s]


def energy_kept(step: float, seconds: float = SECONDS) -> float:
    """Energy of the cradle after `seconds`, as part of that at the start, above the balls at rest."""
    space, balls = _hanging()
    before = _energy(balls)
    for _ in range(round(seconds / step)):
        space.step(step)
    return _energy(balls) / before


def blow(step: float) -> Array:
    """(5,) final velocities of four free balls just touching, after a fifth has struck them at unit speed."""
    space = pymunk.Space()
    balls = [_ball(space, (2.0 * RADIUS * k, 0.0)) for k in range(BALLS)]
    balls[0].position = (-1.0, 0.0)
    balls[0].velocity = (1.0, 0.0)
    for _ in range(math.ceil(3.0 / step)):
        space.step(step)
    return np.array([ball.velocity.x for ball in balls])


def _hanging() -> tuple[pymunk.Space, list[pymunk.Body]]:
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
