"""The chains of the golden record: those of the catalogue, and seeded random ones."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from softcradle.physics import METHODS, Chain, Contact, simulate
from softcradle.scenes import load, names

from benchmarks.golden.golden_run import ADAPTIVE, Array

LIMIT = 2.5  # processor time [s] of a run, of the catalogue or live, beyond which it is recorded as slow
RANDOM_LIMIT = 0.8  # processor time [s] of a run of a random chain
LIVE_SEEDS = 40  # random chains that are also moved frame by frame
SEEDS = 200  # random chains, each in four variants
PARTS = 200  # steps in the shortest contact of a random chain
ALL = [method.name for method in METHODS if method.name != "scipy"]  # which takes minutes


@dataclass(frozen=True)
class Problem:
    """A chain with its start, and which methods shall move it for how long."""

    name: str
    chain: Chain
    velocity: Array
    duration: float | None
    step: float
    methods: Sequence[str]
    live: bool = False
    limit: float = LIMIT
    short: float | None = None  # duration of adaptive methods where it is another


def problems() -> Iterator[Problem]:
    """All of them."""
    for name in names():
        scene = load(name)
        for index, lane in enumerate(scene.lanes):
            chain, velocity = lane.chain(), np.array(lane.velocity)
            step = simulate(chain, velocity, 0.0, "verlet", samples=2).step
            yield Problem(f"scene/{name}/{index}", chain, velocity, scene.duration, step, ALL)
    for seed in range(SEEDS):
        yield from random_problems(seed)


def random_problems(seed: int) -> Iterator[Problem]:
    """A random chain without friction, with that of the bed, with loss in its contacts, and with both."""
    draw = np.random.default_rng(seed)
    plain, velocity = random_chain(draw, seed)
    times = contact_times(plain, velocity)
    closing = float(np.ptp(velocity)) or 1.0
    braked = closing / (9.81 * times.max() * 10 ** draw.uniform(0, 2))  # a bead stops within so many contacts
    lossy = [replace(c, loss=float(draw.choice([0.0, 0.3, 0.8, 0.95]))) for c in plain.contact]
    lossy[0] = replace(lossy[0], loss=0.4)
    wanted = 3.0 * float(times.max()) + np.abs(plain.gap).sum() / closing
    for name, contacts, friction in (
        ("plain", plain.contact, 0.0),
        ("bed", plain.contact, braked),
        ("loss", lossy, 0.0),
        ("both", lossy, braked),
    ):
        chain = Chain(plain.mass, contacts, plain.gap, plain.drive, friction)
        endless = plain.drive is None and (not chain.dissipative or seed % 8 == 0)
        live = seed < LIVE_SEEDS and seed % 4 == ("plain", "bed", "loss", "both").index(name)
        yield Problem(
            f"random/{seed}/{name}", chain, velocity, None if endless else wanted, float(times.min()) / PARTS,
            random_methods(seed, name), live, RANDOM_LIMIT, wanted / 3.0 if chain.dissipative and seed % 16 else None,
        )  # fmt: skip


def random_methods(seed: int, variant: str) -> list[str]:
    """Three methods always, the others in turn; adaptive ones are slow on chains that rub, so that few of those have two."""
    turn = [["radau", "yoshida4"], ["dop853", "euler"], ["euler", "yoshida4"]][seed % 3]
    taken = [name for name in turn if variant == "plain" or name == "euler" or (variant == "both" and name in ADAPTIVE)]
    return ["accurate", "verlet", "conserving", *taken]


def random_chain(draw: np.random.Generator, seed: int) -> tuple[Chain, Array]:
    """One of eight families of laws, in turn; masses, gaps, a wall and a drive as they come."""
    n = int(draw.integers(1, 13))
    contacts = _laws(draw, seed % 8, n)
    decades = 2.0 if seed % 8 == 5 else 0.5 * float(draw.random() < 0.4)
    mass = 10 ** draw.uniform(-decades, decades, n + 1)
    strikers = int(draw.integers(1, n + 1))
    clusters = seed % 8 == 6 or draw.random() < 0.4
    velocity = np.where(np.arange(n + 1) < strikers, 1.0, 0.0) if clusters else draw.normal(size=n + 1)
    gap = np.where(draw.random(n) < 0.6, 0.0, draw.uniform(0.0, 0.3, n))
    if clusters:
        gap = np.where(np.arange(n) == strikers - 1, 0.5 * float(draw.random() < 0.5), 0.0)
    if draw.random() < 0.2:
        wall = n if clusters else int(draw.choice([0, n]))
        mass[wall], velocity[wall] = math.inf, 0.0
    if seed % 10 == 7:  # one contact is pressed from the start
        gap[int(draw.integers(n))] = -0.01
    drive = np.where(np.isfinite(mass), draw.normal(size=n + 1), 0.0) if draw.random() < 0.15 else None
    return Chain(mass, contacts, gap, drive), velocity


def _laws(draw: np.random.Generator, family: int, n: int) -> list[Contact]:
    """(n) contacts: power laws, Hertz and Hooke, draft gears, mixed, step forces; then power laws and mixed again."""
    kinds: list[Callable[[], Contact]] = [
        lambda: Contact(0.0, 10 ** draw.uniform(-0.5, 0.5), 1.0 / draw.uniform(2.0, 30.0)),
        lambda: Contact(0.0, 10 ** draw.uniform(1.0, 3.0), float(draw.choice([1.0, 1.5]))),
        lambda: Contact(10 ** draw.uniform(-1.0, 1.0), 10 ** draw.uniform(0.5, 2.0), 1.0),
        lambda: Contact(draw.uniform(0.0, 2.0), draw.uniform(0.1, 10.0), float(draw.choice([0.1, 0.5, 1.0, 1.5]))),
        lambda: Contact(10 ** draw.uniform(-0.5, 0.5), 0.0, 1.0),
    ]
    if family in (3, 7):
        return [kinds[int(draw.integers(5))]() for _ in range(n)]
    kind = kinds[{5: 0, 6: 0}.get(family, family)]
    return [kind()] * n if draw.random() < 0.4 else [kind() for _ in range(n)]


def contact_times(chain: Chain, velocity: Array) -> Array:
    """(n,) times [s] of about one contact at the closing speed."""
    inverse_mass, speed = 1.0 / np.array(chain.mass), float(np.ptp(velocity)) or 1.0
    energy = 0.5 * speed**2 / (inverse_mass[:-1] + inverse_mass[1:])
    preload, stiffness, exponent = np.array([(c.preload, c.stiffness, c.exponent) for c in chain.contact]).T
    with np.errstate(divide="ignore"):
        by_power = ((1.0 + exponent) * energy / stiffness) ** (1.0 / (1.0 + exponent))
        depth = np.minimum(energy / preload, by_power)
    times: Array = 2.0 * depth / speed
    return times
