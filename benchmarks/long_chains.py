"""Long chains by `accurate`: a collision with a thousand beads, and a pulse in a Hertz chain of which it crosses a part."""

from __future__ import annotations

from collections.abc import Iterator
from time import process_time

import numpy as np
from softcradle.physics import hertz, one_on, power_law, simulate

from benchmarks.reports import Report, at_most

SPEED = 0.8405  # of the pulse: contacts a second, for beads of 1 kg, 1 N/m**1.5 and a hit at 1 m/s
BEADS = 100_000  # of the Hertz chain
CROSSED = {1000: 1.0, 10_000: 10.0}  # beads of it that the pulse crosses, and seconds that this may take
DEEP = "one on 1000, alpha 1/10"
AIMS = {DEEP: 1.0} | {f"Hertz, {beads} of {BEADS} crossed": aim for beads, aim in CROSSED.items()}


def measure() -> dict[str, dict[str, float]]:
    """Processor time [s], steps and their error of each."""
    simulate(one_on(4, power_law(1.0, 0.1)), np.eye(1, 5)[0], samples=2)  # loads the kernels
    deep, pulse = one_on(1000, power_law(1.0, 0.1)), one_on(BEADS, hertz(1.0))
    cases = [(deep, None), *((pulse, beads / SPEED) for beads in CROSSED)]
    found = {}
    for name, (chain, duration) in zip(AIMS, cases, strict=True):
        began = process_time()
        motion = simulate(chain, np.eye(1, chain.contacts + 1)[0], duration, tolerance=1e-6, samples=2)
        found[name] = {
            "seconds": process_time() - began,
            "steps": motion.steps,
            "error": float(motion.velocity_error.max()),
        }
    return found


def reports() -> Iterator[Report]:
    """Seconds beside their aims."""
    found = measure()
    rows = [
        [name, at_most(one["seconds"], AIMS[name]), f"{one['steps']:.0f}", f"{one['error']:.1e}"]
        for name, one in found.items()
    ]
    yield Report(
        "Long chains at 1e-6, processor seconds", ["", "s (aim)", "steps", "stated error [m/s]"], rows, [], found
    )
