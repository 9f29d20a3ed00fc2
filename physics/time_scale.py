"""Time scales of a chain, from energy alone: how deep and how long a contact can be pressed at given velocities."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physics.chain import Chain

Array = NDArray[np.float64]

STEPS_A_CONTACT = 1000  # default fixed step: the shortest contact in this many steps


def closing_speed(velocity: ArrayLike) -> float:
    """Largest speed [m/s] at which any two beads approach; 1 where nothing moves, so that scales stay finite."""
    speeds = np.asarray(velocity, dtype=np.float64)
    return float(np.ptp(speeds)) or 1.0


def contact_scales(chain: Chain, velocity: ArrayLike) -> tuple[Array, Array]:
    """(n,) estimates of largest overlap [m] and contact time [s] if every contact were struck alone.

    Energy balance ``F d + K d**(1+a)/(1+a) = mu v**2 / 2`` with the reduced mass mu, taken from the smaller of its two
    one-term solutions; the time is that of crossing this overlap and back at the closing speed.
    """
    law, inverse_mass = chain.parameters
    preload, stiffness, exponent = law.T
    speed = closing_speed(velocity)
    energy = 0.5 * speed**2 / (inverse_mass[:-1] + inverse_mass[1:])
    with np.errstate(divide="ignore"):
        by_power = ((1.0 + exponent) * energy / stiffness) ** (1.0 / (1.0 + exponent))
        depth = np.minimum(energy / preload, by_power)
    return depth, 2.0 * depth / speed


def default_step(chain: Chain, velocity: ArrayLike) -> float:
    """Step [s] of a fixed-step method where none is given: a thousandth of the shortest contact."""
    return float(contact_scales(chain, velocity)[1].min()) / STEPS_A_CONTACT
