"""Hashes of the results of the engine, with every method. The scenes are hashed frame by frame. Random chains are
hashed after a whole run.

    python -m tests.helpers.digests            # list the results that differ from data/digests.json, the stored hashes
    python -m tests.helpers.digests --write    # rewrite data/digests.json after a change that is meant to change digits

The hashes are the same on every machine, because the engine uses only operations of IEEE 754. The results of the method
`pymunk` are an exception: they depend on the pymunk wheel of the platform.
"""

import argparse
import hashlib
import json
import platform
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import METHODS, Chain, State, advance
from softcradle.physics.methods import refusal_of
from softcradle.physics.scales import contact_scales

from softcradle import scenes
from tests.helpers.random_chains import random_collision, random_dissipative
from tests.helpers.relations import fineness, simulate_quietly

Array = NDArray[np.float64]

FILE = Path(__file__).parent / "data" / "digests.json"
CHECKPOINTS = 12
CONTACT_TIMES = 3.0  # Simulated time that is hashed, as a multiple of the shortest contact time.
# Number of random chains without dissipation. The number of random chains with friction and loss is the same.
SEEDS = 20
MOST_CONTACTS = 8
STEPS = 600  # Number of steps of a run with a fixed step.
# Methods whose results differ on this platform.
NOT_OURS = set() if platform.machine() in ("x86_64", "AMD64") else {"pymunk"}


def motions() -> Iterator[tuple[str, Chain, Array, str]]:
    """Yield name, chain, start velocities and method of live motions. Every scene is combined with every method that
    accepts its chain.

    The method dop853 is used only for chains without soft contacts. With soft contacts, dop853 resolves every
    oscillation, which takes seconds.
    """
    for name in scenes.names():
        lane = scenes.load(name).lanes[0]
        chain = lane.chain()
        slow = {"scipy", "dop853"} if chain.law_rows[:, 2].min() < 1.0 else {"scipy"}
        for method in METHODS:
            if method.name not in slow and not refusal_of(method.name, chain):
                yield f"{name}/{method.name}", chain, np.asarray(lane.velocity, dtype=float), method.name


def states(chain: Chain, velocity: Array, method: str) -> Array:
    """Return the state after each frame as an array of shape (CHECKPOINTS, 2n+2). Each row contains the overlaps, the
    rates, and the position and velocity of the anchor.
    """
    speed = velocity if np.ptp(velocity) else np.eye(1, velocity.size)[0]
    frame = CONTACT_TIMES * float(contact_scales(chain, speed)[1].min()) / CHECKPOINTS
    state, rows = State.at_start(chain, velocity), []
    with warnings.catch_warnings():
        # Explicit methods exceed their step limits in these runs, which does not matter for a hash.
        warnings.simplefilter("ignore")
        for _ in range(CHECKPOINTS):
            advance(chain, state, frame, method)
            rows.append(np.concatenate((state.overlap, state.rate, state.anchor)))
    return np.array(rows)


def digest(rows: Array) -> str:
    # Adding 0.0 turns -0.0 into 0.0. Both values then have the same hash.
    return hashlib.sha256((rows + 0.0).tobytes()).hexdigest()[:12]


def runs() -> Iterator[tuple[str, Chain, Array, str]]:
    """Yield name, chain, start velocities and method of runs of random chains. The method dop853 is used only for
    chains without dissipation.
    """
    for seed in range(SEEDS):
        kinds = {"collision": random_collision(seed, MOST_CONTACTS), "rubbing": random_dissipative(seed)}
        for kind, (chain, velocity) in kinds.items():
            slow = {"scipy", "dop853", "radau"} if kind == "rubbing" else {"scipy", "dop853"}
            for method in METHODS:
                if method.name not in slow and not refusal_of(method.name, chain):
                    yield f"{kind}/{seed}/{method.name}", chain, velocity, method.name


def solved(chain: Chain, velocity: Array, method: str) -> str:
    """Return the hash of a run. The hash includes samples, times of contact changes, final velocities and the number of
    steps.
    """
    duration = CONTACT_TIMES * float(contact_scales(chain, velocity)[1].min())
    with np.errstate(all="ignore"):
        found = simulate_quietly(chain, velocity, duration, method, samples=33, **fineness(method, duration / STEPS))
    switches = [time for times in found.contact_intervals for interval in times for time in interval]
    parts = (found.overlap, found.rate, found.force, found.final_velocity, switches, found.steps)
    return digest(np.concatenate([np.ravel(part) for part in parts]))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true")
    wanted, known = parser.parse_args(), json.loads(FILE.read_text())
    found = {name: digest(states(*rest)) for name, *rest in motions()}
    found |= {name: solved(*rest) for name, *rest in runs()}
    changed = sorted(name for name in known.keys() | found.keys() if known.get(name) != found.get(name))
    if wanted.write:
        FILE.write_text(json.dumps(found, indent=0) + "\n")
    print("\n".join([*changed, f"{len(changed)} of {len(found)} have other digits"]))
    return int(bool(changed) and not wanted.write)


if __name__ == "__main__":
    sys.exit(main())
