"""The hanging cradle: balls on strings in an ordinary pymunk Space, with soft contacts and with pymunk's rigid ones.

Both hang from PinJoints under gravity; only the contacts between the balls differ.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import pymunk
from softcradle.physics import Contact, SoftChain, SoftContact, draft_gear, hertz, power_law
from softcradle.sandbox.languages import NP_

RADIUS = 0.1  # m, of a ball
STRING = 1.0  # m
GRAVITY = 9.81  # m/s^2
ANGLE = 0.62  # rad, of the strings of the lifted balls
BALLS = 5

LAWS: dict[str, Contact] = {
    NP_("button", "steel balls (Hertz)"): hertz(1e6),
    NP_("button", "power law, alpha 1/14"): power_law(60.0, 1.0 / 14.0),
    NP_("button", "power law, alpha 1/10"): power_law(60.0, 0.1),
    NP_("button", "draft gear"): draft_gear(1500.0, 0.04),
}
CHAIN, SPRINGS = "SoftChain", "SoftContact"
METHODS = (CHAIN, SPRINGS)  # all contacts solved at once, keeping energy; one spring for each contact
Vector = tuple[float, float]


@dataclass(frozen=True)
class Cradle:
    """Balls in a Space of their own; `chain` is None where no SoftChain acts, `springs` is the law of SoftContacts that do."""

    space: pymunk.Space
    balls: tuple[pymunk.Body, ...]
    chain: SoftChain | None = None
    springs: Contact | None = None

    def places(self) -> list[Vector]:
        """Centres of the balls [m], y upwards from the anchors."""
        vectors = [ball.position for ball in self.balls] if self.chain is None else self.chain.positions
        return [(float(place[0]), float(place[1])) for place in vectors]

    def stored(self) -> float:
        """Energy in the contacts [J]."""
        if self.chain is not None:
            return self.chain.energy
        if self.springs is None:
            return 0.0
        pairs = pairwise(self.balls)
        overlaps = (2.0 * RADIUS - (b.position - a.position).length for a, b in pairs)
        return sum(float(self.springs.energy(max(0.0, overlap))) for overlap in overlaps)

    def energy(self) -> float:
        """Kinetic, potential and stored energy [J]; 0 for balls that hang at rest."""
        kinetic = sum(0.5 * ball.mass * ball.velocity.length**2 for ball in self.balls)
        potential = sum(
            GRAVITY * ball.mass * (STRING + y) for ball, (_, y) in zip(self.balls, self.places(), strict=True)
        )
        return kinetic + potential + self.stored()

    def stretch(self) -> float:
        """Greatest change of a string's length [m]."""
        pairs = zip(anchors(), self.balls, strict=True)
        return max(abs(math.dist((x, 0.0), ball.position) - STRING) for x, ball in pairs)


def anchors() -> list[float]:
    """Where the strings are fixed [m], such that the balls just touch."""
    return [2.0 * RADIUS * k for k in range(BALLS)]


def start_places(lifted: int) -> list[Vector]:
    """Centres [m] with the first `lifted` balls pulled aside."""
    angles = [-ANGLE if k < lifted else 0.0 for k in range(BALLS)]
    return [
        (x + STRING * math.sin(angle), -STRING * math.cos(angle)) for x, angle in zip(anchors(), angles, strict=True)
    ]


def make_cradle(
    law: Contact | None, places: Sequence[Vector], velocities: Sequence[Vector] | None = None, method: str = CHAIN
) -> Cradle:
    """A cradle at `places`, at rest without `velocities`; law None: pymunk's own circles of elasticity 1."""
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    balls = []
    for k, (x, place) in enumerate(zip(anchors(), places, strict=True)):
        ball = pymunk.Body(mass=1.0, moment=math.inf)
        ball.position = place
        ball.velocity = (0.0, 0.0) if velocities is None else velocities[k]
        string = pymunk.PinJoint(space.static_body, ball, (x, 0.0), (0.0, 0.0))
        string.distance = STRING
        space.add(ball, string)
        balls.append(ball)
    if law is None:
        for ball in balls:
            circle = pymunk.Circle(ball, RADIUS)
            circle.elasticity = 1.0
            space.add(circle)
        return Cradle(space, tuple(balls))
    if method == CHAIN:
        chain = SoftChain(balls, law, 2.0 * RADIUS)
        space.add(*chain)
        return Cradle(space, tuple(balls), chain)
    springs = [SoftContact(a, b, (0.0, 0.0), (0.0, 0.0), 2.0 * RADIUS, law) for a, b in pairwise(balls)]
    space.add(*springs)
    return Cradle(space, tuple(balls), springs=law)
