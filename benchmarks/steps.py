"""Computing time for one step and one contact with `verlet` and `conserving`.

The time is measured with `advance` on chains in the middle of a collision.
"""

from __future__ import annotations

from collections.abc import Iterator
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from softcradle.physics import Chain, State, advance, one_on, power_law

from benchmarks.reports import Report, at_most

ROUNDS = 9
ALPHA = 0.1
FRAME = 1.0 / 60.0  # Duration of a frame of the live simulation [s].
COLLISION_TIME = 0.8  # Time after the first touch [s]. The time is less than half the contact time of one bead on many.
OVERLAP = 0.01  # Overlap of all equally loaded contacts [m].
CONTACT_STEPS = 400_000  # Largest product of contacts and steps in a round.


class StepCase(NamedTuple):
    """Method, step [s], kind of chain and wanted time [ns].

    The contacts of the chain are all loaded equally, or the chain is in the middle of a collision.
    """

    method: str
    step: float
    contacts: int
    alike: bool
    aim: float


CASES = (
    StepCase("verlet", 1e-6, 4, True, 20.0),
    StepCase("verlet", 1e-6, 4, False, 20.0),
    StepCase("verlet", 1e-6, 1000, True, 15.0),
    StepCase("verlet", 1e-6, 1000, False, 15.0),
    StepCase("conserving", 1e-3, 4, False, 1500.0),
    StepCase("conserving", FRAME, 4, False, 1500.0),
    StepCase("conserving", 1e-3, 1000, False, 1000.0),
    StepCase("conserving", FRAME, 1000, False, 1000.0),
    StepCase("conserving", FRAME, 10_000, False, 1000.0),
    StepCase("conserving", FRAME, 100_000, False, 1000.0),
)


def colliding(contacts: int) -> tuple[Chain, State]:
    """Return a chain in which one bead has hit many soft beads, some time after the first touch."""
    chain = one_on(contacts, power_law(1.0, ALPHA))
    state = State.at_start(chain, np.eye(1, contacts + 1)[0])
    advance(chain, state, COLLISION_TIME, method="conserving", step=FRAME)
    return chain, state


def loaded_alike(contacts: int) -> tuple[Chain, State]:
    """Return beads at rest between two walls. All contacts have equal loads, so each evaluates its power in every step."""
    chain = Chain([np.inf, *np.ones(contacts - 1), np.inf], power_law(1.0, ALPHA))
    state = State.at_start(chain, np.zeros(contacts + 1))
    state.overlap[:] = OVERLAP
    return chain, state


def measure(case: StepCase, contact_steps: int = CONTACT_STEPS, rounds: int = ROUNDS) -> dict[str, Any]:
    """Return the shortest time for a step and a contact over several rounds. Each round starts from the same state."""
    chain, state = (loaded_alike if case.alike else colliding)(case.contacts)
    steps = int(np.clip(contact_steps // case.contacts, 4, 0.5 / case.step))
    seconds = []
    closed = int((state.overlap > 0.0).sum())
    arrays = state.overlap, state.rate, state.anchor, state.force
    start = [array.copy() for array in arrays]
    for _ in range(rounds + 1):  # The first round does not count because it allocates work arrays.
        for array, value in zip(arrays, start, strict=True):
            array[:] = value
        state.time = 0.0
        began = perf_counter()
        advance(chain, state, steps * case.step, method=case.method, step=case.step)
        seconds.append(perf_counter() - began)
    return {
        "method": case.method,
        "step": case.step,
        "contacts": case.contacts,
        "state": "loaded alike" if case.alike else "amid a collision",
        "closed": closed,
        "steps": steps,
        "nanoseconds": min(seconds[1:]) / (steps * case.contacts) * 1e9,
        "aim": case.aim,
    }


def reports() -> Iterator[Report]:
    """Yield the table of measured times."""
    found = [measure(case) for case in CASES]
    rows = [
        [
            row["method"],
            f"{row['step']:.2g}",
            str(row["contacts"]),
            f"{row['state']}, {row['closed']} closed",
            at_most(row["nanoseconds"], row["aim"]),
        ]
        for row in found
    ]
    columns = ["method", "step [s]", "contacts", "state", "ns a contact and step (aim)"]
    note = f"alpha = 1/10; least of {ROUNDS} rounds of at most {CONTACT_STEPS} contact steps"
    yield Report("Cost of a step", columns, rows, [note], found)
