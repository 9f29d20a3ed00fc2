"""The hanging cradle: balls on strings in an ordinary pymunk Space, with soft contacts and with pymunk's rigid ones.

Both hang from PinJoints under gravity; only the contacts between the balls differ.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import pymunk
from softcradle.physics import Contact, SoftChain, draft_gear, hertz, power_law
from softcradle.sandbox.languages import N_, NP_, _
from softcradle.sandbox.story.verdict import BAD, FAIR, GOOD

RADIUS = 0.1  # m, of a ball
STRING = 1.0  # m
GRAVITY = 9.81  # m/s^2
ANGLE = 0.62  # rad, of the strings of the lifted balls
BALLS = 5
FRAME = 1.0 / 60.0  # s, of the model between two pictures at real time
RATES = (60, 120, 240, 480, 960)  # steps a second; each divides into frames
RATE = 480  # steps a second at first: at a swing's lowest point a pin joint loses energy in proportion to the step
MOST_PULL = 60.0  # N, of the pointer on a ball
LEAST_ENERGY = 1e-9  # J: a cradle with less hangs still
FAIR_CHANGE = 0.02  # of the energy, the largest that is good: less cannot be seen in the height of a swing
BAD_CHANGE = 0.10  # of the energy, the largest that is fair

LAWS: dict[str, Contact] = {
    NP_("button", "steel balls (Hertz)"): hertz(1e6),
    NP_("button", "soft, alpha 1/14"): power_law(60.0, 1.0 / 14.0),
    NP_("button", "soft, alpha 1/10"): power_law(60.0, 0.1),
    NP_("button", "draft gear"): draft_gear(1500.0, 0.04),
}
GAINED = N_("{percent:.2g} % of the energy was gained. Use more steps per second.")
LOST = N_("{percent:.2g} % of the energy was lost, some of it by the strings. Use more steps per second.")
Vector = tuple[float, float]


def _pair(vector: Sequence[float]) -> Vector:
    return float(vector[0]), float(vector[1])


def anchors() -> list[float]:
    """Where the strings are fixed [m], such that the balls just touch."""
    return [2.0 * RADIUS * k for k in range(BALLS)]


def start_places(lifted: int) -> list[Vector]:
    """Centres [m] with the first `lifted` balls pulled aside."""
    angles = [-ANGLE if k < lifted else 0.0 for k in range(BALLS)]
    return [
        (x + STRING * math.sin(angle), -STRING * math.cos(angle)) for x, angle in zip(anchors(), angles, strict=True)
    ]


class EnergyVerdict(NamedTuple):
    """Level and sentence, and the change of the energy that they follow from (a share)."""

    level: str
    sentence: str
    change: float


@dataclass
class Cradle:
    """Balls in a Space of their own.

    Attributes:
        first, greatest: energy [J] when the pointer last did work on it, and the greatest since.
        tangled: the left one of the first two balls that have passed each other, or None.
    """

    space: pymunk.Space
    tangled: int | None = None

    def __post_init__(self) -> None:
        self.first = self.greatest = self.energy()

    @property
    def balls(self) -> list[pymunk.Body]:
        """From left to right."""
        return list(self.space.bodies)

    @property
    def chain(self) -> SoftChain | None:
        """The soft contacts; None where pymunk's own act."""
        return next(iter(SoftChain.of(self.space)), None)

    def copy(self) -> Cradle:
        """The same in a Space of its own."""
        made = copy(self)
        made.space = self.space.copy()
        return made

    def places(self) -> list[Vector]:
        """Centres of the balls [m], y upwards from the anchors."""
        return list(map(_pair, [ball.position for ball in self.balls] if self.chain is None else self.chain.positions))

    def energy(self) -> float:
        """Kinetic, potential and stored energy [J]; 0 for balls that hang at rest."""
        kinetic = sum(0.5 * ball.mass * ball.velocity.length**2 for ball in self.balls)
        heights = (GRAVITY * ball.mass * (STRING + y) for ball, (_x, y) in zip(self.balls, self.places(), strict=True))
        return kinetic + sum(heights) + (0.0 if self.chain is None else self.chain.energy)

    def advance(self, steps: int, fresh: bool) -> None:
        """Move by a frame; a `fresh` one has been pulled at: its energy begins anew."""
        for _step in range(steps):
            self.space.step(FRAME / steps)
        places, energy = self.places(), self.energy()
        passed = (k for k, (left, right) in enumerate(pairwise(places)) if right[0] < left[0])
        self.tangled = next(passed, None) if self.tangled is None else self.tangled
        self.first, self.greatest = (energy, energy) if fresh else (self.first, max(self.greatest, energy))

    def verdict(self) -> EnergyVerdict:
        """How far it can be trusted."""
        whole = self.first if self.first > LEAST_ENERGY else math.inf
        change, risen = (self.energy() - self.first) / whole, (self.greatest - self.first) / whole
        worst = max(abs(change), risen)
        if self.tangled is not None:
            left, right = self.tangled, self.tangled + 1
            text = _("Balls {left} and {right} passed through each other. Press R to restart.", left=left, right=right)
            return EnergyVerdict(BAD, text, change)
        if worst <= FAIR_CHANGE:
            return EnergyVerdict(GOOD, _("energy error {percent:.2g} %", percent=100.0 * worst), change)
        text = _(GAINED if risen > abs(change) or change > 0.0 else LOST, percent=100.0 * worst)
        return EnergyVerdict(FAIR if worst <= BAD_CHANGE else BAD, text, change)


def make_cradle(law: Contact | None, places: Sequence[Vector]) -> Cradle:
    """A cradle at rest at `places`; law None: pymunk's own circles of elasticity 1."""
    space = pymunk.Space()
    space.gravity = (0.0, -GRAVITY)
    balls = tuple(pymunk.Body(mass=1.0, moment=math.inf) for _place in places)
    for x, ball, place in zip(anchors(), balls, places, strict=True):
        ball.position = place
        string = pymunk.PinJoint(space.static_body, ball, (x, 0.0), (0.0, 0.0))
        string.distance = STRING
        space.add(ball, string)
        if law is None:
            circle = pymunk.Circle(ball, RADIUS)
            circle.elasticity = 1.0
            space.add(circle)
    if law is not None:
        space.add(*SoftChain(balls, law, 2.0 * RADIUS))
    return Cradle(space)


class HangingModel:
    """Both cradles, side by side; they run forwards alone: what is asked of time is asked of the scenes.

    Attributes:
        law: name of the soft contacts' law, from LAWS.
        lifted: how many balls are lifted at the start.
        rate: steps a second.
        cradles: (soft, rigid).
        time: [s].
    """

    def __init__(self, law: str = next(iter(LAWS)), lifted: int = 1, rate: int = RATE) -> None:
        self.law, self.lifted, self.rate = law, lifted, rate
        self.restart()

    def restart(self) -> None:
        """Lift the balls again."""
        places = start_places(self.lifted)
        self.cradles: tuple[Cradle, ...] = (make_cradle(LAWS[self.law], places), make_cradle(None, places))
        self.time = 0.0
        self._fresh = False  # whether the pointer has done work since the last frame
        self._pointer: tuple[pymunk.Space, pymunk.Body, Any] | None = None

    @property
    def pulled(self) -> bool:
        """Whether the pointer pulls a ball."""
        return self._pointer is not None

    def copy(self) -> HangingModel:
        """The same motion, which goes on by itself to the last digit; no pointer holds it."""
        made = copy(self)
        made.cradles, made._pointer = tuple(cradle.copy() for cradle in self.cradles), None
        made._fresh = self._fresh or self.pulled
        for cradle in made.cradles:
            cradle.space.remove(*(joint for joint in cradle.space.constraints if isinstance(joint, pymunk.PivotJoint)))
        return made

    def advance(self) -> bool:
        """Move both by a frame; True, for it always can."""
        self.time += FRAME
        for cradle in self.cradles:
            cradle.advance(round(self.rate * FRAME), self._fresh or self.pulled)
        self._fresh = False
        return True

    def hold(self, cradle: int, ball: int, place: Vector) -> None:
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
            self._pointer, self._fresh = None, True
