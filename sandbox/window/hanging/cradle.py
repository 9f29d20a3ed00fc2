"""The hanging cradle: balls on strings in an ordinary pymunk Space, with soft contacts or with pymunk's rigid contacts.

In both cases the balls hang from PinJoints under gravity; only the contacts between the balls differ.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import pymunk
from softcradle.physics import Contact, SoftChain, draft_gear, hertz, power_law
from softcradle.sandbox.languages import N_, NP_, _
from softcradle.sandbox.story.verdict import BAD, FAIR, GOOD

RADIUS = 0.1  # Radius of a ball [m].
STRING = 1.0  # Length of a string [m].
GRAVITY = 9.81  # Gravitational acceleration [m/s^2].
ANGLE = 0.62  # Initial angle of the strings of the lifted balls [rad].
BALLS = 5
FRAME = 1.0 / 60.0  # Model time between two pictures at real time [s].
RATES = (60, 120, 240, 480, 960)  # Selectable numbers of steps per second; each is a multiple of the frame rate.
# Initial number of steps per second. At the lowest point of a swing, a pin joint loses energy in proportion to the step
# size.
RATE = 480
MOST_PULL = 60.0  # Largest force of the pointer on a ball [N].
LEAST_ENERGY = 1e-9  # Energy [J] below which a cradle counts as at rest.
# Relative change of the energy up to which the verdict is good. A smaller change is invisible in the height of a swing.
FAIR_CHANGE = 0.02
BAD_CHANGE = 0.10  # Relative change of the energy up to which the verdict is fair.

# Contact laws by name. All are soft enough for RATE: a blow of balls that fall from ANGLE is resolved by SoftChain.
LAWS: dict[str, Contact] = {
    NP_("button", "steel balls (Hertz)"): hertz(5e4),
    NP_("button", "soft, alpha 1/14"): power_law(60.0, 1.0 / 14.0),
    NP_("button", "soft, alpha 1/10"): power_law(60.0, 0.1),
    NP_("button", "draft gear"): draft_gear(1000.0, 0.05),
}
GAINED = N_("{percent:.2g} % of the energy was gained. Use more steps per second.")
LOST = N_("{percent:.2g} % of the energy was lost, some of it by the strings. Use more steps per second.")
UNRESOLVED = N_("The steps are too long for these blows. Use at least {rate} steps per second.")
Vector = tuple[float, float]


def _pair(vector: Sequence[float]) -> Vector:
    return float(vector[0]), float(vector[1])


def anchors() -> list[float]:
    """Return the positions [m] of the upper ends of the strings. Hanging balls just touch."""
    return [2.0 * RADIUS * k for k in range(BALLS)]


def start_places(lifted: int) -> list[Vector]:
    """Return the centres [m] of the balls, with the first `lifted` balls pulled aside."""
    angles = [-ANGLE if k < lifted else 0.0 for k in range(BALLS)]
    return [
        (x + STRING * math.sin(angle), -STRING * math.cos(angle)) for x, angle in zip(anchors(), angles, strict=True)
    ]


class EnergyVerdict(NamedTuple):
    """Level and sentence of the energy check, and the relative change of the energy from which they follow."""

    level: str
    sentence: str
    change: float


@dataclass
class Cradle:
    """A cradle in a separate pymunk Space.

    Attributes:
        first, greatest: energy [J] at the last moment when the pointer did work on the cradle, and the largest energy
            since then.
        tangled: index of the left ball of the first two balls that have passed through each other, or None.
        steps: steps in a frame.
        fastest: largest closing speed of two neighbours before a blow so far [m/s].
    """

    space: pymunk.Space
    tangled: int | None = None
    steps: int = 1
    fastest: float = 0.0

    def __post_init__(self) -> None:
        self.first = self.greatest = self.energy()

    @property
    def balls(self) -> list[pymunk.Body]:
        """The balls from left to right."""
        return list(self.space.bodies)

    @property
    def chain(self) -> SoftChain | None:
        """The soft contacts, or None if the cradle uses pymunk's contacts."""
        return next(iter(SoftChain.of(self.space)), None)

    def copy(self) -> Cradle:
        """Return a copy of the cradle in a new Space."""
        made = copy(self)
        made.space = self.space.copy()
        return made

    def places(self) -> list[Vector]:
        """Return the centres of the balls [m], with y upwards from the anchors."""
        return list(map(_pair, [ball.position for ball in self.balls] if self.chain is None else self.chain.positions))

    def energy(self) -> float:
        """Return the kinetic, potential and stored energy [J]; it is 0 if all balls hang at rest."""
        kinetic = sum(0.5 * ball.mass * ball.velocity.length**2 for ball in self.balls)
        heights = (GRAVITY * ball.mass * (STRING + y) for ball, (_x, y) in zip(self.balls, self.places(), strict=True))
        return kinetic + sum(heights) + (0.0 if self.chain is None else self.chain.energy)

    def advance(self, steps: int, fresh: bool) -> None:
        """Advance by one frame in `steps` steps. If `fresh`, the pointer has done work, so the reference energy is set
        again.
        """
        closing = max(left.velocity.x - right.velocity.x for left, right in pairwise(self.balls))
        struck = False
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # the verdict shows them
            for _step in range(steps):
                self.space.step(FRAME / steps)
                struck = struck or (self.chain is not None and self.chain.energy > 0.0)
        self.steps, self.fastest = steps, max(self.fastest, closing) if struck else self.fastest
        places, energy = self.places(), self.energy()
        passed = (k for k, (left, right) in enumerate(pairwise(places)) if right[0] < left[0])
        self.tangled = next(passed, None) if self.tangled is None else self.tangled
        self.first, self.greatest = (energy, energy) if fresh else (self.first, max(self.greatest, energy))

    def missing_rate(self) -> int:
        """Return the steps per second that the fastest blow needs, or 0 if the present steps are short enough."""
        if self.chain is None or not self.fastest:
            return 0
        needed = self.chain.substeps(FRAME / self.steps, self.fastest)
        return round(needed * self.steps / FRAME) if needed > 1 else 0

    def verdict(self) -> EnergyVerdict:
        """Return how far the motion can be trusted, judged from the change of its energy."""
        whole = self.first if self.first > LEAST_ENERGY else math.inf
        change, risen = (self.energy() - self.first) / whole, (self.greatest - self.first) / whole
        worst = max(abs(change), risen)
        if self.tangled is not None:
            left, right = self.tangled, self.tangled + 1
            text = _("Balls {left} and {right} passed through each other. Press R to restart.", left=left, right=right)
            return EnergyVerdict(BAD, text, change)
        if worst <= FAIR_CHANGE and (rate := self.missing_rate()):
            return EnergyVerdict(FAIR, _(UNRESOLVED, rate=rate), change)
        if worst <= FAIR_CHANGE:
            return EnergyVerdict(GOOD, _("energy error {percent:.2g} %", percent=100.0 * worst), change)
        text = _(GAINED if risen > abs(change) or change > 0.0 else LOST, percent=100.0 * worst)
        return EnergyVerdict(FAIR if worst <= BAD_CHANGE else BAD, text, change)


def make_cradle(law: Contact | None, places: Sequence[Vector]) -> Cradle:
    """Return a cradle at rest with the balls at `places`. If `law` is None, the contacts are pymunk circles of
    elasticity 1.
    """
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
    """Both cradles, side by side. They only run forwards; looking back in time is possible only in scenes.

    Attributes:
        law: name in LAWS of the law of the soft contacts.
        lifted: number of balls that are lifted at the start.
        rate: number of steps per second.
        cradles: (soft, rigid).
        time: model time [s].
    """

    def __init__(self, law: str = next(iter(LAWS)), lifted: int = 1, rate: int = RATE) -> None:
        self.law, self.lifted, self.rate = law, lifted, rate
        self.restart()

    def restart(self) -> None:
        """Lift the balls again."""
        places = start_places(self.lifted)
        self.cradles: tuple[Cradle, ...] = (make_cradle(LAWS[self.law], places), make_cradle(None, places))
        self.time = 0.0
        self._fresh = False  # True if the pointer has done work since the last frame.
        self._pointer: tuple[pymunk.Space, pymunk.Body, Any] | None = None

    @property
    def pulled(self) -> bool:
        """True while the pointer pulls a ball."""
        return self._pointer is not None

    def copy(self) -> HangingModel:
        """Return a copy without the pointer, which continues the same motion bitwise."""
        made = copy(self)
        made.cradles, made._pointer = tuple(cradle.copy() for cradle in self.cradles), None
        made._fresh = self._fresh or self.pulled
        for cradle in made.cradles:
            cradle.space.remove(*(joint for joint in cradle.space.constraints if isinstance(joint, pymunk.PivotJoint)))
        return made

    def advance(self) -> bool:
        """Advance both cradles by one frame. Always return True."""
        self.time += FRAME
        for cradle in self.cradles:
            cradle.advance(round(self.rate * FRAME), self._fresh or self.pulled)
        self._fresh = False
        return True

    def hold(self, cradle: int, ball: int, place: Vector) -> None:
        """Pull a ball towards `place` [m] with at most MOST_PULL. The string still holds the ball."""
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
        """Release the ball and reset the reference energies, because the pointer has done work."""
        if self._pointer is not None:
            space, _, joint = self._pointer
            space.remove(joint)
            self._pointer, self._fresh = None, True
