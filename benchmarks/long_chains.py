"""Long chains by `accurate`: a collision with a thousand beads, and a pulse in a Hertz chain of which it crosses a part."""

from __future__ import annotations

from collections.abc import Iterator
from time import process_time
from typing import NamedTuple

import numpy as np
from softcradle.physics import Chain, hertz, one_on, power_law, simulate

from benchmarks.reports import Report, at_most

SPEED = 0.8405  # of the pulse: contacts a second, for beads of 1 kg, 1 N/m**1.5 and a hit at 1 m/s
BEADS = 100_000  # of the Hertz chain


class LongRun(NamedTuple):
    """A run, and what it may take."""

    name: str
    chain: Chain
    duration: float | None  # [s]
    tolerance: float
    aim: float  # processor time [s]


def runs() -> list[LongRun]:
    """At finer tolerances the longest one checks itself by a finer run, for which contacts behind the pulse rattle."""
    deep, pulse = one_on(1000, power_law(1.0, 0.1)), one_on(BEADS, hertz(1.0))
    return [
        LongRun("one on 1000, alpha 1/10, at 1e-6", deep, None, 1e-6, 1.0),
        LongRun(f"Hertz, 1000 of {BEADS} crossed, at 1e-6", pulse, 1000 / SPEED, 1e-6, 1.0),
        LongRun(f"Hertz, 10000 of {BEADS} crossed, at 1e-4", pulse, 10_000 / SPEED, 1e-4, 10.0),
    ]


def measure() -> dict[str, dict[str, float]]:
    """Processor time [s], steps and their error of each."""
    simulate(one_on(4, power_law(1.0, 0.1)), np.eye(1, 5)[0], samples=2)  # loads the kernels
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


def reports() -> Iterator[Report]:
    """Seconds beside their aims."""
    found = measure()
    rows = [
        [name, at_most(one["seconds"], one["aim"]), f"{one['steps']:.0f}", f"{one['error']:.1e}"]
        for name, one in found.items()
    ]
    yield Report("Long chains, processor seconds", ["", "s (aim)", "steps", "stated error [m/s]"], rows, [], found)
