"""What is added to a solve: samples, friction and loss by `accurate` at 1e-6; and to its kernels, by Python around them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from time import perf_counter, thread_time
from typing import Any, NamedTuple

import numpy as np
from softcradle.physics import Chain, draft_gear, hertz, one_on, power_law
from softcradle.physics.simulation import solve

from benchmarks.reports import Report, at_most
from softcradle import warm

TOLERANCE = 1e-6
SAMPLES_AIM, DISSIPATION_AIM = 1.5, 3.0  # times the cost without
ROUNDS = 15
CALLS = 2000  # of a solve that is measured without its kernels


class Pair(NamedTuple):
    """A solve with something added, and the same without."""

    name: str
    chain: Chain
    samples: int
    plain: Chain
    duration: float | None
    aim: float


def pairs() -> list[Pair]:
    """What is added, one by one."""
    four, gears = one_on(4, power_law(1.0, 0.1)), one_on(10, draft_gear(1.0, 1.0))
    sliding, lossy = Chain([1.0] * 5, power_law(1.0, 0.1), friction=0.01), one_on(10, draft_gear(1.0, 1.0, 0.2))
    pulse = one_on(100, hertz(1.0))
    return [
        Pair("one on 4, alpha 1/10: 201 samples", four, 201, four, None, SAMPLES_AIM),
        Pair("Hertz, one on 100: 201 samples", pulse, 201, pulse, 200.0, SAMPLES_AIM),
        Pair("one on 4, alpha 1/10: friction 0.01", sliding, 2, four, None, DISSIPATION_AIM),
        Pair("draft gears, one on 10: loss 0.2", lossy, 2, gears, None, DISSIPATION_AIM),
    ]


def measure(pair: Pair, rounds: int = ROUNDS) -> dict[str, float]:
    """Processor time [s] of both, in turns, the least of all rounds; and their ratio."""
    least = [np.inf, np.inf]
    for _ in range(rounds):
        for k, (chain, samples) in enumerate(((pair.chain, pair.samples), (pair.plain, 2))):
            velocity: Any = np.eye(1, chain.contacts + 1)[0]
            began = thread_time()
            solve(chain, velocity, pair.duration, samples=samples, tolerance=TOLERANCE)
            least[k] = min(least[k], thread_time() - began)
    return {"with": least[0], "without": least[1], "ratio": least[0] / least[1]}


def measure_python(method: str, new: bool, rounds: int = CALLS) -> float:
    """Seconds of one on 4 to its end outside of its kernels, the least of all rounds; with a `new` chain each time or not."""
    law, velocity, least = power_law(1.0, 0.1), [1.0, 0.0, 0.0, 0.0, 0.0], np.inf
    chain = one_on(4, law)
    for _ in range(rounds):
        began = perf_counter()
        found = solve(one_on(4, law) if new else chain, velocity, method=method, samples=2, tolerance=TOLERANCE)
        least = min(least, perf_counter() - began - found.seconds)
    return float(least)


def reports() -> Iterator[Report]:
    """Milliseconds with and without, and their ratio beside its aim; milliseconds of Python."""
    warm(["accurate", "conserving"])
    found = {pair.name: (pair, measure(pair)) for pair in pairs()}
    rows = [
        [name, f"{1e3 * one['with']:.3f}", f"{1e3 * one['without']:.3f}", at_most(one["ratio"], pair.aim)]
        for name, (pair, one) in found.items()
    ]
    columns = ["", "with [ms]", "without [ms]", "ratio (aim)"]
    data = {name: one for name, (_, one) in found.items()}
    yield Report(f"What is added to a solve at {TOLERANCE:g}", columns, rows, [], data)
    python = {
        f"{method}, {'a new chain' if new else 'the same chain'}": measure_python(method, new)
        for method, new in product(("accurate", "conserving"), (False, True))
    }
    rows = [[name, f"{1e3 * seconds:.3f}"] for name, seconds in python.items()]
    yield Report("Python around the kernels of one on 4", ["", "[ms]"], rows, [], python)
