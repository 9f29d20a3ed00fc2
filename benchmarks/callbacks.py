"""Cost of one pymunk step with compiled and with Python contact callbacks: ``python -m benchmarks.callbacks [--json]``.

Every contact is pressed all the time (alpha = 1/10, the costly power), so that every callback works every step. The
Space has one solver iteration, as method `pymunk` sets it, and pymunk's default of ten.
"""

from __future__ import annotations

import argparse
import itertools
import json
from time import perf_counter

import pymunk
from softcradle.physics import SoftContact, power_law
from softcradle.physics.pymunk_contacts import compiled_force as native

CONTACTS = (4, 64)
ITERATIONS = (1, 10)
ROUNDS = 7
STEPS = 2000
PRESSED = 0.01  # overlap [m]; forces so small that it stays


def row(contacts: int, iterations: int, compiled: bool) -> pymunk.Space:
    """A row of bodies, every neighbour pressed."""
    space = pymunk.Space()
    space.iterations = iterations
    bodies = [pymunk.Body(1.0, 1.0) for _ in range(contacts + 1)]
    for i, body in enumerate(bodies):
        body.position = i * (1.0 - PRESSED), 0.0
    law = power_law(1e-9, 0.1)
    pairs = itertools.pairwise(bodies)
    space.add(*bodies, *[SoftContact(a, b, (0, 0), (0, 0), 1.0, law, native=compiled) for a, b in pairs])
    return space


def microseconds(space: pymunk.Space) -> float:
    """Time of a step, mean of many."""
    began = perf_counter()
    for _ in range(STEPS):
        space.step(1e-6)
    return (perf_counter() - began) / STEPS * 1e6


def measure(contacts: int, iterations: int) -> dict[str, float]:
    """Best of some rounds; compiled and Python alternate, so that both meet the same load of the machine."""
    spaces = [row(contacts, iterations, compiled) for compiled in (True, False)]
    rounds = [[microseconds(space) for space in spaces] for _ in range(ROUNDS)]
    compiled, python = (min(times) for times in zip(*rounds, strict=True))
    return {
        "contacts": contacts,
        "iterations": iterations,
        "compiled_microseconds": compiled,
        "python_microseconds": python,
        "ratio": python / compiled,
    }


def main(arguments: list[str] | None = None) -> int:
    """Print the table, or JSON; 1 where there are no compiled callbacks."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print JSON")
    as_json = parser.parse_args(arguments).json
    if native.unavailable():
        print(f"no compiled callbacks here: {native.unavailable()}")
        return 1
    rows = [measure(contacts, iterations) for contacts in CONTACTS for iterations in ITERATIONS]
    if as_json:
        print(json.dumps(rows, indent=1))
        return 0
    print(f"{'contacts':>8} {'iterations':>10} {'compiled us':>11} {'Python us':>9} {'ratio':>5}")
    for found in rows:
        print("{:8d} {:10d} {:11.2f} {:9.2f} {:5.1f}".format(*found.values()))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
