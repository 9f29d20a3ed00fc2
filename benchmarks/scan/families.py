"""Families of random chains.

A family is a function of a random generator. A family returns a chain, the start velocities and a duration.
"""

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
from softcradle.physics.chain import GRAVITY
from softcradle.physics.scales import contact_scales

Array = NDArray[np.float64]
Draw = np.random.Generator

NUMBER = r"\d+\.\d+(e[+-]?\d+)?"  # Pattern of a number with a decimal point, as Python writes it.


@dataclass(frozen=True)
class Motion:
    """Chain of the scan with its family and seed, its start velocities (n+1,) [m/s], and its duration [s] or None."""

    family: str
    seed: int
    chain: Chain
    velocity: tuple[float, ...]
    duration: float | None = None

    @property
    def key(self) -> str:
        """Text with family, seed and a hash of the chain. Reference solutions are stored under this key.

        For the hash, all numbers of the chain are rounded to ten digits. The rounding is needed because durations
        follow from scales, and the last digits of scales depend on the processor.
        """
        # The text of a chain does not contain the numbers of user-defined laws.
        own = [law.law for law in self.chain.own_laws]
        content = re.sub(
            NUMBER, lambda found: f"{float(found[0]):.10g}", repr((self.chain, self.velocity, self.duration, *own))
        )
        return f"{self.family}/{self.seed}/{hashlib.sha256(content.encode()).hexdigest()[:12]}"

    @property
    def speed(self) -> float:
        """Speed [m/s] to which a tolerance refers. This speed is the largest difference of start velocities, or 1 if
        they are equal.
        """
        return float(np.ptp(self.velocity)) or 1.0


@dataclass(frozen=True)
class FormLaw:
    """Contact law that is not a power law. The law has a strength [N], a length [m] and one of the FORMS."""

    strength: float
    length: float
    form: str

    def force(self, overlap: Array) -> Array:
        """Return the force [N] at `overlap` [m]."""
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
    """Return start velocities of strikers that hit a cluster at rest, or random velocities of all beads."""
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
    """Return a duration [s] of a few contact times."""
    moving = velocity if np.ptp(velocity) else np.eye(1, velocity.size)[0]
    return float(np.median(contact_scales(chain, moving)[1]) * draw.uniform(1.0, 5.0))


def power(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return a chain with one power law for all contacts."""
    n = int(draw.integers(2, 7))
    law = power_law(float(_log(draw, 0.1, 10.0)), float(_log(draw, 0.05, 3.0)))
    return Chain(_masses(draw, n), law), _strike(draw, n), None


def mixed(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return a chain with an exponent and a strength for each contact."""
    n = int(draw.integers(2, 7))
    laws = [power_law(float(_log(draw, 0.1, 10.0)), float(_log(draw, 0.05, 3.0))) for _ in range(n)]
    return Chain(_masses(draw, n), laws), _strike(draw, n), None


def hooke_hertz(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return a chain of springs and spheres. The strengths of the contacts differ by up to four orders of magnitude."""
    n = int(draw.integers(2, 8))
    laws = [(hooke, hertz)[int(draw.integers(2))](float(_log(draw, 1.0, 1e4))) for _ in range(n)]
    return Chain(_masses(draw, n, 0.6), laws), _strike(draw, n), None


def gears(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return a chain of equal or different draft gears. Some chains also contain contacts with a constant force."""
    n = int(draw.integers(2, 7))

    def gear() -> Contact:
        if draw.random() < 0.1:
            return step_force(float(_log(draw, 0.1, 10.0)))
        return draft_gear(float(_log(draw, 1.0, 1e3)), float(_log(draw, 1e-3, 1.0)))

    laws = [gear()] * n if draw.random() < 0.5 else [gear() for _ in range(n)]
    return Chain(_masses(draw, n), laws), float(_log(draw, 0.1, 3.0)) * _strike(draw, n), None


def clusters(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return up to three clusters that collide with each other. There are gaps between the clusters."""
    n = int(draw.integers(3, 8))
    cluster = np.sort(draw.integers(0, 3, n + 1))
    velocity = np.sort(draw.uniform(-1.0, 1.0, 3))[::-1][cluster]
    gap = np.where(np.diff(cluster) > 0, draw.choice([0.0, 0.01, 0.3], n), 0.0)
    return Chain(_masses(draw, n), _laws(draw, n), gap), velocity, None


def driven(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return a chain with steady forces on the beads. Some chains have a wall at the end, and some start at rest."""
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
    """Return a chain with a wall at one end or at both ends."""
    n = int(draw.integers(2, 7))
    mass, velocity = _masses(draw, n), _strike(draw, n)
    ends = ((0,), (n,), (0, n))[int(draw.integers(3))]
    mass[list(ends)], velocity[list(ends)] = math.inf, 0.0
    gap = np.where(draw.random(n) < 0.5, 0.0, draw.uniform(0.0, 0.3, n))
    chain = Chain(mass, _laws(draw, n), gap)
    return chain, velocity, _time(draw, chain, velocity)


def friction(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return a chain on a bed. A third of the chains have loss in the contacts, and some have an external force."""
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
    """Return a chain whose contacts absorb a part of their energy."""
    n = int(draw.integers(1, 6))
    laws = [replace(law, loss=float(draw.uniform(0.05, 0.9))) for law in _laws(draw, n)]
    chain, velocity = Chain(_masses(draw, n), laws), _strike(draw, n)
    return chain, velocity, _time(draw, chain, velocity)


def extreme(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return a chain with masses over eight orders of magnitude and strengths over nine orders."""
    n = int(draw.integers(2, 5))
    mass = np.asarray(_log(draw, 1e-4, 1e4, n + 1))
    laws = [power_law(float(_log(draw, 1e-3, 1e6)), float(draw.choice([0.2, 1.0, 1.5, 2.5]))) for _ in range(n)]
    return Chain(mass, laws), _strike(draw, n), None


def one_on_n(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return the paper's collision, in which one bead hits n equal beads. n is 2 to 30, and the exponent 0.005 to 0.5."""
    n = int(draw.integers(2, 31))
    return one_on(n, power_law(1.0, float(_log(draw, 0.005, 0.5)))), np.eye(1, n + 1)[0], None


def own_laws(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return a chain with user-defined laws. Half of the chains also have power laws, and some have a wall at the end."""
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
    """Return a train whose couplers have loss, slack and stops. Some trains are on a bed, and some are pulled by a
    force.
    """
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
        coupled=True if pull else None,
    )  # fmt: skip


def timed(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return a chain with forces over time. The beads are at rest or struck.

    A third of the chains have brakes over time, and a third are on a bed.
    """
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
    """Return a force over time on one or two beads. The force consists of a pulse, ramps or steps."""
    beads = draw.choice(n + 1, size=int(draw.integers(1, 3)), replace=False).tolist()
    knots = np.sort(draw.uniform(0.0, end, int(draw.integers(1, 5))))
    if draw.random() < 0.4:  # The force has steps, so each breakpoint occurs twice.
        knots = np.repeat(knots, 2)
    return TimedForce(beads, knots, np.append(values[: knots.size - 1], draw.choice([0.0, values[-1]])))


def bounded(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return a long motion between walls, or of beads that couplers hold together. The motion can end in the middle of
    a collision.
    """
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
    """Return a struck chain of two to four beads on a bed. Friction stops the beads about when the contacts open.

    The contacts are soft. The largest overlap is a quarter to two thirds of the distance that the striker would slide
    without contact. Often one bead stops while it still touches its neighbour. The neighbour then stops soon after the
    contact opens.
    """
    n = int(draw.integers(1, 4))
    mass, exponent, friction = _masses(draw, n, 0.3), _bed_exponent(draw), float(_log(draw, 0.03, 1.0))
    gap = np.where(draw.random(n) < 0.3, 0.0, draw.uniform(0.0, 0.1, n))
    velocity, speed = np.zeros(n + 1), float(draw.uniform(0.1, 2.0))
    velocity[: int(draw.integers(1, n + 1))] = speed
    overlap = _sliding_distance(speed, friction) * float(_log(draw, 0.25, 0.65))
    law = power_law(float(mass.min()) * speed**2 / overlap ** (exponent + 1.0), exponent)
    return Chain(mass, law, gap, friction=friction), velocity, float(_log(draw, 0.5, 10.0))


def bed_pressed(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return a chain of two to four beads that overlap at the start, on a bed that holds most of them.

    In nine of ten chains one bead moves. This bead is so fast that it slides over a fifth to three times the largest
    overlap.
    """
    n = int(draw.integers(1, 4))
    law = power_law(float(_log(draw, 0.3, 30.0)), _bed_exponent(draw))
    overlap, friction = np.asarray(_log(draw, 3e-3, 0.3, n)), float(_log(draw, 0.1, 3.0))
    velocity = np.zeros(n + 1)
    if draw.random() < 0.9:
        speed = math.sqrt(float(overlap.max() * _log(draw, 0.2, 3.0)) / _sliding_distance(1.0, friction))
        velocity[int(draw.integers(n + 1))] = draw.choice([-speed, speed])
    return Chain(_masses(draw, n, 0.6), law, -overlap, friction=friction), velocity, float(_log(draw, 0.5, 10.0))


def _sliding_distance(speed: float, friction: float) -> float:
    """Return the distance [m] that a bead with `speed` [m/s] slides on a bed without other forces."""
    return speed**2 / (2.0 * friction * GRAVITY)


def _bed_exponent(draw: Draw) -> float:
    """Return an exponent from 1 to 4, mostly above 2.

    The force of such a contact falls so softly to zero that a long step can carry the contact far past its opening.
    """
    return float(draw.choice([1.0, 1.5, 2.0, 2.5, 3.0, 3.0, 3.5, 4.0]))


def strings(draw: Draw) -> tuple[Chain, Array, float | None]:
    """Return beads on strings for up to two and a half swings. Some chains have gaps, a wall, an external force or
    loss.
    """
    n = int(draw.integers(1, 6))
    mass, laws, velocity = _masses(draw, n), _laws(draw, n), _strike(draw, n)
    if draw.random() < 0.25:
        laws = [replace(law, loss=float(draw.uniform(0.05, 0.9))) for law in laws]
    if n > 1 and draw.random() < 0.15:
        mass[-1], velocity[-1] = math.inf, 0.0
    drive = draw.normal(size=n + 1) * float(_log(draw, 0.01, 0.3)) if draw.random() < 0.15 else None
    # A contact lasts from a thousandth to a third of a swing.
    contact_time = _time(draw, Chain(mass, laws), velocity)
    length = GRAVITY * (contact_time / float(_log(draw, 6e-3, 2.0))) ** 2
    period = 2.0 * math.pi * math.sqrt(length / GRAVITY)
    gap = np.where(draw.random(n) < 0.75, 0.0, draw.uniform(-0.02, 0.1, n))
    chain = Chain(mass, laws, gap, drive, strings=length)
    return chain, velocity, period * float(draw.uniform(0.2, 2.5))


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
    "strings": strings,
}


def motion(family: str, seed: int) -> Motion:
    """Return a random chain of `family`, generated from `seed`."""
    draw = np.random.default_rng([seed, *family.encode()])
    chain, velocity, duration = FAMILIES[family](draw)
    return Motion(family, seed, chain, tuple(float(v) for v in velocity), duration)
