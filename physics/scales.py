"""Scales of a chain, from energy alone: speeds, depth and time of each contact, and the default step."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.chain import GRAVITY, Chain

Array = NDArray[np.float64]

STEPS_A_CONTACT = 1000  # default fixed steps in the shortest contact time
STEPS_A_STOP = 100  # default fixed steps, at the least, in the time in which bed friction stops a bead


def closing_speed(velocity: ArrayLike) -> float:
    """Largest speed [m/s] at which any two beads approach; 1 where nothing moves, so that scales stay finite."""
    speeds = np.asarray(velocity, dtype=np.float64)
    return float(np.ptp(speeds)) or 1.0


def speed_scale(chain: Chain, velocity: ArrayLike) -> float:
    """Largest of the closing speed and the speeds that the drive and pressed contacts can give [m/s]; 1 where all are 0."""
    inner = max(_driven_speed(chain), _released_speed(chain))
    return max(float(np.ptp(np.asarray(velocity))), inner) if inner else closing_speed(velocity)


def _released_speed(chain: Chain) -> float:
    """Largest speed [m/s] at which a contact that is pressed at the start drives its two beads apart; 0 without."""
    squares = [
        2.0 * float(contact.energy(-gap)) * float(weight)
        for contact, gap, weight in zip(chain.contact, chain.gap, chain.inverse_reduced_mass, strict=True)
        if gap < 0.0
    ]
    return max(squares, default=0.0) ** 0.5


def _driven_speed(chain: Chain) -> float:
    """Largest speed [m/s] that a contact reaches under the force by which the drive accelerates a rigid chain; 0 without."""
    if chain.drive_force is None:
        return 0.0
    preload, stiffness, exponent = chain.parameters.law.T
    force = np.maximum(_rigid_forces(chain, chain.drive_force) - preload, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = ((1.0 + exponent) * force / stiffness) ** (1.0 / exponent)
        speed = np.sqrt(2.0 * force * depth * chain.inverse_reduced_mass)
    return float(np.max(speed, where=np.isfinite(speed), initial=0.0))


def _rigid_forces(chain: Chain, drive: Array) -> Array:
    """(n,) contact forces [N] at which all beads accelerate as one; with a wall, an upper bound."""
    from_left, from_right = np.cumsum(drive)[:-1], -np.cumsum(drive[::-1])[-2::-1]
    if chain.walls:
        return np.maximum(from_left, from_right)
    share = np.cumsum(chain.mass)[:-1] / sum(chain.mass)
    rigid: Array = from_left - share * drive.sum()
    return rigid


def contact_scales(chain: Chain, velocity: ArrayLike) -> tuple[Array, Array]:
    """(n,) estimates of largest overlap [m] and contact time [s] if every contact were struck alone.

    Energy balance ``F d + K d**(1+a)/(1+a) = mu v**2 / 2`` with the reduced mass mu, taken from the smaller of its two
    one-term solutions; the time is that of crossing this overlap and back at the closing speed.
    """
    preload, stiffness, exponent = chain.parameters.law.T
    speed = speed_scale(chain, velocity)
    energy = 0.5 * speed**2 / chain.inverse_reduced_mass
    with np.errstate(divide="ignore"):
        by_power = ((1.0 + exponent) * energy / stiffness) ** (1.0 / (1.0 + exponent))
        depth = np.minimum(energy / preload, by_power)
    return depth, 2.0 * depth / speed


def default_step(chain: Chain, velocity: ArrayLike) -> float:
    """Step [s] of a fixed-step method where none is given: a thousandth of the shortest contact time.

    With bed friction it is at most a hundredth of the time in which friction stops a bead.
    """
    shortest = float(contact_scales(chain, velocity)[1].min()) / STEPS_A_CONTACT
    if not chain.friction:
        return shortest
    return min(shortest, speed_scale(chain, velocity) / (chain.friction * GRAVITY) / STEPS_A_STOP)
