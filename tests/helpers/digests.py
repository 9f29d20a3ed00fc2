"""Digits of what the engine answers: every scene frame by frame, and random chains as they are solved, by every method.

    python -m tests.helpers.digests            # says which answers differ from data/digests.json, the one record of them
    python -m tests.helpers.digests --write    # writes it anew, after a change that is meant to change digits

They hold for one arithmetic: the powers, exponentials and
logarithms of the C library and the instructions of the processor. On another one the states themselves are compared, where
a motion is so far determined that a change of 1e-15 in its forces moves no velocity by more than `CALM`.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import sys
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import METHODS, Chain, Coupler, State, advance, simulate
from softcradle.physics.methods import refusal_of
from softcradle.physics.numerics.jit import jit
from softcradle.physics.scales import contact_scales

from softcradle import scenes
from tests.helpers.random_chains import random_collision, random_dissipative

Array = NDArray[np.float64]

FILE = Path(__file__).parent / "data" / "digests.json"
CHECKPOINTS = 12
CONTACT_TIMES = 3.0  # of the quickest contact: the time that is hashed
CALM = 1e-13  # closing speeds
SHAKE = 1e-15  # of the forces
SEEDS = 20  # random chains without, and as many with friction and loss
MOST_CONTACTS = 8
STEPS = 600  # of a run of fixed steps


@jit
def _probe(numbers: Array, found: Array) -> None:
    """Functions of the C library as compiled code calls them, and a product and a sum that might be fused."""
    for i in range(numbers.size):
        x = numbers[i]
        found[0, i], found[1, i] = x**0.1, math.expm1(x)
        found[2, i], found[3, i] = math.log1p(x), x * x + 1.0 / x


def arithmetic() -> str:
    """A name for the arithmetic of this machine: equal where all digits are."""
    numbers = np.minimum(np.random.default_rng(1).lognormal(0.0, 2.0, 5000), 700.0)  # plain Python has no larger expm1
    found = np.empty((4, numbers.size))
    _probe(numbers, found)
    return hashlib.sha256(found.tobytes() + np.power(numbers, 0.3).tobytes()).hexdigest()[:12]


def motions() -> Iterator[tuple[str, Chain, Array, str]]:
    """Name, chain, start velocities and method: every scene by every method that takes its chain.

    Alone, dop853 is for contacts that are not soft: in others it follows every swing, for seconds.
    """
    for name in scenes.names():
        lane = scenes.load(name).lanes[0]
        chain = lane.chain()
        slow = {"scipy", "dop853"} if chain.law_rows[:, 2].min() < 1.0 else {"scipy"}
        for method in METHODS:
            if method.name not in slow and not refusal_of(method.name, chain):
                yield f"{name}/{method.name}", chain, np.asarray(lane.velocity, dtype=float), method.name


def states(chain: Chain, velocity: Array, method: str) -> Array:
    """(CHECKPOINTS, 2n+2) overlaps, rates and the anchor's position and velocity, frame by frame."""
    speed = velocity if np.ptp(velocity) else np.eye(1, velocity.size)[0]
    frame = CONTACT_TIMES * float(contact_scales(chain, speed)[1].min()) / CHECKPOINTS
    state, rows = State.at_start(chain, velocity), []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # explicit methods pass their limits, which is not what is looked at here
        for _ in range(CHECKPOINTS):
            advance(chain, state, frame, method)
            rows.append(np.concatenate((state.overlap, state.rate, state.anchor)))
    return np.array(rows)


def digest(rows: Array) -> str:
    """Of every bit of the states."""
    return hashlib.sha256((rows + 0.0).tobytes()).hexdigest()[:12]  # -0 as 0


def velocities(chain: Chain, row: Array) -> Array:
    """(n+1,) of one row of states."""
    n = chain.contacts
    state = State(0.0, row[:n], row[n : 2 * n], row[2 * n :], np.zeros(n))
    return state.velocity(chain)


def shaken(chain: Chain) -> Chain:
    """The chain with forces that differ in the last digit."""
    laws = [shaken_law(law) for law in chain.contact]
    return replace(chain, contact=tuple(laws))


def shaken_law(law: Any) -> Any:
    """The law likewise; of a coupler both that push and that pull."""
    if isinstance(law, Coupler):
        return replace(law, push=shaken_law(law.push), pull=shaken_law(law.pull))
    return replace(law, preload=law.preload * (1.0 + SHAKE), stiffness=law.stiffness * (1.0 - SHAKE))


def runs() -> Iterator[tuple[str, Chain, Array, str]]:
    """Name, chain, start velocities and method of the runs of random chains; dop853 alone is for those that lose nothing."""
    for seed in range(SEEDS):
        for kind, (chain, velocity) in (
            ("collision", random_collision(seed, MOST_CONTACTS)),
            ("rubbing", random_dissipative(seed)),
        ):
            slow = {"scipy", "dop853", "radau"} if kind == "rubbing" else {"scipy", "dop853"}
            for method in METHODS:
                if method.name not in slow and not refusal_of(method.name, chain):
                    yield f"{kind}/{seed}/{method.name}", chain, velocity, method.name


def solved(chain: Chain, velocity: Array, method: str) -> str:
    """The digest of a run: samples, switches of contacts, final velocities, number of steps."""
    duration = CONTACT_TIMES * float(contact_scales(chain, velocity)[1].min())
    step = None if next(one for one in METHODS if one.name == method).adaptive else duration / STEPS
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        found = simulate(chain, velocity, duration, method, step, samples=33)
    switches = [time for times in found.contact_intervals for interval in times for time in interval]
    parts = (found.overlap, found.rate, found.force, found.final_velocity, switches, found.steps)
    return digest(np.concatenate([np.ravel(part) for part in parts]))


def record() -> dict[str, Any]:
    """Digests and calm velocities of all motions, and digests of all runs."""
    found: dict[str, Any] = {"arithmetic": arithmetic(), "motions": {}, "runs": {}}
    for name, chain, velocity, method in motions():
        rows, other = states(chain, velocity, method), states(shaken(chain), velocity, method)
        speed = float(np.ptp(velocity)) or 1.0
        apart = np.array(
            [np.abs(velocities(chain, a) - velocities(chain, b)).max() for a, b in zip(rows, other, strict=True)]
        )
        calm = int(np.argmax(apart > CALM * speed)) if (apart > CALM * speed).any() else CHECKPOINTS
        entry = {"digest": digest(rows), "calm": calm}
        if calm:
            entry["velocity"] = velocities(chain, rows[calm - 1]).tolist()
        found["motions"][name] = entry
    found["runs"] = {name: solved(*rest) for name, *rest in runs()}
    return found


def differences(old: dict[str, Any], new: dict[str, Any]) -> list[str]:
    """Names of what has other digits, or is in one record alone."""
    kept, made = ({**one["motions"], **one.get("runs", {})} for one in (old, new))
    digests = [
        {name: entry["digest"] if isinstance(entry, dict) else entry for name, entry in one.items()}
        for one in (kept, made)
    ]
    return sorted(name for name in kept.keys() | made.keys() if digests[0].get(name) != digests[1].get(name))


def main() -> int:
    """Compare, or write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true")
    wanted, found = parser.parse_args(), record()
    old = json.loads(FILE.read_text())
    if wanted.write:
        FILE.write_text(json.dumps(found, indent=0) + "\n")
    if old["arithmetic"] != found["arithmetic"]:
        print("the record is of another arithmetic: another processor, C library or compiler")
    changed = differences(old, found)
    print("\n".join([*changed, f"{len(changed)} of {len(found['motions']) + len(found['runs'])} have other digits"]))
    return int(bool(changed) and not wanted.write)


if __name__ == "__main__":
    sys.exit(main())
