"""The critical speed of draft gears: up to it a struck cluster moves exactly as one rigid body."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from softcradle.physics.analysis.closed_forms import rigid_masses
from softcradle.physics.chain import Chain, mass_shares
from softcradle.physics.contact import Contact


def critical_speed(gear: Contact, mass: ArrayLike, strikers: int) -> float:
    """Largest speed [m/s] at which no contact but the struck one yields, so that both clusters stay exactly rigid.

    While contact i inside a cluster only touches, it carries the share r_i of the struck contact's force f, Eq. (5), and the
    peak of f is ``sqrt(F^2 + K mu v^2)``. With r the largest share, the first contact reaches F at
    ``v_c = w D sqrt(1/r^2 - 1)``, w^2 = K (1/M1 + 1/M2), D = F / K. Infinite for one on one.

    Raises:
        ValueError: the contact is no preloaded spring (exponent 1, stiffness > 0).
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
    """The contact law of a chain whose contacts are all alike; None where they differ, or are couplers or laws of one's own."""
    law = chain.contact[0]
    return law if isinstance(law, Contact) and all(contact == law for contact in chain.contact) else None


def speed_ratio(chain: Chain, struck: int, speed: float) -> float | None:
    """V/v_c of draft gears, all alike, whose contact `struck` closes at `speed` [m/s]; None where there is no critical speed."""
    gear = common_law(chain)
    if gear is None or chain.walls or gear.exponent != 1.0 or gear.preload == 0.0 or gear.stiffness == 0.0:
        return None
    critical = critical_speed(gear, chain.mass, struck + 1)
    return speed / critical if math.isfinite(critical) else None
