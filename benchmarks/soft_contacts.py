"""``python -m benchmarks soft-contacts``: energy of SoftContacts at 60 frames per second.

The table in docs/games.md shows the energy of five balls of 1 kg after three seconds. The first ball starts at 1 m/s. A
scan searches for unreported growth of the energy. The scan generates random laws, masses, speeds, gaps, walls, frame
rates and substeps from a seed. If no warning appears, the energy must stay within the limit of `substeps`.
"""

from __future__ import annotations

import argparse
import itertools
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pymunk
from softcradle.physics import Contact, SoftContact, draft_gear, hertz, hooke, power_law, step_force

from benchmarks.reports import Report

FRAME = 1.0 / 60.0  # Duration of a frame [s].
SECONDS = 3.0
TABLE = {
    "`hertz(1e3)`": hertz(1e3),
    "`hertz(1e6)`": hertz(1e6),
    "`hooke(1e4)`": hooke(1e4),
    "`power_law(50, 0.1)`": power_law(50.0, 0.1),
    "`draft_gear(1000, 0.05)`": draft_gear(1000.0, 0.05),
    "`Contact.by_contact_time(0.05, 0.5, 1)`": Contact.by_contact_time(0.05, 0.5, 1.0),
}
COLUMNS = ["law", "energy, 1 step a frame", "4 steps", "`substeps`", "energy then"]
SAID = 0.03  # Largest allowed relative gain of energy in a second without a warning.


@dataclass(frozen=True)
class Row:
    """Chain of balls, between walls if `wall_gap` is set [m]. The first ball moves at the start.

    Attributes:
        law, mass, gap, speed: contact law, masses [kg], gaps [m], and speed of the first ball [m/s].
        step, seconds: time step and duration of the simulation [s].
    """

    law: Contact
    mass: tuple[float, ...]
    gap: tuple[float, ...]
    speed: float
    step: float
    seconds: float
    wall_gap: float | None = None
    reach: float = 100.0  # Touching distance [m]. The distance is so large that no ball passes through another.

    def run(self) -> tuple[float, float, bool]:
        """Simulate the chain.

        Return the largest and the last energy relative to the initial energy, and True if there was a warning.
        """
        space, contacts = self._space()
        start = 0.5 * self.mass[0] * self.speed**2
        largest = energy = 1.0
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            for _ in range(math.ceil(self.seconds / self.step)):
                space.step(self.step)
                if all(contact.overlap <= 0.0 for contact in contacts):
                    energy = sum(0.5 * ball.mass * ball.velocity.length**2 for ball in space.bodies) / start
                    largest = max(largest, energy)
        return largest, energy, bool(said)

    def _space(self) -> tuple[pymunk.Space, list[SoftContact]]:
        space, far = pymunk.Space(), self.reach
        balls = [pymunk.Body(mass, math.inf) for mass in self.mass]
        places = np.cumsum([0.0, *(far + gap for gap in self.gap)]).tolist()
        for ball, place in zip(balls, places, strict=True):
            ball.position = place, 0.0
        balls[0].velocity = self.speed, 0.0
        bodies = list(balls)
        if self.wall_gap is not None:
            walls = pymunk.Body(body_type=pymunk.Body.STATIC), pymunk.Body(body_type=pymunk.Body.STATIC)
            walls[0].position = -far - self.wall_gap, 0.0
            walls[1].position = places[-1] + far + self.wall_gap, 0.0
            bodies = [walls[0], *balls, walls[1]]
        contacts = [SoftContact(a, b, (0, 0), (0, 0), far, self.law) for a, b in itertools.pairwise(bodies)]
        space.add(*balls, *contacts)
        return space, contacts


def five_balls(law: Contact, substeps: int) -> float:
    """Return the energy of five balls after three seconds, relative to the initial energy."""
    return Row(law, (1.0,) * 5, (0.0,) * 4, 1.0, FRAME / substeps, SECONDS, reach=1.0).run()[1]


def needed(law: Contact) -> int:
    """Return the number of steps per frame that `substeps` recommends for the collision of the table."""
    pair = [pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)]
    return SoftContact(*pair, (0, 0), (0, 0), 1.0, law).substeps(FRAME, 1.0)


def table() -> list[list[str]]:
    """Return the rows of the table in docs/games.md."""
    rows = []
    for name, law in TABLE.items():
        count = needed(law)
        energies = [five_balls(law, substeps) for substeps in (1, 4, count)]
        shown = [f"x {energy:.2g}" if energy >= 10.0 else f"x {energy:.2f}" for energy in energies]
        rows.append([name, *shown[:2], str(count), shown[2]])
    return rows


def drawn(seed: int) -> Row:
    """Return a random chain of balls, generated from `seed`."""
    random = np.random.default_rng(seed)
    strength = 10.0 ** random.uniform(0.0, 6.0)
    laws = (
        hertz(strength),
        hooke(strength),
        power_law(strength**0.5, random.uniform(0.02, 0.9)),
        draft_gear(strength, random.uniform(0.0, 0.1)),
        step_force(strength**0.5),
        Contact(0.0, strength, random.uniform(1.5, 3.0)),
    )
    balls = int(random.integers(2, 7))
    return Row(
        law=laws[seed % len(laws)],
        mass=tuple(random.uniform(0.5, 2.0, balls).tolist()),
        gap=tuple((random.uniform(0.0, 0.1, balls - 1) * random.integers(0, 2, balls - 1)).tolist()),
        speed=10.0 ** random.uniform(-1.0, 1.0),
        step=1.0 / float(random.choice([30, 60, 120, 240])) / float(random.choice([1, 2, 4, 16, 64])),
        seconds=1.0,
        wall_gap=float(random.uniform(0.0, 0.2)) if random.integers(0, 2) else None,
    )


def silent(seeds: Sequence[int]) -> tuple[int, list[tuple[int, float]]]:
    """Return the number of simulations with a warning, and a list for the simulations without a warning.

    The list contains the seed and the gain of energy. The largest gain is first.
    """
    found = {seed: drawn(seed).run() for seed in seeds}
    gains = [(seed, largest - 1.0) for seed, (largest, _, said) in found.items() if not said]
    return len(found) - len(gains), sorted(gains, key=lambda gain: -gain[1])


def main(arguments: list[str] | None = None) -> int:
    """Print the table and the result of the scan. Return 1 if energy grew without a warning."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks soft-contacts", description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=600, help="of the scan; default: %(default)s")
    args = parser.parse_args(arguments)
    print(Report("Five balls at 60 frames a second", COLUMNS, table()).markdown())
    warned, gains = silent(range(args.runs))
    wrong = [seed for seed, gain in gains if gain > SAID]
    print(f"{args.runs} runs: {warned} warned, {len(gains)} not, of which {len(wrong)} gained over {SAID:.0%}")
    print(f"largest gains in silence (seed, gain): {[(seed, round(gain, 4)) for seed, gain in gains[:5]]}")
    return 1 if wrong else 0
