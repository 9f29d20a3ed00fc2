"""Small pymunk Spaces for the tests of the pymunk constraints."""

import itertools
import math

import numpy as np
import pymunk
from softcradle.physics import Contact, draft_gear, hertz, hooke, power_law, step_force
from softcradle.physics.pymunk_contacts.contact_constraint import SoftContact
from softcradle.physics.pymunk_contacts.soft_chain import SoftChain

FRAME = 1.0 / 60.0  # Duration of a frame [s].
LAWS = [power_law(2.0, 0.1), hertz(50.0), hooke(30.0), draft_gear(40.0, 0.1), step_force(3.0), Contact(0.5, 7.0, 2.5)]
LOSS = 0.8
LOSSY = {
    "draft gear": draft_gear(770.0, 0.0177, LOSS),
    "Hertz": hertz(1.0, LOSS),
    "power law": power_law(1.0, 0.1, LOSS),
    "step": step_force(1.0, LOSS),
    "preload and root": Contact(0.5, 2.0, 0.5, LOSS),
}


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
    """A force law that is not a Contact. The law raises an error at overlaps above `fails_at` [m]."""

    def __init__(self, fails_at=math.inf):
        self.fails_at = fails_at

    def force(self, overlap):
        if overlap > self.fails_at:
            raise ZeroDivisionError(f"overlap {overlap:.2f}")
        return 100.0 * overlap**2


def chain_row(law, gap=0.0, beads=5, speed=1.0, direction=(1.0, 0.0), masses=None):
    """Return a Space, a row of bodies in it, and the SoftChain of the bodies. The first body moves.

    Neighbours are 1 m plus `gap` apart. A single number of `gap` applies only to the first contact.
    """
    space, along = pymunk.Space(), pymunk.Vec2d(*direction)
    gaps = [gap] + [0.0] * (beads - 2) if np.ndim(gap) == 0 else gap
    places = np.concatenate(([0.0], np.cumsum(1.0 + np.array(gaps))))
    wanted, still = masses or [1.0 + 0.1 * i for i in range(beads)], pymunk.Body.KINEMATIC
    bodies = [pymunk.Body(body_type=still) if math.isinf(mass) else pymunk.Body(mass, math.inf) for mass in wanted]
    for body, place in zip(bodies, places.tolist(), strict=True):
        body.position = place * along
    bodies[0].velocity = speed * along
    chain = SoftChain(bodies, law, 1.0)
    space.add(*bodies, *chain)
    return space, bodies, chain


def momentum(bodies):
    """Return the total momentum of the bodies along x [kg m/s]."""
    return sum(body.mass * body.velocity.x for body in bodies)


def total_energy(bodies, chain):
    """Return the sum of the kinetic energy and the stored energy [J]. Pymunk's attribute kinetic_energy is not used,
    because it lacks the factor one half.
    """
    return sum(0.5 * body.mass * body.velocity.dot(body.velocity) for body in bodies) + chain.energy
