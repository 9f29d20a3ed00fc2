"""The hanging cradle: balls on strings in an ordinary pymunk Space, with soft contacts and with pymunk's rigid ones.

Both hang from PinJoints under gravity; only the contacts between the balls differ.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pymunk
from softcradle.physics import Contact, SoftChain, draft_gear, hertz, power_law

RADIUS = 0.1  # m, of a ball
STRING = 1.0  # m
GRAVITY = 9.81  # m/s^2
ANGLE = 0.62  # rad, of the strings of the lifted balls
BALLS = 5
STEP = 1.0 / 480.0  # s: at a swing's lowest point a pin joint loses energy in proportion to it
MOST_PULL = 60.0  # N, of the pointer on a ball
MOST_SAMPLES = 6000  # of the energies
SAMPLE = 1.0 / 60.0  # s between two samples of the energies

LAWS: dict[str, Contact] = {
    "power law, alpha 1/14": power_law(60.0, 1.0 / 14.0),
    "power law, alpha 1/10": power_law(60.0, 0.1),
    "draft gear": draft_gear(1500.0, 0.04),
    "steel balls (Hertz)": hertz(1e6),
}


@dataclass(frozen=True)
class Cradle:
    """Balls in a Space of their own; `chain` is None where pymunk's own collisions act."""

    space: pymunk.Space
    balls: tuple[pymunk.Body, ...]
    chain: SoftChain | None

    def places(self) -> list[tuple[float, float]]:
        """Centres of the balls [m], y upwards from the anchors."""
        vectors = [ball.position for ball in self.balls] if self.chain is None else self.chain.positions
        return [(float(place[0]), float(place[1])) for place in vectors]

    def energy(self) -> float:
        """Kinetic, potential and stored energy [J]; 0 for balls that hang at rest."""
        kinetic = sum(0.5 * ball.mass * ball.velocity.length**2 for ball in self.balls)
        potential = sum(
            GRAVITY * ball.mass * (STRING + y) for ball, (_, y) in zip(self.balls, self.places(), strict=True)
        )
        return kinetic + potential + (0.0 if self.chain is None else self.chain.energy)


def anchors() -> list[float]:
    """Where the strings are fixed [m], such that the balls just touch."""
    return [2.0 * RADIUS * k for k in range(BALLS)]


def start_places(lifted: int) -> list[tuple[float, float]]:
    """Centres [m] with the first `lifted` balls pulled aside."""
    angles = [-ANGLE if k < lifted else 0.0 for k in range(BALLS)]
    return [
        (x + STRING * math.sin(angle), -STRING * math.cos(angle)) for x, angle in zip(anchors(), angles, strict=True)
    ]


def make_cradle(law: Contact | None, places: Sequence[tuple[float, float]]) -> Cradle:
    """A cradle at rest at `places`; law None: pymunk's own circles of elasticity 1."""
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    balls = []
    for x, place in zip(anchors(), places, strict=True):
        ball = pymunk.Body(mass=1.0, moment=math.inf)
        ball.position = place
        space.add(ball, pymunk.PinJoint(space.static_body, ball, (x, 0.0), (0.0, 0.0)))
        balls.append(ball)
    chain = None
    if law is None:
        for ball in balls:
            circle = pymunk.Circle(ball, RADIUS)
            circle.elasticity = 1.0
            space.add(circle)
    else:
        chain = SoftChain(balls, law, 2.0 * RADIUS)
        space.add(*chain)
    return Cradle(space, tuple(balls), chain)


class HangingModel:
    """The two cradles on one clock.

    Attributes:
        law: name of the soft contacts' law, from LAWS.
        lifted: how many balls are lifted at the start.
        cradles: (soft, rigid).
        time: [s].
        energies: (time, soft, rigid) [s, J, J], sampled.
    """

    def __init__(self, law: str = next(iter(LAWS)), lifted: int = 1) -> None:
        self.law, self.lifted = law, lifted
        self.restart()

    def restart(self) -> None:
        """Lift the balls again."""
        places = start_places(self.lifted)
        self.cradles = make_cradle(LAWS[self.law], places), make_cradle(None, places)
        self.time, self._due, self._next_sample = 0.0, 0.0, 0.0
        self.energies: deque[tuple[float, float, float]] = deque(maxlen=MOST_SAMPLES)
        self._pointer: tuple[pymunk.Space, pymunk.Body, Any] | None = None
        self._sample()

    def _sample(self) -> None:
        self.energies.append((self.time, self.cradles[0].energy(), self.cradles[1].energy()))
        self._next_sample += SAMPLE

    def advance(self, seconds: float) -> None:
        """Move both by `seconds` of model time, in whole steps; the rest is due next time."""
        self._due += seconds
        while self._due >= STEP:
            self._due -= STEP
            for cradle in self.cradles:
                cradle.space.step(STEP)
            self.time += STEP
            if self.time >= self._next_sample:
                self._sample()

    def hold(self, cradle: int, ball: int, place: tuple[float, float]) -> None:
        """Pull a ball towards `place` [m] with at most MOST_PULL; the string still holds."""
        held = self.cradles[cradle]
        if self._pointer is None:
            pointer = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
            pointer.position = place
            joint = pymunk.PivotJoint(pointer, held.balls[ball], (0.0, 0.0), (0.0, 0.0))
            joint.max_force, joint.error_bias = MOST_PULL, 0.85**60
            held.space.add(joint)
            self._pointer = held.space, pointer, joint
        self._pointer[1].position = place

    def release(self) -> None:
        """Release the ball; the energies begin anew, for the pointer has done work."""
        if self._pointer is not None:
            space, _, joint = self._pointer
            space.remove(joint)
            self._pointer = None
            self.energies.clear()
            self._next_sample = self.time
            self._sample()
