"""Long chains with the method `accurate`.

The cases are a collision with a thousand beads, a pulse through part of a Hertz chain, and random chains. In a chain of
equal beads with exponents above 1, a wave leaves the beads behind it with nearly the same velocity. The computed
differences are numerical noise, which must not become a motion. In other chains, beads really chatter behind a wave.
"""

from __future__ import annotations

from collections.abc import Iterator
from time import process_time
from typing import NamedTuple

import numpy as np
from softcradle.physics import Chain, hertz, one_on, power_law, simulate
from softcradle.physics.simulation import solve

from benchmarks.reports import Report, at_most

SPEED = 0.8405  # Speed of the pulse in contacts per second, for beads of 1 kg, 1 N/m**1.5 and an impact at 1 m/s.
BEADS = 100_000  # Number of beads of the Hertz chain.
ROWS, SEED = 100, 5  # Number and seed of the random chains.
# Factor between the tolerance and the smaller tolerance of the simulation from which an error is measured.
FINER = 1e-2


class LongRun(NamedTuple):
    """Simulation of a long chain, and its wanted time."""

    name: str
    chain: Chain
    duration: float | None  # Duration of the simulation [s].
    tolerance: float
    aim: float  # Wanted processor time [s].


def runs() -> list[LongRun]:
    """Return the simulations of long chains."""
    deep, pulse = one_on(1000, power_law(1.0, 0.1)), one_on(BEADS, hertz(1.0))
    return [
        LongRun("one on 1000, alpha 1/10, at 1e-6", deep, None, 1e-6, 1.0),
        LongRun(f"Hertz, 1000 of {BEADS} crossed, at 1e-6", pulse, 1000 / SPEED, 1e-6, 1.0),
        LongRun(f"Hertz, 10000 of {BEADS} crossed, at 1e-4", pulse, 10_000 / SPEED, 1e-4, 10.0),
    ]


def measure() -> dict[str, dict[str, float]]:
    """Measure processor time [s], number of steps and error of each simulation."""
    simulate(one_on(4, power_law(1.0, 0.1)), np.eye(1, 5)[0], samples=2)  # The first simulation loads the kernels.
    found = {}
    for name, chain, duration, tolerance, aim in runs():
        began = process_time()
        motion = simulate(chain, np.eye(1, chain.contacts + 1)[0], duration, tolerance=tolerance, samples=2)
        found[name] = {
            "seconds": process_time() - began,
            "aim": aim,
            "steps": motion.steps,
            "error": float(motion.velocity_error.max()),
        }
    return found


def random_rows(count: int = ROWS, seed: int = SEED) -> Iterator[dict[str, float]]:
    """Yield cost and result of random collisions of one bead with 60 to 1500 equal beads.

    The exponents are random and between 1.1 and 3.
    """
    draw = np.random.default_rng(seed)
    for _ in range(count):
        beads, tolerance = int(60.0 * 25.0 ** draw.random()), float(10.0 ** draw.uniform(-8.0, -4.0))
        exponent = float(draw.uniform(1.1, 3.0))
        chain, velocity = one_on(beads, power_law(100.0, exponent)), np.eye(1, beads + 1)[0]
        began = process_time()
        motion = solve(chain, velocity, tolerance=tolerance, samples=2)
        seconds = process_time() - began
        finer = solve(chain, velocity, tolerance=FINER * tolerance, samples=2)
        error = float(np.abs(motion.final_velocity - finer.final_velocity).max())
        yield {
            "beads": beads,
            "exponent": exponent,
            "tolerance": tolerance,
            "seconds": seconds,
            "stated": float(motion.velocity_error.max()),
            "error": error,
            "closings": sum(map(len, motion.contact_intervals)) / beads,
        }


def _random_report() -> Report:
    rows = list(random_rows())
    told = {
        "processor seconds, most": max(row["seconds"] for row in rows),
        "stated error over tolerance, median": float(np.median([row["stated"] / row["tolerance"] for row in rows])),
        "stated error over tolerance, most": max(row["stated"] / row["tolerance"] for row in rows),
        "error over stated error, most": max(row["error"] / row["stated"] for row in rows),
        "times that a contact closes, most on the average of a row": max(row["closings"] for row in rows),
    }
    note = f"seed {SEED}; errors by runs at {FINER:g} of the tolerance"
    return Report(
        f"{ROWS} random long rows", ["", ""], [[name, f"{value:.3g}"] for name, value in told.items()], [note], rows
    )


def reports() -> Iterator[Report]:
    """Yield a table of times with their goals, and a table for the random chains."""
    yield _random_report()
    found = measure()
    rows = [
        [name, at_most(one["seconds"], one["aim"]), f"{one['steps']:.0f}", f"{one['error']:.1e}"]
        for name, one in found.items()
    ]
    yield Report("Long chains, processor seconds", ["", "s (aim)", "steps", "stated error [m/s]"], rows, [], found)
