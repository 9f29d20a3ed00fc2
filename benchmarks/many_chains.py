"""Simulation of very many short chains.

`ensemble_ends` is compared with `ensemble` on one core. The time of 1e5 collisions is measured on all cores.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from time import perf_counter, process_time
from typing import Any

import numpy as np
from softcradle.physics import ChainBatch, Contact, draft_gear, ensemble, ensemble_ends, hertz, one_on, power_law
from softcradle.physics.ensemble_runs import cores

from benchmarks.reports import Report, at_least, at_most

CHAINS = 2000  # Number of chains in a round of `ensemble_ends`.
ALONE = 200  # Number of chains in a round of `ensemble`. These chains are a part of the chains of `ensemble_ends`.
# Number of collisions of one bead with four at tolerance 1e-6. The goal is for ten times this number.
COLLISIONS = 10_000
TARGETS = 4
TOLERANCE = 1e-6
RATE_AIM = 3.0  # Wanted speed relative to `ensemble`.
SECONDS_AIM = 8.0  # Wanted time for 1e5 collisions on two cores [s].
ROUNDS = 3

CASES: dict[str, Callable[[float], Contact]] = {
    "Hertz": lambda part: hertz(1.0 + part),
    "draft gears": lambda part: draft_gear(500.0 + 200.0 * part, 0.02),
    "power laws, alpha 0.3 to 0.6": lambda part: power_law(1.0, 0.3 + 0.3 * part),
    "power laws, alpha near 0.1": lambda part: power_law(1.0, 0.099 + 0.002 * part),
}
METHODS = ("verlet", "yoshida4")


def measure(law: Callable[[float], Contact], method: str, chains: int = CHAINS, alone: int = ALONE) -> dict[str, float]:
    """Return the processor time [ms] of a collision with each of the two functions, and their ratio.

    The time is that of the shortest round. Methods use their default steps.
    """
    each = [one_on(TARGETS, law(part)) for part in np.linspace(0.0, 1.0, chains).tolist()]
    start, some = np.eye(1, TARGETS + 1)[0], each[:: max(1, chains // alone)][:alone]
    batch, found = ChainBatch.of(each), {"ends": np.inf, "ensemble": np.inf}
    for k in range(ROUNDS + 1):
        began = process_time()
        ensemble_ends(batch, start, method=method, workers=1)
        between = process_time()
        ensemble(some, [start] * len(some), method=method, workers=1)
        if k:  # The first round does not count because it loads kernels.
            found["ends"] = min(found["ends"], 1e3 * (between - began) / chains)
            found["ensemble"] = min(found["ensemble"], 1e3 * (process_time() - between) / len(some))
    return {**found, "ratio": found["ensemble"] / found["ends"]}


def measure_collisions(count: int = COLLISIONS) -> dict[str, float]:
    """Return the seconds for 1e5 collisions on all cores, and the processor time [ms] of one collision.

    One bead hits four, and the method is `accurate` with tolerance 1e-6.
    """
    exponents = np.linspace(0.099, 0.101, count)[:, None]
    start, best, work = np.eye(1, TARGETS + 1)[0], np.inf, np.inf
    for k in range(ROUNDS + 1):
        began, own = perf_counter(), process_time()
        batch = ChainBatch(np.ones((count, TARGETS + 1)), 0.0, 1.0, exponents)
        ensemble_ends(batch, start, tolerance=TOLERANCE)
        if k:
            best, work = min(best, perf_counter() - began), min(work, process_time() - own)
    return {"seconds": 1e5 * best / count, "milliseconds": 1e3 * work / count}


def reports() -> Iterator[Report]:
    """Yield both tables."""
    found: list[dict[str, Any]] = [
        {"case": name, "method": method, **measure(law, method)} for name, law in CASES.items() for method in METHODS
    ]
    rows = [
        [
            f"{row['case']}, {row['method']}",
            f"{row['ensemble']:.3f}",
            f"{row['ends']:.3f}",
            at_least(f"{row['ratio']:.1f}", row["ratio"], RATE_AIM),
        ]
        for row in found
    ]
    columns = ["one on 4", "ensemble [ms]", "ensemble_ends [ms]", "times the rate (aim)"]
    note = f"processor time of a collision with default steps, least of {ROUNDS} rounds; both give the same digits"
    yield Report("Very many short chains, on one core", columns, rows, [note], found)
    many = measure_collisions()
    rows = [
        [f"1e5 of them on {cores()} cores, s", at_most(many["seconds"], SECONDS_AIM)],
        ["one of them, processor ms", f"{many['milliseconds']:.3f}"],
    ]
    note = f"measured at {COLLISIONS} of them, least of {ROUNDS} rounds; the aim is for two cores"
    yield Report("Collisions of one on 4 at 1e-6 by `ensemble_ends`", ["", "measured (aim)"], rows, [note], many)
