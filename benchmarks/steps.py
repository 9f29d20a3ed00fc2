"""Cost of one step and contact of `verlet` and `conserving`, by `advance` on chains in the middle of a collision."""

from __future__ import annotations

from collections.abc import Iterator
from time import perf_counter
from typing import Any

import numpy as np
from softcradle.physics import Chain, State, advance, one_on, power_law

from benchmarks.report import Report, against

ROUNDS = 9
ALPHA = 0.1
FRAME = 1.0 / 60.0
MIDDLE = 0.8  # [s] less than half the time of contact
PRESSED = 0.01  # [m] overlap of all contacts alike
WORK = 400_000  # contacts times steps in a measurement

# method, step [s], contacts, all contacts pressed alike (True) or amid a collision, aim [ns]
CASES: tuple[tuple[str, float, int, bool, float | None], ...] = (
    ("verlet", 1e-6, 4, True, 20.0),
    ("verlet", 1e-6, 4, False, 20.0),
    ("verlet", 1e-6, 1000, True, 15.0),
    ("verlet", 1e-6, 1000, False, 15.0),
    ("conserving", 1e-3, 4, False, 1500.0),
    ("conserving", FRAME, 4, False, 1500.0),
    ("conserving", 1e-3, 1000, False, 1000.0),
    ("conserving", FRAME, 1000, False, 1000.0),
    ("conserving", FRAME, 10_000, False, 1000.0),
    ("conserving", FRAME, 100_000, False, 1000.0),
)


def amid(contacts: int) -> tuple[Chain, State]:
    """One on many soft beads, some way into the collision."""
    chain = one_on(contacts, power_law(1.0, ALPHA))
    state = State.at_start(chain, np.eye(1, contacts + 1)[0])
    advance(chain, state, MIDDLE, method="conserving", step=FRAME)
    return chain, state


def pressed(contacts: int) -> tuple[Chain, State]:
    """Beads between two walls, every contact pressed alike and at rest: no contact is spared its power."""
    chain = Chain([np.inf, *np.ones(contacts - 1), np.inf], power_law(1.0, ALPHA))
    state = State.at_start(chain, np.zeros(contacts + 1))
    state.overlap[:] = PRESSED
    return chain, state


def nanoseconds(method: str, step: float, contacts: int, alike: bool, work: int = WORK, rounds: int = ROUNDS) -> Any:
    """Least time a step and contact of some rounds, each from the same state."""
    chain, state = (pressed if alike else amid)(contacts)
    steps = int(np.clip(work // contacts, 4, 0.5 / step))
    spent = []
    closed = int((state.overlap > 0.0).sum())
    start = state.overlap.copy(), state.rate.copy(), state.anchor.copy(), state.force.copy()
    for _ in range(rounds + 1):  # the first finds its scratch memory
        for now, then in zip((state.overlap, state.rate, state.anchor, state.force), start, strict=True):
            now[:] = then
        state.time = 0.0
        began = perf_counter()
        advance(chain, state, steps * step, method=method, step=step)
        spent.append(perf_counter() - began)
    return {
        "method": method,
        "step": step,
        "contacts": contacts,
        "state": "pressed alike" if alike else "amid a collision",
        "closed": closed,
        "steps": steps,
        "nanoseconds": min(spent[1:]) / (steps * contacts) * 1e9,
    }


def reports() -> Iterator[Report]:
    """The one table."""
    found = [{**nanoseconds(*case[:4]), "aim": case[4]} for case in CASES]
    rows = [
        [
            str(row["method"]),
            f"{row['step']:.2g}",
            str(row["contacts"]),
            f"{row['state']}, {row['closed']} closed",
            against(row["nanoseconds"], row["aim"]),
        ]
        for row in found
    ]
    columns = ["method", "step [s]", "contacts", "state", "ns a contact and step (aim)"]
    note = f"alpha = 1/10; least of {ROUNDS} rounds of about {WORK} contact steps"
    yield Report("Cost of a step", columns, rows, [note], found)
