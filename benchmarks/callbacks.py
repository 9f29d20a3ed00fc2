"""Cost of one pymunk step with compiled and with Python contact callbacks.

Every contact stays closed, so each callback evaluates its law in every step. The exponent is alpha = 1/10, whose power
is expensive. The Space has one solver iteration, as for the method `pymunk`, or pymunk's default of ten.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from time import perf_counter

import pymunk
from softcradle.physics import SoftContact, power_law
from softcradle.physics.pymunk_contacts.compiled_force import unavailable

from benchmarks.reports import Report, at_least

CONTACTS = (4, 64)
ITERATIONS = (1, 10)
ROUNDS = 7
STEPS = 2000  # Number of steps in a round.
OVERLAP = 0.01  # Overlap of every contact [m]. The forces are so small that it hardly changes.
RATIO_AIM = 3.0  # Smallest wanted ratio of the Python time to the compiled time, for 4 contacts.


def chain_space(contacts: int, iterations: int, compiled: bool) -> pymunk.Space:
    """Return a Space with a chain of bodies, in which all neighbours are in contact."""
    space = pymunk.Space()
    space.iterations = iterations
    bodies = [pymunk.Body(1.0, 1.0) for _ in range(contacts + 1)]
    for i, body in enumerate(bodies):
        body.position = i * (1.0 - OVERLAP), 0.0
    law = power_law(1e-9, 0.1)
    pairs = itertools.pairwise(bodies)
    space.add(*bodies, *[SoftContact(a, b, (0, 0), (0, 0), 1.0, law, native=compiled) for a, b in pairs])
    return space


def microseconds(space: pymunk.Space) -> float:
    """Return the mean time of a step in microseconds."""
    began = perf_counter()
    for _ in range(STEPS):
        space.step(1e-6)
    return (perf_counter() - began) / STEPS * 1e6


def measure(contacts: int, iterations: int) -> dict[str, float]:
    """Return the shortest time of a step with compiled and with Python callbacks.

    The rounds alternate between both, so other load on the machine affects both.
    """
    spaces = [chain_space(contacts, iterations, compiled) for compiled in (True, False)]
    rounds = [[microseconds(space) for space in spaces] for _ in range(ROUNDS)]
    compiled, python = (min(times) for times in zip(*rounds, strict=True))
    return {
        "contacts": contacts,
        "iterations": iterations,
        "compiled_microseconds": compiled,
        "python_microseconds": python,
        "ratio": python / compiled,
    }


def reports() -> Iterator[Report]:
    """Yield one table, or the reason why compiled callbacks are not available."""
    if unavailable():
        yield Report(f"no compiled pymunk callbacks here: {unavailable()}")
        return
    found = [measure(contacts, iterations) for contacts in CONTACTS for iterations in ITERATIONS]
    rows = []
    for row in found:
        ratio = f"{row['ratio']:.1f}"
        rows.append(
            [
                f"{row['contacts']} contacts, {row['iterations']} iterations",
                f"{row['compiled_microseconds']:.2f}",
                f"{row['python_microseconds']:.2f}",
                at_least(ratio, row["ratio"], RATIO_AIM) if row["contacts"] == 4 else ratio,
            ]
        )
    columns = ["", "compiled [us]", "Python [us]", "ratio (aim)"]
    note = f"least of {ROUNDS} rounds of {STEPS} steps"
    yield Report("One step of a pymunk Space, contacts as callbacks", columns, rows, [note], found)
