"""``python -m benchmarks two-versions PYTHON``: compare the times of the adaptive methods in two versions of
softcradle.

PYTHON is the interpreter of the other version's environment. Each case runs alternately in both versions, in separate
processes. Other load therefore affects both. The shortest time counts, including the Python code around the kernel.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter
from typing import Any

TOLERANCES = (1e-6, 1e-9)
SECONDS = 0.15  # Time that is spent on a case in each turn [s].
FEWEST = 3  # Smallest number of simulations of a case in each turn.
TURNS = 4
# Wanted times of `accurate` at these tolerances [ms], including the Python code.
AIMS = {
    "one on 4": (0.17, 0.40),
    "one on 5": (0.23, 1.1),
    "one on 10": (0.45, 1.3),
    "Hertz 100": (1.9, 3.4),
    "gears": (0.08, 0.15),
}


def cases() -> dict[str, tuple[Any, list[float], float | None]]:
    """Return chain, velocities and duration of each case. Only names that exist in both versions are used."""
    from softcradle import Chain, TimedForce, draft_gear, hertz, hooke, one_on, power_law

    inf = float("inf")
    gears = [draft_gear(3.0, 0.05), draft_gear(20.0, 0.2), draft_gear(50.0, 0.01), draft_gear(8.0, 0.1)]
    mixed = [power_law(1.0, 0.1), draft_gear(2.0, 0.05), hertz(100.0), power_law(3.0, 0.2)]
    chains: dict[str, Any] = {
        "one on 4": one_on(4, power_law(1.0, 0.1)),
        "one on 5": one_on(5, power_law(1.0, 1 / 14)),
        "one on 10": one_on(10, power_law(1.0, 1 / 30)),
        "Hertz 100": one_on(99, hertz(1e4)),
        "gears": one_on(4, draft_gear(1.0, 0.05)),
        "different gears": Chain([1.0, 2.0, 0.5, 1.0, 1.5], gears),
        "mixed contacts": Chain([1.0] * 5, mixed),
        "friction .01": Chain([1.0] * 5, power_law(1.0, 0.1), friction=0.01),
        "loss .2": Chain([1.0] * 5, power_law(1.0, 0.1, loss=0.2)),
    }
    found: dict[str, tuple[Any, list[float], float | None]] = {
        name: (chain, [1.0, *[0.0] * chain.contacts], None) for name, chain in chains.items()
    }
    walls = Chain([inf, 1.0, 1.0, 1.0, inf], hooke(10.0), gap=0.1)
    steady = Chain([1.0] * 5, power_law(1.0, 0.1), drive=[0.1, 0.0, 0.0, 0.0, 0.0])
    sloped = Chain([1.0] * 5, power_law(1.0, 0.1), forces=TimedForce(0, [0.0, 10.0], [0.0, 0.2]))
    return found | {
        "walls": (walls, [0.0, 1.0, 0.0, 0.0, 0.0], 20.0),
        "a steady force": (steady, [1.0, 0.0, 0.0, 0.0, 0.0], 5.0),
        "a force with a slope": (sloped, [1.0, 0.0, 0.0, 0.0, 0.0], 5.0),
    }


def measured() -> dict[str, float]:
    """Measure the shortest time [ms] of each case, method and tolerance in this process."""
    from softcradle.physics.simulation import solve

    found = {}
    for name, (chain, velocity, duration) in cases().items():
        for method in ("accurate", "radau") if name != "Hertz 100" else ("accurate",):
            for tolerance in TOLERANCES:
                least, runs, began = float("inf"), 0, perf_counter()
                while runs < FEWEST or perf_counter() - began < SECONDS:
                    before = perf_counter()
                    solve(chain, velocity, duration, method, samples=2, tolerance=tolerance)
                    least, runs = min(least, perf_counter() - before), runs + 1
                found[f"{name}, {method}, {tolerance:g}"] = 1e3 * least
    return found


def times_of(python: str) -> dict[str, float]:
    """Return the times that a process with the interpreter `python` measures."""
    found: dict[str, float] = json.loads(
        subprocess.run([python, __file__], check=True, capture_output=True, text=True).stdout
    )
    return found


def rows(here: dict[str, float], there: dict[str, float]) -> Iterator[list[str]]:
    """Yield one row for each case and method.

    For each tolerance, it contains the other version's time, the time of this version with its goal, and their ratio.
    """
    from benchmarks.reports import at_most

    for key in [key for key in here if key.endswith(f"{TOLERANCES[0]:g}")]:
        case, method, _ = key.rsplit(", ", 2)
        row = [case, method]
        for k, tolerance in enumerate(TOLERANCES):
            own, other = (times[f"{case}, {method}, {tolerance:g}"] for times in (here, there))
            aim = AIMS[case][k] if case in AIMS and method == "accurate" else None
            row += [at_most(other, None), at_most(own, aim), f"{own / other:.2f}"]
        yield row


def main(arguments: list[str]) -> int:
    """Measure both versions alternately, and print one table."""
    from rich.console import Console

    from benchmarks.reports import Report

    parser = argparse.ArgumentParser(prog="python -m benchmarks two-versions", description=__doc__)
    parser.add_argument("python", help="interpreter of the other version's environment")
    parser.add_argument("--turns", type=int, default=TURNS, help=f"runs of each version (default {TURNS})")
    args = parser.parse_args(arguments)
    if not Path(args.python).exists():
        parser.error(f"{args.python} is not there: give the interpreter of the other version, its .venv/bin/python")
    own: dict[str, float] = {}
    other: dict[str, float] = {}
    for _ in range(args.turns):
        for python, least in ((args.python, other), (sys.executable, own)):
            for key, time in times_of(python).items():
                least[key] = min(time, least.get(key, float("inf")))
    columns = ["case", "method"]
    for tolerance in TOLERANCES:
        columns += [f"other to {tolerance:g}", "this (aim)", "ratio"]
    note = f"milliseconds, the least of {args.turns} turns, Python included; tolerances are asked for alike in both"
    Report("Times of two versions", columns, list(rows(own, other)), [note], {"own": own, "other": other}).show(
        Console(width=140)
    )
    return 0


if __name__ == "__main__":
    print(json.dumps(measured()))
