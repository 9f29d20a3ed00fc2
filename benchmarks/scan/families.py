"""Families of random chains: each a function from a seeded generator to a chain, its start and its duration."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import (
    Chain,
    Contact,
    Coupler,
    TimedForce,
    draft_gear,
    hertz,
    hooke,
    one_on,
    power_law,
    step_force,
)
from softcradle.physics.scales import contact_scales

Array = NDArray[np.float64]
Draw = np.random.Generator

NUMBER = r"\d+\.\d+(e[+-]?\d+)?"  # with a point, as Python writes it


@dataclass(frozen=True)
class Motion:
    """One chain of the scan: where it came from, its start velocities (n+1,) [m/s] and its duration [s] or None."""

    family: str
    seed: int
    chain: Chain
    velocity: tuple[float, ...]
    duration: float | None = None

    @property
    def key(self) -> str:
        """Family, seed and a digest of the chain, its numbers to ten digits: what a truth is stored under.

        Durations come from scales, whose last digits are the processor's.
        """
        own = [law.law for law in self.chain.own_laws]  # whose numbers the chain does not tell
        content = re.sub(
            NUMBER, lambda found: f"{float(found[0]):.10g}", repr((self.chain, self.velocity, self.duration, *own))
        )
        return f"{self.family}/{self.seed}/{hashlib.sha256(content.encode()).hexdigest()[:12]}"

    @property
    def speed(self) -> float:
        """What a tolerance is relative to [m/s]: the largest difference of start velocities, 1 where there is none."""
        return float(np.ptp(self.velocity)) or 1.0


@dataclass(frozen=True)
class FormLaw:
    """A contact law that is no power: strength [N], length [m] and one of the FORMS."""

    strength: float
    length: float
    form: str

    def force(self, overlap: Array) -> Array:
        """Force [N] at `overlap` [m]."""
        found: Array = self.strength * FORMS[self.form](np.asarray(overlap) / self.length)
        return found


FORMS: dict[str, Callable[[Array], Array]] = {
    "exponential": np.expm1,
    "stiffening": lambda x: x + x**3,
    "saturating": np.tanh,
    "soft": lambda x: np.sqrt(x) + x,
    "preloaded": lambda x: 1.0 + np.log1p(x),
    "bent": lambda x: np.where(x < 0.3, x, 0.3 + 4.0 * (x - 0.3)),
}


def _log(draw: Draw, low: float, high: float, size: int | None = None) -> Array | float:
    return 10.0 ** draw.uniform(math.log10(low), math.log10(high), size)


def _masses(draw: Draw, n: int, decades: float = 1.0) -> Array:
    return np.ones(n + 1) if draw.random() < 0.5 else np.asarray(_log(draw, 0.1**decades, 10.0**decades, n + 1))


def _strike(draw: Draw, n: int) -> Array:
    """Start velocities of one or more strikers on a cluster at rest, or of beads of which each has its own."""
    if draw.random() < 0.3:
        return draw.uniform(-1.0, 1.0, n + 1)
    velocity = np.zeros(n + 1)
    velocity[: int(draw.integers(1, n + 1))] = 1.0
    return velocity


def _any_law(draw: Draw) -> Contact:
    strength = float(_log(draw, 0.1, 100.0))
    return (
        power_law(strength, float(_log(draw, 0.05, 1.0))),
        hooke(strength),
        hertz(strength),
        draft_gear(strength, float(_log(draw, 1e-3, 1.0))),
        step_force(strength),
        Contact(float(draw.uniform(0.0, 2.0)), strength, float(_log(draw, 0.1, 2.0))),
    )[int(draw.integers(6))]


def _laws(draw: Draw, n: int) -> list[Contact]:
    if draw.random() < 0.4:
        return [_any_law(draw)] * n
    return [_any_law(draw) for _ in range(n)]


def _time(draw: Draw, chain: Chain, velocity: Array) -> float:
    """A duration [s] of a few contacts."""
    moving = velocity if np.ptp(velocity) else np.eye(1, velocity.size)[0]
    return float(np.median(contact_scales(chain, moving)[1]) * draw.uniform(1.0, 5.0))


def power(draw: Draw) -> tuple[Chain, Array, float | None]:
    """One exponent for all contacts."""
    n = int(draw.integers(2, 7))
    law = power_law(float(_log(draw, 0.1, 10.0)), float(_log(draw, 0.05, 3.0)))
    return Chain(_masses(draw, n), law), _strike(draw, n), None


def mixed(draw: Draw) -> tuple[Chain, Array, float | None]:
    """An exponent and a strength for each contact."""
    n = int(draw.integers(2, 7))
    laws = [power_law(float(_log(draw, 0.1, 10.0)), float(_log(draw, 0.05, 3.0))) for _ in range(n)]
    return Chain(_masses(draw, n), laws), _strike(draw, n), None


def hooke_hertz(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Springs and spheres with strengths over four decades."""
    n = int(draw.integers(2, 8))
    laws = [(hooke, hertz)[int(draw.integers(2))](float(_log(draw, 1.0, 1e4))) for _ in range(n)]
    return Chain(_masses(draw, n, 0.6), laws), _strike(draw, n), None


def gears(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Draft gears, alike or not, some with step forces among them."""
    n = int(draw.integers(2, 7))

    def gear() -> Contact:
        if draw.random() < 0.1:
            return step_force(float(_log(draw, 0.1, 10.0)))
        return draft_gear(float(_log(draw, 1.0, 1e3)), float(_log(draw, 1e-3, 1.0)))

    laws = [gear()] * n if draw.random() < 0.5 else [gear() for _ in range(n)]
    return Chain(_masses(draw, n), laws), float(_log(draw, 0.1, 3.0)) * _strike(draw, n), None


def clusters(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Two or three clusters with gaps between them that run into each other."""
    n = int(draw.integers(3, 8))
    cluster = np.sort(draw.integers(0, 3, n + 1))
    velocity = np.sort(draw.uniform(-1.0, 1.0, 3))[::-1][cluster]
    gap = np.where(np.diff(cluster) > 0, draw.choice([0.0, 0.01, 0.3], n), 0.0)
    return Chain(_masses(draw, n), _laws(draw, n), gap), velocity, None


def driven(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Steady forces on the beads, some chains with a wall at the end, some at rest at first."""
    n = int(draw.integers(1, 6))
    mass = _masses(draw, n)
    velocity = _strike(draw, n) * float(draw.random() < 0.7)
    if draw.random() < 0.4:
        mass[-1], velocity[-1] = math.inf, 0.0
    drive = np.where(np.isfinite(mass), draw.normal(size=n + 1) * float(_log(draw, 0.01, 1.0)), 0.0)
    gap = np.where(draw.random(n) < 0.7, 0.0, draw.uniform(0.0, 0.3, n))
    chain = Chain(mass, _laws(draw, n), gap, drive)
    return chain, velocity, _time(draw, chain, velocity)


def walls(draw: Draw) -> tuple[Chain, Array, float | None]:
    """A wall at one end or both."""
    n = int(draw.integers(2, 7))
    mass, velocity = _masses(draw, n), _strike(draw, n)
    ends = ((0,), (n,), (0, n))[int(draw.integers(3))]
    mass[list(ends)], velocity[list(ends)] = math.inf, 0.0
    gap = np.where(draw.random(n) < 0.5, 0.0, draw.uniform(0.0, 0.3, n))
    chain = Chain(mass, _laws(draw, n), gap)
    return chain, velocity, _time(draw, chain, velocity)


def friction(draw: Draw) -> tuple[Chain, Array, float | None]:
    """A bed that brakes, in a third of the chains with loss in the contacts and in some with a drive."""
    n = int(draw.integers(1, 6))
    laws = _laws(draw, n)
    if draw.random() < 0.33:
        laws = [replace(law, loss=float(draw.uniform(0.05, 0.9))) for law in laws]
    mass = _masses(draw, n)
    drive = draw.normal(size=n + 1) if draw.random() < 0.2 else None
    gap = np.where(draw.random(n) < 0.6, 0.0, draw.uniform(0.0, 0.2, n))
    chain = Chain(mass, laws, gap, drive, float(_log(draw, 1e-3, 0.5)))
    velocity = _strike(draw, n)
    return chain, velocity, _time(draw, chain, velocity)


def loss(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Contacts of which each takes a part of its energy."""
    n = int(draw.integers(1, 6))
    laws = [replace(law, loss=float(draw.uniform(0.05, 0.9))) for law in _laws(draw, n)]
    chain, velocity = Chain(_masses(draw, n), laws), _strike(draw, n)
    return chain, velocity, _time(draw, chain, velocity)


def extreme(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Masses over eight decades, strengths over nine."""
    n = int(draw.integers(2, 5))
    mass = np.asarray(_log(draw, 1e-4, 1e4, n + 1))
    laws = [power_law(float(_log(draw, 1e-3, 1e6)), float(draw.choice([0.2, 1.0, 1.5, 2.5]))) for _ in range(n)]
    return Chain(mass, laws), _strike(draw, n), None


def one_on_n(draw: Draw) -> tuple[Chain, Array, float | None]:
    """The paper's collision: one bead on n alike, n from 2 to 30, exponent from 0.005 to 0.5."""
    n = int(draw.integers(2, 31))
    return one_on(n, power_law(1.0, float(_log(draw, 0.005, 0.5)))), np.eye(1, n + 1)[0], None


def own_laws(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Laws of one's own, in half of the chains beside power laws, some with a wall at the end."""
    n = int(draw.integers(1, 6))
    laws: list[FormLaw | Contact] = [_form(draw)] * n if draw.random() < 0.3 else [_form(draw) for _ in range(n)]
    if draw.random() < 0.5:
        laws[1:] = [_any_law(draw) if draw.random() < 0.4 else law for law in laws[1:]]
    mass, velocity = _masses(draw, n), _strike(draw, n)
    if n > 1 and draw.random() < 0.2:
        mass[-1], velocity[-1] = math.inf, 0.0
    gap = np.where(draw.random(n) < 0.7, 0.0, draw.uniform(0.0, 0.3, n))
    chain = Chain(mass, laws, gap)
    return chain, velocity, _time(draw, chain, velocity)


def _form(draw: Draw) -> FormLaw:
    form = str(draw.choice(list(FORMS)))
    return FormLaw(float(_log(draw, 0.3, 30.0)), float(_log(draw, 0.1, 1.0)), form)


def couplers(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Trains: couplers with gears that lose, with slack, with stops, some on a bed, some pulled by a force."""
    n = int(draw.integers(1, 5))
    link = _coupler(draw) if draw.random() < 0.5 else None
    laws = [link or _coupler(draw) for _ in range(n)]
    mass, velocity = _masses(draw, n, 0.5), _strike(draw, n)
    rolling = float(_log(draw, 1e-3, 0.1)) if draw.random() < 0.3 else 0.0
    drive = draw.normal(size=n + 1) if draw.random() < 0.3 else None
    gap = np.where(draw.random(n) < 0.5, 0.0, draw.uniform(-0.05, 0.2, n))
    chain = Chain(mass, laws, gap, drive, rolling)
    return chain, velocity, 2.0 * _time(draw, chain, velocity)


def _coupler(draw: Draw) -> Coupler:
    def gear() -> Contact:
        strength, lost = float(_log(draw, 3.0, 300.0)), draw.choice([0.0, draw.uniform(0.05, 0.8)])
        if draw.random() < 0.7:
            return draft_gear(strength, float(_log(draw, 1e-3, 0.1)), float(lost))
        return replace(hooke(strength), loss=float(lost))

    solid = draw.random() < 0.4
    pull = gear() if draw.random() < 0.8 else None
    return Coupler(
        gear(), pull, float(draw.choice([0.0, draw.uniform(0.0, 0.2)])) if pull else 0.0,
        float(draw.uniform(0.02, 0.3)) if solid else math.inf, float(_log(draw, 1e3, 1e5)) if solid else 0.0,
    )  # fmt: skip


def timed(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Forces over time, in a third of the chains brakes over time, in a third a bed, from rest or from a strike."""
    n = int(draw.integers(1, 6))
    mass, laws = _masses(draw, n), _laws(draw, n)
    velocity = _strike(draw, n) * float(draw.random() < 0.7)
    gap = np.where(draw.random(n) < 0.7, 0.0, draw.uniform(0.0, 0.3, n))
    end = _time(draw, Chain(mass, laws, gap), velocity)
    strength = float(_log(draw, 0.01, 3.0))
    forces = [_over_time(draw, n, end, strength * draw.normal(size=9)) for _ in range(int(draw.integers(1, 3)))]
    brakes = [_over_time(draw, n, end, strength * draw.random(9))] if draw.random() < 0.3 else []
    rolling = float(_log(draw, 1e-3, 0.3)) if draw.random() < 0.3 else 0.0
    return Chain(mass, laws, gap, None, rolling, forces, brakes), velocity, end


def _over_time(draw: Draw, n: int, end: float, values: Array) -> TimedForce:
    """Pulse, ramps or steps on one bead or two."""
    beads = draw.choice(n + 1, size=int(draw.integers(1, 3)), replace=False).tolist()
    knots = np.sort(draw.uniform(0.0, end, int(draw.integers(1, 5))))
    if draw.random() < 0.4:  # steps: each time twice
        knots = np.repeat(knots, 2)
    return TimedForce(beads, knots, np.append(values[: knots.size - 1], draw.choice([0.0, values[-1]])))


def bounded(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Motions that go on for long and may end in the middle of a bounce: between walls, or held together by couplers."""
    n = int(draw.integers(1, 6))
    mass, velocity = _masses(draw, n, 0.5), _strike(draw, n)
    if n == 1 or draw.random() < 0.5:
        laws: list[Contact | Coupler] = (
            [_coupler(draw)] * n if draw.random() < 0.5 else [_coupler(draw) for _ in range(n)]
        )
        if draw.random() < 0.3:
            mass[-1], velocity[-1] = math.inf, 0.0
        gap = np.zeros(n)
    else:
        laws = [*_laws(draw, n)]
        mass[[0, n]], velocity[[0, n]] = math.inf, 0.0
        gap = np.where(draw.random(n) < 0.5, 0.0, draw.uniform(0.0, 0.3, n))
    chain = Chain(mass, laws, gap)
    return chain, velocity, _time(draw, chain, velocity) * float(_log(draw, 1.0, 15.0))


def bed_struck(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Two to four beads on a bed that are struck: exponents from 1 to 4, with gaps, until most beads have come to rest."""
    n = int(draw.integers(1, 4))
    law = power_law(float(_log(draw, 0.3, 30.0)), _bed_exponent(draw))
    gap = np.where(draw.random(n) < 0.5, 0.0, draw.uniform(0.0, 0.1, n))
    velocity = np.zeros(n + 1)
    velocity[: int(draw.integers(1, n + 1))] = draw.uniform(0.1, 2.0)
    chain = Chain(_masses(draw, n, 0.6), law, gap, friction=float(_log(draw, 0.01, 3.0)))
    return chain, velocity, float(_log(draw, 0.5, 10.0))


def bed_pressed(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Two to four beads that overlap at the start, on a bed that holds some of them; in half of the chains one is fast."""
    n = int(draw.integers(1, 4))
    law = power_law(float(_log(draw, 0.3, 30.0)), _bed_exponent(draw))
    gap = -np.asarray(_log(draw, 0.03, 0.5, n))
    velocity = np.zeros(n + 1)
    if draw.random() < 0.5:
        velocity[int(draw.integers(n + 1))] = draw.uniform(-2.0, 2.0)
    chain = Chain(_masses(draw, n, 0.6), law, gap, friction=float(_log(draw, 3e-3, 1.0)))
    return chain, velocity, float(_log(draw, 0.5, 10.0))


def _bed_exponent(draw: Draw) -> float:
    return float(draw.choice([1.0, 1.5, 2.0, 2.5, 3.0, 4.0, draw.uniform(1.0, 4.0)]))


FAMILIES: dict[str, Callable[[Draw], tuple[Chain, Array, float | None]]] = {
    "power": power,
    "mixed": mixed,
    "hooke-hertz": hooke_hertz,
    "gears": gears,
    "clusters": clusters,
    "driven": driven,
    "walls": walls,
    "friction": friction,
    "loss": loss,
    "extreme": extreme,
    "one-on-n": one_on_n,
    "timed": timed,
    "own-laws": own_laws,
    "couplers": couplers,
    "bounded": bounded,
    "bed-struck": bed_struck,
    "bed-pressed": bed_pressed,
}


def motion(family: str, seed: int) -> Motion:
    """The chain of `family` with this seed."""
    draw = np.random.default_rng([seed, *family.encode()])
    chain, velocity, duration = FAMILIES[family](draw)
    return Motion(family, seed, chain, tuple(float(v) for v in velocity), duration)
