"""A Newton's cradle in a pymunk Space: balls on PinJoints, once with soft contacts and once with pymunk's rigid contacts.

    python examples/hanging_cradle.py

The script prints how far each ball has swung out after the first blow, and how much energy is left after 20 s. The strings lose
energy, because pymunk corrects their lengths. A cradle without this loss is the scene `cradle`, in which beads hang on strings of
the engine: ``Chain(..., strings=length)``.
"""

from __future__ import annotations

import math
import warnings

import pymunk

from softcradle import Contact, SoftChain, hertz, power_law

BALLS = 5
RADIUS, STRING = 0.05, 1.0  # radius of a ball and length of a string [m]
MASS, GRAVITY = 1.0, 9.81  # mass of a ball [kg], gravitational acceleration [m/s²]
ANGLE = 0.5  # initial angle of the first string [rad]
FRAME = 1.0 / 60.0  # time between two pictures [s]
RIGID_STEPS = 8  # steps in a frame with pymunk's contacts
LAWS = {"steel, Hertz": hertz(1e5), "soft, alpha 1/10": power_law(60.0, 0.1), "pymunk's rigid contacts": None}


class Cradle:
    """Five balls on strings, the first one lifted; `law` is the law of soft contacts, None for pymunk's rigid contacts.

    Attributes:
        space, balls: the pymunk Space and its bodies from left to right.
        chain: the soft contacts, or None.
        steps: steps in a frame; with soft contacts as many as the first blow needs.
    """

    def __init__(self, law: Contact | None) -> None:
        """Hang the balls."""
        self.space = pymunk.Space()
        self.space.gravity = 0.0, -GRAVITY
        self.balls = [pymunk.Body(MASS, math.inf) for _ in range(BALLS)]
        for k, ball in enumerate(self.balls):
            angle = -ANGLE if k == 0 else 0.0
            hook = 2.0 * RADIUS * k, 0.0
            ball.position = hook[0] + STRING * math.sin(angle), -STRING * math.cos(angle)
            string = pymunk.PinJoint(self.space.static_body, ball, hook, (0.0, 0.0))
            string.distance = STRING
            self.space.add(ball, string)
        self.chain = None if law is None else SoftChain(self.balls, law, 2.0 * RADIUS)
        self.steps = RIGID_STEPS
        if self.chain is None:
            self._add_circles()
        else:
            self.space.add(*self.chain)
            # the speed with which the first ball strikes
            speed = math.sqrt(2.0 * GRAVITY * STRING * (1.0 - math.cos(ANGLE)))
            self.steps = self.chain.substeps(FRAME, speed)

    def _add_circles(self) -> None:
        for ball in self.balls:
            circle = pymunk.Circle(ball, RADIUS)
            circle.elasticity = 1.0
            self.space.add(circle)

    def run(self, frames: int) -> None:
        """Advance by a number of frames."""
        for _ in range(frames * self.steps):
            self.space.step(FRAME / self.steps)

    def swings(self) -> list[float]:
        """Return how far [m] each ball is to the right of its place of rest."""
        return [ball.position.x - 2.0 * RADIUS * k for k, ball in enumerate(self.balls)]

    def energy(self) -> float:
        """Return the kinetic, potential and stored energy [J]; it is 0 if all balls hang at rest."""
        moving = sum(
            0.5 * MASS * ball.velocity.length**2 + MASS * GRAVITY * (STRING + ball.position.y) for ball in self.balls
        )
        return moving + (0.0 if self.chain is None else self.chain.energy)


def main() -> None:
    """Print the motion of all cradles."""
    for name, law in LAWS.items():
        cradle = Cradle(law)
        first = cradle.energy()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # later blows can be faster than the first one
            cradle.run(62)  # the balls have swung out to the right
            swings = ", ".join(f"{x:5.2f}" for x in cradle.swings())
            cradle.run(20 * 60 - 62)
        print(f"{name:24} balls at {swings} m; {100.0 * cradle.energy() / first:.1f} % of the energy after 20 s")


if __name__ == "__main__":
    main()
