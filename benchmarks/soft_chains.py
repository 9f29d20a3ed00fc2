"""``python -m benchmarks soft-chains``: error of the velocities after a collision in a SoftChain.

The SoftChain uses the number of steps that `substeps` recommends. Random chains of balls are compared with the method
`accurate`. The chains are elastic or have loss, and have gaps and walls. Chains in which a contact closes more than
once are left out, because successive collisions multiply errors.
"""

from __future__ import annotations

import argparse
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pymunk
from softcradle.physics import Chain, Contact, SoftChain, draft_gear, hertz, hooke, power_law, simulate, step_force
from softcradle.physics.pymunk_contacts.soft_chain import VISIBLE_ERROR

# Touching distance [m]. The distance is so large that balls of these chains never pass through each other.
REACH = 1000.0
# Largest number of steps of a simulation. A chain that needs more is left out.
MOST_STEPS = 20_000


@dataclass(frozen=True)
class Row:
    """Chain of balls. If the first mass is infinite, it is a wall. The ball at the free end moves at the start.

    Attributes
    ----------
    law : Contact
        Law of all contacts.
    mass, gap : tuple of float
        Masses [kg] and gaps [m].
    speed : float
        Speed [m/s] of the moving ball: the last one if there is a wall, else the first one.
    shift : float
        Part of a step after which the first contact closes.
    """

    law: Contact
    mass: tuple[float, ...]
    gap: tuple[float, ...]
    speed: float
    shift: float

    def error(self, allowed: float) -> float | None:
        """Return the error of the velocities, relative to the speed, or None if a contact closes more than once."""
        walled = math.isinf(self.mass[0])
        struck = len(self.gap) - 1 if walled else 0
        bodies = [
            pymunk.Body(body_type=pymunk.Body.STATIC) if math.isinf(mass) else pymunk.Body(mass, math.inf)
            for mass in self.mass
        ]
        chain = SoftChain(bodies, self.law, REACH)
        substeps = chain.substeps(1.0, self.speed, allowed)
        gap = list(self.gap)
        gap[struck] += self.shift * self.speed / substeps
        start = [0.0] * len(self.mass)
        start[-1 if walled else 0] = -self.speed if walled else self.speed
        with warnings.catch_warnings(action="ignore"):
            right = simulate(Chain(self.mass, self.law, gap), start, tolerance=1e-8)
        steps = math.ceil(float(right.time[-1]) * substeps) + 2
        if max(map(len, right.contact_intervals)) > 1 or steps > MOST_STEPS:
            return None
        space = pymunk.Space()
        places = np.cumsum([0.0, *(REACH + one for one in gap)]).tolist()
        for body, place, velocity in zip(bodies, places, start, strict=True):
            body.position = place, 0.0
            if body.body_type == pymunk.Body.DYNAMIC:
                body.velocity = velocity, 0.0
                space.add(body)
        space.add(*chain)
        with warnings.catch_warnings(action="error" if allowed <= VISIBLE_ERROR else "ignore"):
            for _ in range(steps):
                space.step(1.0 / substeps)
        found = np.array([body.velocity.x for body in bodies])
        return float(np.abs(found - right.final_velocity).max()) / self.speed


def drawn(seed: int) -> Row:
    """Return a random chain of balls, generated from `seed`. Every second chain has loss."""
    random = np.random.default_rng(seed)
    strength = 10.0 ** random.uniform(1.0, 6.0)
    loss = float(random.uniform(0.05, 0.9)) if seed % 2 else 0.0
    laws = (
        hertz(strength, loss),
        hooke(strength, loss),
        power_law(strength**0.5, random.uniform(0.05, 0.9), loss),
        draft_gear(strength, random.uniform(0.0, 0.1), loss),
        step_force(strength**0.5, loss),
        Contact(0.0, strength, random.uniform(1.5, 3.0), loss),
    )
    balls = int(random.integers(2, 7))
    mass = random.uniform(0.5, 2.0, balls).tolist()
    gap = (random.uniform(0.0, 0.1, balls - 1) * random.integers(0, 2, balls - 1)).tolist()
    if balls < 5 and random.integers(0, 2):
        mass, gap = [math.inf, *mass], [float(random.uniform(0.0, 0.1)), *gap]
    speed = 10.0 ** random.uniform(-1.0, 1.0)
    return Row(laws[seed // 2 % len(laws)], tuple(mass), tuple(gap), speed, float(random.uniform()))


def errors(seeds: Sequence[int], allowed: float) -> list[tuple[float, int]]:
    """Return the error and the seed of each chain in which every contact closes at most once. The largest error is
    first.
    """
    found = [(drawn(seed).error(allowed), seed) for seed in seeds]
    return sorted(((error, seed) for error, seed in found if error is not None), reverse=True)


def main(arguments: list[str] | None = None) -> int:
    """Print the largest errors. Return 1 if an error is larger than allowed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks soft-chains", description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=1000, help="number of random rows; default: %(default)s")
    args = parser.parse_args(arguments)
    wrong = 0
    for allowed in (VISIBLE_ERROR, 0.01):
        found = errors(range(args.runs), allowed)
        beyond = [seed for error, seed in found if error > allowed]
        wrong += len(beyond)
        print(
            f"error {allowed:g} allowed, {len(found)} rows: {len(beyond)} beyond it {beyond}; largest errors and seeds:"
        )
        print(", ".join(f"{error:.4f} ({seed})" for error, seed in found[:5]))
    return 1 if wrong else 0
