"""Closed-form results for one contact, for rigid clusters, and for a very long linear chain.

Tests compare the numerical methods with them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special
from softcradle.physics.chain import Chain, mass_shares
from softcradle.physics.contact import Contact

Array = NDArray[np.float64]


class Stroke(NamedTuple):
    """Compression and release of one contact: largest overlap [m], contact time [s] and peak force [N]."""

    largest_overlap: float
    contact_time: float
    peak_force: float


def one_on_one(contact: Contact, reduced_mass: float, closing_speed: float) -> Stroke:
    """Solve ``mu d'' = -f(d)`` for two bodies that collide through one contact, from energy and quadrature.

    power law, p = 1 + a   d_max = (p mu v^2 / (2 K))^(1/p),   T = (2 d_max / v) B(1/p, 1/2) / p
    preloaded spring       d + D = D cos wt + (v/w) sin wt,   w^2 = K / mu,   D = F / K,   T = (2/w) atan(v / (w D))
    step force             d_max = mu v^2 / (2 F),   T = 2 mu v / F

    Here d is the overlap, mu the reduced mass, K the stiffness, a the exponent, F the preload and B the beta function.
    The integral of dy / sqrt(1 - y^p) from 0 to 1 is B(1/p, 1/2) / p. A contact with loss l unloads with the fraction 1
    - l of its force. Therefore unloading takes 1 / sqrt(1 - l) times as long as loading.

    Arguments:
        contact: its law. A contact with a preload must have exponent 1 or stiffness 0.
        reduced_mass: mu = m1 m2 / (m1 + m2) [kg].
        closing_speed: v > 0 [m/s].

    Raises:
        ValueError: if the contact has a preload and an exponent other than 1.
    """
    preload, stiffness, exponent = contact.preload, contact.stiffness, contact.exponent
    energy, ways = 0.5 * reduced_mass * closing_speed**2, 1.0 + 1.0 / math.sqrt(1.0 - contact.loss)
    if stiffness == 0.0:
        return Stroke(energy / preload, ways * reduced_mass * closing_speed / preload, preload)
    if preload == 0.0:
        power = 1.0 + exponent
        depth = (power * energy / stiffness) ** (1.0 / power)
        quarter = float(special.beta(1.0 / power, 0.5)) / power
        return Stroke(depth, ways * depth / closing_speed * quarter, stiffness * depth**exponent)
    if exponent != 1.0:
        raise ValueError(f"no closed form for a preload with exponent {exponent!r}: only with exponent 1")
    frequency = math.sqrt(stiffness / reduced_mass)
    peak = math.sqrt(preload**2 + 2.0 * stiffness * energy)
    time = ways / frequency * math.atan(closing_speed * stiffness / (frequency * preload))
    return Stroke(2.0 * energy / (peak + preload), time, peak)


def rigid_masses(mass: ArrayLike, strikers: int) -> tuple[float, float]:
    """Return the total masses [kg] of the first `strikers` beads and of the others."""
    masses = np.asarray(mass, dtype=np.float64)
    return float(masses[:strikers].sum()), float(masses[strikers:].sum())


def rigid_collision(mass: ArrayLike, strikers: int, speed: float = 1.0) -> Array:
    """Return the (N,) velocities after an elastic collision of two rigid bodies.

    One body consists of the first `strikers` beads, the other one of all remaining beads. The result is the limit alpha
    -> 0 of the power law, Eq. (2). For one bead on n equal beads the velocities are ``(1-n)/(1+n)`` and ``2/(n+1)``.
    """
    first, second = rigid_masses(mass, strikers)
    count = np.asarray(mass).size
    before, after = (first - second) / (first + second) * speed, 2.0 * first / (first + second) * speed
    return np.repeat([before, after], [strikers, count - strikers])


def rigid_stroke(contact: Contact, mass: ArrayLike, strikers: int, speed: float = 1.0) -> Stroke:
    """Return the stroke of the struck contact if each side moves as one rigid body.

    The stroke follows from :func:`one_on_one` with the reduced mass of both sides. The result is exact for the step
    force, with contact time ``2n/(n+1) m v / f0`` for one bead on n beads. The result is also exact for draft gears
    below the critical speed. A side may contain a wall.
    """
    first, second = rigid_masses(mass, strikers)
    return one_on_one(contact, 1.0 / (1.0 / first + 1.0 / second), speed)


def long_linear_chain(mass: float = 1.0, stiffness: float = 1.0) -> tuple[float, float]:
    """Return the final velocity of the striker of a very long linear chain, and its contact time [s].

    The velocity is given as a fraction of the initial velocity. The velocity of the striker is ``v0(t) = J1(2wt) /
    (wt)`` with w^2 = k/m. The contact force is proportional to ``J2(2wt) / t`` and first vanishes at 2wt = j_(2,1). At
    this zero, J1(x) / (x/2) = J0(x). So the fraction is J0(j_(2,1)) = -0.1322795, and the contact time is 2.56781
    sqrt(m/k).
    """
    zero = float(special.jn_zeros(2, 1)[0])
    return float(special.j0(zero)), 0.5 * zero * math.sqrt(mass / stiffness)


def critical_speed(gear: Contact, mass: ArrayLike, strikers: int) -> float:
    """Return the largest speed [m/s] at which only the struck contact yields, so that both clusters stay exactly rigid.

    A contact i inside a cluster that only touches transmits the share r_i of the force of the struck contact, Eq. (5).
    The peak of this force is ``sqrt(F^2 + K mu v^2)``. Let r be the largest of these shares. The first inner contact
    reaches its preload F at the speed ``v_c = w D sqrt(1/r^2 - 1)``, w^2 = K (1/M1 + 1/M2), D = F / K. The result is
    infinite for one bead on one bead.

    Raises:
        ValueError: if the contact is not a preloaded spring (exponent 1, stiffness > 0).
    """
    if gear.exponent != 1.0 or gear.stiffness == 0.0:
        raise ValueError("a critical speed needs draft gears: exponent 1, stiffness > 0")
    first, second = rigid_masses(mass, strikers)
    carried = float(np.delete(mass_shares(mass, strikers - 1), strikers - 1).max(initial=0.0))
    if carried == 0.0:
        return math.inf
    frequency = math.sqrt(gear.stiffness * (1.0 / first + 1.0 / second))
    return frequency * gear.preload / gear.stiffness * math.sqrt(1.0 / carried**2 - 1.0)


def common_law(chain: Chain) -> Contact | None:
    """Return the contact law of a chain whose contacts are all equal.

    The result is None if contacts differ, or for couplers and user-defined laws.
    """
    law = chain.contact[0]
    return law if isinstance(law, Contact) and all(contact == law for contact in chain.contact) else None


def meets_freely(chain: Chain, struck: int) -> bool:
    """Return True if two clusters collide at contact `struck` without external forces.

    Inside each cluster, the beads must just touch at the start.
    """
    inside = chain.gap[:struck] + chain.gap[struck + 1 :]
    return chain.gap[struck] >= 0.0 and not (any(inside) or chain.driven or chain.takes_momentum)


def speed_ratio(chain: Chain, struck: int, speed: float) -> float | None:
    """Return the ratio V/v_c of the closing speed to the critical speed for a chain of equal draft gears.

    Contact `struck` closes at `speed` [m/s]. The result is None for a chain without a critical speed.
    """
    gear = common_law(chain)
    if gear is None or gear.exponent != 1.0 or gear.preload == 0.0 or gear.stiffness == 0.0:
        return None
    if chain.walls or not meets_freely(chain, struck):
        return None
    critical = critical_speed(gear, chain.mass, struck + 1)
    return speed / critical if math.isfinite(critical) else None
