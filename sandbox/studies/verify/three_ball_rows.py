"""Numbers known of three balls: touching or with gaps ("Newton's cradle undone"), and of masses that pass everything on."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from scipy.optimize import brentq
from softcradle.physics import Chain, Trajectory, hertz, hooke, one_on, simulate
from softcradle.sandbox.studies.verify.known_number import KnownNumber

TOLERANCE = 1e-9
ALLOWED = 1e-7
RESTITUTION = 0.8  # with gaps the striker then follows, while it is thrown back by balls that touch
BALLS = ("striker", "middle", "last")


def rows() -> Iterator[KnownNumber]:
    """All rows of this file."""
    modes = "normal modes up to each opening"
    for ball, known in enumerate(touching_springs()):
        name = f"three balls that touch, Hooke: {BALLS[ball]} [m/s]"
        yield KnownNumber(name, known, modes, partial(_touching, ball), ALLOWED)
    undone = "collisions of two balls; Donahue et al., Phys. Fluids 20, 113301 (2008)"
    for ball, known in enumerate(with_gaps(RESTITUTION)):
        name = f"three balls with gaps, restitution {RESTITUTION:g}: {BALLS[ball]} [m/s]"
        yield KnownNumber(name, known, undone, partial(_lossy_with_gaps, ball), ALLOWED)
    magic = "1 / cos(pi / n) - 1; Ee and Lee, arXiv:1310.5200"
    for n in (5, 7, 9):
        name = f"ball of {magic_mass(n):.4g} between two of 1, with gaps"
        yield KnownNumber(f"{name}: last [m/s]", 1.0, magic, partial(_last_of_magic_masses, n), ALLOWED)
        yield KnownNumber(f"{name}: its collisions", n - 1.0, magic, partial(_collisions_of_magic_masses, n), 0.0)


def magic_mass(n: int) -> float:
    """Mass of a ball that passes all momentum of a ball of mass 1 on to another of mass 1, in n - 1 collisions; n is odd.

    In coordinates of equal inertia the two gaps are the sides of a wedge of angle pi / n, whose cosine is 1 / (1 + mass).
    """
    return 1.0 / math.cos(math.pi / n) - 1.0


def touching_springs() -> tuple[float, float, float]:
    """Velocities after one at 1 m/s has hit two, on unit masses and springs: modes of frequency 1 and sqrt(3), then of sqrt(2).

    The overlaps are ``(sin t +- sin(sqrt(3) t) / sqrt(3)) / 2``: the first contact opens first, the energy left in the
    second then drives its two balls apart.
    """
    root3 = math.sqrt(3.0)
    opened = brentq(lambda t: math.sin(t) + math.sin(root3 * t) / root3, math.pi / root3, math.pi, xtol=1e-15)
    slow, fast = 0.5 * math.cos(opened), math.cos(root3 * opened)
    striker, middle, last = 1.0 / 3.0 + slow + fast / 6.0, 1.0 / 3.0 - fast / 3.0, 1.0 / 3.0 - slow + fast / 6.0
    overlap = 0.5 * (math.sin(opened) - math.sin(root3 * opened) / root3)
    mean, apart = 0.5 * (middle + last), 0.5 * math.hypot(middle - last, math.sqrt(2.0) * overlap)
    return striker, mean - apart, mean + apart


def with_gaps(restitution: float) -> tuple[float, float, float]:
    """Velocities of equal balls after one at 1 m/s has hit two with gaps: pairs collide while a ball is faster than the next."""
    velocity = [1.0, 0.0, 0.0]
    while faster := [i for i in (0, 1) if velocity[i] > velocity[i + 1]]:
        i = faster[0]
        mean, apart = 0.5 * (velocity[i] + velocity[i + 1]), 0.5 * restitution * (velocity[i] - velocity[i + 1])
        velocity[i : i + 2] = [mean - apart, mean + apart]
    return velocity[0], velocity[1], velocity[2]


def _touching(ball: int) -> float:
    return float(simulate(one_on(2, hooke(1.0)), [1.0, 0.0, 0.0], samples=2, tolerance=TOLERANCE).final_velocity[ball])


def _lossy_with_gaps(ball: int) -> float:
    chain = Chain([1.0] * 3, hertz(1e6, 1.0 - RESTITUTION**2), gap=0.5)
    return float(simulate(chain, [1.0, 0.0, 0.0], samples=2, tolerance=TOLERANCE).final_velocity[ball])


def _through_magic_mass(n: int) -> Trajectory:
    chain = Chain([1.0, magic_mass(n), 1.0], hertz(1e6), gap=0.5)
    return simulate(chain, [1.0, 0.0, 0.0], samples=2, tolerance=TOLERANCE)


def _last_of_magic_masses(n: int) -> float:
    return float(_through_magic_mass(n).final_velocity[2])


def _collisions_of_magic_masses(n: int) -> float:
    return float(sum(len(intervals) for intervals in _through_magic_mass(n).contact_intervals))
