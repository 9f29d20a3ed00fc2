"""Comparison of softcradle with numbers from other sources. This module lists all numbers and checks them."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq
from softcradle.physics import (
    Chain,
    Contact,
    Trajectory,
    cluster_on_cluster,
    draft_gear,
    hertz,
    hooke,
    one_on,
    power_law,
    simulate,
    step_force,
)
from softcradle.physics.analysis.closed_forms import critical_speed, long_linear_chain, one_on_one, rigid_stroke
from softcradle.physics.chain import GRAVITY
from softcradle.physics.simulation import solve
from softcradle.sandbox.studies.paper import crest

# Allowed difference for the simulations of this file. The tolerance of the simulations is a hundredth of this
# difference.
ALLOWED = 1e-7


@dataclass(frozen=True)
class KnownNumber:
    """A number known from another source.

    Attributes:
        name: description with unit.
        value: the number.
        source: origin of the number.
        find: function that computes the number with softcradle.
        allowed: largest allowed difference, relative to `value` unless that is 0. It is the last digit given, or the
            tolerance.
    """

    name: str
    value: float
    source: str
    find: Callable[[], float]
    allowed: float = ALLOWED


@dataclass(frozen=True)
class Checked:
    """A known number, the result of softcradle and their difference. The difference is absolute if the known number is
    0.
    """

    known: KnownNumber
    found: float
    error: float

    @property
    def agrees(self) -> bool:
        """Return True if the difference is within its allowed limit."""
        return self.error <= self.known.allowed


def check(known: KnownNumber) -> Checked:
    """Compute a number with softcradle, and compare it with the known number."""
    found = known.find()
    return Checked(known, found, abs(found - known.value) / (abs(known.value) or 1.0))


Array = NDArray[np.float64]
TOLERANCE = 1e-9
QUADRUPLE = "Taylor series of order 26 to 36 in quadruple precision"
GEAR = draft_gear(770.0, 0.0177)  # Draft gear of the paper. GEAR_MASS is its mass.
GEAR_MASS = 0.396
TAPER = 0.95
FINAL = {  # Velocity of the striker after a collision at 1 m/s, with unit masses and strengths.
    (4, 0.1): -0.56758562476447303918,
    (5, 0.1): -0.59285240054465332785,
    (4, 1 / 14): -0.59754443842240887993,
    (5, 1.5): -0.071085017086094284724,
    (4, 1.0): -0.13227948470970768681,
}


def _closed_forms() -> Iterator[KnownNumber]:
    """Yield numbers that are known from closed formulas.

    The numbers include velocities of the striker and of the last of two on two, contact times, critical speeds, loss,
    and balls with gaps.
    """
    for (n, exponent), value in FINAL.items():
        name = f"velocity of the striker, one on {n}, alpha {exponent:.3g} [m/s]"
        yield KnownNumber(name, value, QUADRUPLE, partial(_final, one_on(n, power_law(1.0, exponent)), 0))
    bessel, long = "J0 at the first zero of J2", long_linear_chain()[0]
    yield KnownNumber("striker of a long Hooke chain [m/s]", long, bessel, partial(_final, one_on(12, hooke(1.0)), 0))
    for n in (2, 9):
        name, rigid = f"rigid limit: striker, one on {n} step forces [m/s]", (1 - n) / (1 + n)
        yield KnownNumber(name, rigid, "two rigid bodies", partial(_final, one_on(n, step_force(1.0)), 0))
    pairs = cluster_on_cluster(2, 2, power_law(1.0, 0.1))
    last = partial(_final, pairs, 3, strikers=2)
    yield KnownNumber("velocity of the last, two on two, alpha 0.1 [m/s]", 1.0011285726409516, QUADRUPLE, last)
    laws = {"alpha 1/10": power_law(1.0, 0.1), "Hertz": hertz(1.0), "draft gear": GEAR, "step force": step_force(1.0)}
    for kind, law in laws.items():
        name, time = f"contact time of two beads, {kind} [s]", one_on_one(law, 0.5, 1.0).contact_time
        yield KnownNumber(name, time, "beta function or arctangent", partial(_contact_time, law))
    for n in (3, 5):
        name, known = f"critical speed of one gear on {n} [m/s]", critical_speed(GEAR, [GEAR_MASS] * (n + 1), 1)
        source = "w D sqrt(2N-1)/(N-1), rigid clusters"
        yield KnownNumber(name, known, source, partial(_measured_critical_speed, n), 1e-4)
    yield KnownNumber("restitution at loss 0.36", 0.8, "sqrt(1 - loss)", _restitution)
    yield KnownNumber("way of a bead on a bed, friction 0.3 [m]", 1.0 / (0.6 * GRAVITY), "v**2 / (2 mu g)", _way)
    # Masses of balls whose diameter is 0.95 of the previous diameter.
    tapered = tuple(TAPER ** (3 * k) for k in range(10))
    passed = math.prod(2.0 * m / (m + after) for m, after in pairwise(tapered))
    known_from = "elastic collisions of two balls, 2 m / (m + M) each"
    for name, known, mass in (
        ("Newton's cradle with gaps: last of five [m/s]", 1.0, (1.0,) * 5),
        ("ball 4 to 1 through 2, with gaps [m/s]", 16 / 9, (4.0, 2.0, 1.0)),
        ("tapered chain of ten, with gaps: last [m/s]", passed, tapered),
    ):
        yield KnownNumber(name, known, known_from, partial(_final, Chain(mass, hertz(1e6), gap=0.5), -1))


def _end(chain: Chain, start: ArrayLike, duration: float | None = None) -> Trajectory:
    """Return the simulation from the velocities `start`, which contains only the final state."""
    return simulate(chain, np.asarray(start), duration, samples=2, tolerance=TOLERANCE)


def _final(chain: Chain, bead: int, strikers: int = 1) -> float:
    """Return the final velocity of a bead after the first beads, at 1 m/s, have hit the other beads."""
    return float(_end(chain, [1.0] * strikers + [0.0] * (chain.contacts + 1 - strikers)).final_velocity[bead])


def _contact_time(law: Contact) -> float:
    closed, opened = _end(one_on(1, law), [1.0, 0.0]).contact_intervals[0][0]
    return opened - closed


def _measured_critical_speed(n: int) -> float:
    """Return the speed at which an inner draft gear first yields, found by bisection."""
    chain = one_on(n, GEAR, GEAR_MASS)
    low, high = 0.1, 3.0
    while high - low > 1e-5 * high:
        speed = 0.5 * (low + high)
        pressed_in = 0.55 * rigid_stroke(GEAR, chain.mass, 1, speed).contact_time
        deepest = simulate(chain, [speed] + [0.0] * n, pressed_in, samples=401, tolerance=1e-8).overlap[:, 1:].max()
        low, high = (low, speed) if deepest > 0.0 else (speed, high)
    return 0.5 * (low + high)


def _restitution() -> float:
    return float(np.diff(_end(one_on(1, hertz(1.0, 0.36), [1.0, 3.0]), [1.0, 0.0]).final_velocity)[0])


def _way() -> float:
    chain = Chain([1.0, 1.0], hertz(1.0), gap=10.0, friction=0.3)
    return float(_end(chain, [1.0, 0.0], 1.0).position[-1, 0])


# Coefficient of restitution. With gaps the striker then follows the other balls. Touching balls throw it back.
RESTITUTION = 0.8
BALLS = ("striker", "middle", "last")


def _three_balls() -> Iterator[KnownNumber]:
    modes = "normal modes up to each opening"
    for ball, known in enumerate(touching_springs()):
        name = f"three balls that touch, Hooke: {BALLS[ball]} [m/s]"
        yield KnownNumber(name, known, modes, partial(_final, one_on(2, hooke(1.0)), ball))
    undone = "collisions of two balls; Donahue et al., Phys. Fluids 20, 113301 (2008)"
    apart = Chain([1.0] * 3, hertz(1e6, 1.0 - RESTITUTION**2), gap=0.5)
    for ball, known in enumerate(with_gaps(RESTITUTION)):
        name = f"three balls with gaps, restitution {RESTITUTION:g}: {BALLS[ball]} [m/s]"
        yield KnownNumber(name, known, undone, partial(_final, apart, ball))
    magic = "1 / cos(pi / n) - 1; Ee and Lee, arXiv:1310.5200"
    for n in (5, 7, 9):
        name = f"ball of {magic_mass(n):.4g} between two of 1, with gaps"
        chain = Chain([1.0, magic_mass(n), 1.0], hertz(1e6), gap=0.5)
        yield KnownNumber(f"{name}: last [m/s]", 1.0, magic, partial(_final, chain, 2))
        yield KnownNumber(f"{name}: its collisions", n - 1.0, magic, partial(_collisions, chain), 0.0)


def magic_mass(n: int) -> float:
    """Return the mass of a middle ball that transfers all momentum from one ball of mass 1 to another.

    The transfer takes n - 1 collisions, and n is odd. In coordinates of equal inertia, the two gaps are the sides of a
    wedge of angle pi / n. The cosine of this angle is 1 / (1 + mass).
    """
    return 1.0 / math.cos(math.pi / n) - 1.0


def touching_springs() -> tuple[float, float, float]:
    """Return the velocities after one bead at 1 m/s has hit two, for unit masses and springs.

    The modes have the frequencies 1 and sqrt(3), and after the first opening sqrt(2). The overlaps are ``(sin t +-
    sin(sqrt(3) t) / sqrt(3)) / 2``. The first contact opens first. The energy left in the second contact then drives
    its two balls apart.
    """
    root3 = math.sqrt(3.0)
    opened = brentq(lambda t: math.sin(t) + math.sin(root3 * t) / root3, math.pi / root3, math.pi, xtol=1e-15)
    slow, fast = 0.5 * math.cos(opened), math.cos(root3 * opened)
    striker, middle, last = 1.0 / 3.0 + slow + fast / 6.0, 1.0 / 3.0 - fast / 3.0, 1.0 / 3.0 - slow + fast / 6.0
    overlap = 0.5 * (math.sin(opened) - math.sin(root3 * opened) / root3)
    mean, apart = 0.5 * (middle + last), 0.5 * math.hypot(middle - last, math.sqrt(2.0) * overlap)
    return striker, mean - apart, mean + apart


def with_gaps(restitution: float) -> tuple[float, float, float]:
    """Return the velocities of equal balls after one ball at 1 m/s has hit two with gaps.

    The balls collide in pairs until no two balls approach each other.
    """
    velocity = [1.0, 0.0, 0.0]
    while faster := [i for i in (0, 1) if velocity[i] > velocity[i + 1]]:
        i = faster[0]
        mean, apart = 0.5 * (velocity[i] + velocity[i + 1]), 0.5 * restitution * (velocity[i] - velocity[i + 1])
        velocity[i : i + 2] = [mean - apart, mean + apart]
    return velocity[0], velocity[1], velocity[2]


def _collisions(chain: Chain) -> float:
    """Return how often contacts close after bead 0, at 1 m/s, has hit the other beads."""
    return float(sum(map(len, _end(chain, [1.0] + [0.0] * chain.contacts).contact_intervals)))


ROW_MASS = (1.0, 2.0, 0.5, 1.5, 1.0)
ROW_LAWS = (power_law(1.0, 0.3), hertz(5.0), draft_gear(10.0, 0.05), hertz(2.0))
ROW_START = (1.0, 0.2, 0.0, 0.0, -0.4)


def _symmetries() -> Iterator[KnownNumber]:
    source = "symmetry of the equations"
    yield KnownNumber("change by a moving observer [m/s]", 0.0, source, _galilean)
    yield KnownNumber("change by a mirror [m/s]", 0.0, source, _mirrored)
    yield KnownNumber("change by other units", 0.0, source, _rescaled)
    yield KnownNumber("start found again backwards [m/s]", 0.0, source, _reversed)


def _apart(one: Array, other: Array) -> float:
    return float(np.abs(one - other).max())


def _galilean() -> float:
    chain, start = Chain(ROW_MASS, ROW_LAWS), np.array(ROW_START)
    return _apart(_end(chain, start + 3.0).final_velocity - 3.0, _end(chain, start).final_velocity)


def _mirrored() -> float:
    image = _end(Chain(ROW_MASS[::-1], ROW_LAWS[::-1]), -np.array(ROW_START)[::-1])
    return _apart(-image.final_velocity[::-1], _end(Chain(ROW_MASS, ROW_LAWS), ROW_START).final_velocity)


def _rescaled() -> float:
    """Compute a collision in other units of length, time and mass. Forces scale as M L / T**2."""
    length, time, mass = 1e-3, 1e-4, 7.0
    force = mass * length / time**2
    laws = [Contact(c.preload * force, c.stiffness * force / length**c.exponent, c.exponent) for c in ROW_LAWS]
    speed = length / time
    image = _end(Chain(np.array(ROW_MASS) * mass, laws), np.array(ROW_START) * speed)
    return _apart(image.final_velocity / speed, _end(Chain(ROW_MASS, ROW_LAWS), ROW_START).final_velocity)


def _reversed() -> float:
    """Simulate a collision backwards from its end. The positions must be the same, with reversed velocities."""
    forward = _end(Chain(ROW_MASS, hertz(5.0)), ROW_START)
    back = Chain(ROW_MASS, hertz(5.0), gap=-forward.overlap[-1])
    return _apart(-_end(back, -forward.final_velocity).final_velocity, np.array(ROW_START))


LENGTH = 60  # Number of beads behind the striker.
FIRST, LAST = 20, 45  # Contacts between which the pulse has its final shape.
DEPTH = 500  # Number of beads of the column.
WEAK = 1e-4  # Speed of the uppermost bead [m/s]. The speed is small compared with the velocity of sound at this bead.
# Number of samples of a simulation. The largest overlap is computed from a parabola through three samples. The error of
# this overlap is a few 1e-6.
SAMPLES = 1201
SOURCE = "long chains of unit spheres, K = 1, struck by one at 1 m/s"


def _pulse_numbers() -> Iterator[KnownNumber]:
    yield KnownNumber("Hertz pulse: contacts a second", 0.840509, SOURCE, _speed, 1e-4)
    yield KnownNumber("Hertz pulse: largest overlap [m]", 0.742309, SOURCE, _overlap, 1e-4)
    yield KnownNumber(
        "width of the Hertz pulse in diameters", 4.967, "pi sqrt(10) / 2, Nesterenko's compacton", _width, 0.1
    )
    for m in (2, 3, 5):
        yield KnownNumber(f"pulses that {m} strikers send", float(m), "one each", partial(_pulses, m), 0.0)
    hong = "Hong, Ji and Kim, Phys. Rev. Lett. 82, 3058 (1999): weak pulses, great depths"
    yield KnownNumber("Hertz chain under its weight: peak velocity as depth to the power", -0.25, hong, _weighted, 0.02)


@cache
def _struck(strikers: int) -> Trajectory:
    chain = Chain([1.0] * (LENGTH + strikers), hertz(1.0))
    velocity = [1.0] * strikers + [0.0] * LENGTH
    time = np.linspace(0.0, 1.15 * LENGTH, SAMPLES)
    return simulate(chain, velocity, float(time[-1]), samples=time, tolerance=1e-8)


def _weighted() -> float:
    """Return the slope of the logarithm of the peak velocity of a bead against the logarithm of its depth in a column.

    Only the lower half of the column counts. The column has unit masses, unit gravity and unit contacts. Contact i
    carries i + 1 beads, so its overlap is i + 1 to the power 2/3.
    """
    carried = np.arange(1.0, DEPTH + 1.0)
    chain = Chain([1.0] * DEPTH + [math.inf], hertz(1.0), gap=-(carried ** (2.0 / 3.0)), drive=[1.0] * DEPTH + [0.0])
    # At this time, the pulse has not yet returned from the ground.
    passed = 0.97 * float((1.0 / np.sqrt(1.5 * carried ** (1.0 / 3.0))).sum())
    velocity = [WEAK] + [0.0] * DEPTH
    found = simulate(chain, velocity, passed, "verlet", 0.03, samples=round(passed / 0.1))
    peak, lower = found.velocity.max(axis=0), slice(DEPTH // 2, round(0.85 * DEPTH))
    return float(np.polyfit(np.log(carried[lower]), np.log(peak[:-1][lower]), 1)[0])


def _peak(found: Trajectory, contact: int) -> tuple[float, float]:
    """Return the time and the size of the largest overlap of a contact."""
    return crest(found.time, found.overlap[:, contact])


def _speed() -> float:
    found = _struck(1)
    return (LAST - FIRST) / (_peak(found, LAST)[0] - _peak(found, FIRST)[0])


def _overlap() -> float:
    return _peak(_struck(1), LAST)[1]


def _width() -> float:
    """Return the width of the pulse, computed from the second moment of velocities along the chain.

    The velocities are assumed to have the shape cos**4 (Nesterenko).
    """
    found = _struck(1)
    k = int(np.argmax(found.overlap[:, LAST]))
    velocity: NDArray[np.float64] = np.maximum(found.velocity[k, FIRST:], 0.0)
    place = np.arange(velocity.size)
    mean = velocity @ place / velocity.sum()
    spread = float(np.sqrt(velocity @ (place - mean) ** 2 / velocity.sum()))
    return spread / _COSINE_SPREAD


_X = np.linspace(-0.5, 0.5, 20001)
# Spread of the shape cos**4 of width 1.
_COSINE_SPREAD = float(np.sqrt((np.cos(np.pi * _X) ** 4 * _X**2).sum() / (np.cos(np.pi * _X) ** 4).sum()))


def _pulses(strikers: int) -> float:
    """Return the number of force maxima in a contact far from the strikers.

    Maxima below a twentieth of the largest one are ignored.
    """
    force = _struck(strikers).force[:, LENGTH // 2 + strikers]
    inner = force[1:-1]
    tops = (inner > force[:-2]) & (inner >= force[2:]) & (inner > 0.05 * force.max())
    return float(tops.sum())


STRING = 0.1  # Length of the strings [m].
BLOW = 0.3  # Speed of the first ball at the lowest place [m/s].
OMEGA = math.sqrt(GRAVITY / STRING)
PERIOD = 2.0 * math.pi / OMEGA
ROCKING = "all balls swing together at last: Hutzler et al., Am. J. Phys. 72, 1508 (2004)"
SWINGS = 5.37  # Time of the closed formula for two balls, in periods. No contact is closed at this time.
BALL_MASS, BALL_STIFFNESS = 0.1, 3e5  # Mass and stiffness of balls whose contacts last about a hundredth of a swing.


def _cradle() -> Iterator[KnownNumber]:
    """Yield numbers for balls on strings: periods, exchange of momentum, energy, and the last motion."""
    yield KnownNumber("swing of a ball on a string [s]", PERIOD, "2 pi sqrt(l/g), small angles", _swing)
    chain = Chain([1.0, 1.0], hooke(1e6), strings=STRING)
    sines = "half sines of the frequencies sqrt(2 k/m + g/l) and sqrt(g/l)"
    for ball, velocity in enumerate(two_balls(1e6, SWINGS * PERIOD)):
        name = f"two Hooke balls after {SWINGS} swings, ball {ball} [m/s]"
        yield KnownNumber(name, velocity, sines, partial(_swung, chain, ball))
    yield KnownNumber("lossy cradle, one of five: energy that is left", 0.2, ROCKING, _common_swing, 1e-3)
    conserved = "conserved; method conserving"
    yield KnownNumber("cradle, one of five: change of energy in 1000 swings", 0.0, conserved, _energy_change, 1e-10)


def two_balls(stiffness: float, time: float) -> tuple[float, float]:
    """Return the velocities [m/s] of two balls on strings at `time` [s].

    The balls have a mass of 1 kg and a Hooke contact. The first ball starts with the speed BLOW. The overlap is half a
    sine while the contact is closed, and half a sine while it is open. The centre of mass swings freely.
    """
    inside = math.sqrt(2.0 * stiffness + OMEGA**2)
    left = time % (math.pi / inside + math.pi / OMEGA)
    closed = inside * left < math.pi
    rate = BLOW * (math.cos(inside * left) if closed else -math.cos(OMEGA * (left - math.pi / inside)))
    mean = 0.5 * BLOW * math.cos(OMEGA * time)
    return mean + 0.5 * rate, mean - 0.5 * rate


def _swing() -> float:
    chain = Chain([1.0, 1.0], hertz(1e6), strings=STRING)
    found = simulate(chain, [-BLOW, 0.0], 0.6 * PERIOD, samples=2, tolerance=TOLERANCE)
    return 2.0 * found.contact_intervals[0][0][0]


def _swung(chain: Chain, ball: int) -> float:
    found = simulate(chain, [BLOW, 0.0], SWINGS * PERIOD, samples=2, tolerance=TOLERANCE)
    return float(found.final_velocity[ball])


def _common_swing() -> float:
    """Return the fraction of the energy that is left after 60 swings of balls with loss."""
    chain = Chain([BALL_MASS] * 5, Contact(0.0, BALL_STIFFNESS, 1.5, loss=0.1), strings=STRING)
    found = solve(chain, [-BLOW, 0.0, 0.0, 0.0, 0.0], 60 * PERIOD, "conserving", PERIOD / 2000, 2)
    return float((found.kinetic_energy + found.string_energy)[-1] / found.kinetic_energy[0])


def _energy_change() -> float:
    chain = Chain([BALL_MASS] * 5, hertz(BALL_STIFFNESS), strings=STRING)
    found = solve(chain, [-BLOW, 0.0, 0.0, 0.0, 0.0], 1000 * PERIOD, "conserving", PERIOD / 700, 101)
    return float(np.ptp(found.ledger) / found.ledger[0])


def known_numbers() -> list[KnownNumber]:
    """Return all known numbers in the order of the table."""
    return [*_closed_forms(), *_three_balls(), *_pulse_numbers(), *_cradle(), *_symmetries()]


def verified(report: Callable[[Checked], None] = lambda _: None) -> list[Checked]:
    """Compute all known numbers, and call `report` after each."""
    found = []
    for known in known_numbers():
        found.append(check(known))
        report(found[-1])
    return found
