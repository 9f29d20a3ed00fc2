"""Small Spaces for the tests of the pymunk constraints."""

import itertools
import math

import pymunk

from physics import Contact, draft_gear, hertz, hooke, power_law, step_force
from physics.constraints import SoftContact

LAWS = [power_law(2.0, 0.1), hertz(50.0), hooke(30.0), draft_gear(40.0, 0.1), step_force(3.0), Contact(0.5, 7.0, 2.5)]


def pair(distance=1.0, law=None, masses=(1.0, 3.0), **options):
    space = pymunk.Space()
    bodies = [pymunk.Body(mass, math.inf) for mass in masses]
    bodies[1].position = distance, 0.0
    contact = SoftContact(*bodies, (0, 0), (0, 0), 1.0, law or hooke(10.0), **options)
    space.add(*bodies, contact)
    return space, bodies, contact


def cradle(law, native=None, beads=5, speed=1.0):
    space = pymunk.Space()
    bodies = [pymunk.Body(1.0 + 0.1 * i, 1.0) for i in range(beads)]
    for i, body in enumerate(bodies):
        body.position = float(i), 0.0
    contacts = [SoftContact(a, b, (0, 0), (0, 0), 1.0, law, native) for a, b in itertools.pairwise(bodies)]
    bodies[0].velocity = speed, 0.0
    space.add(*bodies, *contacts)
    return space, bodies, contacts


def run(space, step=1e-3, count=500):
    for _ in range(count):
        space.step(step)


class Quadratic:
    """A law of the user's own."""

    def __init__(self, fails_at=math.inf):
        self.fails_at = fails_at

    def force(self, overlap):
        if overlap > self.fails_at:
            raise ZeroDivisionError(f"overlap {overlap:.2f}")
        return 100.0 * overlap**2
