"""One run of the golden record: a call of `simulate` or `advance` as plain numbers, and its answer to the last digit."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics import METHODS, Chain, Contact, State, Trajectory, advance, simulate

Array = NDArray[np.float64]
Table = dict[str, Any]

SAMPLES = 33  # of a run
TOLERANCE = 1e-8  # of adaptive methods
FRAMES = 60  # of a live run
LISTED_INTERVALS = 200  # of one contact; the digest covers them all
ADAPTIVE = {method.name for method in METHODS if method.adaptive}


@dataclass(frozen=True)
class Run:
    """One call of `simulate`, or with `pushes` of `advance` frame by frame; all that it needs, as plain numbers."""

    chain: Table
    method: str
    duration: float | None
    step: float | None
    pushes: dict[str, list[str] | None] | None = None
    samples: int = SAMPLES


def hexed(values: ArrayLike) -> list[str]:
    """Numbers as text that keeps every bit."""
    return [float(value).hex() for value in np.asarray(values, dtype=np.float64).ravel()]


def numbers(texts: Sequence[str]) -> Array:
    """Numbers from what `hexed` made."""
    return np.array([float.fromhex(text) for text in texts])


def digest(*arrays: ArrayLike) -> str:
    """A hash of all bits."""
    found = hashlib.sha256()
    for array in arrays:
        found.update(np.ascontiguousarray(array, dtype=np.float64).tobytes())
    return found.hexdigest()[:32]


def written(chain: Chain, velocity: ArrayLike) -> Table:
    """A chain and its start as plain numbers."""
    return {
        "mass": hexed(chain.mass),
        "contact": [hexed([c.preload, c.stiffness, c.exponent, c.loss]) for c in chain.contact],
        "gap": hexed(chain.gap),
        "drive": None if chain.drive is None else hexed(chain.drive),
        "friction": float(chain.friction).hex(),
        "velocity": hexed(velocity),
    }


def read(table: Table) -> tuple[Chain, Array]:
    """The chain and its start from what `written` made."""
    contacts = [Contact(*numbers(law).tolist()) for law in table["contact"]]
    drive = None if table["drive"] is None else numbers(table["drive"])
    friction = float.fromhex(table["friction"])
    return Chain(numbers(table["mass"]), contacts, numbers(table["gap"]), drive, friction), numbers(table["velocity"])


def answer(run: Run) -> Table:
    """What the engine says: its result, or that it refuses."""
    began = perf_counter()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            found = _moved(run) if run.pushes is None else _played(run)
        except ValueError:
            return {"status": "refused"}
        except Exception as error:  # is a finding like any other
            return {"status": f"error: {type(error).__name__}: {error}"}
    return {"status": "done", "seconds": round(perf_counter() - began, 4), **found}


def _moved(run: Run) -> Table:
    chain, velocity = read(run.chain)
    found = simulate(chain, velocity, run.duration, run.method, run.step, run.samples, TOLERANCE)
    return {
        "final_velocity": hexed(found.final_velocity),
        "steps": found.steps,
        "end": float(found.time[-1]).hex() if found.time.size else "nan",
        "warned": bool(found.warnings),
        "ledger": hexed(found.ledger),
        "digest": digest(found.time, found.overlap, found.rate, found.anchor, found.force),
        "last": hexed(np.concatenate((found.overlap[-1:].ravel(), found.rate[-1:].ravel()))),
        **_switches(found),
    }


def _switches(found: Trajectory) -> Table:
    flat = [[time for interval in intervals for time in interval] for intervals in found.contact_intervals]
    return {
        "intervals": [hexed(times[: 2 * LISTED_INTERVALS]) for times in flat],
        "interval_counts": [len(times) // 2 for times in flat],
        "interval_digest": digest(*flat),
    }


def _played(run: Run) -> Table:
    chain, velocity = read(run.chain)
    assert run.duration is not None
    assert run.pushes is not None
    state, warned = State.at_start(chain, velocity), False
    for frame in range(FRAMES):
        if str(frame) in run.pushes:
            push = run.pushes[str(frame)]
            state.push = None if push is None else numbers(push)
        advance(chain, state, run.duration / FRAMES, run.method, run.step, TOLERANCE)
        warned = warned or bool(state.warnings)
    return {
        "final_velocity": hexed(state.velocity(chain)),
        "steps": state.switches,
        "end": float(state.time).hex(),
        "warned": warned,
        "ledger": hexed(state.absorbed),
        "digest": digest(state.overlap, state.rate, state.anchor, state.force, state.absorbed),
        "last": hexed(np.concatenate((state.overlap, state.rate, state.anchor, state.force))),
    }
